//! Sizes and contents that a material cannot have.

use crate::source::Located;

mistakes! {
    /// A size or content that a material cannot have.
    SizeError:

    Absurd(name: Located<String>) =>
        Size("`{name}`: no texture has so many texels").at(name, "");

    NoTexels { name: Located<String>, size: [u32; 2], layers: u32, mips: u32, samples: u32 } =>
        Size(
            "`{name}`: {}×{} texels, layers: {layers}, mips: {mips}, samples: {samples}: a texture \
             of no texels",
            size[0], size[1]
        )
        .at(name, "").help("give it one at least");

    Texels(name: Located<String>, size: [u32; 2], most: u32) =>
        Size("`{name}`: {}×{} texels are more than the adapter can hold", size[0], size[1])
        .at(name, "").help(format!("its limit is {most} in each direction"));

    Layers { name: Located<String>, layers: u32, most: u32 } =>
        Size("`{name}`: {layers} layers or slices are more than the adapter can hold")
        .at(name, "").help(format!("its limit is {most}"));

    Mips { name: Located<String>, mips: u32, full: u32 } =>
        Size("`{name}`: {mips} mips are too many")
        .at(name, "").help(format!("it can have {full}: `mips: All`"));

    Samples(name: Located<String>, format: wgt::TextureFormat, samples: u32, counts: Vec<u32>) =>
        FormatMismatch("`{name}`: a texture of {format:?} cannot have {samples} samples")
        .at(name, "")
        .help(format!("it can have {}", list(counts.iter().map(u32::to_string), ", ")));

    FormatFeature(name: Located<String>, format: wgt::TextureFormat, feature: wgt::Features) =>
        Feature("`{name}`: not every device has {format:?}")
        .at(name, "")
        .help(format!(
            "list `requires: [\"{}\"]`, or use a format of floats or 8 bits",
            list(feature.iter_names().map(|(name, _)| name.to_owned()), "\", \"")
        ));

    SamplesOfMany(name: Located<String>) =>
        Size("`{name}`: a texture of several samples has one mip and one layer").at(name, "");

    LayersOf3d(name: Located<String>) =>
        Size("`{name}`: a 3D texture has slices, not layers")
        .at(name, "").help("leave `layers` out");

    FileHas(file: Located<String>, field: &'static str) =>
        Size("the file brings its {field}").at(file, "").help(format!("leave `{field}` out"));

    NoPicture(file: Located<String>, candidates: Vec<String>) =>
        MissingFile("picture `{file}` not found")
        .at(file, "asked for here").help(format!("looked for {}", candidates.join(", ")));

    Picture(file: Located<String>, why: String) =>
        MissingFile("the picture `{file}` cannot be read").at(file, "asked for here").help(why);

    PictureFormat(format: Located<String>) =>
        FormatMismatch("a texture of {format} cannot hold a picture")
        .at(format, "")
        .help(
            "use R8Unorm, Rg8Unorm, Rgba8Unorm, Rgba8UnormSrgb, or a format of 16- or 32-bit \
             floats",
        );

    DataHas(name: Located<String>) =>
        Size("`{name}` is as many items as its `data`").at(name, "").help("leave `count` out");

    NoItems(name: Located<String>) =>
        Size("`{name}`: a buffer of no items").at(name, "").help("give it one at least");

    KeepsConstant(name: Located<String>) =>
        Size("`{name}` holds what stands in the document, and stays as it is anyway")
        .at(name, "").help("leave `keep` out");

    GrowWithoutCount(name: Located<String>) =>
        Size("`{name}` grows, but from which `count`?")
        .at(name, "").help("give it a `count` to begin with; `data` does not grow");

    GrowWithoutLayers(name: Located<String>) =>
        Size("`{name}` grows, but from which `layers`?")
        .at(name, "")
        .help(
            "give it `layers` to begin with, two or more; a picture and a 3D texture do not grow",
        );

    GrowFromOne(name: Located<String>) =>
        Size("`{name}` grows from one layer")
        .at(name, "")
        .help(
            "begin with two `layers`, and let `max` be two or more: one layer can be bound and \
             drawn to as a texture without layers, several cannot",
        );

    GrowToNothing(name: Located<String>) =>
        Size("`{name}` grows to nothing: its `max` is 0").at(name, "").help("give it one at least");

    Counter(name: Located<String>, what: &'static str) =>
        Size("`{name}` is {what}: it cannot count items")
        .at(name, "")
        .help("name a buffer whose first u32 a pass makes the number of items needed");
}

fn list(texts: impl Iterator<Item = String>, between: &str) -> String {
    texts.collect::<Vec<_>>().join(between)
}
