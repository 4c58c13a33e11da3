//! Passes whose shaders, attachments, copies or dispatches do not fit.

use crate::{
    diagnostics::{code::Code, diagnostic::Diagnostic, reports::IntoDiagnostic},
    param::Param,
    scalar_class::ScalarClass,
    source::span::{Located, Span},
};
use wgt::TextureFormat;

#[derive(Clone, Debug, thiserror::Error)]
pub(crate) enum LinkError {
    #[error("`{pass}` does not read `{}`", **name)]
    ReadsNot { pass: String, name: Located<String> },
    #[error("`{}` reads `{name}`, too", **pass)]
    ReadsMore {
        pass: Located<String>,
        name: String,
        read: Span,
    },
    #[error("a step of this pass has no shader")]
    NoShader,
    #[error("the shader `{}` was not loaded with the document", **.0)]
    ShaderNotLoaded(Located<String>),
    #[error("last frame's version of `{of}` cannot be written")]
    WritesPrevious { of: String, span: Span },
    #[error("`{name}` holds what stands in the document, and is never written")]
    WritesConstant { name: String, span: Span },
    #[error("`{name}` belongs to the host and cannot be written")]
    WritesProvided { name: String, span: Span },
    #[error("the vertex shader writes `{global}`, which most devices cannot")]
    VertexWrites { global: String, span: Span },
    #[error("pass `{}` asks the device for ray queries, which it does not have", **pass)]
    RayQuery { pass: Located<String>, span: Span },
    #[error("pass `{pass}` uses `{name}` twice at once, and writes it")]
    Feedback {
        pass: String,
        name: String,
        reader: Span,
        reads: bool,
        writer: Span,
    },
    #[error("pass `{pass}` does not write `{}`", **name)]
    Overwrites { pass: String, name: Located<String> },
    #[error("`{shader}` has no param or constant `{}` to set", **name)]
    UnusedSet {
        shader: String,
        name: Located<String>,
        known: Vec<String>,
    },
    #[error("`{shader}` has no global `{}` to bind", **name)]
    UnusedBind {
        shader: String,
        name: Located<String>,
        known: Vec<String>,
    },
    #[error("`{global}` is in @group({group}), which the adapter does not have")]
    BindGroup {
        global: String,
        group: u32,
        most: u32,
        span: Span,
    },
    #[error("pass `{}` binds {number} {what}", **pass)]
    TooManyBindings {
        pass: Located<String>,
        what: &'static str,
        number: usize,
        most: u32,
    },
    #[error("`{global}` is {what}, which a graph cannot bind")]
    Unsupported {
        global: String,
        what: &'static str,
        span: Span,
    },
    #[error("the uniform `params` {what}")]
    ParamsUniform {
        what: &'static str,
        size: u64,
        span: Span,
    },
    #[error("pass `{}` binds the unknown material `{global}`", **pass)]
    UnknownGlobal {
        global: String,
        span: Span,
        pass: Located<String>,
        known: Vec<String>,
    },
    #[error("the shader's `{global}` needs {needed}, but `{name}` is {found}")]
    WrongKind {
        global: String,
        span: Span,
        needed: &'static str,
        name: String,
        found: &'static str,
        declared: Option<Span>,
    },
    #[error("`{name}` has {have} bytes, the shader's type {size}")]
    UniformSize {
        name: String,
        have: u64,
        size: u64,
        span: Span,
    },
    #[error("the uniform `{global}` has {size} bytes, more than the adapter can bind")]
    UniformLimit {
        global: String,
        size: u64,
        most: u64,
        span: Span,
    },
    #[error("items of `{name}` are {stride} bytes apart, and cannot be bound alone")]
    Alignment {
        name: String,
        stride: u64,
        alignment: u64,
        span: Span,
    },
    #[error("the texture `{name}` cannot be the shader's `{global}`")]
    Texture {
        name: String,
        format: TextureFormat,
        global: String,
        span: Span,
        declared: Option<Span>,
        misfit: Box<TextureMisfit>,
    },
    #[error("the override `{}` has no value", **.0)]
    OverrideWithout(Located<String>),
    #[error("`{name}` has no word `{word}`")]
    UnknownWord {
        name: String,
        word: String,
        constant: String,
        span: Span,
    },
    #[error("`{name}` takes {expected}")]
    SetValue {
        name: String,
        expected: String,
        found: String,
        span: Span,
    },
    #[error("unknown param `{member}` in the shader's `params`")]
    UnknownMember {
        member: String,
        span: Span,
        known: Vec<String>,
        /// The type of a param that is such a member, if there is one.
        ty: Option<String>,
    },
    #[error("`params.index` is the number of the repetition, a u32")]
    IndexMember(Span),
    #[error("`params.{member}` cannot be set: it is neither a number nor a vector")]
    MemberIsNoVector { member: String, span: Span },
    #[error(
        "param `{}` is {width} × {scalar} in a shader, `params.{member}` is not", *param.name
    )]
    MemberType {
        param: Box<Param>,
        member: String,
        scalar: ScalarClass,
        width: u32,
        span: Span,
    },
    #[error("`{}` cannot hold indirect arguments", **name)]
    NoArguments {
        name: Located<String>,
        found: &'static str,
    },
    #[error("a workgroup size that is an override is not supported")]
    WorkgroupOverride { at: Span, pass: Located<String> },
    #[error(
        "a workgroup of {}×{}×{} is more than the adapter can run", size[0], size[1], size[2]
    )]
    WorkgroupSize {
        size: [u32; 3],
        most: [u32; 3],
        threads: u32,
        at: Span,
        pass: Located<String>,
    },
    #[error(
        "{}×{}×{} workgroups are more than the adapter can run", groups[0], groups[1], groups[2]
    )]
    Workgroups {
        groups: [u64; 3],
        most: u32,
        pass: Located<String>,
    },
    #[error("`{}` cannot be copied onto `{}`", **from, **to)]
    CopyFormat {
        from: Located<String>,
        to: Located<String>,
        formats: [TextureFormat; 2],
    },
    /// Width, height, layers and mips.
    #[error("`{}` cannot be copied onto `{}`", **from, **to)]
    CopySize {
        from: Located<String>,
        to: Located<String>,
        extents: [[usize; 4]; 2],
    },
    #[error("`{}` cannot be copied onto `{}`", **from, **to)]
    CopyKinds {
        from: Located<String>,
        to: Located<String>,
        kinds: [&'static str; 2],
    },
    #[error("a texture of format {format:?} cannot be cleared")]
    ClearFormat {
        name: Located<String>,
        format: TextureFormat,
    },
    #[error("the buffer `{}` can only be cleared to zero", **.0)]
    ClearBufferValue(Located<String>),
    #[error("`{}` cannot be cleared", **name)]
    ClearKind {
        name: Located<String>,
        found: &'static str,
    },
    #[error("`{}` cannot be cleared to {wrong}", **name)]
    ClearValue {
        name: Located<String>,
        wrong: f64,
        format: TextureFormat,
        expected: &'static str,
    },
    #[error("this adapter does not draw with `{field}`")]
    DrawFeature {
        pass: Located<String>,
        field: &'static str,
        feature: &'static str,
    },
    #[error("{count} colour targets are more than the adapter can draw to")]
    TooManyTargets {
        pass: Located<String>,
        count: usize,
        most: u32,
    },
    #[error("the colour targets of `{}` take {bytes} bytes per pixel", **pass)]
    BytesPerPixel {
        pass: Located<String>,
        bytes: u32,
        most: u32,
    },
    #[error("a texture of format {format:?} cannot be a colour target")]
    NotDrawable {
        name: Located<String>,
        format: TextureFormat,
    },
    #[error("a target of format {format:?} cannot be blended")]
    NotBlendable {
        name: Located<String>,
        format: TextureFormat,
    },
    #[error("nothing can be resolved into `{}`", **name)]
    Resolve {
        name: Located<String>,
        why: &'static str,
    },
    #[error("the fragment shader writes nothing to `{}`", **name)]
    NoFragmentOutput {
        name: Located<String>,
        location: u32,
        entry: Span,
    },
    #[error("`{}` has the format {format:?}, the shader writes {written}", **name)]
    FragmentOutput {
        name: Located<String>,
        format: TextureFormat,
        expected: String,
        needed: u32,
        written: String,
        location: u32,
        entry: Span,
    },
    #[error("a texture of format {format:?} cannot be a depth target")]
    NoDepth {
        name: Located<String>,
        format: TextureFormat,
    },
    #[error("a texture of format {format:?} cannot be a stencil target")]
    NoStencil {
        name: Located<String>,
        format: TextureFormat,
    },
    #[error("pass `{pass}` cannot draw to `{}`", **name)]
    NoTexture {
        pass: String,
        name: Located<String>,
        found: &'static str,
    },
    #[error("`{}` has several mips or layers", **.0)]
    SeveralLayers(Located<String>),
    #[error("pass `{}` draws to nothing", **pass)]
    NoTargets {
        pass: Located<String>,
        fullscreen: bool,
    },
    #[error("pass `{pass}` has a target and a `size`")]
    CanvasBeside {
        pass: String,
        size: Span,
        target: Located<String>,
    },
    #[error("pass `{}` has neither a target nor a fragment shader", **pass)]
    CanvasWithoutFragment { pass: Located<String>, size: Span },
    #[error("the fragment shader of pass `{pass}` returns a value, but the pass has no target")]
    CanvasOutput {
        pass: String,
        size: Span,
        entry: Span,
    },
    #[error("depth and stencil of pass `{}` are two textures", **.0)]
    TwoDepthStencils(Located<String>),
    #[error("the targets of pass `{}` differ in size", **pass)]
    TargetSizes {
        pass: Located<String>,
        names: [String; 2],
        sizes: [[u32; 2]; 2],
    },
    #[error("the targets of pass `{}` differ in samples", **pass)]
    TargetSamples {
        pass: Located<String>,
        names: [String; 2],
        samples: [u32; 2],
    },
    #[error("the area of pass `{}` does not lie in what it draws to", **pass)]
    AreaOutside {
        pass: Located<String>,
        area: [u32; 4],
        whole: [u32; 2],
    },
}

/// Why a texture cannot be what a shader declares.
#[derive(Clone, Debug, thiserror::Error)]
pub(crate) enum TextureMisfit {
    #[error("{}", scalars(*reads, *holds, *depth))]
    Scalar {
        reads: ScalarClass,
        holds: Option<ScalarClass>,
        depth: bool,
    },
    #[error("sampled through `{sampler}`, but the format cannot be filtered")]
    Filtered { sampler: String, by_feature: bool },
    #[error("it has {0} samples: declare a multisampled texture where these are more than one")]
    Samples(u32),
    #[error("the shader declares {0}")]
    StorageFormat(String),
    #[error("the adapter offers no storage access of this kind")]
    NoStorage,
    #[error("it has {0} samples, and a storage texture has one")]
    StorageSamples(u32),
    #[error("it has several mips, a storage texture is one")]
    StorageMips,
    #[error("it is not a 3D texture")]
    Flat,
    #[error("it is a 3D texture")]
    Solid,
    #[error("a slice of a 3D texture can be drawn to, not bound")]
    Slice,
    #[error("it has {0} layers, the shader sees one")]
    Layers(usize),
    #[error("it has {0} layers, a cube has six")]
    Cube(usize),
    #[error("its layers become more, a cube has six")]
    Grows,
}

fn scalars(reads: ScalarClass, holds: Option<ScalarClass>, depth: bool) -> String {
    match holds {
        _ if depth => "the shader declares a depth texture".to_owned(),
        Some(holds) => format!("the shader reads {reads}, the texture holds {holds}"),
        None => format!("the shader reads {reads}"),
    }
}

impl TextureMisfit {
    fn code(&self) -> Code {
        match self {
            Self::Flat
            | Self::Solid
            | Self::Slice
            | Self::Layers(_)
            | Self::Cube(_)
            | Self::Grows => Code::ResourceKind,
            Self::StorageMips | Self::StorageSamples(_) | Self::Samples(_) => Code::ResourceKind,
            _ => Code::FormatMismatch,
        }
    }

    fn help(&self) -> Option<&'static str> {
        match self {
            Self::Filtered {
                by_feature: true, ..
            } => Some(
                "list `requires: [\"FLOAT32_FILTERABLE\"]`, or use a sampler with \
                 `filter: Nearest`, textureLoad, or a format of 16 bits",
            ),
            Self::Filtered { .. } => {
                Some("use a sampler with `filter: Nearest`, textureLoad, or a filterable format")
            }
            Self::NoStorage => Some(
                "R32Uint, R32Float and the Rgba formats of 8, 16 and 32 bits can be written by \
                 every adapter",
            ),
            Self::Layers(_) => Some("declare an array texture, or bind one layer: `x[0]`"),
            Self::StorageSamples(_) => {
                Some("write a texture without `samples`, or draw to this one")
            }
            Self::Grows => Some("declare a texture_2d_array"),
            Self::StorageMips => Some("bind one of them: `x.mip[0]`"),
            _ => None,
        }
    }
}

impl LinkError {
    fn kind(&self) -> Code {
        match self {
            Self::ShaderNotLoaded(_) => Code::MissingFile,
            Self::NoShader | Self::WorkgroupOverride { .. } => Code::Shader,
            Self::VertexWrites { .. } | Self::DrawFeature { .. } | Self::RayQuery { .. } => {
                Code::Feature
            }
            Self::Feedback { .. } => Code::FeedbackLoop,
            Self::UnusedSet { .. } | Self::UnusedBind { .. } => Code::Unused,
            Self::BindGroup { .. }
            | Self::TooManyBindings { .. }
            | Self::UniformLimit { .. }
            | Self::WorkgroupSize { .. }
            | Self::Workgroups { .. }
            | Self::TooManyTargets { .. }
            | Self::BytesPerPixel { .. } => Code::Limit,
            Self::Unsupported { .. } | Self::ParamsUniform { .. } => Code::Binding,
            Self::UnknownGlobal { .. } => Code::UnknownResource,
            Self::UniformSize { .. } | Self::IndexMember(_) => Code::LayoutMismatch,
            Self::MemberIsNoVector { .. } | Self::MemberType { .. } => Code::LayoutMismatch,
            Self::Alignment { .. } => Code::Alignment,
            Self::Texture { misfit, .. } => misfit.code(),
            Self::OverrideWithout(_) | Self::UnknownMember { .. } => Code::UnknownParam,
            Self::UnknownWord { .. } | Self::SetValue { .. } => Code::ParamValue,
            Self::CopyFormat { .. }
            | Self::CopySize { .. }
            | Self::ClearFormat { .. }
            | Self::ClearValue { .. }
            | Self::NotDrawable { .. }
            | Self::NotBlendable { .. }
            | Self::NoFragmentOutput { .. }
            | Self::CanvasOutput { .. }
            | Self::FragmentOutput { .. }
            | Self::NoDepth { .. }
            | Self::NoStencil { .. } => Code::FormatMismatch,
            Self::NoTargets { .. } | Self::CanvasWithoutFragment { .. } => Code::MissingField,
            Self::TargetSizes { .. }
            | Self::TargetSamples { .. }
            | Self::AreaOutside { .. }
            | Self::CanvasBeside { .. } => Code::Size,
            _ => Code::ResourceKind,
        }
    }
}

impl IntoDiagnostic for LinkError {
    fn code(&self) -> Code {
        self.kind()
    }

    fn explain(self, diagnostic: Diagnostic) -> Diagnostic {
        match self {
            Self::NoShader => diagnostic,
            Self::ShaderNotLoaded(name) => diagnostic.at(
                name.span,
                "a pass kind must not choose its shaders by values",
            ),
            Self::WritesPrevious { of, span } => diagnostic.at(span, "written here").help(format!(
                "write `{of}`: the next frame finds it as `{of}.previous`"
            )),
            Self::WritesConstant { span, .. } => diagnostic
                .at(span, "written here")
                .help("write another material; a `Copy` above brings the content there"),
            Self::WritesProvided { span, .. } => {
                diagnostic.at(span, "declare it `var<storage, read>`")
            }
            Self::VertexWrites { span, .. } => diagnostic
                .at(span, "")
                .help("say `requires: [\"VERTEX_WRITABLE_STORAGE\"]`, or write it elsewhere"),
            Self::RayQuery { pass, span } => diagnostic
                .at(pass.span, "")
                .at(span, "needs the feature EXPERIMENTAL_RAY_QUERY")
                .help(
                    "take another adapter, another value of the param that chose this pass, or a \
                     pass that does without: `if: \"has(EXPERIMENTAL_RAY_QUERY)\"`",
                ),
            Self::Feedback {
                reader,
                reads,
                writer,
                ..
            } => diagnostic
                .at(reader, if reads { "read here" } else { "written here" })
                .at(writer, "written here")
                .help("read a copy, or a part that this pass does not write"),
            Self::Overwrites { name, .. } => diagnostic.at(name.span, "said to be overwritten"),
            Self::UnusedSet { name, known, .. } | Self::UnusedBind { name, known, .. } => {
                diagnostic.at(name.span.clone(), "").suggest(&name, known)
            }
            Self::OverrideWithout(name) => diagnostic
                .at(
                    name.span.clone(),
                    "no param that is a single number has this name",
                )
                .help(format!(
                    "declare a param `{0}` with a single number, `set` it, or write \
                     `override {0}: … = …;`",
                    *name
                )),
            Self::UnknownWord { constant, span, .. } => diagnostic.at(span, "").help(format!(
                "a word is one of a Choice param of that name, or a constant of the shader: \
                 `{constant}`"
            )),
            Self::SetValue { found, span, .. } => diagnostic.at(span, format!("this is {found}")),
            Self::WorkgroupOverride { at, pass } => diagnostic
                .at(at, "")
                .at(pass.span, "run by this pass")
                .help("write the size as a number or `const`"),
            Self::WorkgroupSize {
                most,
                threads,
                at,
                pass,
                ..
            } => diagnostic
                .at(at, "")
                .at(pass.span, "run by this pass")
                .help(format!(
                    "its limits are {}×{}×{} and {threads} invocations in all",
                    most[0], most[1], most[2]
                )),
            Self::Workgroups { most, pass, .. } => diagnostic
                .at(pass.span, "dispatched by this pass")
                .help(format!("its limit is {most} in each direction")),
            other => other.explain_reads(diagnostic),
        }
    }
}

impl LinkError {
    /// Explains mistakes in the `reads` of a pass.
    fn explain_reads(self, diagnostic: Diagnostic) -> Diagnostic {
        match self {
            Self::ReadsNot { name, .. } => diagnostic
                .at(name.span, "said to be read")
                .help("take it out of `reads`"),
            Self::ReadsMore { pass, name, read } => diagnostic
                .at(read, "read here")
                .at(pass.span, "by this pass")
                .help(format!(
                    "add `{name}` to its `reads`, as the document calls it"
                )),
            other => other.explain_binding(diagnostic),
        }
    }

    fn explain_binding(self, diagnostic: Diagnostic) -> Diagnostic {
        match self {
            Self::BindGroup { most, span, .. } => diagnostic
                .at(
                    span,
                    format!("its groups are 0 to {}", most.saturating_sub(1)),
                )
                .help("leave the numbers out: the graph gives them"),
            Self::TooManyBindings { pass, most, .. } => diagnostic.at(pass.span, "").help(format!(
                "the adapter's limit is {most} per shader stage: split the pass or pack what it \
                 binds"
            )),
            Self::Unsupported { span, .. } => diagnostic.at(span, ""),
            Self::ParamsUniform { what, size, span } => diagnostic
                .at(span, format!("{size} bytes"))
                .help(if what.contains("large") {
                    "put what is large into a buffer"
                } else {
                    "write `struct Params { … }` with the params that the shader reads, \
                     and `var<uniform> params: Params;`"
                }),
            Self::UnknownGlobal {
                global,
                span,
                pass,
                known,
            } => diagnostic
                .at(
                    span,
                    "no material, input or provided resource has this name",
                )
                .at(pass.span, "bound by this pass")
                .suggest(&global, known)
                .help(format!(
                    "bind what is meant: `bind: {{\"{global}\": \"…\"}}`"
                )),
            Self::WrongKind {
                span,
                needed,
                found,
                declared,
                ..
            } => {
                let diagnostic = diagnostic.at(span, format!("the shader declares {needed}"));
                match declared {
                    Some(declared) => diagnostic.at(declared, found),
                    None => diagnostic,
                }
            }
            Self::UniformSize { span, .. } => {
                diagnostic.at(span, "import its type from the module that declares it")
            }
            Self::UniformLimit { most, span, .. } => diagnostic
                .at(span, "")
                .help(format!("its limit is {most}: use a storage buffer")),
            Self::Alignment {
                alignment, span, ..
            } => diagnostic.at(span, "bound here").help(format!(
                "the device binds at multiples of {alignment} bytes"
            )),
            Self::Texture {
                span,
                declared,
                misfit,
                format,
                ..
            } => {
                let mut diagnostic = diagnostic.at(span, misfit.to_string());
                if let Some(declared) = declared {
                    diagnostic = diagnostic.at(declared, format!("{format:?}"));
                }
                match misfit.help() {
                    Some(help) => diagnostic.help(help),
                    None => diagnostic,
                }
            }
            other => other.explain_member(diagnostic),
        }
    }

    fn explain_member(self, diagnostic: Diagnostic) -> Diagnostic {
        match self {
            Self::UnknownMember {
                member,
                span,
                known,
                ty,
            } => diagnostic
                .at(span, "")
                .suggest(&member, known)
                .help(match ty {
                    Some(ty) => format!(
                        "declare it, `params: [{ty}(name: \"{member}\", default: …)]`, or `set` it"
                    ),
                    None => format!("`set` it: `set: {{\"{member}\": …}}`"),
                }),
            Self::IndexMember(span) | Self::MemberIsNoVector { span, .. } => {
                diagnostic.at(span, "in this uniform")
            }
            Self::MemberType { param, span, .. } => diagnostic.at(span, "in this uniform").at(
                param.name.span.clone(),
                format!("declared {} here", param.ty),
            ),
            other => other.explain_target(diagnostic),
        }
    }

    fn explain_target(self, diagnostic: Diagnostic) -> Diagnostic {
        match self {
            Self::NoArguments { name, found } => diagnostic.at(
                name.span,
                format!("this is {found}, a buffer of the document is needed"),
            ),
            Self::CopyFormat { from, to, formats } => diagnostic
                .at(from.span, format!("{:?}", formats[0]))
                .at(to.span, format!("{:?}", formats[1]))
                .help("format, samples and dimension must be the same"),
            Self::CopySize { from, to, extents } => diagnostic
                .at(from.span, extent(extents[0]))
                .at(to.span, extent(extents[1]))
                .help("both must be equally large"),
            Self::CopyKinds { from, to, kinds } => {
                diagnostic.at(from.span, kinds[0]).at(to.span, kinds[1])
            }
            Self::ClearFormat { name, .. } => diagnostic
                .at(name.span, "wgpu clears what can be drawn to")
                .help("write it whole by a Compute pass instead"),
            Self::ClearBufferValue(name) => diagnostic
                .at(name.span, "")
                .help("leave `value` out, or write the buffer by a Compute pass"),
            Self::ClearKind { name, found } => diagnostic.at(name.span, format!("this is {found}")),
            Self::ClearValue {
                name,
                format,
                expected,
                ..
            } => diagnostic.at(
                name.span,
                format!("a texture of format {format:?}, which takes {expected}"),
            ),
            Self::DrawFeature {
                pass,
                field,
                feature,
            } => diagnostic.at(pass.span, format!("`{field}`")).help(format!(
                "list it in `requires: [\"{feature}\"]`, so that devices that have it are opened \
                 with it"
            )),
            Self::TooManyTargets { pass, most, .. } => diagnostic
                .at(pass.span, "")
                .help(format!("its limit is {most}")),
            Self::BytesPerPixel { pass, most, .. } => diagnostic.at(pass.span, "").help(format!(
                "the adapter's limit is {most}: use smaller formats or two passes"
            )),
            Self::NotDrawable { name, .. } => diagnostic
                .at(name.span, "")
                .help("use a colour format that can be drawn to, or `depth: \"…\"`"),
            Self::NotBlendable { name, .. } => diagnostic.at(name.span, ""),
            Self::Resolve { name, why } => diagnostic.at(name.span, why),
            other => other.explain_attachment(diagnostic),
        }
    }

    fn explain_attachment(self, diagnostic: Diagnostic) -> Diagnostic {
        match self {
            Self::NoFragmentOutput {
                name,
                location,
                entry,
            } => diagnostic
                .at(name.span, format!("this target has location {location}"))
                .at(entry, format!("no output @location({location}) here")),
            Self::FragmentOutput {
                name,
                expected,
                needed,
                written,
                location,
                entry,
                ..
            } => diagnostic
                .at(name.span, format!("needs {needed} × {expected}"))
                .at(entry, format!("writes {written} at @location({location})")),
            Self::NoDepth { name, .. } => diagnostic
                .at(name.span, "")
                .help("use Depth32Float, Depth24Plus, Depth16Unorm, or one of them with Stencil8"),
            Self::NoStencil { name, .. } => diagnostic
                .at(name.span, "")
                .help("use Depth24PlusStencil8, Depth32FloatStencil8 or Stencil8"),
            Self::NoTexture { name, found, .. } => {
                diagnostic.at(name.span, format!("this is {found}, a texture is needed"))
            }
            Self::SeveralLayers(name) => diagnostic
                .at(name.span, "a pass draws to one mip of one layer")
                .help(format!(
                    "name one: `{0}[0]`, `{0}.mip[0]`, `{0}[0].mip[0]`",
                    name.value
                )),
            Self::TwoDepthStencils(pass) => diagnostic
                .at(pass.span, "")
                .help("a stencil is that of the depth: one texture with both"),
            Self::TargetSizes { pass, names, sizes } => diagnostic.at(
                pass.span,
                format!(
                    "`{}` has {}×{} texels, `{}` {}×{}",
                    names[0], sizes[0][0], sizes[0][1], names[1], sizes[1][0], sizes[1][1]
                ),
            ),
            Self::TargetSamples {
                pass,
                names,
                samples,
            } => diagnostic.at(
                pass.span,
                format!(
                    "`{}` has {}, `{}` {}",
                    names[0], samples[0], names[1], samples[1]
                ),
            ),
            Self::AreaOutside { pass, area, whole } => diagnostic.at(
                pass.span,
                format!(
                    "{}×{} texels at ({}, {}), of {}×{}",
                    area[2], area[3], area[0], area[1], whole[0], whole[1]
                ),
            ),
            other => other.explain_canvas(diagnostic),
        }
    }

    fn explain_canvas(self, diagnostic: Diagnostic) -> Diagnostic {
        match self {
            Self::NoTargets {
                pass,
                fullscreen: true,
            } => diagnostic.at(pass.span, "give it `color: […]` or `stencil: (…)`"),
            Self::NoTargets { pass, .. } => diagnostic
                .at(
                    pass.span,
                    "give it `color: […]`, `depth: …` or `stencil: (…)`",
                )
                .help(
                    "or `size: (width, height)`, if its fragment shader writes buffers or storage \
                     textures alone",
                ),
            Self::CanvasBeside { size, target, .. } => diagnostic
                .at(size, "this is the size of a pass without targets")
                .at(target.span, "the pass is as large as this")
                .help("leave `size` out"),
            Self::CanvasWithoutFragment { pass, size } => diagnostic
                .at(pass.span, "")
                .at(size, "a pass without targets")
                .help("give it a fragment shader that writes buffers or storage textures"),
            Self::CanvasOutput { size, entry, .. } => diagnostic
                .at(entry, "have it return nothing")
                .at(size, "or give the pass `color: […]` in the place of `size`"),
            _ => diagnostic,
        }
    }
}

fn extent([width, height, layers, mips]: [usize; 4]) -> String {
    match (layers, mips) {
        (1, 1) => format!("{width}×{height} texels"),
        _ => format!("{width}×{height} texels, layers: {layers}, mips: {mips}"),
    }
}
