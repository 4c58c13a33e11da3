//! Copies and clears of textures and buffers.

use super::attachments::clear_value;
use super::pass::{Ids, Usage};
use super::scope::PassScope;
use crate::diagnostics::Reported;
use crate::errors::link::LinkError;
use crate::kinds::{Operand, Step};
use crate::resource::{ResourceKind, Target, Texture};

/// Returns the width, height, number of layers and number of mips of a part of a texture.
fn extent(texture: &Texture, target: &Target) -> [usize; 4] {
    let [width, height] = texture.mip_size(target.part.mips.start);
    let (layers, mips) = (target.part.layers.len(), target.part.mips.len());
    [width as usize, height as usize, layers, mips]
}

pub(super) fn copy(from: &Operand, to: &Operand, scope: &mut PassScope<'_>) -> Reported<Step<Ids>> {
    let (source, from) = scope.operand(from)?;
    let (target, to) = scope.operand(to)?;
    scope.writable(target.id, &to.span)?;
    let kinds = [source.id, target.id].map(|id| scope.get(id).kind.clone());
    let usages = match &kinds {
        [ResourceKind::Texture(a), ResourceKind::Texture(b)] => {
            if a.format != b.format || a.samples != b.samples || a.is_3d != b.is_3d {
                return Err(scope.report(LinkError::CopyFormat {
                    from,
                    to,
                    formats: [a.format, b.format],
                }));
            }
            let extents = [extent(a, &source), extent(b, &target)];
            if extents[0] != extents[1] {
                return Err(scope.report(LinkError::CopySize { from, to, extents }));
            }
            [wgt::TextureUsages::COPY_SRC, wgt::TextureUsages::COPY_DST].map(Usage::Texture)
        }
        [
            ResourceKind::Buffer(_) | ResourceKind::Provided(_) | ResourceKind::Frame,
            ResourceKind::Buffer(_),
        ] => {
            let mut sized = source.clone();
            sized.id = scope.symbols.base(source.id);
            let copied = (sized, from.clone());
            scope.layouts.same(copied, (target.clone(), to.clone()));
            [wgt::BufferUsages::COPY_SRC, wgt::BufferUsages::COPY_DST].map(Usage::Buffer)
        }
        [a, b] => {
            return Err(scope.report(LinkError::CopyKinds {
                from,
                to,
                kinds: [a.describe(), b.describe()],
            }));
        }
    };
    scope.access(&source, (true, false, false), usages[0], &from.span);
    scope.access(&target, (false, true, true), usages[1], &to.span);
    Ok(Step::Copy {
        from: source,
        to: target,
    })
}

pub(super) fn clear(
    operand: &Operand,
    value: [f64; 4],
    scope: &mut PassScope<'_>,
) -> Reported<Step<Ids>> {
    let (target, name) = scope.operand(operand)?;
    scope.writable(target.id, &name.span)?;
    let usage = match &scope.get(target.id).kind {
        ResourceKind::Texture(texture) => {
            let format = texture.format;
            let needed = wgt::TextureUsages::RENDER_ATTACHMENT;
            let features = format.guaranteed_format_features(scope.request().features);
            if !features.allowed_usages.contains(needed) {
                return Err(scope.report(LinkError::ClearFormat(name, format)));
            }
            scope.check(clear_value(&name, format, value))?;
            Usage::Texture(needed)
        }
        ResourceKind::Buffer(_) if value != [0.0; 4] => {
            return Err(scope.report(LinkError::ClearBufferValue(name)));
        }
        ResourceKind::Buffer(_) => Usage::Buffer(wgt::BufferUsages::COPY_DST),
        other => {
            let kind = other.describe();
            return Err(scope.report(LinkError::ClearKind(name, kind)));
        }
    };
    scope.access(&target, (false, true, true), usage, &name.span);
    Ok(Step::Clear { target, value })
}
