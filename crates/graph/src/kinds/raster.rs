//! `Raster`: a draw call with vertex pulling into colour, depth and stencil attachments.

use super::entry_name::EntryName;
use super::kind::{Lowering, PassKind};
use super::step::{Draw, DrawCall, Operand, Step};
use super::targets::{self, ColorEntry, DepthEntry, StencilEntry};
use crate::errors::document::DocumentError;
use crate::errors::evaluation::EvaluationError;
use crate::fields::{Chosen, by_text};
use crate::language::{Expr, Reference};
use serde::Deserialize;
use skiagraph_located_ron::reader::read;
use std::ops::Range;

/// One draw call, whose vertices the shader pulls by their index.
#[derive(Clone, Debug, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields)]
pub(super) struct Raster {
    /// The number of vertices, or `Indirect("buffer")`: four u32 in a buffer.
    draw: Call,
    /// How often they are drawn; once without it.
    instances: Option<Expr>,
    /// Index of the first vertex; 0 without it.
    first_vertex: Option<Expr>,
    /// Index of the first instance; 0 without it.
    first_instance: Option<Expr>,
    /// Colour attachments, in the order of the shader's locations.
    #[serde(default)]
    color: Vec<ColorEntry>,
    /// Depth attachment.
    depth: Option<DepthEntry>,
    /// Stencil attachment.
    stencil: Option<StencilEntry>,
    /// Width and height in texels, one number for a square, of a pass without attachments, whose
    /// fragment shader writes buffers or storage textures.
    size: Option<Expr>,
    /// The texels that are drawn, `(x, y, width, height)`; all without it.
    area: Option<Expr>,
    /// The triangles that are left out, none without it, or in quotes a `Choice` of `none`,
    /// `front`, `back`, or one of them by a condition.
    #[serde(default = "no_culling")]
    cull: Chosen<Face>,
    /// Which triangles show their front: `Ccw`, counter-clockwise ones, without it; or in quotes
    /// one of `ccw` and `cw` by a condition.
    #[serde(default = "counter_clockwise")]
    front_face: Chosen<Winding>,
    /// Primitives that vertices form; `TriangleList` without it.
    #[serde(default, deserialize_with = "Topology::deserialize")]
    #[cfg_attr(feature = "schema", schemars(with = "Topology"))]
    topology: wgt::PrimitiveTopology,
    /// Counts every pixel that a triangle touches, not only those whose centre it covers.
    #[serde(default)]
    conservative: bool,
    /// Draws what lies before the near or behind the far plane, its depth clamped.
    #[serde(default)]
    unclipped: bool,
    /// The vertex entry point, where the shader has several.
    vertex: Option<EntryName>,
    /// The fragment entry point, where the shader has several; `none` draws depth alone.
    fragment: Option<EntryName>,
}

fn counter_clockwise() -> Chosen<Winding> {
    Chosen::Word(Winding::Ccw)
}

/// The windings as words behind a condition.
const WINDINGS: [(&str, Winding); 2] = [("ccw", Winding::Ccw), ("cw", Winding::Cw)];

fn no_culling() -> Chosen<Face> {
    Chosen::Word(Face::None)
}

/// A number of vertices, or `Indirect("buffer")`.
#[derive(Clone, Debug)]
enum Call {
    Vertices(Expr),
    Indirect(Reference),
}

#[derive(Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename = "draw")]
pub(super) enum CallWords {
    /// Four u32 in a buffer.
    Indirect(Reference),
}

by_text!(
    Call,
    |text, _| if text.starts_with(|c: char| c.is_alphabetic()) {
        read(text).map(|CallWords::Indirect(buffer)| Self::Indirect(buffer))
    } else {
        read(text).map(Self::Vertices)
    }
);

/// Which triangles are left out.
#[derive(Clone, Copy, Debug, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[cfg_attr(feature = "schema", schemars(rename = "Cull"))]
enum Face {
    None,
    Front,
    Back,
}

/// The faces as words of a `Choice`.
const FACES: [(&str, Face); 3] = [
    ("none", Face::None),
    ("front", Face::Front),
    ("back", Face::Back),
];

/// Which triangles show their front.
#[derive(Clone, Copy, Debug, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
enum Winding {
    Ccw,
    Cw,
}

/// Primitives that vertices form.
#[derive(Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(remote = "wgt::PrimitiveTopology")]
enum Topology {
    TriangleList,
    TriangleStrip,
    LineList,
    PointList,
}

impl PassKind for Raster {
    fn lower(&self, pass: &mut Lowering<'_>) {
        let mut program = pass.program();
        program.vertex = self.vertex.as_ref().and_then(|entry| entry.chosen(pass));
        program.fragment = self.fragment.as_ref().and_then(|entry| entry.chosen(pass));
        program.no_fragment = self.fragment.is_some() && program.fragment.is_none();
        let call = match &self.draw {
            Call::Vertices(count) => DrawCall::Direct {
                vertices: range(self.first_vertex.as_ref(), Some(count), pass),
                instances: range(self.first_instance.as_ref(), self.instances.as_ref(), pass),
            },
            Call::Indirect(buffer) => {
                if let Some(first) = self.first_vertex.as_ref().or(self.first_instance.as_ref()) {
                    pass.report(DocumentError::FirstOfIndirect(first.span.clone()));
                }
                DrawCall::Indirect(Operand::from(buffer))
            }
        };
        let primitive = wgt::PrimitiveState {
            topology: self.topology,
            front_face: match pass.word(&self.front_face, &WINDINGS) {
                Winding::Ccw => wgt::FrontFace::Ccw,
                Winding::Cw => wgt::FrontFace::Cw,
            },
            cull_mode: match pass.word(&self.cull, &FACES) {
                Face::None => None,
                Face::Front => Some(wgt::Face::Front),
                Face::Back => Some(wgt::Face::Back),
            },
            conservative: self.conservative,
            unclipped_depth: self.unclipped,
            ..wgt::PrimitiveState::default()
        };
        let (area, depth) = (self.area.as_ref(), self.depth.as_ref());
        let draw = Draw {
            program,
            fullscreen: false,
            colors: targets::colors(&self.color, area, pass),
            depth: depth.map(|depth| targets::depth(depth, area, pass)),
            stencil: targets::stencil(self.stencil.as_ref(), area, pass),
            canvas: self.size.as_ref().map(|size| targets::canvas(size, pass)),
            area: area.and_then(|area| targets::area(area, pass)),
            call,
            primitive,
        };
        pass.step(Step::Draw(draw));
    }
}

/// Returns `count` indices (one without it) from `first` on (from 0 without it).
fn range(first: Option<&Expr>, count: Option<&Expr>, pass: &mut Lowering<'_>) -> Range<u32> {
    let start = first.map_or(0, |first| pass.count32(first));
    let count = count.map_or(1, |count| pass.count32(count));
    let end = start.checked_add(count);
    if let (None, Some(first)) = (end, first) {
        let last = u64::from(start) + u64::from(count);
        pass.report(EvaluationError::Large(first.span.clone(), last));
    }
    start..end.unwrap_or(start)
}

#[cfg(feature = "schema")]
crate::written::written!(Call, "Call", generator => {
    let count = generator.subschema_for::<Expr>();
    let words = <CallWords as schemars::JsonSchema>::json_schema(generator);
    schemars::json_schema!({
        "description": "A number of vertices, or arguments in a buffer.",
        "anyOf": [count, words],
    })
});
