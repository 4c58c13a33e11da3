//! Where the content of an output or capture comes from, so that somebody who looks at it knows how to read it.

use super::{Access, BindTarget, LinkedStep, Plan, ResourceId, ResourceKind};
use naga::{Handle, ScalarKind, TypeInner};
use std::collections::BTreeSet;

/// One scalar of a buffer's items.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Field {
    /// As WGSL spells it, from the item on: `origin.x`, `indices[2]`; empty if the item is a single scalar.
    pub name: String,
    /// Bytes from the begin of the item.
    pub offset: usize,
    /// What it is.
    pub scalar: Scalar,
}

/// A scalar of 32 bits.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Scalar {
    /// `f32`.
    F32,
    /// `i32`.
    I32,
    /// `u32`.
    U32,
}

/// The items of a buffer, as a shader that binds it declares them.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Item {
    /// Bytes from one item to the next.
    pub stride: usize,
    /// Its scalars; bytes between them are padding.
    pub fields: Vec<Field>,
}

/// An item with more scalars than this is no row of a table.
const MOST_FIELDS: usize = 64;

impl Plan {
    /// The provided resources that are bound by the passes that write an output or capture: depths that are written with a
    /// `camera` bound are that camera's.
    pub fn provided_behind(&self, output: &str) -> BTreeSet<&str> {
        let Some(origin) = self.origin(output) else {
            return BTreeSet::new();
        };
        let passes = self.schedule.iter().map(|&pass| &self.passes[pass]);
        let writers = passes.filter(|pass| {
            let writes = |access: &Access| access.writes && access.resource == origin;
            pass.accesses.iter().any(writes)
        });
        writers
            .flat_map(|pass| &pass.accesses)
            .map(|access| &self.resources[access.resource.0])
            .filter(|resource| matches!(resource.kind, ResourceKind::Provided(_)))
            .map(|resource| resource.name.as_str())
            .collect()
    }

    /// The items of an output or capture that is a buffer; `None` if it is none, or no live pass binds it as an array of
    /// plain items or as a single one.
    pub fn item(&self, output: &str) -> Option<Item> {
        let origin = self.origin(output)?;
        let passes = self.schedule.iter().map(|&pass| &self.passes[pass]);
        let programs = passes
            .flat_map(|pass| &pass.steps)
            .filter_map(|step| match step {
                LinkedStep::Draw(draw) => Some(&draw.program),
                LinkedStep::Dispatch { program, .. } => Some(program),
                _ => None,
            });
        let mut seen = programs.flat_map(|program| {
            let bindings = program.bindings.iter();
            bindings.map(move |binding| (&program.shader.module, binding))
        });
        let (module, binding) = seen.find(
            |(_, binding)| matches!(binding.target, BindTarget::Buffer(id) if id == origin),
        )?;
        let place = naga::ResourceBinding {
            group: binding.group,
            binding: binding.binding,
        };
        let mut globals = module.global_variables.iter();
        let (_, global) = globals.find(|(_, global)| global.binding == Some(place))?;
        item(module, global.ty)
    }

    /// The resource that an output or capture is a copy of, or is itself.
    fn origin(&self, output: &str) -> Option<ResourceId> {
        let (_, target) = self.readable.iter().find(|(name, _)| name == output)?;
        let mut origin = target.id;
        let mut steps: Vec<&LinkedStep> = self
            .schedule
            .iter()
            .flat_map(|&pass| &self.passes[pass].steps)
            .collect();
        // The last copy onto it counts; what that one reads was copied before.
        while let Some(step) = steps.pop() {
            origin = match step {
                LinkedStep::CopyTexture { from, to } if to.id == origin => from.id,
                LinkedStep::CopyBuffer { from, to } if *to == origin => *from,
                _ => origin,
            };
        }
        Some(origin)
    }
}

fn item(module: &naga::Module, ty: Handle<naga::Type>) -> Option<Item> {
    let inner = &module.types[ty].inner;
    let (of, stride) = match inner {
        TypeInner::Array { base, stride, .. } => (*base, *stride),
        _ => (ty, inner.size(module.to_ctx())),
    };
    let mut fields = Vec::new();
    flatten(module, of, String::new(), 0, &mut fields)?;
    Some(Item {
        stride: stride as usize,
        fields,
    })
}

/// Adds the scalars of a type; `None` if it has one that is no 32-bit number, or too many.
fn flatten(
    module: &naga::Module,
    ty: Handle<naga::Type>,
    name: String,
    offset: usize,
    fields: &mut Vec<Field>,
) -> Option<()> {
    let mut push = |name: String, offset, scalar: naga::Scalar| {
        let scalar = match (scalar.kind, scalar.width) {
            (ScalarKind::Float, 4) => Scalar::F32,
            (ScalarKind::Sint, 4) => Scalar::I32,
            (ScalarKind::Uint, 4) => Scalar::U32,
            _ => return None,
        };
        fields.push(Field {
            name,
            offset,
            scalar,
        });
        (fields.len() <= MOST_FIELDS).then_some(())
    };
    let dot = if name.is_empty() { "" } else { "." };
    match &module.types[ty].inner {
        TypeInner::Scalar(scalar) | TypeInner::Atomic(scalar) => push(name, offset, *scalar),
        TypeInner::Vector { size, scalar } => ["x", "y", "z", "w"]
            .iter()
            .take(*size as usize)
            .enumerate()
            .try_for_each(|(index, axis)| {
                let place = offset + index * usize::from(scalar.width);
                push(format!("{name}{dot}{axis}"), place, *scalar)
            }),
        TypeInner::Array {
            base,
            size: naga::ArraySize::Constant(count),
            stride,
        } => (0..count.get() as usize).try_for_each(|index| {
            let place = offset + index * *stride as usize;
            flatten(module, *base, format!("{name}[{index}]"), place, fields)
        }),
        TypeInner::Struct { members, .. } => members.iter().try_for_each(|member| {
            let of = member.name.as_deref().unwrap_or("_");
            let place = offset + member.offset as usize;
            flatten(module, member.ty, format!("{name}{dot}{of}"), place, fields)
        }),
        _ => None,
    }
}
