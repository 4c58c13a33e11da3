//! Memory that an entry point takes of a device: shared memory of a workgroup, and the variables
//! and values of each thread. Sizes are sums in 64 bits; nothing is allocated.

use super::{compiled::Specialised, expand::Expanded};
use crate::source::{Located, Span};
use naga::valid::FunctionInfo;
use naga::{AddressSpace, Block, Function, Handle, Module, ShaderStage, Statement, TypeInner};
use std::collections::BTreeSet;

/// Size in bytes of several variables of a shader, and the largest of them.
#[derive(Clone, Debug, Default)]
pub(crate) struct Memory {
    /// Sum of the sizes in bytes of the variables.
    pub bytes: u64,
    largest: Option<(u64, Located<String>)>,
}

impl Memory {
    fn add(&mut self, bytes: u64, variable: impl FnOnce() -> Located<String>) {
        self.bytes = self.bytes.saturating_add(bytes);
        if self.largest.as_ref().is_none_or(|(most, _)| bytes > *most) {
            self.largest = Some((bytes, variable()));
        }
    }

    /// Returns the largest variable: its size in bytes, and its name with its place. Without a
    /// variable: 0, and an empty name with the place `otherwise`.
    pub fn largest(&self, otherwise: &Span) -> (u64, Located<String>) {
        let none = || (0, Located::new(String::new(), otherwise.clone()));
        self.largest.clone().unwrap_or_else(none)
    }
}

/// Memory that an entry point takes, including the functions that it calls.
#[derive(Clone, Debug, Default)]
pub(crate) struct Footprint {
    /// Memory of the workgroup variables, once per workgroup; each variable is rounded up to 16
    /// bytes, as WebGPU counts.
    pub workgroup: Memory,
    /// Memory of the `var<private>` variables, per thread.
    pub private: Memory,
    /// Names of the entry point and of the functions that it calls, each with the memory of its
    /// local variables, per thread.
    pub functions: Vec<(String, Memory)>,
    /// Memory of the largest array or struct that is a value of an expression, not a variable; its
    /// name is that of the function.
    pub value: Memory,
}

impl Footprint {
    pub(super) fn new(
        specialised: &Specialised<'_>,
        (stage, name): (ShaderStage, &str),
        source: &Expanded,
    ) -> Self {
        let mut footprint = Self::default();
        let module = &*specialised.module;
        let mut points = module.entry_points.iter();
        let point = points.position(|point| point.stage == stage && point.name == name);
        let Some((index, point)) = point.map(|index| (index, &module.entry_points[index])) else {
            return footprint;
        };
        let info = specialised.info.get_entry_point(index);
        footprint.globals(specialised, info, source);
        footprint.function(specialised, (&point.function, info), name, source);
        for handle in called(module, &point.function) {
            let function = &module.functions[handle];
            let name = function.name.as_deref().unwrap_or_default();
            let info = &specialised.info[handle];
            footprint.function(specialised, (function, info), name, source);
        }
        footprint
    }

    fn globals(&mut self, specialised: &Specialised<'_>, info: &FunctionInfo, source: &Expanded) {
        for (handle, variable) in specialised.module.global_variables.iter() {
            let bytes = bytes_of(specialised, &specialised.module.types[variable.ty].inner);
            let (memory, bytes) = match variable.space {
                _ if info[handle].is_empty() => continue,
                AddressSpace::WorkGroup => (&mut self.workgroup, bytes.next_multiple_of(16)),
                AddressSpace::Private => (&mut self.private, bytes),
                _ => continue,
            };
            let span = specialised.module.global_variables.get_span(handle);
            memory.add(bytes, || located(variable.name.as_deref(), span, source));
        }
    }

    fn function(
        &mut self,
        specialised: &Specialised<'_>,
        (function, info): (&Function, &FunctionInfo),
        name: &str,
        source: &Expanded,
    ) {
        let mut variables = Memory::default();
        for (handle, local) in function.local_variables.iter() {
            let bytes = bytes_of(specialised, &specialised.module.types[local.ty].inner);
            let span = function.local_variables.get_span(handle);
            variables.add(bytes, || located(local.name.as_deref(), span, source));
        }
        self.functions.push((name.to_owned(), variables));
        for (handle, _) in function.expressions.iter() {
            let ty = info[handle].ty.inner_with(&specialised.module.types);
            let is_large = matches!(ty, TypeInner::Array { .. } | TypeInner::Struct { .. });
            if !is_large || info[handle].ref_count == 0 {
                continue;
            }
            let bytes = bytes_of(specialised, ty);
            if bytes > self.value.bytes {
                let span = function.expressions.get_span(handle);
                self.value = Memory::default();
                self.value.add(bytes, || located(Some(name), span, source));
            }
        }
    }
}

/// Bytes of a type that validation has found to have a size.
fn bytes_of(specialised: &Specialised<'_>, ty: &TypeInner) -> u64 {
    u64::from(ty.size(specialised.module.to_ctx()))
}

fn located(name: Option<&str>, span: naga::Span, source: &Expanded) -> Located<String> {
    Located::new(name.unwrap_or_default().to_owned(), source.place(span))
}

/// Returns the functions that `first` calls, directly or not, each once.
pub(super) fn called(module: &Module, first: &Function) -> BTreeSet<Handle<Function>> {
    let mut functions = BTreeSet::new();
    let mut open: Vec<&Block> = vec![&first.body];
    while let Some(block) = open.pop() {
        for statement in block.iter() {
            match statement {
                Statement::Block(block) => open.push(block),
                Statement::If { accept, reject, .. } => open.extend([accept, reject]),
                Statement::Switch { cases, .. } => {
                    open.extend(cases.iter().map(|case| &case.body));
                }
                Statement::Loop {
                    body, continuing, ..
                } => open.extend([body, continuing]),
                Statement::Call { function, .. } if functions.insert(*function) => {
                    open.push(&module.functions[*function].body);
                }
                _ => {}
            }
        }
    }
    functions
}
