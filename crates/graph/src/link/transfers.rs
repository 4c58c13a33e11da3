//! Copies and clears of textures and buffers.

use super::{
    linker::{Linker, access},
    pass::{Ids, LinkedPass, Usage},
};
use crate::{
    diagnostics::reports::ErrorGuaranteed,
    errors::link::LinkError,
    kinds::step::{Operand, Step},
    resource::{ResourceKind, Target, Texture},
};

/// Width, height, layers and mips of a part of a texture.
fn extent(texture: &Texture, target: &Target) -> [usize; 4] {
    let [width, height] = texture.mip_size(target.part.mips.start);
    let (layers, mips) = (target.part.layers.len(), target.part.mips.len());
    [width as usize, height as usize, layers, mips]
}

impl Linker<'_, '_> {
    pub(super) fn copy(
        &mut self,
        from: &Operand,
        to: &Operand,
        pass: &mut LinkedPass,
    ) -> Result<Step<Ids>, ErrorGuaranteed> {
        let (source, from) = self.operand(from, &pass.name)?;
        let (target, to) = self.operand(to, &pass.name)?;
        self.writable(target.id, &to.span)?;
        let kinds = [source.id, target.id].map(|id| self.symbols.get(id).kind.clone());
        let usages = match &kinds {
            [ResourceKind::Texture(a), ResourceKind::Texture(b)] => {
                if a.format != b.format || a.samples != b.samples || a.is_3d != b.is_3d {
                    return Err(self.report(LinkError::CopyFormat {
                        from,
                        to,
                        formats: [a.format, b.format],
                    }));
                }
                let extents = [extent(a, &source), extent(b, &target)];
                if extents[0] != extents[1] {
                    return Err(self.report(LinkError::CopySize { from, to, extents }));
                }
                [wgt::TextureUsages::COPY_SRC, wgt::TextureUsages::COPY_DST].map(Usage::Texture)
            }
            [
                ResourceKind::Buffer(_) | ResourceKind::Provided(_) | ResourceKind::Frame,
                ResourceKind::Buffer(_),
            ] => {
                let sized = self.symbols.base(source.id);
                let source = (sized, &source.part, &from);
                self.layouts.same(source, (target.id, &target.part, &to));
                [wgt::BufferUsages::COPY_SRC, wgt::BufferUsages::COPY_DST].map(Usage::Buffer)
            }
            [a, b] => {
                return Err(self.report(LinkError::CopyKinds {
                    from,
                    to,
                    kinds: [a.describe(), b.describe()],
                }));
            }
        };
        let read = access(&source, (true, false, false), usages[0], &from.span);
        let written = access(&target, (false, true, true), usages[1], &to.span);
        pass.accesses.extend([read, written]);
        Ok(Step::Copy {
            from: source,
            to: target,
        })
    }

    pub(super) fn clear(
        &mut self,
        operand: &Operand,
        value: [f64; 4],
        pass: &mut LinkedPass,
    ) -> Result<Step<Ids>, ErrorGuaranteed> {
        let (target, name) = self.operand(operand, &pass.name)?;
        self.writable(target.id, &name.span)?;
        let usage = match &self.symbols.get(target.id).kind {
            ResourceKind::Texture(texture) => {
                let format = texture.format;
                let needed = wgt::TextureUsages::RENDER_ATTACHMENT;
                let features = format.guaranteed_format_features(self.symbols.request.features);
                if !features.allowed_usages.contains(needed) {
                    return Err(self.report(LinkError::ClearFormat { name, format }));
                }
                self.clear_value(&name, format, value)?;
                Usage::Texture(needed)
            }
            ResourceKind::Buffer(_) if value != [0.0; 4] => {
                return Err(self.report(LinkError::ClearBufferValue(name)));
            }
            ResourceKind::Buffer(_) => Usage::Buffer(wgt::BufferUsages::COPY_DST),
            other => {
                let found = other.describe();
                return Err(self.report(LinkError::ClearKind { name, found }));
            }
        };
        pass.accesses
            .push(access(&target, (false, true, true), usage, &name.span));
        Ok(Step::Clear { target, value })
    }
}
