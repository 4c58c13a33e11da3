//! Materials: the textures, buffers and samplers of a document ("material" is Nau3D's word for what
//! passes share), and the inputs that an includer or the host gives.

use crate::errors::document::DocumentError;
use crate::fields::{Compare, by_text};
use crate::language::{Expr, FORMATS, Leaf, Name, Reference, format_named};
use crate::source::Located;
use serde::Deserialize;
use skiagraph_located_ron::mistakes::unknown_word;
use skiagraph_located_ron::reader::{read, refuse};

/// A declared material.
#[derive(Clone, Debug)]
pub(crate) enum Material {
    Texture(TextureEntry),
    Buffer(BufferEntry),
    Sampler(SamplerEntry),
}

impl Material {
    pub fn name(&self) -> &Located<Name> {
        match self {
            Self::Texture(texture) => &texture.name,
            Self::Buffer(buffer) => &buffer.name,
            Self::Sampler(sampler) => &sampler.name,
        }
    }

    /// True if the material's content stays from frame to frame (`keep: true`); false for a
    /// sampler.
    pub fn keeps(&self) -> bool {
        match self {
            Self::Texture(texture) => texture.keep,
            Self::Buffer(buffer) => buffer.keep,
            Self::Sampler(_) => false,
        }
    }

    /// Calls `each` with every leaf (param, word, material, constant or feature) of the expressions
    /// for the material's size, format, data and growth.
    pub fn visit<'a>(&'a self, each: &mut dyn FnMut(Leaf<'a>)) {
        let (grow, exprs) = match self {
            Self::Texture(texture) => {
                let format = match &texture.format {
                    FormatEntry::Expr(format) => Some(format),
                    FormatEntry::Named(_) => None,
                };
                let mips = match &texture.mips {
                    Mips::Number(mips) => Some(mips),
                    Mips::One | Mips::All => None,
                };
                let (size, layers) = (texture.size.as_ref(), texture.layers.as_ref());
                let exprs = vec![format, mips, size, layers, texture.samples.as_ref()];
                (texture.grow.as_deref(), exprs)
            }
            Self::Buffer(buffer) => {
                let data = buffer.data.iter().flat_map(|data| data.0.iter().map(Some));
                let exprs = data.chain([buffer.count.as_ref()]).collect();
                (buffer.grow.as_ref(), exprs)
            }
            Self::Sampler(_) => return,
        };
        if let Some(grow) = grow {
            grow.counter.visit(each);
            grow.max.visit(each);
        }
        for expr in exprs.into_iter().flatten() {
            expr.visit(each);
        }
    }
}

/// A texture, which passes draw into, write and read.
#[derive(Clone, Debug, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields)]
pub(crate) struct TextureEntry {
    /// Name for passes and shaders.
    pub name: Located<Name>,
    /// Its texels.
    pub format: FormatEntry,
    /// Size of mip 0: one number (a square), two, or three (a 3D texture). Where none is given, the
    /// viewport's, or the file's.
    pub size: Option<Expr>,
    /// Number of mips, one without it; `All` goes down to one texel.
    #[serde(default)]
    pub mips: Mips,
    /// Number of layers; with it the texture is an array.
    pub layers: Option<Expr>,
    /// How its layers become more between frames.
    pub grow: Option<Box<GrowEntry>>,
    /// Samples of a texel, one without it.
    pub samples: Option<Expr>,
    /// The picture that the texture holds; it is never written then.
    pub file: Option<Located<String>>,
    /// Keeps its content from frame to frame until a pass overwrites it; `false` without it.
    #[serde(default)]
    pub keep: bool,
}

/// Number of mips of a texture.
#[derive(Clone, Debug, Default)]
pub(crate) enum Mips {
    #[default]
    One,
    /// All mips down to one texel.
    All,
    Number(Expr),
}

by_text!(Mips, |text, _| match text {
    "All" => Ok(Self::All),
    _ => read(text).map(Self::Number),
});

/// A format by wgpu's name, or `"other.format"`.
#[derive(Clone, Debug)]
pub(crate) enum FormatEntry {
    Named(wgt::TextureFormat),
    Expr(Expr),
}

by_text!(FormatEntry, |text, span| {
    if text.starts_with('"') {
        return read(text).map(Self::Expr);
    }
    let named = format_named(text).map(Self::Named);
    let unknown = || unknown_word(&Located::new(text.to_owned(), span), FORMATS);
    named.ok_or_else(|| refuse(unknown()))
});

/// A buffer; the layout of an item comes from the shaders that bind it.
#[derive(Clone, Debug, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields)]
pub(crate) struct BufferEntry {
    /// Name for passes and shaders.
    pub name: Located<Name>,
    /// Number of items of the runtime-sized array that the shaders see; none where they see a fixed
    /// size.
    pub count: Option<Expr>,
    /// The items that the buffer holds; it is never written then.
    pub data: Option<Located<Data>>,
    /// How it grows between frames.
    pub grow: Option<GrowEntry>,
    /// Keeps its content from frame to frame until a pass overwrites it; `false` without it.
    #[serde(default)]
    pub keep: bool,
}

/// How the items of a buffer or the layers of a texture become more between frames.
#[derive(Clone, Debug, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[cfg_attr(feature = "schema", schemars(rename = "Growth"))]
#[serde(deny_unknown_fields)]
pub(crate) struct GrowEntry {
    /// The buffer, or item of one, whose first u32 says how many items or layers a frame would have
    /// needed.
    pub counter: Reference,
    /// Most items or layers.
    pub max: Expr,
}

/// Constant items of a buffer: a number, or a tuple of numbers and tuples for one number per scalar
/// of the shader's type.
#[derive(Clone, Debug)]
pub(crate) struct Data(pub Vec<Expr>);

by_text!(Data, |_, span| {
    let wrong = || refuse(DocumentError::Data(span.clone()));
    let items = span.list().map_err(|_| wrong())?;
    let items = items.iter().map(|item| read(item.text()));
    items.collect::<Result<_, _>>().map(Self)
});

/// A sampler: how shaders read a texture between its texels.
#[derive(Clone, Debug, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields)]
pub(crate) struct SamplerEntry {
    /// Name for passes and shaders.
    pub name: Located<Name>,
    /// Minification, magnification and mip filter; `Nearest` without it.
    #[serde(default)]
    pub filter: Filter,
    /// Addressing outside of the texture, in all directions; `ClampToEdge` without it.
    #[serde(default)]
    pub address: Address,
    /// Makes it a comparison sampler.
    pub compare: Option<Compare>,
}

/// Filter of a sampler, for minification, magnification and between mips.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub enum Filter {
    /// Takes the nearest texel of the nearest mip; the default.
    #[default]
    Nearest,
    /// Interpolates between texels (bilinear) and between mips (trilinear).
    Linear,
}

/// Texels that a sampler reads outside of the texture.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub enum Address {
    /// The texels of the edge, repeated; the default.
    #[default]
    ClampToEdge,
    /// The texture again, side by side.
    Repeat,
    /// The texture again, every second one mirrored.
    MirrorRepeat,
}

/// Material that a document asks its includer, or the host, for.
#[derive(Clone, Debug)]
pub(crate) struct Input {
    pub name: Located<Name>,
    pub kind: InputKind,
}

#[derive(Clone, Debug)]
pub(crate) enum InputKind {
    /// A texture of this format, or of any format for `None`.
    Texture(Option<wgt::TextureFormat>),
    Buffer,
    Sampler {
        compare: bool,
    },
}

impl InputKind {
    /// Returns the kind of input in words, for messages.
    pub fn describe(&self) -> &'static str {
        match self {
            Self::Texture(_) => "a texture",
            Self::Buffer => "a buffer",
            Self::Sampler { compare: true } => "a sampler with `compare`",
            Self::Sampler { compare: false } => "a sampler without `compare`",
        }
    }

    /// Returns the kind of input in words, with the format that a texture must have.
    pub fn describe_with_format(&self) -> String {
        match self {
            Self::Texture(Some(format)) => format!("a texture {format:?}"),
            other => other.describe().to_owned(),
        }
    }
}

/// A texture that the includer, or the host, gives.
#[derive(Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields)]
pub(crate) struct TextureInput {
    /// Name of the input in this document.
    pub name: Located<Name>,
    /// The format that it must have; any without it.
    pub format: Option<FormatEntry>,
}

/// A buffer that the includer, or the host, gives.
#[derive(Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields)]
pub(crate) struct BufferInput {
    /// Name of the input in this document.
    pub name: Located<Name>,
}

/// A sampler that the includer, or the host, gives.
#[derive(Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields)]
pub(crate) struct SamplerInput {
    /// Name of the input in this document.
    pub name: Located<Name>,
    /// True for a comparison sampler.
    #[serde(default)]
    pub compare: bool,
}
