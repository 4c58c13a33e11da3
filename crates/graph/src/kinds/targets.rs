//! Attachments as documents write them.

use super::blend::Blend;
use super::kind::Lowering;
use super::step::{ColorTarget, DepthTarget, Names, StencilTarget};
use crate::errors::document::DocumentError;
use crate::fields::{Compare, Load, by_text, short_or_long};
use crate::language::{Expr, Reference};
use crate::source::Located;
use serde::{Deserialize, Deserializer};
use skiagraph_located_ron::reader::refuse;

/// A colour attachment: `"image"`, or `(target: "image", load: …, blend: …, write: …, resolve: …,
/// if: …)`.
#[derive(Clone, Debug)]
pub(super) struct ColorEntry(ColorFields);

/// A colour attachment.
#[derive(Clone, Debug, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields)]
pub(super) struct ColorFields {
    /// The texture, or one mip or layer of it.
    target: Reference,
    /// Operation before the first draw; cleared to zero without it.
    load: Option<Load>,
    /// How what is drawn is mixed with what is there; it replaces it without this.
    blend: Option<Blend>,
    /// The channels that are written, such as `rg`; all without it.
    #[serde(default)]
    write: WriteMask,
    /// The texture that a multisampled target is resolved into.
    resolve: Option<Reference>,
    /// Condition under which the target is there; what the shader writes to its location is lost
    /// else.
    #[serde(default, rename = "if")]
    condition: Option<Expr>,
}

by_text!(ColorEntry, |text, span| {
    let short = |target| ColorFields {
        target,
        load: None,
        blend: None,
        write: WriteMask::default(),
        resolve: None,
        condition: None,
    };
    short_or_long((text, span), Self, |target| Self(short(target)))
});

/// Channels that are written: `rg`, `true`, `false`.
#[derive(Clone, Copy, Debug)]
struct WriteMask(wgt::ColorWrites);

impl Default for WriteMask {
    fn default() -> Self {
        Self(wgt::ColorWrites::ALL)
    }
}

by_text!(WriteMask, |text, span| {
    let channel = |sign| match sign {
        'r' => Some(wgt::ColorWrites::RED),
        'g' => Some(wgt::ColorWrites::GREEN),
        'b' => Some(wgt::ColorWrites::BLUE),
        'a' => Some(wgt::ColorWrites::ALPHA),
        _ => None,
    };
    match text {
        "true" => Ok(Self::default()),
        "false" => Ok(Self(wgt::ColorWrites::empty())),
        _ => text
            .chars()
            .map(channel)
            .collect::<Option<_>>()
            .map(Self)
            .ok_or_else(|| refuse(DocumentError::WriteMask(span))),
    }
});

/// A depth attachment: `"depth"`, or
/// `(target: "depth", load: …, compare: …, write: …, bias: …)`.
#[derive(Clone, Debug)]
pub(super) struct DepthEntry(DepthFields);

/// A depth attachment.
#[derive(Clone, Debug, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields)]
pub(super) struct DepthFields {
    /// The texture, or one mip or layer of it.
    target: Reference,
    /// Operation before the first draw; cleared to one without it.
    load: Option<Load>,
    /// Which depths pass; smaller ones without it.
    #[serde(default)]
    compare: Compare,
    /// Writes depth; `true` without it.
    #[serde(default = "yes")]
    write: bool,
    /// Bias that the rasteriser adds to depth.
    #[serde(default)]
    bias: BiasEntry,
}

by_text!(DepthEntry, |text, span| {
    let short = |target| DepthFields {
        target,
        load: None,
        compare: Compare::default(),
        write: true,
        bias: BiasEntry::default(),
    };
    short_or_long((text, span), Self, |target| Self(short(target)))
});

fn yes() -> bool {
    true
}

/// Depth bias of the rasteriser, as wgpu defines it.
#[derive(Clone, Debug, Default, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[cfg_attr(feature = "schema", schemars(rename = "Bias"))]
#[serde(deny_unknown_fields)]
struct BiasEntry {
    /// In steps of the format.
    #[serde(default)]
    constant: i32,
    /// Times the triangle's greatest slope.
    slope_scale: Option<Expr>,
    /// Most that is added; no bound where it is 0.
    #[serde(default)]
    clamp: f32,
}

/// A stencil attachment: `(target: "ds", load: …, front: …, back: …, …)`.
#[derive(Clone, Debug, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[cfg_attr(feature = "schema", schemars(rename = "Stencil"))]
#[serde(deny_unknown_fields)]
pub(super) struct StencilEntry {
    /// The texture, or one mip or layer of it; the depth attachment's, where there are both.
    target: Reference,
    /// Operation before the first draw; cleared to zero without it.
    load: Option<Load>,
    /// Triangles that show their front.
    #[serde(default, deserialize_with = "FaceEntry::deserialize")]
    #[cfg_attr(feature = "schema", schemars(with = "FaceEntry"))]
    front: wgt::StencilFaceState,
    /// Triangles that show their back.
    #[serde(default, deserialize_with = "FaceEntry::deserialize")]
    #[cfg_attr(feature = "schema", schemars(with = "FaceEntry"))]
    back: wgt::StencilFaceState,
    /// The bits that are compared.
    #[serde(default = "all_ones")]
    read_mask: u32,
    /// The bits that are written.
    #[serde(default = "all_ones")]
    write_mask: u32,
    /// Value that the test compares with and `Replace` writes; 0 without it.
    reference: Option<Expr>,
}

fn all_ones() -> u32 {
    u32::MAX
}

/// Test and operations of one side.
#[derive(Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[cfg_attr(feature = "schema", schemars(rename = "StencilFace"))]
#[serde(remote = "wgt::StencilFaceState", deny_unknown_fields)]
struct FaceEntry {
    /// The test of `reference` against what is stored; `Always` without it.
    #[serde(default = "always", deserialize_with = "compare")]
    #[cfg_attr(feature = "schema", schemars(with = "Compare"))]
    compare: wgt::CompareFunction,
    /// Operation where the test fails; `Keep` without it, as below.
    #[serde(default, deserialize_with = "StencilOperation::deserialize")]
    #[serde(rename = "fail")]
    #[cfg_attr(feature = "schema", schemars(with = "StencilOperation"))]
    fail_op: wgt::StencilOperation,
    /// Where it passes and that of depth fails.
    #[serde(default, deserialize_with = "StencilOperation::deserialize")]
    #[serde(rename = "depth_fail")]
    #[cfg_attr(feature = "schema", schemars(with = "StencilOperation"))]
    depth_fail_op: wgt::StencilOperation,
    /// Where both pass.
    #[serde(default, deserialize_with = "StencilOperation::deserialize")]
    #[serde(rename = "pass")]
    #[cfg_attr(feature = "schema", schemars(with = "StencilOperation"))]
    pass_op: wgt::StencilOperation,
}

fn always() -> wgt::CompareFunction {
    wgt::CompareFunction::Always
}

fn compare<'de, D: Deserializer<'de>>(deserializer: D) -> Result<wgt::CompareFunction, D::Error> {
    Compare::deserialize(deserializer).map(Into::into)
}

/// Operation on a stencil value; wgpu's names.
#[derive(Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(remote = "wgt::StencilOperation")]
enum StencilOperation {
    Keep,
    Zero,
    Replace,
    Invert,
    IncrementClamp,
    DecrementClamp,
    IncrementWrap,
    DecrementWrap,
}

/// The value that an attachment is cleared to; `None` keeps what is there. Clearing knows no area.
fn clear(
    load: Option<&Load>,
    default: f64,
    area: Option<&Expr>,
    pass: &mut Lowering<'_>,
) -> Option<[f64; 4]> {
    let values = match (load, area) {
        (Some(Load::Keep), _) | (None, Some(_)) => return None,
        (Some(Load::KeepIf(condition)), None) if pass.boolean(condition) => return None,
        (None | Some(Load::KeepIf(_)), None) => return Some([default; 4]),
        (Some(Load::Clear(values)), None) => values,
        (Some(Load::Clear(values)), Some(area)) => return refused(&values[0], area, pass),
        (Some(Load::KeepIf(condition)), Some(area)) => return refused(condition, area, pass),
    };
    let values: Vec<f64> = values.iter().map(|value| pass.number(value)).collect();
    // One value fills all channels.
    Some(std::array::from_fn(|channel| {
        values[channel.min(values.len() - 1)]
    }))
}

/// Reports a `load` that would clear more than the area of a draw.
fn refused(clear: &Expr, area: &Expr, pass: &mut Lowering<'_>) -> Option<[f64; 4]> {
    pass.report(DocumentError::ClearInArea {
        clear: clear.span.clone(),
        area: area.span.clone(),
    });
    None
}

pub(super) fn colors(
    entries: &[ColorEntry],
    area: Option<&Expr>,
    pass: &mut Lowering<'_>,
) -> Vec<Option<ColorTarget<Names>>> {
    let mut constants: Option<[f64; 4]> = None;
    let color = |ColorEntry(entry): &ColorEntry| {
        let condition = entry.condition.as_ref();
        if !condition.is_none_or(|condition| pass.condition(condition)) {
            return None;
        }
        let constant = entry.blend.as_ref().and_then(|blend| blend.constant(pass));
        if let Some(constant) = &constant
            && *constants.get_or_insert(constant.value) != constant.value
        {
            pass.report(DocumentError::BlendConstants(constant.span.clone()));
        }
        Some(ColorTarget {
            target: entry.target.clone(),
            resolve: entry.resolve.clone(),
            clear: clear(entry.load.as_ref(), 0.0, area, pass),
            blend: entry.blend.as_ref().map(|blend| blend.state(pass)),
            blend_constant: constant.map(|constant| constant.value),
            write: entry.write.0,
        })
    };
    entries.iter().map(color).collect()
}

pub(super) fn depth(
    DepthEntry(entry): &DepthEntry,
    area: Option<&Expr>,
    pass: &mut Lowering<'_>,
) -> DepthTarget<Names> {
    let slope_scale = entry.bias.slope_scale.as_ref();
    DepthTarget {
        target: entry.target.clone(),
        clear: clear(entry.load.as_ref(), 1.0, area, pass).map(|[value, ..]| value as f32),
        compare: entry.compare.into(),
        write: entry.write,
        bias: wgt::DepthBiasState {
            constant: entry.bias.constant,
            slope_scale: slope_scale.map_or(0.0, |scale| pass.number(scale) as f32),
            clamp: entry.bias.clamp,
        },
    }
}

pub(super) fn stencil(
    entry: Option<&StencilEntry>,
    area: Option<&Expr>,
    pass: &mut Lowering<'_>,
) -> Option<StencilTarget<Names>> {
    let entry = entry?;
    let reference = entry.reference.as_ref();
    Some(StencilTarget {
        target: entry.target.clone(),
        clear: clear(entry.load.as_ref(), 0.0, area, pass).map(|value| match &entry.load {
            Some(Load::Clear(values)) => pass.count32(&values[0]),
            _ => value[0] as u32,
        }),
        state: wgt::StencilState {
            front: entry.front,
            back: entry.back,
            read_mask: entry.read_mask,
            write_mask: entry.write_mask,
        },
        reference: reference.map_or(0, |reference| pass.count32(reference)),
    })
}

/// The width and height of a draw without attachments.
pub(super) fn canvas(size: &Expr, pass: &mut Lowering<'_>) -> Located<[u64; 2]> {
    let edges = pass.edges(size);
    let canvas = <[u64; 2]>::try_from(edges).unwrap_or_else(|_| {
        pass.report(DocumentError::Canvas(size.span.clone()));
        [1, 1]
    });
    Located::new(canvas, size.span.clone())
}

/// A rectangle of texels: `(x, y, width, height)`.
pub(super) fn area(entry: &Expr, pass: &mut Lowering<'_>) -> Option<[u32; 4]> {
    let list = pass.list(entry);
    if list.is_empty() {
        return None;
    }
    let edges: Option<Vec<u32>> = list.iter().map(|edge| edge.whole()).collect();
    let area = edges.and_then(|edges| <[u32; 4]>::try_from(edges).ok());
    if area.is_none() {
        pass.report(DocumentError::Area(entry.span.clone()));
    }
    area
}

#[cfg(feature = "schema")]
crate::written::short_or_long!(ColorEntry, "Color", ColorFields);
#[cfg(feature = "schema")]
crate::written::short_or_long!(DepthEntry, "Depth", DepthFields);
#[cfg(feature = "schema")]
crate::written::written!(WriteMask, "Channels", _generator => schemars::json_schema!({
    "description": "`true`, `false`, or channels: `rg`.",
    "anyOf": [{ "type": "boolean" }, { "type": "string", "pattern": "^[rgba]+$" }],
}));
