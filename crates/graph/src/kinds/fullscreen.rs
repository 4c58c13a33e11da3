//! `Fullscreen`: a fragment shader once per pixel of its targets.

use super::entry_name::EntryName;
use super::kind::{Lowering, PassKind};
use super::step::{Draw, DrawCall, Step};
use super::targets::{self, ColorEntry, StencilEntry};
use crate::language::Expr;
use serde::Deserialize;

/// Runs a fragment shader once for each pixel of its targets.
#[derive(Clone, Debug, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields)]
pub(super) struct Fullscreen {
    /// Colour attachments, in the order of the shader's locations.
    #[serde(default)]
    color: Vec<ColorEntry>,
    /// Stencil attachment.
    stencil: Option<StencilEntry>,
    /// The texels that are drawn, `(x, y, width, height)`; all without it.
    area: Option<Expr>,
    /// The fragment entry point, where the shader has several.
    fragment: Option<EntryName>,
}

impl PassKind for Fullscreen {
    fn lower(&self, pass: &mut Lowering<'_>) {
        let mut program = pass.program();
        program.fragment = self.fragment.as_ref().and_then(|entry| entry.chosen(pass));
        let area = self.area.as_ref();
        let draw = Draw {
            program,
            fullscreen: true,
            colors: targets::colors(&self.color, area, pass),
            depth: None,
            stencil: targets::stencil(self.stencil.as_ref(), area, pass),
            canvas: None,
            area: area.and_then(|area| targets::area(area, pass)),
            call: DrawCall::Direct {
                vertices: 0..3,
                instances: 0..1,
            },
            primitive: wgt::PrimitiveState::default(),
        };
        pass.step(Step::Draw(draw));
    }
}
