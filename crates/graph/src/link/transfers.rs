//! Copies and clears of whole textures and buffers.

use super::{Access, LinkedPass, LinkedStep, Linker, Usage};
use crate::{
    diagnostics::{Code, Diagnostic},
    document::located::Located,
    resolve::{Part, ResourceKind, Target, Texture},
};

impl Linker<'_, '_> {
    pub(super) fn copy(
        &mut self,
        from: &Located<String>,
        to: &Located<String>,
        pass: &mut LinkedPass,
    ) -> Option<LinkedStep> {
        let (source, target) = (self.expect(from)?, self.expect(to)?);
        self.writable(&target, to, &to.span);
        let mismatch = |what: String| {
            Diagnostic::error(
                Code::FormatMismatch,
                format!("`{}` cannot be copied onto `{}`", from.value, to.value),
            )
            .at(from.span.clone(), "")
            .at(to.span.clone(), what)
        };
        let resources = (
            self.resources.get(source.id).clone(),
            self.resources.get(target.id).clone(),
        );
        let (usages, step) = match (&resources.0.kind, &resources.1.kind) {
            (ResourceKind::Texture(a), ResourceKind::Texture(b)) => {
                let size = |texture: &Texture, part: &Part| {
                    let [width, height] = texture.size.map(|edge| (edge >> part.mips.start).max(1));
                    (width, height, part.layers.len(), part.mips.len())
                };
                if a.format != b.format {
                    self.report(mismatch(format!("{:?} is not {:?}", b.format, a.format)));
                    return None;
                }
                let (from_size, to_size) = (size(a, &source.part), size(b, &target.part));
                if from_size != to_size {
                    let words = |(width, height, layers, mips)| match (layers, mips) {
                        (1, 1) => format!("{width}×{height} texels"),
                        _ => format!("{width}×{height} texels, layers: {layers}, mips: {mips}"),
                    };
                    self.report(mismatch(words(to_size)).help(format!(
                        "it must be as large as `{}`: {}",
                        from.value,
                        words(from_size)
                    )));
                    return None;
                }
                let usage = (
                    Usage::Texture(wgpu::TextureUsages::COPY_SRC),
                    Usage::Texture(wgpu::TextureUsages::COPY_DST),
                );
                (
                    usage,
                    LinkedStep::CopyTexture {
                        from: source.clone(),
                        to: target.clone(),
                    },
                )
            }
            (ResourceKind::Buffer(_) | ResourceKind::Provided(_), ResourceKind::Buffer(_)) => {
                let sized = self.resources.base(source.id);
                self.layouts.same((sized, from), (target.id, to));
                let usage = (
                    Usage::Buffer(wgpu::BufferUsages::COPY_SRC),
                    Usage::Buffer(wgpu::BufferUsages::COPY_DST),
                );
                (
                    usage,
                    LinkedStep::CopyBuffer {
                        from: source.id,
                        to: target.id,
                    },
                )
            }
            (a, b) => {
                let error = Diagnostic::error(
                    Code::ResourceKind,
                    format!("`{}` cannot be copied onto `{}`", from.value, to.value),
                )
                .at(from.span.clone(), a.describe())
                .at(to.span.clone(), b.describe());
                self.report(error);
                return None;
            }
        };
        let access = |target: &Target, name: &Located<String>, writes: bool, usage| Access {
            resource: target.id,
            part: target.part.clone(),
            reads: !writes,
            writes,
            covers: writes,
            usage,
            span: name.span.clone(),
            step: 0,
        };
        pass.accesses.push(access(&source, from, false, usages.0));
        pass.accesses.push(access(&target, to, true, usages.1));
        Some(step)
    }

    pub(super) fn clear(
        &mut self,
        name: &Located<String>,
        value: [f64; 4],
        pass: &mut LinkedPass,
    ) -> Option<LinkedStep> {
        let target = self.expect(name)?;
        self.writable(&target, name, &name.span);
        let (usage, step) = match &self.resources.get(target.id).kind {
            ResourceKind::Texture(texture) => {
                let format = texture.format;
                let usages = wgpu::TextureUsages::RENDER_ATTACHMENT;
                if !format
                    .guaranteed_format_features(self.features)
                    .allowed_usages
                    .contains(usages)
                {
                    self.report(
                        Diagnostic::error(
                            Code::FormatMismatch,
                            format!("a texture of format {format:?} cannot be cleared"),
                        )
                        .at(name.span.clone(), "wgpu clears what can be drawn to")
                        .help("write it whole by a Compute pass instead"),
                    );
                    return None;
                }
                self.clear_value(name, format, value);
                (
                    Usage::Texture(usages),
                    LinkedStep::ClearTexture {
                        target: target.clone(),
                        value,
                    },
                )
            }
            ResourceKind::Buffer(_) => {
                if value != [0.0; 4] {
                    self.report(
                        Diagnostic::error(
                            Code::ResourceKind,
                            format!("the buffer `{}` can only be cleared to zero", name.value),
                        )
                        .at(name.span.clone(), "")
                        .help("leave `value` out, or write the buffer by a Compute pass"),
                    );
                    return None;
                }
                (
                    Usage::Buffer(wgpu::BufferUsages::COPY_DST),
                    LinkedStep::ClearBuffer(target.id),
                )
            }
            other => {
                let what = other.describe();
                self.report(
                    Diagnostic::error(
                        Code::ResourceKind,
                        format!("`{}` cannot be cleared", name.value),
                    )
                    .at(name.span.clone(), format!("this is {what}")),
                );
                return None;
            }
        };
        pass.accesses.push(Access {
            resource: target.id,
            part: target.part,
            reads: false,
            writes: true,
            covers: true,
            usage,
            span: name.span.clone(),
            step: 0,
        });
        Some(step)
    }
}
