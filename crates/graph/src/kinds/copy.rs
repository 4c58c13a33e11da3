//! `Copy`: a texture or buffer (or last frame's version of one) onto another of equal format and
//! size.

use super::{
    kind::{Lowering, PassKind},
    step::{Operand, Step},
};
use crate::language::syntax::Reference;
use serde::Deserialize;

/// Body of a `Copy` pass.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct Copy {
    from: Reference,
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
