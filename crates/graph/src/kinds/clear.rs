//! `Clear`: a texture to a value, or a buffer to zero.

use super::kind::{Lowering, PassKind};
use super::step::{Operand, Step};
use crate::language::{Expr, Reference};
use serde::Deserialize;

/// Sets a texture to a value, or a buffer to zero.
#[derive(Clone, Debug, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields)]
pub(super) struct Clear {
    /// The texture or buffer, or a part of one.
    target: Reference,
    /// One value for all channels; four; a depth and a stencil. 0 without it, of a depth, too.
    value: Option<Expr>,
}

impl PassKind for Clear {
    fn lower(&self, pass: &mut Lowering<'_>) {
        let mut value = [0.0; 4];
        if let Some(expr) = &self.value {
            let list = pass.list(expr);
            match list.as_slice() {
                [] => {}
                [one] => value = [one.number(); 4],
                [depth, stencil] => value = [depth.number(), stencil.number(), 0.0, 0.0],
                [r, g, b, a] => value = [r, g, b, a].map(|channel| channel.number()),
                _ => {
                    let what = "a clear value is one number, four, or a depth and a stencil";
                    pass.report_value(crate::diagnostics::code::Code::Expression, expr, what);
                }
            }
        }
        pass.step(Step::Clear {
            target: Operand::from(&self.target),
            value,
        });
    }
}
