//! Why a mesh was refused.

/// Why a mesh was refused: what, where, and what is accepted. Lines and faces are counted from 1.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum MeshError {
    /// Nothing to read.
    #[error(
        "the OBJ is empty; expected Wavefront OBJ text with `v x y z` and `f a b c` lines, in metres"
    )]
    Empty,
    /// A line that cannot be parsed.
    #[error("OBJ line {line}: {message}")]
    Syntax {
        /// The line.
        line: usize,
        /// What is wrong with it and what is accepted.
        message: String,
    },
    /// No faces.
    #[error(
        "the OBJ has {vertices} vertices but no face with three or more corners; expected at least one line such \
         as `f 1 2 3`"
    )]
    NoFaces {
        /// `v` lines read.
        vertices: usize,
    },
    /// A face names a vertex that the file does not have.
    #[error(
        "OBJ line {line}, face {face}: position index {index} is out of range; accepted are 1 … {available} and, \
         counted back from the line, -1 … -{available_before}"
    )]
    FaceIndex {
        /// The line.
        line: usize,
        /// The face.
        face: usize,
        /// The index as written.
        index: i64,
        /// The number in the file.
        available: usize,
        /// The number in the file before the line.
        available_before: usize,
    },
    /// NaN or infinity as a coordinate.
    #[error(
        "OBJ line {line}: coordinate `{text}` is not finite; expected a decimal number in metres"
    )]
    NonFinite {
        /// The line.
        line: usize,
        /// The number as written.
        text: String,
    },
    /// A coordinate above the renderer's limit.
    #[error(
        "OBJ line {line}: coordinate `{text}` is too large; accepted are -{limit:e} … {limit:e} m"
    )]
    TooLarge {
        /// The line.
        line: usize,
        /// The number as written.
        text: String,
        /// Largest magnitude, m.
        limit: f64,
    },
    /// More triangles than the limit.
    #[error(
        "OBJ line {line}: the mesh has more than {limit} triangles, the maximum; simplify or split it"
    )]
    TooManyTriangles {
        /// The line of the face that exceeds the limit.
        line: usize,
        /// Most triangles of one mesh.
        limit: usize,
    },
    /// A concave polygon with too many corners.
    #[error(
        "OBJ line {line}: a concave polygon of {corners} corners is too much to cut into triangles; accepted are {limit} corners, and \
         fewer where a mesh has many such polygons; triangulate the mesh"
    )]
    PolygonTooLarge {
        /// The line of the face.
        line: usize,
        /// Its corners.
        corners: usize,
        /// Most corners of a concave polygon.
        limit: usize,
    },
    /// Every triangle is degenerate.
    #[error(
        "none of the {triangles} triangles has an area: their corners coincide or lie on a line; expected at least one \
         triangle with three distinct corners"
    )]
    NoArea {
        /// Triangles read.
        triangles: usize,
    },
    /// The store is full.
    #[error(
        "the mesh takes {needed_bytes} bytes, but the mesh store holds {used_bytes} of at most {budget_bytes} bytes; \
         delete meshes that are not needed; a larger store is a setting of the program (CAUSTICA_MESH_STORE_BYTES)"
    )]
    StoreFull {
        /// Bytes the mesh needs.
        needed_bytes: u64,
        /// Bytes held.
        used_bytes: u64,
        /// Maximum number of bytes held.
        budget_bytes: u64,
    },
    /// The OBJ library refused a file that passed our checks.
    #[error("the OBJ cannot be read: {reason}; expected Wavefront OBJ text")]
    Unreadable {
        /// The library's message.
        reason: String,
    },
}
