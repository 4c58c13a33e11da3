//! `Raster`: a draw call with vertex pulling into colour and depth attachments.

use crate::{
    document::{
        located::{self, Located},
        materials::Count,
        params::{Param, ParamType, ParamValue},
        value::{Compare, Value},
    },
    registry::{FromParam, Lowering, PassKind},
    step::{ColorTarget, DepthTarget, Draw, DrawCall, Step},
};
use serde::{Deserialize, Deserializer};

/// Body of a `Raster` pass.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Raster {
    draw: Call,
    #[serde(default)]
    instances: Option<Count>,
    #[serde(default)]
    color: Vec<ColorEntry>,
    #[serde(default)]
    depth: Option<DepthEntry>,
    #[serde(default = "no_culling")]
    cull: Value<Face>,
    #[serde(default)]
    front_face: Winding,
    #[serde(default)]
    topology: Topology,
    /// Whether a pixel that a triangle touches anywhere counts, not only one whose centre it covers.
    #[serde(default)]
    conservative: bool,
    #[serde(default)]
    vertex: Option<Located<String>>,
    #[serde(default)]
    fragment: Option<Located<String>>,
}

fn no_culling() -> Value<Face> {
    Value::Literal(Face::None)
}

#[derive(Clone, Debug)]
enum Call {
    Vertices(Count),
    Indirect(Located<String>),
}

impl<'de> Deserialize<'de> for Call {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        #[derive(Deserialize)]
        #[serde(rename = "draw")]
        enum Words {
            Vertices(Count),
            CountOf(Located<String>),
            Indirect(Located<String>),
        }
        match located::literal::<u32, D>(deserializer)? {
            Ok(number) => Ok(Self::Vertices(Count::Number(Value::Literal(number)))),
            Err(text) => Ok(match located::word::<Words, D::Error>(text)? {
                Words::Vertices(count) => Self::Vertices(count),
                Words::CountOf(name) => Self::Vertices(Count::CountOf(name)),
                Words::Indirect(name) => Self::Indirect(name),
            }),
        }
    }
}

/// A colour attachment as the document writes it.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ColorEntry {
    target: Located<String>,
    #[serde(default)]
    load: ColorLoad,
    #[serde(default)]
    blend: Option<Blend>,
}

#[derive(Clone, Debug, Deserialize)]
enum ColorLoad {
    Clear(f64, f64, f64, f64),
    Load,
}

impl Default for ColorLoad {
    fn default() -> Self {
        Self::Clear(0.0, 0.0, 0.0, 0.0)
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

impl ColorEntry {
    pub(super) fn target(&self) -> ColorTarget {
        let same = |operation| {
            let component = wgpu::BlendComponent {
                src_factor: wgpu::BlendFactor::One,
                dst_factor: wgpu::BlendFactor::One,
                operation,
            };
            wgpu::BlendState {
                color: component,
                alpha: component,
            }
        };
        ColorTarget {
            target: self.target.clone(),
            clear: match self.load {
                ColorLoad::Clear(r, g, b, a) => Some([r, g, b, a]),
                ColorLoad::Load => None,
            },
            blend: self.blend.map(|blend| match blend {
                Blend::Alpha => wgpu::BlendState::ALPHA_BLENDING,
                Blend::Premultiplied => wgpu::BlendState::PREMULTIPLIED_ALPHA_BLENDING,
                Blend::Additive => same(wgpu::BlendOperation::Add),
                Blend::Min => same(wgpu::BlendOperation::Min),
                Blend::Max => same(wgpu::BlendOperation::Max),
            }),
        }
    }
}

#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
struct DepthEntry {
    target: Located<String>,
    #[serde(default)]
    load: DepthLoad,
    #[serde(default)]
    compare: Compare,
    #[serde(default = "yes")]
    write: bool,
    #[serde(default)]
    bias: BiasEntry,
}

fn yes() -> bool {
    true
}

#[derive(Clone, Debug, Deserialize)]
enum DepthLoad {
    Clear(Value<f32>),
    Load,
}

impl Default for DepthLoad {
    fn default() -> Self {
        Self::Clear(Value::Literal(1.0))
    }
}

/// Depth bias of the rasteriser, as wgpu defines it.
#[derive(Clone, Debug, Default, Deserialize)]
#[serde(deny_unknown_fields)]
struct BiasEntry {
    #[serde(default)]
    constant: i32,
    #[serde(default)]
    slope_scale: Option<Value<f32>>,
    #[serde(default)]
    clamp: f32,
}

#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Deserialize)]
enum Face {
    #[default]
    None,
    Front,
    Back,
}

impl FromParam for Face {
    const EXPECTED: &'static str = "a Choice of \"none\", \"front\", \"back\"";
    fn from_param(param: &Param, value: &ParamValue) -> Option<Self> {
        // Every word must be a face, not only the chosen one: a document must not fail on some of its params' values.
        let face = |word: &str| match word.to_ascii_lowercase().as_str() {
            "none" => Some(Self::None),
            "front" => Some(Self::Front),
            "back" => Some(Self::Back),
            _ => None,
        };
        match (&param.ty, value) {
            (ParamType::Choice(words), ParamValue::Choice(word))
                if words.iter().all(|word| face(word).is_some()) =>
            {
                face(word)
            }
            _ => None,
        }
    }
}

#[derive(Clone, Copy, Debug, Default, Deserialize)]
enum Winding {
    #[default]
    Ccw,
    Cw,
}

#[derive(Clone, Copy, Debug, Default, Deserialize)]
enum Topology {
    #[default]
    TriangleList,
    TriangleStrip,
    LineList,
    PointList,
}

impl PassKind for Raster {
    fn lower(&self, pass: &mut Lowering<'_>) {
        let mut program = pass.program();
        program.vertex.clone_from(&self.vertex);
        program.fragment.clone_from(&self.fragment);
        let depth = self.depth.as_ref().map(|depth| DepthTarget {
            target: depth.target.clone(),
            clear: match &depth.load {
                DepthLoad::Clear(value) => Some(pass.value(value, 1.0)),
                DepthLoad::Load => None,
            },
            compare: depth.compare,
            write: depth.write,
            bias: wgpu::DepthBiasState {
                constant: depth.bias.constant,
                slope_scale: depth
                    .bias
                    .slope_scale
                    .as_ref()
                    .map_or(0.0, |scale| pass.value(scale, 0.0)),
                clamp: depth.bias.clamp,
            },
        });
        let call = match &self.draw {
            Call::Vertices(count) => DrawCall::Direct {
                count: count.clone(),
                instances: self
                    .instances
                    .clone()
                    .unwrap_or(Count::Number(Value::Literal(1))),
            },
            Call::Indirect(buffer) => DrawCall::Indirect(buffer.clone()),
        };
        let primitive = wgpu::PrimitiveState {
            topology: match self.topology {
                Topology::TriangleList => wgpu::PrimitiveTopology::TriangleList,
                Topology::TriangleStrip => wgpu::PrimitiveTopology::TriangleStrip,
                Topology::LineList => wgpu::PrimitiveTopology::LineList,
                Topology::PointList => wgpu::PrimitiveTopology::PointList,
            },
            front_face: match self.front_face {
                Winding::Ccw => wgpu::FrontFace::Ccw,
                Winding::Cw => wgpu::FrontFace::Cw,
            },
            cull_mode: match pass.value(&self.cull, Face::None) {
                Face::None => None,
                Face::Front => Some(wgpu::Face::Front),
                Face::Back => Some(wgpu::Face::Back),
            },
            conservative: self.conservative,
            ..wgpu::PrimitiveState::default()
        };
        let colors = self.color.iter().map(ColorEntry::target).collect();
        pass.step(Step::Draw(Draw {
            program,
            fullscreen: false,
            colors,
            depth,
            call,
            primitive,
        }));
    }
}
