//! Values of the output `status` of a shadow method: the method's own verdict on each pixel.

/// Value of `status`: the pixel shows no geometry.
pub const BACKGROUND: u32 = 0;
/// Value of `status`: the pixel faces away from the light.
pub const FACING_AWAY: u32 = 1;
/// Value of `status`: the method is certain that the pixel is lit.
pub const CERTAIN_LIGHT: u32 = 2;
/// Value of `status`: the method is certain that the pixel is in shadow.
pub const CERTAIN_SHADOW: u32 = 3;
/// Value of `status`: the method could not decide from its shadow map if the pixel is lit, and
/// traced a ray or guessed.
pub const UNCERTAIN: u32 = 4;
