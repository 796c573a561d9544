//! Why a mesh was refused.

/// Why a mesh was refused: what, where, and what would be accepted. Lines and faces count from 1.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum MeshError {
    /// Nothing to read.
    #[error(
        "the OBJ is empty; expected Wavefront OBJ text with `v x y z` and `f a b c` lines, in metres"
    )]
    Empty,
    /// Bytes that are no text.
    #[error(
        "the {file} is not UTF-8 text: byte {offset} (line {line}) starts an invalid sequence; expected Wavefront \
         {file} text in UTF-8 or ASCII"
    )]
    NotUtf8 {
        /// `OBJ` or `MTL`.
        file: &'static str,
        /// Bytes before the first invalid one.
        offset: usize,
        /// Its line.
        line: usize,
    },
    /// A line that cannot be understood.
    #[error("{file} line {line}: {message}")]
    Syntax {
        /// `OBJ` or `MTL`.
        file: &'static str,
        /// The line.
        line: usize,
        /// What is wrong with it and what would be accepted.
        message: String,
    },
    /// Vertices, perhaps, but no surface.
    #[error(
        "the OBJ has {vertices} vertices but no face with three or more corners; expected at least one line such \
         as `f 1 2 3`"
    )]
    NoFaces {
        /// `v` lines read.
        vertices: usize,
    },
    /// A face names a vertex or normal that the file does not have.
    #[error(
        "OBJ line {line}, face {face}: {what} index {index} is out of range; accepted are 1 … {available} and, \
         counted back from the line, -1 … -{available_before}"
    )]
    FaceIndex {
        /// The line.
        line: usize,
        /// The face.
        face: usize,
        /// `position` or `normal`.
        what: &'static str,
        /// The index as written.
        index: i64,
        /// How many the file has.
        available: usize,
        /// How many the file has before the line.
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
    /// A coordinate beyond what the renderer can place.
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
    /// More triangles than the service takes.
    #[error(
        "OBJ line {line}: the mesh has more than {limit} triangles, the most that is accepted; simplify or split it"
    )]
    TooManyTriangles {
        /// The line of the face that was one too many.
        line: usize,
        /// Most triangles of one mesh.
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
    /// The store has no room.
    #[error(
        "the mesh takes {needed_bytes} bytes, but the mesh store holds {used_bytes} of at most {budget_bytes} bytes; \
         delete meshes or raise the limit"
    )]
    StoreFull {
        /// What the mesh would take.
        needed_bytes: u64,
        /// What is held.
        used_bytes: u64,
        /// What may be held.
        budget_bytes: u64,
    },
    /// The OBJ reader refused what the checks before it let pass.
    #[error("the OBJ cannot be read: {reason}; expected Wavefront OBJ text")]
    Unreadable {
        /// The reader's words.
        reason: String,
    },
}
