//! Sizes of dispatches, and arguments that stand in buffers.

use super::{Access, LinkedGroups, LinkedPass, LinkedProgram, Linker, Usage};
use crate::{
    diagnostics::{Code, Diagnostic},
    document::located::Located,
    resolve::{ResourceId, ResourceKind},
    step::Groups,
};

/// Spreads a number of workgroups over two dimensions when one does not hold it: `[min(n, most), ceil(n / most), 1]`.
fn fold(groups: u64, most: u32) -> [u32; 3] {
    let x = groups.min(u64::from(most)).max(1);
    let y = groups.div_ceil(x).max(1);
    [x as u32, u32::try_from(y).unwrap_or(u32::MAX), 1]
}

impl Linker<'_, '_> {
    /// A buffer of indirect arguments of at least `bytes`.
    pub(super) fn indirect(
        &mut self,
        name: &Located<String>,
        bytes: u64,
        pass: &mut LinkedPass,
    ) -> Option<ResourceId> {
        let target = self.expect(name)?;
        let resource = self.resources.get(target.id);
        if !matches!(resource.kind, ResourceKind::Buffer(_)) {
            let what = resource.kind.describe();
            self.report(
                Diagnostic::error(
                    Code::ResourceKind,
                    format!("`{}` cannot hold indirect arguments", name.value),
                )
                .at(
                    name.span.clone(),
                    format!("this is {what}, a buffer of the document is needed"),
                ),
            );
            return None;
        }
        self.layouts
            .at_least(self.resources.base(target.id), bytes, name.span.clone());
        pass.accesses.push(Access {
            resource: target.id,
            part: target.part,
            reads: true,
            writes: false,
            covers: false,
            usage: Usage::Buffer(wgpu::BufferUsages::INDIRECT),
            span: name.span.clone(),
            step: 0,
        });
        Some(target.id)
    }

    pub(super) fn workgroup_size(
        &mut self,
        program: &LinkedProgram,
        pass: &Located<String>,
    ) -> Option<[u32; 3]> {
        let entry = *program.entries.first()?;
        let Some(size) = program.shader.workgroup_size(entry) else {
            self.report(
                Diagnostic::error(
                    Code::Shader,
                    "a workgroup size that is an override is not supported",
                )
                .at(program.shader.entry_span(entry), "")
                .at(pass.span.clone(), "run by this pass")
                .help("write the size as a number or `const`"),
            );
            return None;
        };
        let limits = self.limits;
        let most = [
            limits.max_compute_workgroup_size_x,
            limits.max_compute_workgroup_size_y,
            limits.max_compute_workgroup_size_z,
        ];
        let total: u64 = size.iter().map(|&edge| u64::from(edge)).product();
        if total > u64::from(limits.max_compute_invocations_per_workgroup)
            || size.iter().zip(most).any(|(edge, most)| *edge > most)
        {
            self.report(
                Diagnostic::error(
                    Code::Limit,
                    format!(
                        "a workgroup of {}×{}×{} is more than the adapter can run",
                        size[0], size[1], size[2]
                    ),
                )
                .at(program.shader.entry_span(entry), "")
                .at(pass.span.clone(), "run by this pass")
                .help(format!(
                    "its limits are {}×{}×{} and {} invocations in all",
                    most[0], most[1], most[2], limits.max_compute_invocations_per_workgroup
                )),
            );
            return None;
        }
        Some(size)
    }

    pub(super) fn groups(
        &mut self,
        groups: &Groups,
        size: [u32; 3],
        pass: &mut LinkedPass,
    ) -> Option<LinkedGroups> {
        let most = self.limits.max_compute_workgroups_per_dimension;
        let groups = match groups {
            Groups::Indirect(name) => {
                return self.indirect(name, 12, pass).map(LinkedGroups::Indirect);
            }
            Groups::Fixed(groups) => *groups,
            Groups::Over(name) => {
                let target = self.expect(name)?;
                let items = match &self.resources.get(target.id).kind {
                    ResourceKind::Texture(texture) => {
                        let mip = target.part.mips.start;
                        let edge = |i: usize| (texture.size[i] >> mip).max(1).div_ceil(size[i]);
                        let layers = u32::try_from(target.part.layers.len()).unwrap_or(u32::MAX);
                        Ok([edge(0), edge(1), layers.div_ceil(size[2])])
                    }
                    ResourceKind::Buffer(buffer) => Err(buffer.count),
                    ResourceKind::Provided(provided) => Err(provided.items),
                    ResourceKind::Sampler(_) => Err(None),
                };
                match items {
                    Ok(groups) => groups,
                    Err(Some(items)) => {
                        let per_group: u64 = size.iter().map(|&edge| u64::from(edge)).product();
                        fold(items.div_ceil(per_group), most)
                    }
                    Err(None) => {
                        let what = self.resources.get(target.id).kind.describe();
                        self.report(
                            Diagnostic::error(Code::Size, format!("a dispatch over `{}` has no size", name.value))
                                .at(name.span.clone(), format!("this is {what} whose number of items is not known"))
                                .help("give the buffer a `count`, or dispatch `Groups(x, y, z)` or `Indirect(…)`"),
                        );
                        return None;
                    }
                }
            }
        };
        if groups.iter().any(|&edge| edge > most) {
            self.report(
                Diagnostic::error(
                    Code::Limit,
                    format!(
                        "{}×{}×{} workgroups are more than the adapter can run",
                        groups[0], groups[1], groups[2]
                    ),
                )
                .at(pass.name.span.clone(), "dispatched by this pass")
                .help(format!("its limit is {most} in each direction")),
            );
            return None;
        }
        Some(LinkedGroups::Fixed(groups))
    }
}
