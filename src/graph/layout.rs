//! Structs that host and shaders share. Each knows its layout; a test compares it with naga's layout of the WGSL twin.

/// A struct's WGSL name, size in bytes, and (field, offset) pairs.
pub type Layout = (&'static str, usize, &'static [(&'static str, usize)]);

/// Declares a `Pod` struct that has a WGSL twin, with the list of its fields' offsets.
#[macro_export]
macro_rules! gpu_struct {
    ($(#[$meta:meta])* $vis:vis $name:ident = $wgsl:literal { $($(#[$fmeta:meta])* $field:ident: $ty:ty),+ $(,)? }) => {
        $(#[$meta])*
        #[repr(C)]
        #[derive(Clone, Copy, Debug, Default, PartialEq, bytemuck::Pod, bytemuck::Zeroable)]
        $vis struct $name { $($(#[$fmeta])* $vis $field: $ty),+ }
        impl $name {
            /// Name of the WGSL struct, its size, and (field, offset) pairs.
            $vis const LAYOUT: $crate::graph::Layout = (
                $wgsl,
                size_of::<$name>(),
                &[$((stringify!($field), std::mem::offset_of!($name, $field))),+],
            );
        }
    };
}
