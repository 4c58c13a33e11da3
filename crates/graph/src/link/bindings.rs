//! Programs: their entry points, and the bindings that they need.

use super::{LinkedPass, Linker};
use crate::{
    diagnostics::{Code, Diagnostic},
    resolve::{ResourceId, Target},
    step::Program,
    wgsl::{Global, Shader},
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
