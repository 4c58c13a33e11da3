//! Values of the output `status` of a shadow preset.

/// The pixel shows no geometry.
pub const BACKGROUND: u32 = 0;
/// The pixel faces away from the light.
pub const FACING_AWAY: u32 = 1;
/// The method is certain that the pixel is lit.
pub const CERTAIN_LIGHT: u32 = 2;
/// The method is certain that the pixel is in shadow.
pub const CERTAIN_SHADOW: u32 = 3;
/// The method could not decide from its shadow map if the pixel is lit, and traced a ray or
/// guessed.
pub const UNCERTAIN: u32 = 4;
