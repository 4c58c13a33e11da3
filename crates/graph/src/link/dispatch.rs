//! Sizes of dispatches, and arguments that stand in buffers.

use super::{
    layouts::Layouts,
    pass::{Ids, LinkedPass, LinkedProgram, Usage},
    programs,
    scope::PassScope,
};
use crate::{
    diagnostics::reports::{ErrorGuaranteed, Reports},
    errors::link::LinkError,
    kinds::step::{Dispatch, Groups, Names, Operand, Threads},
    resource::{ResourceKind, Target},
    source::span::Located,
};
use naga::ShaderStage;

/// Spreads a number of workgroups over two dimensions when one does not hold it:
/// `[min(n, most), ceil(n / most), 1]`.
fn fold(groups: u64, most: u32) -> [u64; 3] {
    let x = groups.min(u64::from(most));
    [x, groups.div_ceil(x.max(1)), 1]
}

pub(super) fn link(
    dispatch: &Dispatch<Names>,
    pass: &mut LinkedPass,
    scope: &mut PassScope<'_>,
    layouts: &mut Layouts,
    reports: &mut Reports,
) -> Result<Dispatch<Ids>, ErrorGuaranteed> {
    let stages = [ShaderStage::Compute];
    let program = programs::link(
        &dispatch.program,
        &stages,
        false,
        pass,
        scope,
        layouts,
        reports,
    )?;
    let limits = &scope.request().limits;
    let size = workgroup_size(&program, &pass.name, limits, reports)?;
    let groups = match &dispatch.groups {
        Groups::Direct(threads) => {
            Groups::Direct(workgroups(threads, size, &pass.name, limits, reports)?)
        }
        Groups::Indirect(buffer) => {
            Groups::Indirect(indirect(buffer, 12, pass, scope, layouts, reports)?)
        }
    };
    Ok(Dispatch { program, groups })
}

/// A buffer of indirect arguments of at least `bytes`.
pub(super) fn indirect(
    operand: &Operand,
    bytes: u64,
    pass: &mut LinkedPass,
    scope: &mut PassScope<'_>,
    layouts: &mut Layouts,
    reports: &mut Reports,
) -> Result<Target, ErrorGuaranteed> {
    let (target, name) = scope.operand(operand, &pass.name, reports)?;
    let resource = scope.get(target.id);
    if !matches!(resource.kind, ResourceKind::Buffer(_)) {
        let found = resource.kind.describe();
        return Err(reports.report(LinkError::NoArguments { name, found }));
    }
    let id = scope.symbols().base(target.id);
    layouts.at_least(id, &target.part, bytes, &name.span);
    let usage = Usage::Buffer(wgt::BufferUsages::INDIRECT);
    pass.access(&target, (true, false, false), usage, &name.span);
    Ok(target)
}

fn workgroup_size(
    program: &LinkedProgram,
    pass: &Located<String>,
    limits: &wgt::Limits,
    reports: &mut Reports,
) -> Result<[u32; 3], ErrorGuaranteed> {
    let entry = program.entries[0];
    let at = program.shader.entry_span(entry);
    let Some(size) = program.shader.workgroup_size(entry) else {
        return Err(reports.report(LinkError::WorkgroupOverride {
            at,
            pass: pass.clone(),
        }));
    };
    let most = [
        limits.max_compute_workgroup_size_x,
        limits.max_compute_workgroup_size_y,
        limits.max_compute_workgroup_size_z,
    ];
    let threads = limits.max_compute_invocations_per_workgroup;
    let total: u64 = size.iter().map(|&edge| u64::from(edge)).product();
    if total > u64::from(threads) || size.iter().zip(most).any(|(edge, most)| *edge > most) {
        reports.unsupported(LinkError::WorkgroupSize {
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
fn workgroups(
    threads: &Threads,
    size: [u32; 3],
    pass: &Located<String>,
    limits: &wgt::Limits,
    reports: &mut Reports,
) -> Result<[u32; 3], ErrorGuaranteed> {
    let most = limits.max_compute_workgroups_per_dimension;
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
        reports.unsupported(LinkError::Workgroups {
            groups,
            most,
            pass: pass.clone(),
        })?;
    }
    Ok(narrow)
}
