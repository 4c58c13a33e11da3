//! The presets that have a CPU reference, with their params.

/// A hybrid whose shadow map classifies; named as its preset.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Method {
    /// The four texels of a bilinear lookup agree (Beister, Ernst, Stamminger 2005).
    HybridPcf,
    /// Outer against inner conservative depth (Hertel, Hormann, Westermann 2009).
    Crsm,
    /// Outer depth against one whose casters shrink only where their surface ends.
    Crsma,
    /// Outer depth against one of texels that a caster's one-ring covers.
    CrsmaFull,
}

/// Faces that are not in the map.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Cull {
    /// All are in it.
    None,
    /// Those that face the light are not.
    Front,
    /// Those that face away from the light are not.
    Back,
}

/// Which depth of a triangle a texel holds.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Depth {
    /// The triangle's plane at the texel's centre.
    Plane,
    /// A bound over the whole texel: nearest in the outer layer, farthest in the inner one.
    Conservative,
}

/// A preset with its params, to be drawn and classified on the CPU.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CpuReference {
    /// Which preset.
    pub method: Method,
    /// Edge of the map in texels, at least 1.
    pub map_size: u32,
    /// Faces that cast no shadow.
    pub cull: Cull,
    /// Triangles grow and shrink by this many diagonals of a texel; [`Method::HybridPcf`] has no
    /// such param.
    pub n: f64,
    /// Which depth; [`Method::HybridPcf`] always takes the plane's.
    pub depth: Depth,
}
