//! Materials: the textures, buffers and samplers of a document ("material" is Nau3D's word for what passes share).

use super::{
    located::{self, Located},
    value::Value,
};
use serde::{Deserialize, Deserializer};

/// A declared material.
#[derive(Clone, Debug)]
#[expect(
    clippy::large_enum_variant,
    reason = "a document has a handful, each made once"
)]
pub enum Material {
    /// A 2D texture, possibly with mips and layers.
    Texture(TextureEntry),
    /// A storage buffer; the layout of its items comes from WGSL.
    Buffer(BufferEntry),
    /// A sampler.
    Sampler(SamplerEntry),
}

impl Material {
    /// Its name.
    pub fn name(&self) -> &Located<String> {
        match self {
            Self::Texture(texture) => &texture.name,
            Self::Buffer(buffer) => &buffer.name,
            Self::Sampler(sampler) => &sampler.name,
        }
    }
}

/// A texture as the document writes it.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct TextureEntry {
    /// Name.
    pub name: Located<String>,
    /// wgpu's name of the format, for example `R32Uint`.
    pub format: Located<Format>,
    /// Size of mip 0.
    pub size: Located<Size>,
    /// Number of mips.
    #[serde(default = "one")]
    pub mips: Value<u32>,
    /// Number of layers; above 1 (or from a param) makes it an array.
    #[serde(default = "one")]
    pub layers: Value<u32>,
    /// Names for parts of the texture.
    #[serde(default)]
    pub views: Vec<ViewEntry>,
}

fn one() -> Value<u32> {
    Value::Literal(1)
}

/// A named part of a texture: some of its mips and layers.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ViewEntry {
    /// Name; used like a material's.
    pub name: Located<String>,
    /// First mip.
    #[serde(default)]
    pub mip: u32,
    /// Number of mips; all that follow where not given.
    #[serde(default)]
    pub mips: Option<u32>,
    /// First layer.
    #[serde(default)]
    pub layer: u32,
    /// Number of layers; all that follow where not given.
    #[serde(default)]
    pub layers: Option<u32>,
}

/// A buffer as the document writes it.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct BufferEntry {
    /// Name.
    pub name: Located<String>,
    /// Number of items of the runtime-sized array that the shaders see; not needed where they see a fixed size.
    #[serde(default)]
    pub count: Option<Located<Count>>,
}

/// A sampler as the document writes it.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct SamplerEntry {
    /// Name.
    pub name: Located<String>,
    /// Minification, magnification and mip filter.
    #[serde(default)]
    pub filter: Filter,
    /// Addressing in all directions.
    #[serde(default)]
    pub address: Address,
    /// Makes it a comparison sampler.
    #[serde(default)]
    pub compare: Option<super::value::Compare>,
}

/// A sampler's filter.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Deserialize)]
pub enum Filter {
    /// The nearest texel.
    #[default]
    Nearest,
    /// Bilinear (and between mips).
    Linear,
}

/// What lies outside a texture.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Deserialize)]
pub enum Address {
    /// The border texels go on.
    #[default]
    ClampToEdge,
    /// The texture repeats.
    Repeat,
    /// The texture repeats, mirrored.
    MirrorRepeat,
}

/// A texture format by wgpu's name.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Format(pub wgpu::TextureFormat);

macro_rules! formats {
    ($($name:ident)*) => {
        const FORMATS: &[&str] = &[$(stringify!($name)),*];
        fn format_named(name: &str) -> Option<wgpu::TextureFormat> {
            match name { $(stringify!($name) => Some(wgpu::TextureFormat::$name),)* _ => None }
        }
    };
}

formats! {
    R8Unorm R8Snorm R8Uint R8Sint R16Uint R16Sint R16Float Rg8Unorm Rg8Snorm Rg8Uint Rg8Sint R32Uint R32Sint R32Float
    Rg16Uint Rg16Sint Rg16Float Rgba8Unorm Rgba8UnormSrgb Rgba8Snorm Rgba8Uint Rgba8Sint Bgra8Unorm Bgra8UnormSrgb
    Rgb10a2Unorm Rgb10a2Uint Rg11b10Ufloat Rg32Uint Rg32Sint Rg32Float Rgba16Uint Rgba16Sint Rgba16Float Rgba32Uint
    Rgba32Sint Rgba32Float Depth16Unorm Depth24Plus Depth32Float
}

impl<'de> Deserialize<'de> for Format {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        struct Name;
        impl serde::de::Visitor<'_> for Name {
            type Value = Format;
            fn expecting(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
                f.write_str("a texture format, for example R32Uint")
            }
            fn visit_str<E: serde::de::Error>(self, name: &str) -> Result<Format, E> {
                format_named(name)
                    .map(Format)
                    .ok_or_else(|| E::unknown_variant(name, FORMATS))
            }
        }
        deserializer.deserialize_identifier(Name)
    }
}

/// Size of a texture.
#[derive(Clone, Debug, Deserialize)]
pub enum Size {
    /// The viewport's.
    Viewport,
    /// The viewport's times a factor, rounded up.
    ViewportTimes(Value<f32>),
    /// That of another texture.
    Like(Located<String>),
    /// Equal width and height.
    Square(Value<u32>),
    /// Width and height.
    Texels(Value<u32>, Value<u32>),
}

/// Number of items.
#[derive(Clone, Debug)]
pub enum Count {
    /// A number or a param.
    Number(Value<u32>),
    /// As many as the viewport has pixels.
    Pixels,
    /// As many as a texture has texels in mip 0 of one layer.
    PixelsOf(Located<String>),
    /// As many as another buffer or provided resource has.
    CountOf(Located<String>),
    /// A product.
    Times(Box<Count>, Box<Count>),
}

impl Count {
    /// Whether it is that of one of `names`.
    pub(crate) fn refers_to(&self, names: &std::collections::HashSet<&str>) -> bool {
        match self {
            Self::Number(_) | Self::Pixels => false,
            Self::PixelsOf(name) | Self::CountOf(name) => names.contains(name.as_str()),
            Self::Times(a, b) => a.refers_to(names) || b.refers_to(names),
        }
    }

    /// Whether it is taken from something else's count, which may be 0 through no fault of the document.
    pub(crate) fn is_taken(&self) -> bool {
        match self {
            Self::CountOf(_) => true,
            Self::Times(a, b) => a.is_taken() || b.is_taken(),
            Self::Number(_) | Self::Pixels | Self::PixelsOf(_) => false,
        }
    }
}

impl<'de> Deserialize<'de> for Count {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        #[derive(Deserialize)]
        #[serde(rename = "Count")]
        enum Words {
            Param(Located<String>),
            Pixels,
            PixelsOf(Located<String>),
            CountOf(Located<String>),
            Times(Count, Count),
        }
        Ok(match located::literal(deserializer)? {
            Ok(number) => Self::Number(Value::Literal(number)),
            Err(text) => match located::word::<Words, D::Error>(text)? {
                Words::Param(name) => Self::Number(Value::Param(name)),
                Words::Pixels => Self::Pixels,
                Words::PixelsOf(name) => Self::PixelsOf(name),
                Words::CountOf(name) => Self::CountOf(name),
                Words::Times(a, b) => Self::Times(Box::new(a), Box::new(b)),
            },
        })
    }
}
