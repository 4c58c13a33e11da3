//! Colour textures, decoded when somebody first looks at their texels.

use crate::limit::Limit;
use image::{ImageFormat, ImageReader, Limits};
use std::{
    io::Cursor,
    path::{Path, PathBuf},
    sync::{Arc, OnceLock},
};

/// Room for 8192² texels of three bytes, not compressed.
const TEXTURE_FILE: Limit = Limit {
    of: "a texture",
    mib: 256,
    way_out: "scale it down",
};

/// Longest edge of a texture, texels.
const LONGEST_EDGE: u32 = 16384;

/// What a texture is beyond its edges.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Wrap {
    /// It begins anew.
    #[default]
    Repeat,
    /// It is mirrored.
    Mirror,
    /// Its outermost texels go on.
    Clamp,
}

impl Wrap {
    /// A coordinate brought into 0…1, in f64; what is not finite counts as 0.
    pub(crate) fn apply(self, at: f64) -> f64 {
        let at = if at.is_finite() { at } else { 0.0 };
        match self {
            Self::Repeat => at - at.floor(),
            Self::Mirror => {
                let in_two = at - 2.0 * (at * 0.5).floor();
                in_two.min(2.0 - in_two)
            }
            Self::Clamp => at.clamp(0.0, 1.0),
        }
    }
}

/// Where the bytes of a texture are.
#[derive(Clone, Debug)]
pub enum Source {
    /// A file.
    File(PathBuf),
    /// The content of a file, as a `.glb` holds it.
    Bytes(Arc<[u8]>),
}

/// Decoded texels.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Texels {
    /// Width and height.
    pub size: [u32; 2],
    /// Red, green, blue, alpha, row by row from the top left; the colours are sRGB.
    pub rgba: Vec<[u8; 4]>,
    /// Whether the file has an alpha channel.
    pub has_alpha: bool,
}

/// A colour texture.
#[derive(Clone, Debug)]
pub struct Texture {
    /// What it is called in messages.
    pub name: String,
    /// Where it is.
    pub source: Source,
    /// What it is beyond its edges, for u and v.
    pub wrap: [Wrap; 2],
    texels: Arc<OnceLock<Result<Texels, String>>>,
}

impl Texture {
    /// A texture that is not read yet.
    pub fn new(name: String, source: Source, wrap: [Wrap; 2]) -> Self {
        let texels = Arc::default();
        Self {
            name,
            source,
            wrap,
            texels,
        }
    }

    /// Its texels, decoded when first asked for: PNG, JPEG or TGA.
    ///
    /// # Errors
    /// Which texture cannot be read, and why.
    pub fn texels(&self) -> Result<&Texels, &str> {
        let decoded = self.texels.get_or_init(|| {
            let texels = match &self.source {
                Source::File(path) => read(path),
                Source::Bytes(bytes) => decode(bytes, None),
            };
            texels.map_err(|why| format!("{}: {why}", self.name))
        });
        decoded.as_ref().map_err(String::as_str)
    }
}

fn read(path: &Path) -> Result<Texels, String> {
    let bytes = TEXTURE_FILE.read(path).map_err(|why| why.to_string())?;
    let tga = path
        .extension()
        .is_some_and(|extension| extension.eq_ignore_ascii_case("tga"));
    decode(&bytes, tga.then_some(ImageFormat::Tga))
}

/// `format`: of a file whose first bytes do not tell.
fn decode(bytes: &[u8], format: Option<ImageFormat>) -> Result<Texels, String> {
    let mut reader = ImageReader::new(Cursor::new(bytes));
    match format {
        Some(format) => reader.set_format(format),
        None => {
            reader = reader
                .with_guessed_format()
                .map_err(|why| why.to_string())?
        }
    }
    let mut limits = Limits::default();
    limits.max_image_width = Some(LONGEST_EDGE);
    limits.max_image_height = Some(LONGEST_EDGE);
    reader.limits(limits);
    let decoded = reader
        .decode()
        .map_err(|why| format!("{why}; a PNG, JPEG or TGA can be read"))?;
    let has_alpha = decoded.color().has_alpha();
    let picture = decoded.into_rgba8();
    let size = [picture.width(), picture.height()];
    if size.contains(&0) {
        return Err("it has no texels".to_owned());
    }
    let rgba = picture.pixels().map(|texel| texel.0).collect();
    Ok(Texels {
        size,
        rgba,
        has_alpha,
    })
}
