//! What charts and graphs say about passes and materials.

use super::{
    Access, Drawing, Kind, Material, Origin, Part, Pass,
    text::{bytes, cut, plural},
};

/// Characters of a name in a picture; longer ones are cut, and whole in their titles.
pub(super) const MOST: usize = 36;

/// What a material is, in a few words.
pub(super) fn detail(material: &Material) -> String {
    let what = match (material.kind, &material.format, material.size) {
        (Kind::Texture, Some(format), Some([width, height])) => {
            let mut what = format!("{format} {width}×{height}");
            if material.layers > 1 {
                what.push_str(&format!(" × {} layers", material.layers));
            }
            if material.mips > 1 {
                what.push_str(&format!(", {} mips", material.mips));
            }
            what
        }
        (Kind::Texture, ..) => "texture".to_owned(),
        (Kind::Buffer, ..) => "buffer".to_owned(),
        (Kind::Sampler, ..) => "sampler".to_owned(),
    };
    match (material.origin, material.bytes) {
        (Origin::Provided, _) => format!("{what}, provided"),
        (Origin::Imported, _) => format!("{what}, imported"),
        (Origin::Previous, _) => format!("{what}, of the frame before"),
        (Origin::Declared | Origin::Scratch | Origin::Capture, _)
            if material.lifetime.is_none() =>
        {
            format!("{what}, not made")
        }
        (_, Some(size)) => format!("{what}, {}", bytes(size)),
        (_, None) => what,
    }
}

/// What a pass does with a material.
pub(super) fn verb(access: &Access) -> &'static str {
    match (access.reads, access.writes) {
        (true, true) => "reads and writes",
        (false, true) => "writes",
        // A sampler is bound, and nobody calls that reading; but neither is it anything else.
        _ => "reads",
    }
}

/// `mip 1, layers 0–3` of a texture with these mips and layers.
pub(super) fn part(part: &Part, material: &Material) -> String {
    let range = |one: &str, range: &std::ops::Range<u32>| match range.len() {
        1 => format!("{one} {}", range.start),
        _ => format!("{one}s {}–{}", range.start, range.end.saturating_sub(1)),
    };
    let mut parts = Vec::new();
    if material.mips > 1 {
        parts.push(range("mip", &part.mips));
    }
    if material.layers > 1 {
        parts.push(range("layer", &part.layers));
    }
    parts.join(", ")
}

/// Kind, shaders and condition of a pass. A shader of the pass's own name is what everybody expects.
pub(super) fn about(pass: &Pass) -> String {
    let stem = |path: &str| {
        let file = path.rsplit('/').next().unwrap_or(path);
        file.strip_suffix(".wgsl").unwrap_or(file).to_owned()
    };
    let own = pass.name.rsplit('.').next().unwrap_or(&pass.name);
    let shaders: Vec<String> = pass
        .shaders
        .iter()
        .map(|path| stem(path))
        .filter(|shader| shader != own)
        .collect();
    let mut parts = vec![pass.kind.clone()];
    if !shaders.is_empty() {
        parts.push(shaders.join(", "));
    }
    parts.extend(pass.run.as_ref().map(|run| format!("run: {run}")));
    cut(&parts.join(" · "), MOST)
}

/// Names of the outputs that are not called like their material.
pub(super) fn renamed(material: &Material) -> String {
    let names: Vec<&str> = material
        .outputs
        .iter()
        .map(String::as_str)
        .filter(|name| *name != material.name)
        .collect();
    cut(&names.join(", "), MOST)
}

/// `m0→m1` for a pass that reads one mip and writes the next.
pub(super) fn note(accesses: &[&Access], material: &Material) -> String {
    let short = |access: &Access| {
        let part = access.part.as_ref()?;
        let range = |letter: char, range: &std::ops::Range<u32>| match range.len() {
            1 => format!("{letter}{}", range.start),
            _ => format!("{letter}{}–{}", range.start, range.end.saturating_sub(1)),
        };
        let mips = (material.mips > 1).then(|| range('m', &part.mips));
        let layers = (material.layers > 1).then(|| range('l', &part.layers));
        Some([mips, layers].into_iter().flatten().collect::<String>())
    };
    let read = accesses
        .iter()
        .find(|access| access.reads && !access.writes)
        .and_then(|access| short(access));
    let written: Vec<String> = accesses
        .iter()
        .filter(|access| access.writes)
        .filter_map(|access| short(access))
        .collect();
    let written = match &written[..] {
        [] => None,
        [one] => Some(one.clone()),
        [first, ..] => Some(format!("{first}…")),
    };
    match (read, written) {
        (Some(read), Some(written)) => format!("{read}→{written}"),
        (read, written) => read.or(written).unwrap_or_default(),
    }
}

pub(super) fn summary(drawing: &Drawing, live: usize) -> String {
    let made = drawing
        .materials
        .iter()
        .filter(|material| material.lifetime.is_some() && !material.origin.is_given())
        .count();
    let mut parts = vec![format!(
        "{} in order of execution",
        plural(live, "pass", "passes")
    )];
    let culled = drawing.passes.len() - live;
    if culled > 0 {
        parts.push(format!("{culled} culled"));
    }
    parts.push(format!(
        "{}, {}",
        plural(made, "material", "materials"),
        bytes(drawing.memory_bytes)
    ));
    if drawing.saved_bytes > 0 {
        parts.push(format!("{} saved by sharing", bytes(drawing.saved_bytes)));
    }
    parts.join(" · ")
}
