//! What stages and warnings need to know of the method that carries the light. Methods themselves live above: each says this of itself.

/// What a method makes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Product {
    /// Flux sums per texel of the receivers' maps.
    ReceiverMaps,
    /// Irradiance at points: pixels of a view, or texels of a map.
    PointIrradiance,
    /// Light in the volume between surface and floor.
    Field,
}

/// A method, as the stages see it.
#[derive(Clone, Debug, PartialEq)]
pub struct MethodFacts {
    /// Its name.
    pub name: &'static str,
    /// What it makes.
    pub product: Product,
    /// Whether what it lands is what the rays took away. Where it is not, accounts that are open are no defect, and the frame says by
    /// how much.
    pub conserves_energy: bool,
    /// Whether rays carry light to meshes where they hit them. Otherwise the method lays light on meshes itself, and rays only tell
    /// what is left for the floor.
    pub lights_meshes_by_hits: bool,
    /// Planes that cut the box of an object along the light, for methods that slice objects; else 0.
    pub reference_planes: u32,
    /// Whether those planes without a surface near them are left out.
    pub skips_empty_planes: bool,
    /// How often a beam may be laid on an object, at most: the account has room for as much.
    pub deposits_per_beam: u32,
    /// Whether the flux sums have room for one more map of the largest object.
    pub has_scratch_map: bool,
    /// What it leaves out, as sentences with their codes: see [`super::warnings`].
    pub leaves_out: LeavesOut,
}

/// What a method leaves out that others simulate.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct LeavesOut {
    /// Shadows of objects on other objects.
    pub shadows_on_objects: bool,
    /// Light on further layers of objects than the first.
    pub further_layers: bool,
}
