//! Passes whose shaders, attachments, copies or dispatches do not fit.

use crate::language::Value;
use crate::param::Param;
use crate::scalar_class::{ItemScalar, ShaderType};
use crate::source::{Located, Span};
use wgt::TextureFormat;

mistakes! {
    /// A pass whose shaders, attachments, copies or dispatches do not fit.
    LinkError:

    ReadsNot(pass: String, name: Located<String>) =>
        ResourceKind("`{pass}` does not read `{name}`")
        .at(name, "said to be read").help("take it out of `reads`");

    ReadsMore(pass: Located<String>, name: String, read: Span) =>
        ResourceKind("`{pass}` reads `{name}`, too")
        .at(read, "read here").at(pass, "by this pass")
        .help(format!("add `{name}` to its `reads`, as the document calls it"));

    /// A part of a pass that a round which does not run cannot leave out.
    InRounds(pass: Span, what: &'static str, counter: Span) =>
        RunCondition("a group that ends early cannot leave this out: {what}")
        .at(pass, "in this pass").at(counter, "the group ends by this counter")
        .help(
            "dispatches and draws that clear nothing stand there; put the rest above or below the \
             group",
        );

    Counter(name: Located<String>, kind: &'static str) =>
        ResourceKind("`{name}` cannot count the rounds of a group")
        .at(name, format!("this is {kind}, and a whole buffer of the document is needed"));

    NoShader =>
        Shader("a step of this pass has no shader");

    ShaderNotLoaded(name: Located<String>) =>
        MissingFile("the shader `{name}` was not loaded with the document")
        .at(name, "a pass kind must not choose its shaders by values");

    WritesPrevious(base: String, span: Span) =>
        ResourceKind("last frame's version of `{base}` cannot be written")
        .at(span, "written here")
        .help(format!("write `{base}`: the next frame finds it as `{base}.previous`"));

    WritesConstant(name: String, span: Span) =>
        ResourceKind("`{name}` holds what stands in the document, and is never written")
        .at(span, "written here")
        .help("write another material; a `Copy` above brings the content there");

    WritesProvided(name: String, span: Span) =>
        ResourceKind("`{name}` belongs to the host and cannot be written")
        .at(span, "declare it `var<storage, read>`, or name a material of the document");

    VertexWrites(global: Located<String>) =>
        Feature("the vertex shader writes `{global}`, which most devices cannot")
        .at(global, "")
        .help("say `requires: [\"VERTEX_WRITABLE_STORAGE\"]`, or write it elsewhere");

    RayQuery(pass: Located<String>, span: Span) =>
        Feature("pass `{pass}` asks the device for ray queries, which it does not have")
        .at(pass, "").at(span, "needs the feature EXPERIMENTAL_RAY_QUERY")
        .help(
            "take another adapter, another value of the param that chose this pass, or a pass that \
             does without: `if: \"has(EXPERIMENTAL_RAY_QUERY)\"`",
        );

    Feedback {
        pass: String,
        name: String,
        reader: Span,
        reads: bool,
        writer: Span,
        /// Name in the document, if the material has a version of the frame before.
        previous: Option<String>,
    } =>
        FeedbackLoop("pass `{pass}` uses `{name}` twice at once, and writes it")
        .at(&reader, if reads { "read here" } else { "written here" }).at(writer, "written here")
        .help("read a copy, or a part that this pass does not write")
        .help_any(previous.map(|name| read_previous(&name, &reader)));

    Overwrites(pass: String, name: Located<String>) =>
        ResourceKind("pass `{pass}` does not write `{name}`").at(name, "said to be overwritten");

    UnusedSet { shader: String, name: Located<String>, names: Vec<String> } =>
        Unused("`{shader}` has no param or constant `{name}` to set")
        .at(&name, "").suggest(&name, names);

    UnusedBind { shader: String, name: Located<String>, globals: Vec<String> } =>
        Unused("`{shader}` has no global `{name}` to bind").at(&name, "").suggest(&name, globals);

    BindGroup { global: String, group: u32, most: u32, span: Span } =>
        Limit("`{global}` is in @group({group}), which the adapter does not have")
        .at(span, format!("its groups are 0 to {}", most.saturating_sub(1)))
        .help("leave the numbers out: the graph gives them");

    TooManyBindings(pass: Located<String>, what: &'static str, number: usize, most: u32) =>
        Limit("pass `{pass}` binds {number} {what}")
        .at(pass, "")
        .help(format!(
            "the adapter's limit is {most} per shader stage: split the pass or pack what it binds"
        ));

    Unsupported(global: Located<String>, what: &'static str) =>
        Binding("`{global}` is {what}, which a graph cannot bind").at(global, "");

    ParamsUniform { what: &'static str, size: u64, span: Span } =>
        Binding("the uniform `params` {what}")
        .at(span, format!("{size} bytes"))
        .help(if what.contains("large") {
            "put what is large into a buffer"
        } else {
            "write `struct Params { … }` with the params that the shader reads, and \
             `var<uniform> params: Params;`"
        });

    UnknownGlobal { global: Located<String>, pass: Located<String>, materials: Vec<String> } =>
        UnknownResource("pass `{pass}` binds the unknown material `{global}`")
        .at(&global, "no material, input or provided resource has this name")
        .at(pass, "bound by this pass")
        .suggest(&global, materials)
        .help(format!("bind what is meant: `bind: {{\"{global}\": \"…\"}}`"));

    WrongKind {
        global: Located<String>, needed: &'static str, name: String, kind: &'static str,
        declared: Option<Span>,
    } =>
        ResourceKind("the shader's `{global}` needs {needed}, but `{name}` is {kind}")
        .at(global, format!("the shader declares {needed}")).at_any(declared, kind);

    UniformSize { name: String, have: u64, size: u64, span: Span } =>
        LayoutMismatch("`{name}` has {have} bytes, the shader's type {size}")
        .at(span, "import its type from the module that declares it");

    UniformLimit { global: Located<String>, size: u64, most: u64 } =>
        Limit("the uniform `{global}` has {size} bytes, more than the adapter can bind")
        .at(global, "").help(format!("its limit is {most}: use a storage buffer"));

    Alignment { name: String, stride: u64, alignment: u64, span: Span } =>
        Alignment("items of `{name}` are {stride} bytes apart, and cannot be bound alone")
        .at(span, "bound here")
        .help(format!("the device binds at multiples of {alignment} bytes"));

    Texture {
        name: String, format: TextureFormat, global: Located<String>, declared: Option<Span>,
        misfit: Box<TextureMisfit>,
    } =>
        FormatMismatch("the texture `{name}` cannot be the shader's `{global}`")
        .because(global, *misfit).at_any(declared, format!("{format:?}"));

    OverrideWithout(name: Located<String>) =>
        UnknownParam("the override `{name}` has no value")
        .at(&name, "no param that is a single number has this name")
        .help(format!(
            "declare a param `{name}` with a single number, `set` it, or write \
             `override {name}: … = …;`"
        ));

    UnknownWord { name: String, word: String, constant: String, span: Span } =>
        ParamValue("`{name}` has no word `{word}`")
        .at(span, "")
        .help(format!(
            "a word is one of a Choice param of that name, or a constant of the shader: \
             `{constant}`"
        ));

    /// A value for a member of `params` or an override, of the type `expected`; `None` for `bool`.
    SetValue { name: String, expected: Option<ShaderType>, value: Value, span: Span } =>
        ParamValue("`{name}` takes {}", expected.map_or("true or false".into(), ShaderType::words))
        .at(&span, format!("this is {value}"))
        .help(match expected {
            Some(expected) => expected.way_out(value.scalars(), span.text()),
            None => "write `true` or `false`, or a comparison in quotes".to_owned(),
        });

    UnknownMember {
        member: String,
        span: Span,
        params: Vec<String>,
        /// Param type that fits the member, for the suggested declaration; `None` if no param can
        /// be it.
        ty: Option<String>,
    } =>
        UnknownParam("unknown param `{member}` in the shader's `params`")
        .at(span, "").suggest(&member, params)
        .help(match ty {
            Some(ty) => format!(
                "declare it, `params: [{ty}(name: \"{member}\", default: …)]`, or `set` it"
            ),
            None => in_a_buffer(&member),
        });

    IndexMember(place: Span) =>
        LayoutMismatch("`params.index` is the number of the repetition, a u32")
        .at(place, "in this uniform");

    MemberIsNoVector(member: String, span: Span) =>
        LayoutMismatch("`params.{member}` cannot be set: it is neither a number nor a vector")
        .at(span, "in this uniform").help(in_a_buffer(&member));

    MemberType {
        param: Box<Param>,
        /// Member of `params`, `params.threshold`, or an override.
        member: String,
        /// Type of the param in a shader.
        needed: ShaderType,
        /// Type of the member; `None` if it is neither a number nor a vector.
        declared: Option<ShaderType>,
        span: Span,
    } =>
        LayoutMismatch(
            "`{member}` is {} in the shader, but the param `{}` needs {needed} there",
            declared.map_or("neither a number nor a vector".to_owned(), |ty| ty.to_string()),
            param.name
        )
        .at(span, "declared here").at(&param.name, format!("declared {} here", param.ty))
        .help_any(match member.strip_prefix("params.") {
            Some(member) => Some(format!("write `{member}: {needed}` in the shader")),
            None if needed.width == 1 => Some(format!("write `override {member}: {needed}`")),
            None => None,
        })
        .help_any(declared.and_then(ShaderType::param).map(|ty| {
            format!("or declare the param so: `{ty}(name: \"{}\", …)`", param.name)
        }));

    NoArguments(name: Located<String>, kind: &'static str) =>
        ResourceKind("`{name}` cannot hold indirect arguments")
        .at(name, format!("this is {kind}, a buffer of the document is needed"));

    WorkgroupOverride(at: Span, pass: Located<String>) =>
        Shader("a workgroup size that is an override is not supported")
        .at(at, "").at(pass, "run by this pass")
        .help("write the size as a number or `const`");

    WorkgroupSize {
        size: [u32; 3], most: [u32; 3], threads: u32, at: Span, pass: Located<String>,
    } =>
        Limit(
            "a workgroup of {}×{}×{} is more than the adapter can run", size[0], size[1], size[2]
        )
        .at(at, "").at(pass, "run by this pass")
        .help(format!(
            "its limits are {}×{}×{} and {threads} invocations in all", most[0], most[1], most[2]
        ));

    Workgroups(groups: [u64; 3], most: u32, pass: Located<String>) =>
        Limit(
            "{}×{}×{} workgroups are more than the adapter can run", groups[0], groups[1], groups[2]
        )
        .at(pass, "dispatched by this pass")
        .help(format!("its limit is {most} in each direction"));

    CopyFormat { from: Located<String>, to: Located<String>, formats: [TextureFormat; 2] } =>
        FormatMismatch("`{from}` cannot be copied onto `{to}`")
        .at(from, format!("{:?}", formats[0])).at(to, format!("{:?}", formats[1]))
        .help("format, samples and dimension must be the same");

    /// Sizes that differ; `extents` holds width, height, layers and mips of both.
    CopySize { from: Located<String>, to: Located<String>, extents: [[usize; 4]; 2] } =>
        FormatMismatch("`{from}` cannot be copied onto `{to}`")
        .at(from, extent(extents[0])).at(to, extent(extents[1])).help("both must be equally large");

    CopyKinds { from: Located<String>, to: Located<String>, kinds: [&'static str; 2] } =>
        ResourceKind("`{from}` cannot be copied onto `{to}`").at(from, kinds[0]).at(to, kinds[1]);

    NoCpuWork(name: Located<String>, kind: &'static str) =>
        ResourceKind("`{name}` does no work on the CPU").at(name, format!("this is {kind}"));

    CpuItems(name: Located<String>, kind: &'static str) =>
        ResourceKind("`{name}` has no items for the CPU").at(name, format!("this is {kind}"));

    ClearFormat(name: Located<String>, format: TextureFormat) =>
        FormatMismatch("a texture of format {format:?} cannot be cleared")
        .at(name, "wgpu clears what can be drawn to")
        .help("write it whole by a Compute pass instead");

    ClearBufferValue(name: Located<String>) =>
        ResourceKind("the buffer `{name}` can only be cleared to zero")
        .at(name, "").help("leave `value` out, or write the buffer by a Compute pass");

    ClearKind(name: Located<String>, kind: &'static str) =>
        ResourceKind("`{name}` cannot be cleared").at(name, format!("this is {kind}"));

    ClearValue {
        name: Located<String>, wrong: f64, format: TextureFormat, expected: &'static str,
    } =>
        FormatMismatch("`{name}` cannot be cleared to {wrong}")
        .at(name, format!("a texture of format {format:?}, which takes {expected}"));

    DrawFeature { pass: Located<String>, field: &'static str, feature: &'static str } =>
        Feature("this adapter does not draw with `{field}`")
        .at(pass, format!("`{field}`"))
        .help(format!(
            "list it in `requires: [\"{feature}\"]`, so that devices that have it are opened with \
             it"
        ));

    TooManyTargets(pass: Located<String>, count: usize, most: u32) =>
        Limit("{count} colour targets are more than the adapter can draw to")
        .at(pass, "").help(format!("its limit is {most}"));

    BytesPerPixel { pass: Located<String>, bytes: u32, most: u32 } =>
        Limit("the colour targets of `{pass}` take {bytes} bytes per pixel")
        .at(pass, "")
        .help(format!("the adapter's limit is {most}: use smaller formats or two passes"));

    NotDrawable(name: Located<String>, format: TextureFormat) =>
        FormatMismatch("a texture of format {format:?} cannot be a colour target")
        .at(name, "").help("use a colour format that can be drawn to, or `depth: \"…\"`");

    NotBlendable(name: Located<String>, format: TextureFormat) =>
        FormatMismatch("a target of format {format:?} cannot be blended")
        .at(name, "")
        .help(match format.sample_type(None, None) {
            Some(wgt::TextureSampleType::Float { .. }) => {
                "write `requires: [\"FLOAT32_BLENDABLE\"]`, or use a format of 16 bits"
            }
            _ => "leave `blend` out, or use a format of floats or normalised numbers",
        });

    Resolve(name: Located<String>, why: &'static str) =>
        ResourceKind("nothing can be resolved into `{name}`").at(name, why);

    NoFragmentOutput(name: Located<String>, location: u32, entry: Span) =>
        FormatMismatch("the fragment shader writes nothing to `{name}`")
        .at(name, format!("this target has location {location}"))
        .at(entry, format!("no output @location({location}) here"));

    NoTarget(pass: Located<String>, location: u32, entry: Span) =>
        Unused("pass `{pass}` has no target for @location({location}) of its fragment shader")
        .at(pass, "what it writes there is lost").at(entry, "written by this")
        .help("add a texture to `color`, or take the output out of the shader");

    FragmentOutput {
        name: Located<String>, format: TextureFormat, expected: String, needed: u32,
        written: String, location: u32, entry: Span,
    } =>
        FormatMismatch("`{name}` has the format {format:?}, the shader writes {written}")
        .at(name, format!("needs {needed} × {expected}"))
        .at(entry, format!("writes {written} at @location({location})"));

    NoDepth(name: Located<String>, format: TextureFormat) =>
        FormatMismatch("a texture of format {format:?} cannot be a depth target")
        .at(name, "")
        .help("use Depth32Float, Depth24Plus, Depth16Unorm, or one of them with Stencil8");

    NoStencil(name: Located<String>, format: TextureFormat) =>
        FormatMismatch("a texture of format {format:?} cannot be a stencil target")
        .at(name, "").help("use Depth24PlusStencil8, Depth32FloatStencil8 or Stencil8");

    NoTexture(pass: String, name: Located<String>, kind: &'static str) =>
        ResourceKind("pass `{pass}` cannot draw to `{name}`")
        .at(name, format!("this is {kind}, a texture is needed"));

    SeveralLayers(name: Located<String>) =>
        ResourceKind("`{name}` has several mips or layers")
        .at(&name, "a pass draws to one mip of one layer")
        .help(format!("name one: `{name}[0]`, `{name}.mip[0]`, `{name}[0].mip[0]`"));

    NoTargets(pass: Located<String>, fullscreen: bool) =>
        MissingField("pass `{pass}` draws to nothing")
        .at(pass, if fullscreen {
            "give it `color: […]` or `stencil: (…)`"
        } else {
            "give it `color: […]`, `depth: …` or `stencil: (…)`"
        })
        .help_any((!fullscreen).then_some(
            "or `size: (width, height)`, if its fragment shader writes buffers or storage textures \
             alone",
        ));

    CanvasBeside { pass: String, size: Span, target: Located<String> } =>
        Size("pass `{pass}` has a target and a `size`")
        .at(size, "this is the size of a pass without targets")
        .at(target, "the pass is as large as this")
        .help("leave `size` out");

    CanvasWithoutFragment(pass: Located<String>, size: Span) =>
        MissingField("pass `{pass}` has neither a target nor a fragment shader")
        .at(pass, "").at(size, "a pass without targets")
        .help("give it a fragment shader that writes buffers or storage textures");

    CanvasOutput { pass: String, size: Span, entry: Span } =>
        FormatMismatch(
            "the fragment shader of pass `{pass}` returns a value, but the pass has no target"
        )
        .at(entry, "have it return nothing")
        .at(size, "or give the pass `color: […]` in the place of `size`");

    TwoDepthStencils(pass: Located<String>) =>
        ResourceKind("depth and stencil of pass `{pass}` are two textures")
        .at(pass, "").help("a stencil is that of the depth: one texture with both");

    TargetSizes { pass: Located<String>, names: [String; 2], sizes: [[u32; 2]; 2] } =>
        Size("the targets of pass `{pass}` differ in size")
        .at(pass, format!(
            "`{}` has {}×{} texels, `{}` {}×{}",
            names[0], sizes[0][0], sizes[0][1], names[1], sizes[1][0], sizes[1][1]
        ));

    TargetSamples { pass: Located<String>, names: [String; 2], samples: [u32; 2] } =>
        Size("the targets of pass `{pass}` differ in samples")
        .at(pass, format!(
            "`{}` has {}, `{}` {}", names[0], samples[0], names[1], samples[1]
        ));

    AreaOutside(pass: Located<String>, area: [u32; 4], whole: [u32; 2]) =>
        Size("the area of pass `{pass}` does not lie in what it draws to")
        .at(pass, format!(
            "{}×{} texels at ({}, {}), of {}×{}",
            area[2], area[3], area[0], area[1], whole[0], whole[1]
        ));
}

mistakes! {
    /// Reason why a texture cannot be bound as a shader declares it; part of another diagnostic.
    TextureMisfit:

    Scalar(reads: ItemScalar, holds: Option<ItemScalar>, depth: bool) =>
        FormatMismatch("{}", match holds {
            _ if depth => "the shader declares a depth texture".to_owned(),
            Some(holds) => format!(
                "the shader reads {}, the texture holds {}", reads.as_str(), holds.as_str()
            ),
            None => format!("the shader reads {}", reads.as_str()),
        });

    Filtered(sampler: String, by_feature: bool) =>
        FormatMismatch("sampled through `{sampler}`, but the format cannot be filtered")
        .help(if by_feature {
            "list `requires: [\"FLOAT32_FILTERABLE\"]`, or use a sampler with `filter: Nearest`, \
             textureLoad, or a format of 16 bits"
        } else {
            "use a sampler with `filter: Nearest`, textureLoad, or a filterable format"
        });

    Samples(samples: u32) =>
        ResourceKind(
            "it has {samples} samples: declare a multisampled texture where these are more than \
             one, or resolve it to one sample before"
        );

    StorageFormat(declared: String) =>
        FormatMismatch("the shader declares {declared}");

    NoStorage =>
        FormatMismatch("no storage access of this kind is offered")
        .help(
            "R32Uint, R32Float and the Rgba formats of 8, 16 and 32 bits can be written by every \
             adapter; others can be drawn to, as a `color`",
        );

    StorageSamples(samples: u32) =>
        ResourceKind("it has {samples} samples, and a storage texture has one")
        .help("write a texture without `samples`, or draw to this one");

    StorageMips =>
        ResourceKind("it has several mips, a storage texture is one")
        .help("bind one of them: `x.mip[0]`");

    Flat =>
        ResourceKind("it is not a 3D texture");

    Solid =>
        ResourceKind("it is a 3D texture");

    Slice =>
        ResourceKind("a slice of a 3D texture can be drawn to, not bound");

    Layers(layers: usize) =>
        ResourceKind("it has {layers} layers, the shader sees one")
        .help("declare an array texture, or bind one layer: `x[0]`");

    Cube(layers: usize) =>
        ResourceKind("it has {layers} layers, a cube has six");

    Grows =>
        ResourceKind("its layers become more, a cube has six").help("declare a texture_2d_array");
}

/// Help for a read of a material that may have meant the frame before; `read` is its place.
pub(super) fn read_previous(name: &str, read: &Span) -> String {
    let reads = if read.file.name.ends_with(".wgsl") {
        format!("bind: {{\"{}\": \"{name}.previous\"}}", read.text())
    } else {
        format!("\"{name}.previous\"")
    };
    format!("if what the frame before left is meant, say so: `{reads}`")
}

/// Help for a member of `params` that no param can be.
fn in_a_buffer(member: &str) -> String {
    format!(
        "`params` holds numbers and vectors; an array, or the rows of a matrix, are a buffer, \
         `Buffer(name: \"{member}\", data: […])`, and in the shader \
         `var<storage, read> {member}: array<…>;`"
    )
}

fn extent([width, height, layers, mips]: [usize; 4]) -> String {
    match (layers, mips) {
        (1, 1) => format!("{width}×{height} texels"),
        _ => format!("{width}×{height} texels, layers: {layers}, mips: {mips}"),
    }
}
