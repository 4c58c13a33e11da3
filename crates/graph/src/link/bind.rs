//! Which resource a shader's global is, and whether it can be.

use super::{
    Access, LinkedPass, Linker, Usage,
    bindings::{BindTarget, Block, LinkedBinding, LinkedProgram},
};
use crate::{
    diagnostics::{Code, Diagnostic},
    document::{
        located::Located,
        materials::{Filter, SamplerEntry},
    },
    resolve::{Part, Resource, ResourceKind, Target},
    step::Program,
    wgsl::{Class, Global, Member, TextureClass},
};
use naga::ShaderStage;
use std::num::NonZeroU64;

/// A global and the resource that it was found to be.
struct Found<'a> {
    global: &'a Global,
    target: &'a Target,
    resource: &'a Resource,
}

/// What is bound, as what, and what its resource must allow for that.
type Binding = (BindTarget, wgpu::BindingType, Usage);

impl Linker<'_, '_> {
    pub(super) fn bind(
        &mut self,
        global: &Global,
        program: &Program,
        linked: &LinkedProgram,
        pass: &mut LinkedPass,
    ) -> Option<LinkedBinding> {
        let mut bound = program.bind.iter();
        let bound = bound.find(|(name, _)| name.value == global.name);
        let (target, ty) = match (&global.class, bound) {
            (Class::Unsupported(what), _) => {
                self.report(
                    Diagnostic::error(
                        Code::Binding,
                        format!("`{}` is {what}, which a graph cannot bind", global.name),
                    )
                    .at(global.span.clone(), ""),
                );
                return None;
            }
            (Class::Uniform { size, members }, None) if global.name == "params" => {
                let block = self.params_uniform(global, *size, members)?;
                (BindTarget::Params(block), uniform(*size))
            }
            (_, bound) => {
                let target = self.target(global, bound.map(|(_, name)| name), pass)?;
                let resource = self.resources.get(target.id).clone();
                let found = Found {
                    global,
                    target: &target,
                    resource: &resource,
                };
                let (bound, ty, usage) = self.binding(&found, linked, program)?;
                if global.writes {
                    self.writable(&target, &resource.name, &global.span);
                }
                pass.accesses.push(Access {
                    resource: target.id,
                    part: if matches!(resource.kind, ResourceKind::Texture(_)) {
                        target.part
                    } else {
                        Part::ONE
                    },
                    reads: global.reads,
                    writes: global.writes,
                    covers: false,
                    usage,
                    span: global.span.clone(),
                    step: 0,
                });
                (bound, ty)
            }
        };
        Some(LinkedBinding {
            group: global.group,
            binding: global.binding,
            target,
            ty,
            visibility: visibility(&linked.stages),
        })
    }

    /// The pass's params as the shader's struct wants them.
    fn params_uniform(&mut self, global: &Global, size: u64, members: &[Member]) -> Option<Block> {
        let what = if members.is_empty() {
            "is no struct"
        } else if size > self.limits.max_uniform_buffer_binding_size {
            "is too large for the adapter"
        } else {
            return self.params_block(global, size, members).map(Block);
        };
        self.report(
            Diagnostic::error(Code::Binding, format!("the uniform `params` {what}"))
                .at(global.span.clone(), format!("{size} bytes"))
                .help("write `struct Params { … }` with the params that the shader reads, and `var<uniform> params: Params;`"),
        );
        None
    }

    /// What a global stands for: what the pass binds to it, else what is called so.
    fn target(
        &mut self,
        global: &Global,
        bound: Option<&Located<String>>,
        pass: &LinkedPass,
    ) -> Option<Target> {
        if let Some(name) = bound {
            return self.expect(name);
        }
        let name = self.global(&global.name);
        if self.resources.is_broken(name) {
            return None;
        }
        let Some(target) = self.resources.find_spelt(name) else {
            self.unknown(global, pass);
            return None;
        };
        self.ambiguous(global, &target, pass);
        Some(target)
    }

    fn binding(
        &mut self,
        found: &Found<'_>,
        linked: &LinkedProgram,
        program: &Program,
    ) -> Option<Binding> {
        let Found {
            global,
            target,
            resource,
        } = *found;
        let needed = match (&global.class, &resource.kind) {
            (Class::Uniform { size, .. }, ResourceKind::Provided(provided)) if provided.uniform => {
                return self.uniform_buffer(found, *size, provided.stride);
            }
            (Class::Storage { .. }, ResourceKind::Provided(provided)) if provided.uniform => {
                "a storage buffer"
            }
            (
                Class::Storage {
                    fixed,
                    stride,
                    read_only,
                    ..
                },
                ResourceKind::Buffer(_) | ResourceKind::Provided(_),
            ) => return self.storage_buffer(found, fixed + stride.unwrap_or(0), *read_only),
            (Class::Texture(class), ResourceKind::Texture(texture)) => {
                let of = (texture.format, &target.part);
                let (ty, usage) = self.texture(global, class, of, (linked, program), resource)?;
                let (TextureClass::Sampled { dimension, .. }
                | TextureClass::Storage { dimension, .. }) = *class;
                let bound = BindTarget::Texture {
                    target: target.clone(),
                    dimension,
                };
                return Some((bound, ty, Usage::Texture(usage)));
            }
            (Class::Sampler { comparison }, ResourceKind::Sampler(sampler)) => {
                match sampler_type(*comparison, sampler) {
                    Ok(ty) => {
                        let ty = wgpu::BindingType::Sampler(ty);
                        return Some((BindTarget::Sampler(target.id), ty, Usage::None));
                    }
                    Err(needed) => needed,
                }
            }
            (Class::Uniform { .. }, _) => "a uniform buffer",
            (Class::Storage { .. }, _) => "a storage buffer",
            (Class::Texture(_), _) => "a texture",
            _ => "a sampler",
        };
        let is = resource.kind.describe();
        let mut error = Diagnostic::error(
            Code::ResourceKind,
            format!(
                "the shader's `{}` needs {needed}, but `{}` is {is}",
                global.name, resource.name
            ),
        )
        .at(global.span.clone(), format!("the shader declares {needed}"));
        if let Some(declared) = &resource.declared {
            error = error.at(declared.clone(), is);
        }
        self.report(error);
        None
    }

    /// A uniform of `size` bytes in the shader, `stride` where the host has it.
    fn uniform_buffer(&mut self, found: &Found<'_>, size: u64, stride: u64) -> Option<Binding> {
        if size > stride {
            let name = &found.resource.name;
            self.report(
                Diagnostic::error(
                    Code::LayoutMismatch,
                    format!("`{name}` has {stride} bytes, the shader's type {size}"),
                )
                .at(
                    found.global.span.clone(),
                    "import its type from the module that declares it",
                ),
            );
            return None;
        }
        Some((
            BindTarget::Buffer(found.target.id),
            uniform(size),
            Usage::Buffer(wgpu::BufferUsages::UNIFORM),
        ))
    }

    /// A storage buffer of which the shader needs `least` bytes.
    fn storage_buffer(
        &mut self,
        found: &Found<'_>,
        least: u64,
        read_only: bool,
    ) -> Option<Binding> {
        let (global, id) = (found.global, found.target.id);
        if matches!(found.resource.kind, ResourceKind::Provided(_)) && !read_only {
            self.report(
                Diagnostic::error(
                    Code::ResourceKind,
                    format!(
                        "`{}` belongs to the host and cannot be written",
                        found.resource.name
                    ),
                )
                .at(global.span.clone(), "declare it `var<storage, read>`"),
            );
            return None;
        }
        self.layouts.see(self.resources.base(id), global);
        Some((
            BindTarget::Buffer(id),
            wgpu::BindingType::Buffer {
                ty: wgpu::BufferBindingType::Storage { read_only },
                has_dynamic_offset: false,
                min_binding_size: NonZeroU64::new(least),
            },
            Usage::Buffer(wgpu::BufferUsages::STORAGE),
        ))
    }

    /// Reports a global that two resources spell alike (`a.b_c` and `a_b.c`); one that is named just so wins.
    fn ambiguous(&mut self, global: &Global, target: &Target, pass: &LinkedPass) {
        let name = &self.resources.get(target.id).name;
        let Some([a, b]) = self.resources.ambiguous(name) else {
            return;
        };
        if name.ends_with(&global.name) {
            return;
        }
        let error = Diagnostic::error(
            Code::Binding,
            format!("the shader's `{}` may be `{a}` or `{b}`", global.name),
        )
        .at(global.span.clone(), "both are spelt so in a shader")
        .at(pass.name.span.clone(), "bound by this pass")
        .help(format!(
            "say which: `bind: {{\"{}\": \"{a}\"}}`",
            global.name
        ));
        self.report(error);
    }

    fn unknown(&mut self, global: &Global, pass: &LinkedPass) {
        let known: Vec<String> = self
            .resources
            .known()
            .iter()
            .map(|name| name.replace('.', "_"))
            .collect();
        let mut error = Diagnostic::error(
            Code::UnknownResource,
            format!(
                "pass `{}` binds `{}`, but nothing is called so",
                *pass.name, global.name
            ),
        )
        .at(
            global.span.clone(),
            "no material or provided resource has this name",
        )
        .at(pass.name.span.clone(), "bound by this pass");
        error = error.suggest_to(self.diagnostics.len(), &global.name, || {
            known.iter().map(String::as_str)
        });
        let hint = error.help.take().unwrap_or_default();
        error = error.help(
            format!("{hint}\nor bind it: `bind: {{\"{}\": \"…\"}}`", global.name)
                .trim()
                .to_owned(),
        );
        self.report(error);
    }
}

/// How a sampler is bound, or what the shader needs instead.
fn sampler_type(
    comparison: bool,
    sampler: &SamplerEntry,
) -> Result<wgpu::SamplerBindingType, &'static str> {
    match (comparison, sampler.compare.is_some(), sampler.filter) {
        (true, true, _) => Ok(wgpu::SamplerBindingType::Comparison),
        (false, false, Filter::Linear) => Ok(wgpu::SamplerBindingType::Filtering),
        (false, false, Filter::Nearest) => Ok(wgpu::SamplerBindingType::NonFiltering),
        (true, false, _) => Err("a sampler with `compare`"),
        (false, true, _) => Err("a sampler without `compare`"),
    }
}

fn visibility(stages: &[ShaderStage]) -> wgpu::ShaderStages {
    let of = |stage: &ShaderStage| match stage {
        ShaderStage::Vertex => wgpu::ShaderStages::VERTEX,
        ShaderStage::Fragment => wgpu::ShaderStages::FRAGMENT,
        _ => wgpu::ShaderStages::COMPUTE,
    };
    stages.iter().map(of).collect()
}

fn uniform(size: u64) -> wgpu::BindingType {
    wgpu::BindingType::Buffer {
        ty: wgpu::BufferBindingType::Uniform,
        has_dynamic_offset: false,
        min_binding_size: NonZeroU64::new(size),
    }
}
