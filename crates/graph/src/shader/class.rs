//! Class of a resource global: a uniform, a storage buffer, a texture, a sampler, each with its
//! layout.

use crate::scalar_class::{ItemScalar, ShaderType};
use naga::{AddressSpace, Handle, ImageClass, TypeInner, proc::Layouter};

/// Type of a resource global of a shader, with the layout that a resource must have to be bound to
/// the global.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) enum Class {
    Uniform {
        size: u64,
        members: Vec<Member>,
        layout: String,
    },
    /// A storage buffer. `fixed`: number of bytes before the runtime-sized array, or of the whole
    /// type without such an array. `stride`: number of bytes from one item of the array to the
    /// next; `None` without such an array. `layout`: text that is equal for equal layouts.
    Storage {
        fixed: u64,
        stride: Option<u64>,
        read_only: bool,
        layout: String,
    },
    Texture(wgt::TextureViewDimension, TextureClass),
    Sampler {
        comparison: bool,
    },
    AccelerationStructure,
    Unsupported(&'static str),
}

/// Type of a texture global: sampled, or storage with its format and access.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) enum TextureClass {
    Sampled(SampledClass),
    Storage(String, wgt::StorageTextureAccess),
}

/// Type of a sampled texture global.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct SampledClass {
    pub scalar: ItemScalar,
    pub depth: bool,
    pub multisampled: bool,
}

/// A member of a uniform struct.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct Member {
    pub name: String,
    /// Offset in bytes of the member from the start of the struct.
    pub offset: u64,
    /// Type of the member; `None` for matrices, arrays and structs.
    pub vector: Option<ShaderType>,
}

/// Returns the type of a scalar or vector; `None` for other types.
pub(super) fn vector(module: &naga::Module, ty: Handle<naga::Type>) -> Option<ShaderType> {
    let (scalar, width) = match module.types[ty].inner {
        TypeInner::Scalar(scalar) | TypeInner::Atomic(scalar) => (scalar, 1),
        TypeInner::Vector { size, scalar } => (scalar, size as u32),
        _ => return None,
    };
    let class = ItemScalar::from_kind(scalar.kind)?;
    Some(ShaderType { class, width })
}

pub(super) fn class_of(
    module: &naga::Module,
    layouter: &Layouter,
    variable: &naga::GlobalVariable,
) -> Class {
    let inner = &module.types[variable.ty].inner;
    let size = u64::from(layouter[variable.ty].size);
    match variable.space {
        AddressSpace::Uniform => {
            let members = match inner {
                TypeInner::Struct { members, .. } => &members[..],
                _ => &[],
            };
            let members = members.iter().map(|member| Member {
                name: member.name.clone().unwrap_or_default(),
                offset: u64::from(member.offset),
                vector: vector(module, member.ty),
            });
            Class::Uniform {
                size,
                members: members.collect(),
                layout: layout(module, variable.ty),
            }
        }
        AddressSpace::Storage { access } => {
            let (fixed, stride) = storage_size(module, variable.ty, size);
            Class::Storage {
                fixed,
                stride,
                read_only: !access.contains(naga::StorageAccess::STORE),
                layout: layout(module, variable.ty),
            }
        }
        AddressSpace::Handle => match *inner {
            TypeInner::Image {
                dim,
                arrayed,
                class,
            } => image(dim, arrayed, class),
            TypeInner::Sampler { comparison } => Class::Sampler { comparison },
            TypeInner::AccelerationStructure { vertex_return } if vertex_return => {
                Class::Unsupported("an acceleration structure that returns vertices")
            }
            TypeInner::AccelerationStructure { .. } => Class::AccelerationStructure,
            TypeInner::BindingArray { .. } => Class::Unsupported("a binding array"),
            _ => Class::Unsupported("a global of this address space"),
        },
        _ => Class::Unsupported("a global of this address space"),
    }
}

fn image(dim: naga::ImageDimension, arrayed: bool, class: ImageClass) -> Class {
    let dimension = match (dim, arrayed) {
        (naga::ImageDimension::D2, false) => wgt::TextureViewDimension::D2,
        (naga::ImageDimension::D2, true) => wgt::TextureViewDimension::D2Array,
        (naga::ImageDimension::D3, _) => wgt::TextureViewDimension::D3,
        (naga::ImageDimension::Cube, false) => wgt::TextureViewDimension::Cube,
        (naga::ImageDimension::Cube, true) => wgt::TextureViewDimension::CubeArray,
        _ => return Class::Unsupported("a 1D texture"),
    };
    let sampled = |scalar, depth, multisampled| {
        TextureClass::Sampled(SampledClass {
            scalar,
            depth,
            multisampled,
        })
    };
    let class = match class {
        ImageClass::Sampled { kind, multi } => match ItemScalar::from_kind(kind) {
            Some(scalar) => sampled(scalar, false, multi),
            None => return Class::Unsupported("a texture of this scalar type"),
        },
        ImageClass::Depth { multi } => sampled(ItemScalar::F32, true, multi),
        ImageClass::Storage { format, access } => {
            let load = access.contains(naga::StorageAccess::LOAD);
            let store = access.contains(naga::StorageAccess::STORE);
            let access = match (load, store) {
                _ if access.contains(naga::StorageAccess::ATOMIC) => {
                    wgt::StorageTextureAccess::Atomic
                }
                (true, true) => wgt::StorageTextureAccess::ReadWrite,
                (true, false) => wgt::StorageTextureAccess::ReadOnly,
                _ => wgt::StorageTextureAccess::WriteOnly,
            };
            TextureClass::Storage(format!("{format:?}"), access)
        }
        _ => return Class::Unsupported("an external texture"),
    };
    Class::Texture(dimension, class)
}

/// Bytes before the runtime-sized array and its stride, or the whole size.
fn storage_size(module: &naga::Module, ty: Handle<naga::Type>, size: u64) -> (u64, Option<u64>) {
    let dynamic = |ty: Handle<naga::Type>| match module.types[ty].inner {
        TypeInner::Array {
            size: naga::ArraySize::Dynamic,
            stride,
            ..
        } => Some(u64::from(stride)),
        _ => None,
    };
    if let Some(stride) = dynamic(ty) {
        return (0, Some(stride));
    }
    let last = match &module.types[ty].inner {
        TypeInner::Struct { members, .. } => members.last(),
        _ => None,
    };
    let dynamic = last.and_then(|last| Some((last.offset, dynamic(last.ty)?)));
    dynamic.map_or((size, None), |(offset, stride)| {
        (u64::from(offset), Some(stride))
    })
}

/// A type's memory layout in words, equal for equal layouts:
/// `array<{0: vec3<f32>, 12: f32}, 16 bytes each>`. Names of members do not count, and two or four
/// scalars are the vector of them: one shader may count atomics that another reads as one.
fn layout(module: &naga::Module, ty: Handle<naga::Type>) -> String {
    let mut text = String::new();
    write_layout(module, ty, &mut text, 0);
    text
}

/// The scalar of which a struct has two or four, one after the other, and nothing else.
fn only_scalar(module: &naga::Module, members: &[naga::StructMember]) -> Option<naga::Scalar> {
    let scalar = |member: &naga::StructMember| match module.types[member.ty].inner {
        TypeInner::Scalar(scalar) | TypeInner::Atomic(scalar) => Some(scalar),
        _ => None,
    };
    let first = scalar(members.first()?)?;
    let is_next = |(index, member): (usize, &naga::StructMember)| {
        member.offset as usize == index * usize::from(first.width) && scalar(member) == Some(first)
    };
    let is_vector = matches!(members.len(), 2 | 4) && members.iter().enumerate().all(is_next);
    is_vector.then_some(first)
}

fn write_layout(module: &naga::Module, ty: Handle<naga::Type>, text: &mut String, depth: usize) {
    // A struct of structs of structs … doubles with every level; all that are longer than this are
    // the same for our purpose.
    const LONGEST: usize = 4096;
    const DEEPEST: usize = 32;
    let scalar = |scalar: naga::Scalar| match scalar.kind {
        naga::ScalarKind::Float => format!("f{}", scalar.width * 8),
        naga::ScalarKind::Sint => format!("i{}", scalar.width * 8),
        _ => format!("u{}", scalar.width * 8),
    };
    if text.len() > LONGEST || depth > DEEPEST {
        text.push('…');
        return;
    }
    match &module.types[ty].inner {
        TypeInner::Scalar(kind) | TypeInner::Atomic(kind) => text.push_str(&scalar(*kind)),
        TypeInner::Vector { size, scalar: kind } => {
            text.push_str(&format!("vec{}<{}>", *size as u32, scalar(*kind)));
        }
        TypeInner::Matrix {
            columns,
            rows,
            scalar: kind,
        } => {
            let (columns, rows) = (*columns as u32, *rows as u32);
            text.push_str(&format!("mat{columns}x{rows}<{}>", scalar(*kind)));
        }
        TypeInner::Array { base, size, stride } => {
            text.push_str("array<");
            write_layout(module, *base, text, depth + 1);
            if let naga::ArraySize::Constant(count) = size {
                text.push_str(&format!(", {count}"));
            }
            text.push_str(&format!(", {stride} bytes each>"));
        }
        TypeInner::Struct { members, .. } => {
            if let Some(kind) = only_scalar(module, members) {
                text.push_str(&format!("vec{}<{}>", members.len(), scalar(kind)));
                return;
            }
            for (index, member) in members.iter().enumerate() {
                let open = if index == 0 { "{" } else { ", " };
                text.push_str(&format!("{open}{}: ", member.offset));
                write_layout(module, member.ty, text, depth + 1);
            }
            text.push('}');
        }
        other => text.push_str(&format!("{other:?}")),
    }
}
