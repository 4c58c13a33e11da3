//! Attachments as documents write them.

use super::{
    kind::Lowering,
    step::{ColorTarget, DepthTarget, Names, StencilTarget},
};
use crate::{
    diagnostics::reports::Mistake,
    document::{
        fields::{Compare, Load, short_or_long},
        ron::{raw, refuse},
    },
    errors::document::DocumentError,
    language::{
        syntax::{Expr, Reference},
        value::Scalar,
    },
};
use serde::{Deserialize, Deserializer};

/// A colour attachment: `"image"`, or `(target: "image", load: …, blend: …, write: …, resolve: …)`.
#[derive(Clone, Debug)]
pub(super) struct ColorEntry {
    target: Reference,
    load: Option<Load>,
    blend: Option<Blend>,
    write: WriteMask,
    resolve: Option<Reference>,
}

impl<'de> Deserialize<'de> for ColorEntry {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        #[derive(Deserialize)]
        #[serde(deny_unknown_fields)]
        struct Long {
            target: Reference,
            #[serde(default)]
            load: Option<Load>,
            #[serde(default)]
            blend: Option<Blend>,
            #[serde(default)]
            write: WriteMask,
            #[serde(default)]
            resolve: Option<Reference>,
        }
        let long = |long: Long| Self {
            target: long.target,
            load: long.load,
            blend: long.blend,
            write: long.write,
            resolve: long.resolve,
        };
        let short = |target| Self {
            target,
            load: None,
            blend: None,
            write: WriteMask::default(),
            resolve: None,
        };
        short_or_long(deserializer, long, short)
    }
}

#[derive(Clone, Copy, Debug, Deserialize)]
enum Blend {
    Alpha,
    Premultiplied,
    Additive,
    Min,
    Max,
}

impl Blend {
    fn state(self) -> wgt::BlendState {
        let same = |operation| {
            let component = wgt::BlendComponent {
                src_factor: wgt::BlendFactor::One,
                dst_factor: wgt::BlendFactor::One,
                operation,
            };
            wgt::BlendState {
                color: component,
                alpha: component,
            }
        };
        match self {
            Self::Alpha => wgt::BlendState::ALPHA_BLENDING,
            Self::Premultiplied => wgt::BlendState::PREMULTIPLIED_ALPHA_BLENDING,
            Self::Additive => same(wgt::BlendOperation::Add),
            Self::Min => same(wgt::BlendOperation::Min),
            Self::Max => same(wgt::BlendOperation::Max),
        }
    }
}

/// Channels that are written: `rg`, `true`, `false`.
#[derive(Clone, Copy, Debug)]
struct WriteMask(wgt::ColorWrites);

impl Default for WriteMask {
    fn default() -> Self {
        Self(wgt::ColorWrites::ALL)
    }
}

impl<'de> Deserialize<'de> for WriteMask {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        let (text, span) = raw(deserializer)?;
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
    }
}

/// A depth attachment: `"depth"`, or
/// `(target: "depth", load: …, compare: …, write: …, bias: …)`.
#[derive(Clone, Debug)]
pub(super) struct DepthEntry {
    target: Reference,
    load: Option<Load>,
    compare: Compare,
    write: bool,
    bias: BiasEntry,
}

impl<'de> Deserialize<'de> for DepthEntry {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        #[derive(Deserialize)]
        #[serde(deny_unknown_fields)]
        struct Long {
            target: Reference,
            #[serde(default)]
            load: Option<Load>,
            #[serde(default)]
            compare: Compare,
            #[serde(default = "yes")]
            write: bool,
            #[serde(default)]
            bias: BiasEntry,
        }
        let long = |long: Long| Self {
            target: long.target,
            load: long.load,
            compare: long.compare,
            write: long.write,
            bias: long.bias,
        };
        let short = |target| Self {
            target,
            load: None,
            compare: Compare::default(),
            write: true,
            bias: BiasEntry::default(),
        };
        short_or_long(deserializer, long, short)
    }
}

fn yes() -> bool {
    true
}

/// Depth bias of the rasteriser, as wgpu defines it.
#[derive(Clone, Debug, Default, Deserialize)]
#[serde(deny_unknown_fields)]
struct BiasEntry {
    #[serde(default)]
    constant: i32,
    #[serde(default)]
    slope_scale: Option<Expr>,
    #[serde(default)]
    clamp: f32,
}

/// A stencil attachment: `(target: "ds", load: …, front: …, back: …, …)`.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct StencilEntry {
    target: Reference,
    #[serde(default)]
    load: Option<Load>,
    #[serde(default)]
    front: FaceEntry,
    #[serde(default)]
    back: FaceEntry,
    #[serde(default = "all_ones")]
    read_mask: u32,
    #[serde(default = "all_ones")]
    write_mask: u32,
    #[serde(default)]
    reference: Option<Expr>,
}

fn all_ones() -> u32 {
    u32::MAX
}

/// Test and operations of one side.
#[derive(Clone, Copy, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
struct FaceEntry {
    #[serde(default = "always")]
    compare: Compare,
    #[serde(default)]
    fail: StencilOperation,
    #[serde(default)]
    depth_fail: StencilOperation,
    #[serde(default)]
    pass: StencilOperation,
}

impl Default for FaceEntry {
    fn default() -> Self {
        Self {
            compare: always(),
            fail: StencilOperation::Keep,
            depth_fail: StencilOperation::Keep,
            pass: StencilOperation::Keep,
        }
    }
}

fn always() -> Compare {
    Compare::Always
}

/// wgpu's `StencilOperation`, which has the same names.
#[derive(Clone, Copy, Debug, Default, Deserialize)]
enum StencilOperation {
    #[default]
    Keep,
    Zero,
    Replace,
    Invert,
    IncrementClamp,
    DecrementClamp,
    IncrementWrap,
    DecrementWrap,
}

impl From<StencilOperation> for wgt::StencilOperation {
    fn from(operation: StencilOperation) -> Self {
        match operation {
            StencilOperation::Keep => Self::Keep,
            StencilOperation::Zero => Self::Zero,
            StencilOperation::Replace => Self::Replace,
            StencilOperation::Invert => Self::Invert,
            StencilOperation::IncrementClamp => Self::IncrementClamp,
            StencilOperation::DecrementClamp => Self::DecrementClamp,
            StencilOperation::IncrementWrap => Self::IncrementWrap,
            StencilOperation::DecrementWrap => Self::DecrementWrap,
        }
    }
}

impl From<FaceEntry> for wgt::StencilFaceState {
    fn from(face: FaceEntry) -> Self {
        Self {
            compare: face.compare.into(),
            fail_op: face.fail.into(),
            depth_fail_op: face.depth_fail.into(),
            pass_op: face.pass.into(),
        }
    }
}

/// The value that an attachment is cleared to; `None` keeps what is there. Clearing knows no area.
fn clear(
    load: Option<&Load>,
    default: f64,
    area: Option<&Expr>,
    pass: &mut Lowering<'_>,
) -> Option<[f64; 4]> {
    let values = match (load, area) {
        (Some(Load::Load), _) | (None, Some(_)) => return None,
        (None, None) => return Some([default; 4]),
        (Some(Load::Clear(values)), None) => values,
        (Some(Load::Clear(values)), Some(area)) => {
            let mistake = DocumentError::ClearInArea {
                clear: values[0].span.clone(),
                area: area.span.clone(),
            };
            pass.report(mistake.diagnostic());
            return None;
        }
    };
    let values: Vec<f64> = values.iter().map(|value| pass.number(value)).collect();
    // One value fills all channels.
    Some(std::array::from_fn(|channel| {
        values[channel.min(values.len() - 1)]
    }))
}

pub(super) fn color(
    entry: &ColorEntry,
    area: Option<&Expr>,
    pass: &mut Lowering<'_>,
) -> ColorTarget<Names> {
    ColorTarget {
        target: entry.target.clone(),
        resolve: entry.resolve.clone(),
        clear: clear(entry.load.as_ref(), 0.0, area, pass),
        blend: entry.blend.map(Blend::state),
        write: entry.write.0,
    }
}

pub(super) fn depth(
    entry: &DepthEntry,
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
    entry: &StencilEntry,
    area: Option<&Expr>,
    pass: &mut Lowering<'_>,
) -> StencilTarget<Names> {
    let reference = entry.reference.as_ref();
    StencilTarget {
        target: entry.target.clone(),
        clear: clear(entry.load.as_ref(), 0.0, area, pass).map(|value| match &entry.load {
            Some(Load::Clear(values)) => pass.count32(&values[0]),
            _ => value[0] as u32,
        }),
        state: wgt::StencilState {
            front: entry.front.into(),
            back: entry.back.into(),
            read_mask: entry.read_mask,
            write_mask: entry.write_mask,
        },
        reference: reference.map_or(0, |reference| pass.count32(reference)),
    }
}

/// A rectangle of texels: `(x, y, width, height)`.
pub(super) fn area(entry: &Expr, pass: &mut Lowering<'_>) -> Option<[u32; 4]> {
    let list = pass.list(entry);
    if list.is_empty() {
        return None;
    }
    let edge = |scalar: &Scalar| match scalar {
        Scalar::Whole(whole) => u32::try_from(*whole).ok(),
        Scalar::Number(_) => None,
    };
    let edges: Option<Vec<u32>> = list.iter().map(edge).collect();
    let area = edges.and_then(|edges| <[u32; 4]>::try_from(edges).ok());
    if area.is_none() {
        pass.report(DocumentError::Area(entry.span.clone()).diagnostic());
    }
    area
}
