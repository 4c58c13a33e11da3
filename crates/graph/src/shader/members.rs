//! Finds the members of a uniform that an entry point reads.

use super::{footprint::called, reflect::Shader};
use naga::{Expression, Function, GlobalVariable, Handle, TypeInner};

/// True if an entry point, or a function that it calls, reads a member of the uniform `global` that
/// begins in its first `bytes` bytes, or reads the whole uniform at once. `entry` is the entry
/// point's index in the module.
pub(crate) fn reads_below(
    shader: &Shader,
    entry: usize,
    global: Handle<GlobalVariable>,
    bytes: u32,
) -> bool {
    let first = &shader.module.entry_points[entry].function;
    let called = called(&shader.module, first).into_iter();
    let called = called.map(|handle| &shader.module.functions[handle]);
    let begins_below = |member: u32| {
        let global = &shader.module.global_variables[global];
        match &shader.module.types[global.ty].inner {
            TypeInner::Struct { members, .. } => members
                .get(member as usize)
                .is_none_or(|member| member.offset < bytes),
            _ => true,
        }
    };
    let mut called = called.chain([first]);
    called.any(|function| reads(function, global, begins_below))
}

/// True if a function reads a global: one of the members, or all of it.
fn reads(
    function: &Function,
    global: Handle<GlobalVariable>,
    member: impl Fn(u32) -> bool,
) -> bool {
    let is_global = |handle: Handle<Expression>| match function.expressions[handle] {
        Expression::GlobalVariable(variable) => variable == global,
        _ => false,
    };
    let mut expressions = function.expressions.iter();
    expressions.any(|(_, expression)| match *expression {
        Expression::AccessIndex { base, index } => is_global(base) && member(index),
        Expression::Load { pointer } => is_global(pointer),
        Expression::Access { base, .. } => is_global(base),
        _ => false,
    })
}
