//! `Fullscreen`: a fragment shader once per pixel of its targets.

use super::raster::ColorEntry;
use crate::{
    document::{located::Located, materials::Count, value::Value},
    registry::{Lowering, PassKind},
    step::{Draw, DrawCall, Step},
};
use serde::Deserialize;

/// Body of a `Fullscreen` pass.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Fullscreen {
    color: Vec<ColorEntry>,
    #[serde(default)]
    fragment: Option<Located<String>>,
}

impl PassKind for Fullscreen {
    fn lower(&self, pass: &mut Lowering<'_>) {
        let mut program = pass.program();
        program.fragment.clone_from(&self.fragment);
        pass.step(Step::Draw(Draw {
            program,
            fullscreen: true,
            colors: self.color.iter().map(ColorEntry::target).collect(),
            depth: None,
            call: DrawCall::Direct {
                count: Count::Number(Value::Literal(3)),
                instances: Count::Number(Value::Literal(1)),
            },
            primitive: wgpu::PrimitiveState::default(),
        }));
    }
}
