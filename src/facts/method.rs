//! Properties of the method that the stages and warnings need. Methods live in a room above this one; each describes itself.

/// The product of a method.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Product {
    /// Flux sums per texel of the receivers' maps.
    ReceiverMaps,
    /// Irradiance at points: pixels of a view, or texels of a map.
    PointIrradiance,
    /// Light on horizontal slices between surface and floor, kept from frame to frame, from which the light at points is looked up.
    Field,
}

/// The properties of a method that the stages use.
#[derive(Clone, Debug, PartialEq)]
pub struct MethodFacts {
    /// Its name.
    pub name: &'static str,
    /// Its product.
    pub product: Product,
    /// Whether the landed flux equals the flux that the rays carry. If not, an energy account that does not close is no defect, and the
    /// frame reports the difference.
    pub conserves_energy: bool,
    /// Whether the flux on its way is counted, term by term. A method that finds light at points has no rays to count.
    pub keeps_account: bool,
    /// Whether meshes are lit where rays hit them. Otherwise the method places light on meshes itself, and the hits only decide which light
    /// is left for the floor.
    pub lights_meshes_by_hits: bool,
    /// Number of planes that cut the box of an object along the light, for methods that slice objects; else 0.
    pub reference_planes: u32,
    /// Whether planes without a surface near them are skipped.
    pub skips_empty_planes: bool,
    /// Largest number of deposits of one beam on an object; the energy account is scaled for it.
    pub deposits_per_beam: u32,
    /// Whether the flux sums have room for one more map of the largest object.
    pub has_scratch_map: bool,
    /// Whether light lands on the surfaces that a view from the light shows. Light that ends elsewhere counts as unresolved.
    pub lands_in_view: bool,
    /// The cells of the water that it follows light from, if they are not `quality.water_cells`.
    pub own_cells: Option<OwnCells>,
    /// Slices and texels of its field, for methods that make one.
    pub field: Option<FieldGrid>,
    /// Effects that it leaves out; [`super::warnings`] has the messages.
    pub leaves_out: LeavesOut,
}

impl MethodFacts {
    /// A method that conserves energy, leaves nothing out, lights meshes where rays hit them, and slices no object.
    pub fn new(name: &'static str, product: Product) -> Self {
        Self {
            name,
            product,
            conserves_energy: true,
            keeps_account: product != Product::PointIrradiance,
            lights_meshes_by_hits: true,
            reference_planes: 0,
            skips_empty_planes: false,
            deposits_per_beam: 1,
            has_scratch_map: false,
            lands_in_view: false,
            own_cells: None,
            field: None,
            leaves_out: LeavesOut::default(),
        }
    }
}

/// The cells of the water that a method follows light from, by a dial of its own.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct OwnCells {
    /// Cells along each side of the window.
    pub cells: u32,
    /// Name of the dial.
    pub dial: &'static str,
}

/// The resolution of a field.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct FieldGrid {
    /// Horizontal slices, at least 2.
    pub slices: u32,
    /// Texels along the longer side of a slice.
    pub texels: u32,
}

/// Effects that a method leaves out and others simulate.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct LeavesOut {
    /// All shadows of objects under water.
    pub shadows: bool,
    /// That waves displace the shadows of objects under water.
    pub waves_in_shadows: bool,
    /// Shadows of objects on other objects.
    pub shadows_on_objects: bool,
    /// Light on further layers of objects than the first.
    pub further_layers: bool,
}
