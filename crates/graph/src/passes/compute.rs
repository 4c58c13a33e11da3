//! `Compute`: one dispatch over a material, of a fixed size, or with its size in a buffer.

use crate::{
    document::located::Located,
    registry::{Lowering, PassKind},
    step::{Dispatch, Groups, Step},
};
use serde::Deserialize;

/// Body of a `Compute` pass.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Compute {
    dispatch: Size,
    #[serde(default)]
    entry: Option<Located<String>>,
}

#[derive(Clone, Debug, Deserialize)]
#[serde(rename = "dispatch")]
enum Size {
    Over(Located<String>),
    Groups(u32, u32, u32),
    Indirect(Located<String>),
}

impl PassKind for Compute {
    fn lower(&self, pass: &mut Lowering<'_>) {
        let mut program = pass.program();
        program.compute.clone_from(&self.entry);
        let groups = match &self.dispatch {
            Size::Over(resource) => Groups::Over(resource.clone()),
            Size::Groups(x, y, z) => Groups::Fixed([*x, *y, *z]),
            Size::Indirect(buffer) => Groups::Indirect(buffer.clone()),
        };
        pass.step(Step::Dispatch(Dispatch { program, groups }));
    }
}
