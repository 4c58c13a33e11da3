//! `Clear`: a whole texture to a value, or a whole buffer to zero.

use crate::{
    document::located::Located,
    registry::{Lowering, PassKind},
    step::Step,
};
use serde::Deserialize;

/// Body of a `Clear` pass.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Clear {
    target: Located<String>,
    #[serde(default)]
    value: [f64; 4],
}

impl PassKind for Clear {
    fn lower(&self, pass: &mut Lowering<'_>) {
        pass.step(Step::Clear {
            target: self.target.clone(),
            value: self.value,
        });
    }
}
