//! Writes texts about passes and materials for charts and graphs.

use crate::drawing::{Access, Aspect, Drawing, Edge, Kind, Material, Origin, Part, Pass, Reason};
use crate::text::{self, NAME, plural};
use skiagraph_graph::Hazard;
use skiagraph_graph::text::{bytes, cut};
use std::ops::Range;

/// Greatest number of characters of a name in a picture. Longer names are cut; tooltips show them
/// whole.
pub(crate) const MOST: usize = 36;

/// End of the name of a material's content in the previous frame.
pub(crate) const PREVIOUS: &str = ".previous";

/// Splits a name into its prefix, which ends with a dot, and the rest: `sample[3].` and
/// `trace_rays`. The prefix of a capture (`rays@sample[3].trace_rays`) is empty.
pub(crate) fn split(name: &str) -> (&str, &str) {
    let latest = name.strip_suffix(PREVIOUS).unwrap_or(name);
    let dot = latest.rfind('.').filter(|_| !name.contains('@'));
    name.split_at(dot.map_or(0, |dot| dot + 1))
}

/// A name that [`split`] has divided, cut to the room in a picture; the prefix is cut first.
#[derive(Debug, PartialEq)]
pub(crate) struct Label {
    pub before: String,
    pub own: String,
}

impl Label {
    pub fn new(name: &str) -> Self {
        let (before, own) = split(name);
        let own = cut(own, MOST - before.chars().count().min(MOST / 3));
        let before = cut(before, MOST - own.chars().count());
        Self { before, own }
    }

    pub fn width(&self) -> f64 {
        text::bold(&self.before, NAME) + text::bold(&self.own, NAME)
    }
}

/// Describes a material in a few words: kind, format, size, source and bytes.
pub(crate) fn detail(material: &Material) -> String {
    let mut words = vec![match (material.kind, &material.format, material.size) {
        (Kind::Texture, Some(format), Some([width, height])) => {
            format!("{format} {width}×{height}")
        }
        (Kind::Texture, ..) => "texture".to_owned(),
        (Kind::Buffer, ..) => "buffer".to_owned(),
        (Kind::Sampler, ..) => "sampler".to_owned(),
        (Kind::AccelerationStructure, ..) => "acceleration structure".to_owned(),
        (Kind::CpuWork, ..) => "work for the CPU".to_owned(),
    }];
    if material.layers > 1 {
        let layer = Unit::from_material(material).word();
        words[0].push_str(&format!(" × {} {}s", material.layers, layer));
    }
    let counts = [
        (material.mips as usize, "mips"),
        (material.samples as usize, "samples"),
        (material.versions, "versions"),
    ];
    let several = counts.into_iter().filter(|(count, _)| *count > 1);
    words.extend(several.map(|(count, what)| format!("{count} {what}")));
    let origin = match material.origin {
        Origin::Constant => "constant",
        Origin::Provided => "provided",
        Origin::Imported => "imported",
        Origin::Frame => "the frame's number and time",
        Origin::Previous => "of the frame before",
        Origin::Declared | Origin::Scratch | Origin::Capture => "",
    };
    words.extend((!origin.is_empty()).then(|| origin.to_owned()));
    if material.origin.is_made() {
        words.extend(match material.lifetime {
            Some(_) => material.bytes.map(bytes),
            None => Some("not made".to_owned()),
        });
    }
    words.join(", ")
}

/// Unit of a material's parts.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) enum Unit {
    Mip,
    Layer,
    Slice,
    Item,
    Depth,
    Stencil,
}

impl Unit {
    pub fn word(self) -> &'static str {
        match self {
            Self::Mip => "mip",
            Self::Layer => "layer",
            Self::Slice => "slice",
            Self::Item => "item",
            Self::Depth => "depth",
            Self::Stencil => "stencil",
        }
    }

    /// Returns the abbreviation for notes at marks: the first letter of [`word`](Self::word), `z`
    /// for a slice.
    pub fn letter(self) -> &'static str {
        match self {
            Self::Slice => "z",
            _ => &self.word()[..1],
        }
    }

    /// Returns the unit of the layers of a material.
    fn from_material(material: &Material) -> Self {
        match material.kind {
            Kind::Buffer => Self::Item,
            _ if material.is_3d => Self::Slice,
            _ => Self::Layer,
        }
    }
}
/// Returns the later pass's part in a conflict with the earlier one, such as `reads what it wrote`.
pub(crate) fn consequence(hazard: Hazard) -> &'static str {
    match hazard {
        Hazard::ReadAfterWrite => "reads what it wrote",
        Hazard::WriteAfterRead => "overwrites what it read",
        Hazard::WriteAfterWrite => "overwrites what it wrote",
    }
}

/// Returns the units (mips, layers, depth or stencil) of which a part has not all, each with its
/// range, whose end is excluded; `None` for an aspect.
pub(crate) fn narrowed<'a>(
    part: &'a Part,
    material: &Material,
) -> impl Iterator<Item = (Unit, Option<&'a Range<u32>>)> {
    let ranges = [
        (Unit::Mip, &part.mips),
        (Unit::from_material(material), &part.layers),
    ];
    let ranges = ranges.into_iter().filter(|(_, range)| range.is_some());
    let aspect = part.aspect.map(|aspect| match aspect {
        Aspect::Depth => (Unit::Depth, None),
        Aspect::Stencil => (Unit::Stencil, None),
    });
    let ranges = ranges.map(|(unit, range)| (unit, range.as_ref()));
    ranges.chain(aspect)
}

fn numbers(range: &Range<u32>) -> String {
    match range.len() {
        1 => range.start.to_string(),
        _ => format!("{}–{}", range.start, range.end.saturating_sub(1)),
    }
}

/// Describes a part of a material: `mip 1, layers 0–3`, both ends included.
pub(crate) fn part(part: &Part, material: &Material) -> String {
    let words = |(unit, range): (Unit, Option<&Range<u32>>)| match range {
        None => unit.word().to_owned(),
        Some(range) if range.len() == 1 => format!("{} {}", unit.word(), numbers(range)),
        Some(range) => format!("{}s {}", unit.word(), numbers(range)),
    };
    let words: Vec<String> = narrowed(part, material).map(words).collect();
    words.join(", ")
}

/// Describes a part of a material briefly: `m1l0–3`.
fn short(part: &Part, material: &Material) -> String {
    let words = |(unit, range): (Unit, Option<&Range<u32>>)| {
        format!("{}{}", unit.letter(), range.map_or(String::new(), numbers))
    };
    narrowed(part, material).map(words).collect()
}

/// Returns the note at a mark: `m0→m1` if a pass reads mip 0 and writes mip 1.
pub(crate) fn note(accesses: &[&Access], material: &Material) -> String {
    let parts = |writes: bool| {
        let of_kind = accesses.iter().filter(|access| access.writes == writes);
        let parts = of_kind.filter_map(|access| Some(short(access.part.as_ref()?, material)));
        match &parts.collect::<Vec<_>>()[..] {
            [] => None,
            [first, _, _, ..] => Some(format!("{first}…")),
            few => Some(few.join(",")),
        }
    };
    match (parts(false), parts(true)) {
        (Some(read), Some(written)) => format!("{read}→{written}"),
        (read, written) => read.or(written).unwrap_or_default(),
    }
}

/// Describes a pass in a few words: kind, shaders and run condition. A shader named like the pass
/// is left out.
pub(crate) fn about(pass: &Pass) -> String {
    let stem = |path: &str| {
        let file = path.rsplit('/').next().unwrap_or(path);
        file.strip_suffix(".wgsl").unwrap_or(file).to_owned()
    };
    let own = split(&pass.name).1;
    // Repetitions are numbered.
    let own = own.split('[').next().unwrap_or(own);
    let shaders = pass.shaders.iter().map(|path| stem(path));
    let shaders: Vec<String> = shaders.filter(|shader| shader != own).collect();
    let mut parts = vec![pass.kind.clone()];
    if !shaders.is_empty() {
        parts.push(cut(&shaders.join(", "), MOST));
    }
    let run = pass.run.as_ref();
    parts.extend(run.map(|run| cut(&format!("run: {run}"), MOST)));
    parts.join(" · ")
}

/// Describes a pass for a tooltip: name, kind, place in the document, shaders, and why it is
/// culled.
pub(crate) fn origin(pass: &Pass) -> String {
    let Pass { name, kind, .. } = pass;
    let mut words = format!("{name} ({kind}), {}:{}", pass.file, pass.line);
    if !pass.shaders.is_empty() {
        words.push_str(&format!("; shader {}", pass.shaders.join(", ")));
    }
    if let Some(why) = &pass.culled {
        words.push_str(&format!("; culled: {why}"));
    }
    words
}

/// Describes an edge for a tooltip: both passes and the reasons for their order.
pub(crate) fn because(edge: &Edge) -> String {
    let reason = |reason: &Reason| {
        let verb = consequence(reason.hazard);
        format!("{verb} ({})", reason.materials.join(", "))
    };
    let reasons: Vec<String> = edge.because.iter().map(reason).collect();
    let implied = if edge.implied {
        "; other edges imply it"
    } else {
        ""
    };
    format!(
        "{} → {}: {}{implied}",
        edge.from,
        edge.to,
        reasons.join("; ")
    )
}

/// Returns the names of the material's outputs that differ from its own name, as text.
pub(crate) fn renamed(material: &Material) -> String {
    let names = material.outputs.iter().map(String::as_str);
    let names: Vec<&str> = names.filter(|name| *name != material.name).collect();
    cut(&names.join(", "), MOST)
}

/// Returns the line below the heading: how many passes run, and the memory they use.
pub(crate) fn summary(drawing: &Drawing) -> String {
    let live = drawing.passes.iter().filter(|pass| pass.position.is_some());
    let live = live.count();
    let is_made = |it: &&Material| it.lifetime.is_some() && it.origin.is_made();
    let made = drawing.materials.iter().filter(is_made);
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
        plural(made.count(), "material", "materials"),
        bytes(drawing.memory_bytes)
    ));
    if drawing.saved_bytes > 0 {
        parts.push(format!("{} saved by sharing", bytes(drawing.saved_bytes)));
    }
    parts.join(" · ")
}
