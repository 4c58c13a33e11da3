//! `Compute`: one dispatch of so many threads or workgroups, or with its size in a buffer.

use super::entry_name::EntryName;
use super::kind::{Lowering, PassKind};
use super::step::{Dispatch, Groups, Operand, Step, Threads};
use crate::language::{Expr, Reference};
use serde::Deserialize;

/// One dispatch of a compute shader.
#[derive(Clone, Debug, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields)]
pub(super) struct Compute {
    /// How many threads or workgroups.
    dispatch: Size,
    /// The entry point, where the shader has several.
    entry: Option<EntryName>,
}

/// How many threads or workgroups a dispatch has.
#[derive(Clone, Debug, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[cfg_attr(feature = "schema", schemars(rename = "Dispatch"))]
#[serde(rename = "dispatch")]
enum Size {
    /// A thread for each of so many items, or for each texel of a size.
    Over(Expr),
    /// So many workgroups.
    Groups(Expr, Expr, Expr),
    /// Three u32 in a buffer.
    Indirect(Reference),
}

impl PassKind for Compute {
    fn lower(&self, pass: &mut Lowering<'_>) {
        let mut program = pass.program();
        program.compute = self.entry.as_ref().and_then(|entry| entry.chosen(pass));
        let groups = match &self.dispatch {
            Size::Over(threads) => Groups::Direct(over(threads, pass)),
            Size::Groups(x, y, z) => {
                Groups::Direct(Threads::Groups([x, y, z].map(|edge| pass.count32(edge))))
            }
            Size::Indirect(buffer) => Groups::Indirect(Operand::from(buffer)),
        };
        pass.step(Step::Dispatch(Dispatch { program, groups }));
    }
}

/// A thread for each of a number of items, or for each texel of a size.
fn over(threads: &Expr, pass: &mut Lowering<'_>) -> Threads {
    let list = pass.list(threads);
    let edges: Option<Vec<u64>> = list.iter().map(|edge| edge.whole()).collect();
    match edges.as_deref() {
        Some([items]) => Threads::Items(*items),
        Some([width, height]) => Threads::Texels([*width, *height, 1]),
        Some([width, height, depth]) => Threads::Texels([*width, *height, *depth]),
        Some([]) => Threads::Items(1),
        _ => {
            let what = "a dispatch is over a number of items or over a size, in whole numbers";
            pass.report_value(crate::diagnostics::code::Code::Expression, threads, what);
            Threads::Items(1)
        }
    }
}
