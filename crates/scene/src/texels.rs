//! Texels of colour textures.

use std::sync::Arc;

/// Decoded texels of a texture.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Texels {
    /// Width and height of the texture in texels.
    pub size: [u32; 2],
    /// One entry per texel, row by row from the top left: sRGB red, green and blue, then alpha.
    pub rgba: Vec<[u8; 4]>,
    /// True if the picture has an alpha channel; without one, every alpha is 255.
    pub has_alpha: bool,
}

impl Texels {
    /// These, if there is one for each place.
    pub(crate) fn checked(self: &Arc<Self>) -> Result<Arc<Self>, String> {
        let [width, height] = self.size;
        let count = u64::from(width) * u64::from(height);
        if count == 0 || count != self.rgba.len() as u64 {
            let given = self.rgba.len();
            return Err(format!(
                "{width} x {height} texels, of which {given} are given"
            ));
        }
        Ok(Arc::clone(self))
    }
}
