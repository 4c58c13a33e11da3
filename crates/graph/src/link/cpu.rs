//! Work of the CPU on the items of buffers.

use super::pass::{Ids, Usage};
use super::scope::PassScope;
use crate::diagnostics::Reported;
use crate::errors::link::LinkError;
use crate::kinds::{CpuCall, CpuItems, Names, Operand};
use crate::resource::{ResourceId, ResourceKind, Target};
use crate::source::{Located, Span};

pub(super) fn link(call: &CpuCall<Names>, scope: &mut PassScope<'_>) -> Reported<CpuCall<Ids>> {
    let source = Usage::Buffer(wgt::BufferUsages::COPY_SRC);
    let (count, span) = buffer(&call.count, scope)?;
    let base = scope.symbols.base(count.id);
    scope.layouts.at_least(base, &count.part, 4, &span);
    scope.access(&count, (true, false, false), source, &span);
    let mut reads = Vec::new();
    for read in &call.reads {
        let (read, span) = items(read, scope)?;
        scope.access(&read.buffer, (true, false, false), source, &span);
        reads.push(read);
    }
    let (writes, span) = items(&call.writes, scope)?;
    scope.writable(writes.buffer.id, &span)?;
    let resource = scope.get(writes.buffer.id);
    if matches!(resource.kind, ResourceKind::Provided(_)) {
        let name = resource.name.clone();
        return Err(scope.report(LinkError::WritesProvided(name, span)));
    }
    let usage = Usage::Buffer(wgt::BufferUsages::COPY_DST);
    // Items beyond `count` stay what they were.
    scope.access(&writes.buffer, (false, true, false), usage, &span);
    Ok(CpuCall {
        work: work(&call.work, scope)?,
        entry: call.entry.clone(),
        count,
        reads,
        writes,
    })
}

/// Resolves the provided resource that does the work.
fn work(name: &Located<String>, scope: &mut PassScope<'_>) -> Reported<ResourceId> {
    let target = scope.provided(name)?;
    match scope.get(target.id).kind {
        ResourceKind::CpuWork => {
            scope.access(&target, (true, false, false), Usage::None, &name.span);
            Ok(target.id)
        }
        ref other => {
            let kind = other.describe();
            Err(scope.report(LinkError::NoCpuWork(name.clone(), kind)))
        }
    }
}

fn buffer(operand: &Operand, scope: &mut PassScope<'_>) -> Reported<(Target, Span)> {
    let (target, name) = scope.operand(operand)?;
    match &scope.get(target.id).kind {
        ResourceKind::Buffer(_) | ResourceKind::Provided(_) => Ok((target, name.span)),
        other => {
            let kind = other.describe();
            Err(scope.report(LinkError::CpuItems(name, kind)))
        }
    }
}

fn items(items: &CpuItems<Names>, scope: &mut PassScope<'_>) -> Reported<(CpuItems<Ids>, Span)> {
    let (buffer, span) = buffer(&items.buffer, scope)?;
    let base = scope.symbols.base(buffer.id);
    scope.layouts.hand(base, items.bytes, &span);
    let bytes = items.bytes;
    Ok((CpuItems { buffer, bytes }, span))
}
