//! Values that pass from one shader stage to the next: their locations, types and interpolation,
//! and the share of the device's limit that built-in values take.

use super::class::vector;
use crate::scalar_class::ItemScalar;
use naga::{Binding, BuiltIn, Handle, Module, Type, TypeInner};

/// A scalar or vector that passes from one shader stage to the next at a `@location`.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct Varying {
    pub location: u32,
    pub scalar: ItemScalar,
    /// Number of components, from 1 to 4; 1 for a scalar.
    pub width: u32,
    pub interpolation: Option<naga::Interpolation>,
    pub sampling: Option<naga::Sampling>,
}

/// Values that an entry point takes from the stage before, or gives to the next one.
#[derive(Clone, Debug, Default)]
pub(crate) struct Varyings {
    /// Values with a `@location`, in the order of their declaration.
    pub locations: Vec<Varying>,
    /// Number of inter-stage variables that the entry point's built-in values count for in the
    /// device's limit.
    pub builtins: u32,
}

impl Varyings {
    /// Returns the values that an entry point takes as arguments. `entry` is its index in the
    /// module.
    pub fn inputs(module: &Module, entry: usize) -> Self {
        let mut inputs = Self::default();
        for argument in &module.entry_points[entry].function.arguments {
            inputs.add(module, argument.binding.as_ref(), argument.ty);
        }
        inputs
    }

    /// Returns the values that an entry point gives as its result. `entry` is its index in the
    /// module.
    pub fn outputs(module: &Module, entry: usize) -> Self {
        let mut outputs = Self::default();
        if let Some(result) = &module.entry_points[entry].function.result {
            outputs.add(module, result.binding.as_ref(), result.ty);
        }
        outputs
    }

    fn add(&mut self, module: &Module, binding: Option<&Binding>, ty: Handle<Type>) {
        match (binding, &module.types[ty].inner) {
            (None, TypeInner::Struct { members, .. }) => {
                for member in members {
                    self.add(module, member.binding.as_ref(), member.ty);
                }
            }
            (
                Some(&Binding::Location {
                    location,
                    interpolation,
                    sampling,
                    ..
                }),
                _,
            ) => {
                let vector = vector(module, ty);
                self.locations.extend(vector.map(|ty| Varying {
                    location,
                    scalar: ty.class,
                    width: ty.width,
                    interpolation,
                    sampling,
                }));
            }
            (Some(Binding::BuiltIn(builtin)), inner) => {
                self.builtins += variables(*builtin, inner);
            }
            (None, _) => {}
        }
    }
}

/// How many variables between stages a built-in value counts for.
fn variables(builtin: BuiltIn, ty: &TypeInner) -> u32 {
    match builtin {
        BuiltIn::ClipDistances => match ty {
            TypeInner::Array {
                size: naga::ArraySize::Constant(count),
                ..
            } => count.get().div_ceil(4),
            _ => 0,
        },
        BuiltIn::FrontFacing
        | BuiltIn::SampleIndex
        | BuiltIn::SampleMask
        | BuiltIn::PrimitiveIndex
        | BuiltIn::SubgroupInvocationId
        | BuiltIn::SubgroupSize
        | BuiltIn::ViewIndex
        | BuiltIn::PointCoord => 1,
        BuiltIn::Barycentric { .. } => 3,
        _ => 0,
    }
}
