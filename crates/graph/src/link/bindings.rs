//! Programs and their bindings: which resource each shader global is, and whether it can be.

use super::{Access, LinkedPass, Linker, Usage};
use crate::{
    diagnostics::{Code, Diagnostic},
    document::materials::Filter,
    resolve::{Part, ResourceId, ResourceKind, Target},
    step::Program,
    wgsl::{Class, Global, Shader, TextureClass},
};
use naga::ShaderStage;
use std::sync::Arc;

/// A shader with its entry points, constants and bindings.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct LinkedProgram {
    pub shader: Arc<Shader>,
    /// Entry points in stage order (vertex, fragment; or compute).
    pub entries: Vec<usize>,
    pub stages: Vec<ShaderStage>,
    pub constants: Vec<(String, f64)>,
    pub bindings: Vec<LinkedBinding>,
}

#[derive(Clone, Debug, PartialEq)]
pub(crate) struct LinkedBinding {
    pub group: u32,
    pub binding: u32,
    pub target: BindTarget,
    pub ty: wgpu::BindingType,
    pub visibility: wgpu::ShaderStages,
}

#[derive(Clone, Debug, PartialEq)]
pub(crate) enum BindTarget {
    Buffer(ResourceId),
    Texture {
        target: Target,
        dimension: wgpu::TextureViewDimension,
    },
    Sampler(ResourceId),
    /// The `params` uniform, already laid out.
    Params(Block),
}

/// The bytes of a `params` uniform. Two of one size are equal: other bytes are an upload, not another binding.
#[derive(Clone, Debug)]
pub(crate) struct Block(pub Vec<u8>);

impl PartialEq for Block {
    fn eq(&self, other: &Self) -> bool {
        self.0.len() == other.0.len()
    }
}

impl Linker<'_, '_> {
    pub(super) fn program(
        &mut self,
        program: &Program,
        stages: &[ShaderStage],
        depth_only: bool,
        pass: &mut LinkedPass,
    ) -> Option<LinkedProgram> {
        let shader = self.shader(program)?;
        let wanted = program
            .shader
            .as_ref()
            .map_or(&pass.name.span, |name| &name.span)
            .clone();
        let mut entries = Vec::new();
        for stage in stages {
            let name = match stage {
                ShaderStage::Vertex => &program.vertex,
                ShaderStage::Fragment => &program.fragment,
                _ => &program.compute,
            };
            match shader.entry(*stage, depth_only, name.as_ref(), &wanted) {
                Ok(entry) => entries.push(entry),
                Err(error) => self.report(error),
            }
        }
        if entries.len() != stages.len() {
            return None;
        }
        let globals = shader.globals(&entries);
        for (bound, _) in &program.bind {
            // A kind with several shaders hands its bindings to all of them, so only what no global could be is wrong.
            let exists = shader
                .module
                .global_variables
                .iter()
                .any(|(_, global)| global.name.as_deref() == Some(bound.as_str()));
            if !exists
                && program.shader.as_ref().is_some_and(|name| {
                    let own = self.scope.map_or(&pass.name.value, |scope| &scope.own_name);
                    name.span != pass.name.span || name.value == *own
                })
            {
                let names = || globals.iter().map(|global| global.name.as_str());
                self.report(
                    Diagnostic::error(
                        Code::Binding,
                        format!(
                            "`{}` has no global `{}` to bind",
                            shader.source.file.name, bound.value
                        ),
                    )
                    .at(bound.span.clone(), "")
                    .suggest_to(self.diagnostics.len(), bound, names),
                );
            }
        }
        self.groups_exist(&globals);
        let mut linked = LinkedProgram {
            constants: self.constants(program, &shader),
            bindings: Vec::new(),
            shader,
            entries,
            stages: stages.to_vec(),
        };
        let mut complete = true;
        for global in &globals {
            match self.bind(global, program, &linked, pass) {
                Some(binding) => linked.bindings.push(binding),
                None => complete = false,
            }
        }
        self.counts(&linked, pass);
        complete.then_some(linked)
    }

    /// Group numbers that the adapter does not have. (One number for two globals is found when the shader is validated.)
    fn groups_exist(&mut self, globals: &[Global]) {
        for global in globals
            .iter()
            .filter(|global| global.group >= self.limits.max_bind_groups)
        {
            self.report(
                Diagnostic::error(
                    Code::Limit,
                    format!(
                        "`{}` is in @group({}), which the adapter does not have",
                        global.name, global.group
                    ),
                )
                .at(
                    global.span.clone(),
                    format!(
                        "its groups are 0 to {}",
                        self.limits.max_bind_groups.saturating_sub(1)
                    ),
                )
                .help("leave the numbers out: the graph gives them"),
            );
        }
    }

    fn bind(
        &mut self,
        global: &Global,
        program: &Program,
        linked: &LinkedProgram,
        pass: &mut LinkedPass,
    ) -> Option<LinkedBinding> {
        let visibility = linked
            .stages
            .iter()
            .fold(wgpu::ShaderStages::empty(), |all, stage| {
                all | match stage {
                    ShaderStage::Vertex => wgpu::ShaderStages::VERTEX,
                    ShaderStage::Fragment => wgpu::ShaderStages::FRAGMENT,
                    _ => wgpu::ShaderStages::COMPUTE,
                }
            });
        let finish = |target, ty| {
            Some(LinkedBinding {
                group: global.group,
                binding: global.binding,
                target,
                ty,
                visibility,
            })
        };
        if let Class::Unsupported(what) = global.class {
            self.report(
                Diagnostic::error(
                    Code::Binding,
                    format!("`{}` is {what}, which a graph cannot bind", global.name),
                )
                .at(global.span.clone(), ""),
            );
            return None;
        }
        let bound = program
            .bind
            .iter()
            .find(|(name, _)| name.value == global.name)
            .map(|(_, target)| target.clone());
        if let (Class::Uniform { size, members }, None) = (&global.class, &bound)
            && global.name == "params"
        {
            let most = self.limits.max_uniform_buffer_binding_size;
            if *size > most || members.is_empty() {
                let what = if members.is_empty() {
                    "is no struct"
                } else {
                    "is too large for the adapter"
                };
                self.report(
                    Diagnostic::error(Code::Binding, format!("the uniform `params` {what}"))
                        .at(global.span.clone(), format!("{size} bytes"))
                        .help("write `struct Params { … }` with the params that the shader reads, and `var<uniform> params: Params;`"),
                );
                return None;
            }
            let block = self.params_block(global, *size, members)?;
            return finish(BindTarget::Params(Block(block)), uniform(*size));
        }
        let target = match &bound {
            Some(name) => self.expect(name)?,
            None if self.resources.is_broken(self.global(&global.name)) => return None,
            None => match self.resources.find_spelt(self.global(&global.name)) {
                Some(target) => target,
                None => {
                    self.unknown(global, pass);
                    return None;
                }
            },
        };
        let resource = self.resources.get(target.id).clone();
        if bound.is_none() {
            self.ambiguous(global, &resource.name, pass);
        }
        let wrong_kind = |this: &mut Self, needed: &str| {
            let mut error = Diagnostic::error(
                Code::ResourceKind,
                format!(
                    "the shader's `{}` needs {needed}, but `{}` is {}",
                    global.name,
                    resource.name,
                    resource.kind.describe()
                ),
            )
            .at(global.span.clone(), format!("the shader declares {needed}"));
            if let Some(declared) = &resource.declared {
                error = error.at(declared.clone(), resource.kind.describe());
            }
            this.report(error);
        };
        let (bind_target, ty, usage) = match (&global.class, &resource.kind) {
            (Class::Uniform { size, .. }, ResourceKind::Provided(provided)) if provided.uniform => {
                if *size > provided.stride {
                    self.report(
                        Diagnostic::error(
                            Code::LayoutMismatch,
                            format!(
                                "`{}` has {} bytes, the shader's type {size}",
                                resource.name, provided.stride
                            ),
                        )
                        .at(
                            global.span.clone(),
                            "import its type from the module that declares it",
                        ),
                    );
                    return None;
                }
                (
                    BindTarget::Buffer(target.id),
                    uniform(*size),
                    Usage::Buffer(wgpu::BufferUsages::UNIFORM),
                )
            }
            (
                Class::Storage {
                    fixed,
                    stride,
                    read_only,
                    ..
                },
                ResourceKind::Buffer(_) | ResourceKind::Provided(_),
            ) => {
                if matches!(&resource.kind, ResourceKind::Provided(provided) if provided.uniform) {
                    wrong_kind(self, "a storage buffer");
                    return None;
                }
                if matches!(resource.kind, ResourceKind::Provided(_)) && !read_only {
                    self.report(
                        Diagnostic::error(
                            Code::ResourceKind,
                            format!(
                                "`{}` belongs to the host and cannot be written",
                                resource.name
                            ),
                        )
                        .at(global.span.clone(), "declare it `var<storage, read>`"),
                    );
                    return None;
                }
                self.layouts.see(self.resources.base(target.id), global);
                let ty = wgpu::BindingType::Buffer {
                    ty: wgpu::BufferBindingType::Storage {
                        read_only: *read_only,
                    },
                    has_dynamic_offset: false,
                    min_binding_size: std::num::NonZeroU64::new(fixed + stride.unwrap_or(0)),
                };
                (
                    BindTarget::Buffer(target.id),
                    ty,
                    Usage::Buffer(wgpu::BufferUsages::STORAGE),
                )
            }
            (Class::Texture(class), ResourceKind::Texture(texture)) => {
                let (ty, usage) = self.texture(
                    global,
                    class,
                    (texture.format, &target.part),
                    (linked, program),
                    &resource,
                )?;
                let dimension = match class {
                    TextureClass::Sampled { dimension, .. }
                    | TextureClass::Storage { dimension, .. } => *dimension,
                };
                (
                    BindTarget::Texture {
                        target: target.clone(),
                        dimension,
                    },
                    ty,
                    Usage::Texture(usage),
                )
            }
            (Class::Sampler { comparison }, ResourceKind::Sampler(sampler)) => {
                let ty = match (*comparison, sampler.compare.is_some(), sampler.filter) {
                    (true, true, _) => wgpu::SamplerBindingType::Comparison,
                    (false, false, Filter::Linear) => wgpu::SamplerBindingType::Filtering,
                    (false, false, Filter::Nearest) => wgpu::SamplerBindingType::NonFiltering,
                    _ => {
                        wrong_kind(
                            self,
                            if *comparison {
                                "a sampler with `compare`"
                            } else {
                                "a sampler without `compare`"
                            },
                        );
                        return None;
                    }
                };
                (
                    BindTarget::Sampler(target.id),
                    wgpu::BindingType::Sampler(ty),
                    Usage::None,
                )
            }
            (Class::Uniform { .. }, _) => {
                wrong_kind(self, "a uniform buffer");
                return None;
            }
            (Class::Storage { .. }, _) => {
                wrong_kind(self, "a storage buffer");
                return None;
            }
            (Class::Texture(_), _) => {
                wrong_kind(self, "a texture");
                return None;
            }
            _ => {
                wrong_kind(self, "a sampler");
                return None;
            }
        };
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
        finish(bind_target, ty)
    }

    /// Reports a global that two resources spell alike (`a.b_c` and `a_b.c`); one that is named just so wins.
    fn ambiguous(&mut self, global: &Global, name: &str, pass: &LinkedPass) {
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

    /// The numbers of bindings that wgpu limits per stage.
    fn counts(&mut self, linked: &LinkedProgram, pass: &LinkedPass) {
        let count = |is: fn(&wgpu::BindingType) -> bool| {
            linked
                .bindings
                .iter()
                .filter(|binding| is(&binding.ty))
                .count()
        };
        let limits = self.limits;
        let checks: [(&str, usize, u32); 4] = [
            (
                "storage buffers",
                count(|ty| {
                    matches!(
                        ty,
                        wgpu::BindingType::Buffer {
                            ty: wgpu::BufferBindingType::Storage { .. },
                            ..
                        }
                    )
                }),
                limits.max_storage_buffers_per_shader_stage,
            ),
            (
                "textures",
                count(|ty| matches!(ty, wgpu::BindingType::Texture { .. })),
                limits.max_sampled_textures_per_shader_stage,
            ),
            (
                "storage textures",
                count(|ty| matches!(ty, wgpu::BindingType::StorageTexture { .. })),
                limits.max_storage_textures_per_shader_stage,
            ),
            (
                "samplers",
                count(|ty| matches!(ty, wgpu::BindingType::Sampler(_))),
                limits.max_samplers_per_shader_stage,
            ),
        ];
        for (what, number, most) in checks {
            if number > most as usize {
                self.report(
                    Diagnostic::error(Code::Limit, format!("pass `{}` binds {number} {what}", *pass.name))
                        .at(pass.name.span.clone(), "")
                        .help(format!("the adapter's limit is {most} per shader stage: split the pass or pack what it binds")),
                );
            }
        }
    }
}

fn uniform(size: u64) -> wgpu::BindingType {
    wgpu::BindingType::Buffer {
        ty: wgpu::BufferBindingType::Uniform,
        has_dynamic_offset: false,
        min_binding_size: std::num::NonZeroU64::new(size),
    }
}
