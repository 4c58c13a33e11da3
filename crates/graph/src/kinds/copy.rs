//! `Copy`: a texture or buffer (or last frame's version of one) onto another of equal format and
//! size.

use super::kind::{Lowering, PassKind};
use super::step::{Operand, Step};
use crate::language::Reference;
use serde::Deserialize;

/// Copies a texture or buffer onto another of equal format and size.
#[derive(Clone, Debug, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields)]
pub(super) struct Copy {
    /// Source; may be last frame's, `"history.previous"`.
    from: Reference,
    /// Destination.
    to: Reference,
}

impl PassKind for Copy {
    fn lower(&self, pass: &mut Lowering<'_>) {
        pass.step(Step::Copy {
            from: Operand::from(&self.from),
            to: Operand::from(&self.to),
        });
    }
}
