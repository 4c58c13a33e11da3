//! Sizes and contents that a material cannot have.

use crate::{
    diagnostics::{code::Code, diagnostic::Diagnostic},
    source::span::Located,
};

#[derive(Clone, Debug, thiserror::Error)]
pub(crate) enum SizeError {
    #[error("`{}`: no texture has so many texels", **name)]
    Absurd { name: Located<String> },
    #[error(
        "`{}`: {}×{} texels, layers: {layers}, mips: {mips}, samples: {samples}: a texture of no \
         texels",
        **name, size[0], size[1]
    )]
    NoTexels {
        name: Located<String>,
        size: [u32; 2],
        layers: u32,
        mips: u32,
        samples: u32,
    },
    #[error(
        "`{}`: {}×{} texels are more than the adapter can hold",
        **name, size[0], size[1]
    )]
    Texels {
        name: Located<String>,
        size: [u32; 2],
        most: u32,
    },
    #[error("`{}`: {layers} layers or slices are more than the adapter can hold", **name)]
    Layers {
        name: Located<String>,
        layers: u32,
        most: u32,
    },
    #[error("`{}`: {mips} mips are too many", **name)]
    Mips {
        name: Located<String>,
        mips: u32,
        full: u32,
    },
    #[error("`{}`: a texture of {format:?} cannot have {samples} samples", **name)]
    Samples {
        name: Located<String>,
        format: wgt::TextureFormat,
        samples: u32,
        known: Vec<u32>,
    },
    #[error("`{}`: not every device has {format:?}", **name)]
    FormatFeature {
        name: Located<String>,
        format: wgt::TextureFormat,
        feature: wgt::Features,
    },
    #[error("`{}`: a texture of several samples has one mip and one layer", **.0)]
    SamplesOfMany(Located<String>),
    #[error("`{}`: a 3D texture has slices, not layers", **.0)]
    LayersOf3d(Located<String>),
    #[error("the file brings its {1}")]
    FileHas(Located<String>, &'static str),
    #[error("picture `{}` not found", **.0)]
    NoPicture(Located<String>, Vec<String>),
    #[error("the picture `{}` cannot be read", **.0)]
    Picture(Located<String>, String),
    #[error("a texture of {} cannot hold a picture", **.0)]
    PictureFormat(Located<String>),
    #[error("`{}` is as many items as its `data`", **.0)]
    DataHas(Located<String>),
    #[error("`{}`: a buffer of no items", **.0)]
    NoItems(Located<String>),
    #[error("`{}` holds what stands in the document, and stays as it is anyway", **.0)]
    KeepsConstant(Located<String>),
    #[error("`{}` grows, but from which `count`?", **.0)]
    GrowWithoutCount(Located<String>),
    #[error("`{}` grows, but from which `layers`?", **.0)]
    GrowWithoutLayers(Located<String>),
    #[error("`{}` grows from one layer", **.0)]
    GrowFromOne(Located<String>),
    #[error("`{}` grows to nothing: its `max` is 0", **.0)]
    GrowToNothing(Located<String>),
    #[error("`{}` is {what}: it cannot count items", **name)]
    Counter {
        name: Located<String>,
        what: &'static str,
    },
}

impl From<SizeError> for Diagnostic {
    fn from(mistake: SizeError) -> Self {
        let diagnostic = Self::error(mistake.code(), mistake.to_string());
        mistake.explain(diagnostic)
    }
}

impl SizeError {
    fn code(&self) -> Code {
        match self {
            Self::NoPicture(..) | Self::Picture(..) => Code::MissingFile,
            Self::PictureFormat(_) | Self::Samples { .. } => Code::FormatMismatch,
            Self::FormatFeature { .. } => Code::Feature,
            _ => Code::Size,
        }
    }

    fn explain(self, diagnostic: Diagnostic) -> Diagnostic {
        match self {
            Self::Absurd { name } => diagnostic.at(name.span, ""),
            Self::NoTexels { name, .. } | Self::NoItems(name) | Self::GrowToNothing(name) => {
                diagnostic.at(name.span, "").help("give it one at least")
            }
            Self::Texels { name, most, .. } => diagnostic
                .at(name.span, "")
                .help(format!("its limit is {most} in each direction")),
            Self::Layers { name, most, .. } => diagnostic
                .at(name.span, "")
                .help(format!("its limit is {most}")),
            Self::Mips { name, full, .. } => diagnostic
                .at(name.span, "")
                .help(format!("it can have {full}: `mips: All`")),
            Self::Samples { name, known, .. } => {
                let known: Vec<String> = known.iter().map(u32::to_string).collect();
                diagnostic
                    .at(name.span, "")
                    .help(format!("it can have {}", known.join(", ")))
            }
            Self::FormatFeature { name, feature, .. } => {
                let names: Vec<&str> = feature.iter_names().map(|(name, _)| name).collect();
                diagnostic.at(name.span, "").help(format!(
                    "list `requires: [\"{}\"]`, or use a format of floats or 8 bits",
                    names.join("\", \"")
                ))
            }
            Self::SamplesOfMany(name) => diagnostic.at(name.span, ""),
            Self::LayersOf3d(name) => diagnostic.at(name.span, "").help("leave `layers` out"),
            Self::FileHas(file, field) => diagnostic
                .at(file.span, "")
                .help(format!("leave `{field}` out")),
            Self::NoPicture(file, candidates) => diagnostic
                .at(file.span, "asked for here")
                .help(format!("looked for {}", candidates.join(", "))),
            Self::Picture(file, why) => diagnostic.at(file.span, "asked for here").help(why),
            Self::PictureFormat(place) => diagnostic.at(place.span, "").help(
                "use R8Unorm, Rg8Unorm, Rgba8Unorm, Rgba8UnormSrgb, or a format of 16- or 32-bit \
                 floats",
            ),
            Self::GrowWithoutCount(name) => diagnostic
                .at(name.span, "")
                .help("give it a `count` to begin with; `data` does not grow"),
            Self::GrowWithoutLayers(name) => diagnostic.at(name.span, "").help(
                "give it `layers` to begin with, two or more; a picture and a 3D texture do not \
                 grow",
            ),
            Self::GrowFromOne(name) => diagnostic.at(name.span, "").help(
                "begin with two `layers`, and let `max` be two or more: one layer can be bound and \
                 drawn to as a texture without layers, several cannot",
            ),
            Self::Counter { name, .. } => diagnostic
                .at(name.span, "")
                .help("name a buffer whose first u32 a pass makes the number of items needed"),
            Self::KeepsConstant(name) => diagnostic.at(name.span, "").help("leave `keep` out"),
            Self::DataHas(name) => diagnostic.at(name.span, "").help("leave `count` out"),
        }
    }
}
