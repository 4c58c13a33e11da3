//! Sizes of dispatches, and arguments that stand in buffers.

use super::{
    linker::{Linker, access},
    pass::{LinkedPass, LinkedProgram, Usage},
};
use crate::{
    diagnostics::reports::ErrorGuaranteed,
    errors::link::LinkError,
    kinds::step::{Operand, Threads},
    resource::{ResourceKind, Target},
    source::span::Located,
};

/// Spreads a number of workgroups over two dimensions when one does not hold it:
/// `[min(n, most), ceil(n / most), 1]`.
fn fold(groups: u64, most: u32) -> [u64; 3] {
    let x = groups.min(u64::from(most));
    [x, groups.div_ceil(x.max(1)), 1]
}

impl Linker<'_, '_> {
    /// A buffer of indirect arguments of at least `bytes`.
    pub(super) fn indirect(
        &mut self,
        operand: &Operand,
        bytes: u64,
        pass: &mut LinkedPass,
    ) -> Result<Target, ErrorGuaranteed> {
        let (target, name) = self.operand(operand, &pass.name)?;
        let resource = self.symbols.get(target.id);
        if !matches!(resource.kind, ResourceKind::Buffer(_)) {
            let found = resource.kind.describe();
            return Err(self.report(LinkError::NoArguments { name, found }));
        }
        let id = self.symbols.base(target.id);
        self.layouts.at_least(id, &target.part, bytes, &name.span);
        let usage = Usage::Buffer(wgt::BufferUsages::INDIRECT);
        pass.accesses
            .push(access(&target, (true, false, false), usage, &name.span));
        Ok(target)
    }

    pub(super) fn workgroup_size(
        &mut self,
        program: &LinkedProgram,
        pass: &Located<String>,
    ) -> Result<[u32; 3], ErrorGuaranteed> {
        let entry = program.entries[0];
        let at = program.shader.entry_span(entry);
        let Some(size) = program.shader.workgroup_size(entry) else {
            return Err(self.report(LinkError::WorkgroupOverride {
                at,
                pass: pass.clone(),
            }));
        };
        let limits = &self.symbols.request.limits;
        let most = [
            limits.max_compute_workgroup_size_x,
            limits.max_compute_workgroup_size_y,
            limits.max_compute_workgroup_size_z,
        ];
        let threads = limits.max_compute_invocations_per_workgroup;
        let total: u64 = size.iter().map(|&edge| u64::from(edge)).product();
        if total > u64::from(threads) || size.iter().zip(most).any(|(edge, most)| *edge > most) {
            self.reports.unsupported(LinkError::WorkgroupSize {
                size,
                most,
                threads,
                at,
                pass: pass.clone(),
            })?;
        }
        Ok(size)
    }

    /// How many workgroups of a size are dispatched.
    pub(super) fn workgroups(
        &mut self,
        threads: &Threads,
        size: [u32; 3],
        pass: &Located<String>,
    ) -> Result<[u32; 3], ErrorGuaranteed> {
        let most = self
            .symbols
            .request
            .limits
            .max_compute_workgroups_per_dimension;
        let per_group: u64 = size.iter().map(|&edge| u64::from(edge)).product();
        let groups: [u64; 3] = match threads {
            Threads::Groups(groups) => groups.map(u64::from),
            Threads::Items(items) => fold(items.div_ceil(per_group.max(1)), most),
            Threads::Texels(texels) => {
                std::array::from_fn(|edge| texels[edge].div_ceil(u64::from(size[edge].max(1))))
            }
        };
        let narrow = groups.map(|edge| u32::try_from(edge).unwrap_or(u32::MAX));
        if narrow.iter().any(|&edge| edge > most) {
            self.reports.unsupported(LinkError::Workgroups {
                groups,
                most,
                pass: pass.clone(),
            })?;
        }
        Ok(narrow)
    }
}
