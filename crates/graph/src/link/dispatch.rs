//! Sizes of dispatches, and arguments that stand in buffers.

use super::pass::{Ids, LinkedProgram, Usage};
use super::programs;
use super::scope::PassScope;
use crate::diagnostics::Reported;
use crate::errors::link::LinkError;
use crate::kinds::{Dispatch, Groups, Names, Operand, Threads};
use crate::resource::{ResourceKind, Target};
use naga::ShaderStage;

/// Spreads a number of workgroups over two dimensions when one does not hold it:
/// `[min(n, most), ceil(n / most), 1]`.
fn fold(groups: u64, most: u32) -> [u64; 3] {
    let x = groups.min(u64::from(most));
    [x, groups.div_ceil(x.max(1)), 1]
}

pub(super) fn link(
    dispatch: &Dispatch<Names>,
    scope: &mut PassScope<'_>,
) -> Reported<Dispatch<Ids>> {
    let stages = [ShaderStage::Compute];
    let program = programs::link(&dispatch.program, &stages, false, scope)?;
    let size = workgroup_size(&program, scope)?;
    let groups = match &dispatch.groups {
        Groups::Direct(threads) => Groups::Direct(workgroups(threads, size, scope)?),
        Groups::Indirect(buffer) => Groups::Indirect(indirect(buffer, 12, scope)?),
    };
    Ok(Dispatch { program, groups })
}

/// Resolves a buffer of indirect arguments, which must hold at least `bytes` bytes.
pub(super) fn indirect(
    operand: &Operand,
    bytes: u64,
    scope: &mut PassScope<'_>,
) -> Reported<Target> {
    let (target, name) = scope.operand(operand)?;
    let resource = scope.get(target.id);
    if !matches!(resource.kind, ResourceKind::Buffer(_)) {
        let kind = resource.kind.describe();
        return Err(scope.report(LinkError::NoArguments(name, kind)));
    }
    let id = scope.symbols.base(target.id);
    scope.layouts.at_least(id, &target.part, bytes, &name.span);
    let usage = Usage::Buffer(wgt::BufferUsages::INDIRECT);
    scope.access(&target, (true, false, false), usage, &name.span);
    Ok(target)
}

fn workgroup_size(program: &LinkedProgram, scope: &mut PassScope<'_>) -> Reported<[u32; 3]> {
    let entry = program.entries[0];
    let at = program.shader.entry_span(entry);
    let Some(size) = program.shader.workgroup_size(entry) else {
        return Err(scope.report(LinkError::WorkgroupOverride(at, scope.pass.clone())));
    };
    let limits = &scope.request().limits;
    let most = [
        limits.max_compute_workgroup_size_x,
        limits.max_compute_workgroup_size_y,
        limits.max_compute_workgroup_size_z,
    ];
    let threads = limits.max_compute_invocations_per_workgroup;
    let total: u64 = size.iter().map(|&edge| u64::from(edge)).product();
    if total > u64::from(threads) || size.iter().zip(most).any(|(edge, most)| *edge > most) {
        scope.unsupported(LinkError::WorkgroupSize {
            size,
            most,
            threads,
            at,
            pass: scope.pass.clone(),
        })?;
    }
    Ok(size)
}

/// Returns the numbers of workgroups to dispatch, for workgroups of this size.
fn workgroups(threads: &Threads, size: [u32; 3], scope: &mut PassScope<'_>) -> Reported<[u32; 3]> {
    let most = scope.request().limits.max_compute_workgroups_per_dimension;
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
        scope.unsupported(LinkError::Workgroups(groups, most, scope.pass.clone()))?;
    }
    Ok(narrow)
}
