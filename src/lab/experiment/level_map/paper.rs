//! What the thesis measured (Tipprasert 2006, tables 5-1 … 5-4): GeForce 6800, 512² texels, seconds a frame.
//!
//! In table 5-1 the volumetric times of teapot and sphere are equal to the last digit in all rows: one of the columns is a copy.

/// A row of tables 5-1, 5-3 and 5-4 for one model.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Row {
    /// Planes asked for.
    pub planes: u32,
    /// Level map, normal slicing, s.
    pub level_map: f64,
    /// Slice images, s.
    pub volumetric: f64,
    /// Level map, smart slicing, s.
    pub smart: f64,
    /// Planes that smart slicing used.
    pub used: u32,
}

/// A model of the thesis.
#[derive(Clone, Copy, Debug)]
pub(super) struct Model {
    /// Name, as in the catalogue of shapes.
    pub name: &'static str,
    /// Polygons (table 5-2).
    pub polygons: u32,
    /// Some rows of its tables.
    pub rows: [Row; 11],
}

const fn row(planes: u32, level_map: f64, volumetric: f64, smart: f64, used: u32) -> Row {
    Row {
        planes,
        level_map,
        volumetric,
        smart,
        used,
    }
}

/// The models that the thesis shows figures of.
pub(super) const MODELS: [Model; 3] = [
    Model {
        name: "teapot",
        polygons: 6320,
        rows: [
            row(3, 0.068, 0.13, 0.053, 2),
            row(5, 0.099, 0.224, 0.069, 3),
            row(9, 0.166, 0.397, 0.102, 5),
            row(17, 0.285, 0.749, 0.185, 10),
            row(25, 0.409, 1.081, 0.268, 15),
            row(33, 0.53, 1.429, 0.341, 20),
            row(50, 0.793, 2.25, 0.5, 30),
            row(67, 1.053, 2.97, 0.659, 40),
            row(84, 1.315, 3.84, 0.824, 50),
            row(100, 1.562, 4.243, 0.98, 60),
            row(101, 1.574, 4.413, 1.0, 61),
        ],
    },
    Model {
        name: "dolphin",
        polygons: 4442,
        rows: [
            row(3, 0.063, 0.12, 0.049, 2),
            row(5, 0.095, 0.199, 0.081, 4),
            row(9, 0.159, 0.353, 0.143, 8),
            row(17, 0.28, 0.67, 0.268, 16),
            row(25, 0.406, 0.989, 0.394, 24),
            row(33, 0.529, 1.302, 0.53, 32),
            row(50, 0.799, 1.982, 0.785, 49),
            row(67, 1.063, 2.695, 1.052, 66),
            row(84, 1.325, 3.333, 1.317, 83),
            row(100, 1.575, 4.016, 1.57, 99),
            row(101, 1.601, 4.089, 1.571, 99),
        ],
    },
    Model {
        name: "sphere",
        polygons: 1984,
        rows: [
            row(3, 0.063, 0.13, 0.032, 1),
            row(5, 0.093, 0.224, 0.048, 2),
            row(9, 0.156, 0.397, 0.08, 4),
            row(17, 0.281, 0.749, 0.144, 8),
            row(25, 0.401, 1.081, 0.212, 12),
            row(33, 0.528, 1.429, 0.274, 17),
            row(50, 0.787, 2.25, 0.423, 25),
            row(67, 1.056, 2.97, 0.564, 34),
            row(84, 1.311, 3.84, 0.709, 42),
            row(100, 1.553, 4.243, 0.821, 50),
            row(101, 1.572, 4.413, 0.825, 50),
        ],
    },
];

/// The thesis's row for a shape and a number of planes, where it is kept here.
pub(super) fn row_of(shape: &str, planes: u32) -> Option<Row> {
    let model = MODELS.iter().find(|model| model.name == shape)?;
    model.rows.iter().find(|row| row.planes == planes).copied()
}
