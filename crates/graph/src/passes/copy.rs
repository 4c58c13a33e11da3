//! `Copy`: a whole texture or buffer (or last frame's version of one) onto another of equal format and size.

use crate::{
    document::{located::Located, value::Reference},
    registry::{Lowering, PassKind},
    step::Step,
};
use serde::Deserialize;

/// Body of a `Copy` pass.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Copy {
    from: Reference,
    to: Located<String>,
}

impl PassKind for Copy {
    fn lower(&self, pass: &mut Lowering<'_>) {
        pass.step(Step::Copy {
            from: self.from.0.clone(),
            to: self.to.clone(),
        });
    }
}
