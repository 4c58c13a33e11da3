//! Materials that grow between frames: from which size, by which counter, how far.

use super::{scopes::Position, symbols::SymbolTable};
use crate::{
    diagnostics::reports::{ErrorGuaranteed, Reports},
    document::materials::{BufferEntry, GrowEntry, TextureEntry},
    errors::resource::SizeError,
    resource::{Buffer, Growth, Origin, ResourceKind, Texture},
    source::span::Located,
};

impl SymbolTable<'_> {
    /// Gives a buffer the items that frames before have asked for.
    pub(super) fn grow_buffer(
        &mut self,
        entry: &BufferEntry,
        buffer: &mut Buffer,
        full_name: &str,
        position: Position,
        reports: &mut Reports,
    ) -> Result<Option<Growth>, ErrorGuaranteed> {
        let Some(grow) = &entry.grow else {
            return Ok(None);
        };
        let name = Located::new(entry.name.value.to_string(), entry.name.span.clone());
        let Some(count) = buffer.count.filter(|_| entry.count.is_some()) else {
            return Err(reports.report(SizeError::GrowWithoutCount(name)));
        };
        let growth = self.growth(&name.value, grow, position, reports)?;
        buffer.count = Some(count.max(self.grown(full_name)).min(growth.max));
        Ok(Some(growth))
    }

    /// Gives a texture the layers that frames before have asked for, no more than the adapter has.
    pub(super) fn grow_texture(
        &mut self,
        entry: &TextureEntry,
        texture: &mut Texture,
        full_name: &str,
        position: Position,
        reports: &mut Reports,
    ) -> Result<Option<Growth>, ErrorGuaranteed> {
        let Some(grow) = &entry.grow else {
            return Ok(None);
        };
        let name = Located::new(entry.name.value.to_string(), entry.name.span.clone());
        if entry.layers.is_none() || texture.is_3d {
            return Err(reports.report(SizeError::GrowWithoutLayers(name)));
        }
        let growth = self.growth(&name.value, grow, position, reports)?;
        let most = self.request.limits.max_texture_array_layers;
        let grown = self.grown(full_name).min(u64::from(most));
        let layers = u64::from(texture.layers).max(grown).min(growth.max);
        // Shaders and passes could take one layer for a texture without layers, and not go on when
        // there are more.
        if layers == 1 {
            return Err(reports.report(SizeError::GrowFromOne(name)));
        }
        texture.layers = u32::try_from(layers).unwrap_or(u32::MAX);
        Ok(Some(growth))
    }

    /// The items or layers that a frame before has asked for; 0 if none has.
    fn grown(&self, full_name: &str) -> u64 {
        self.request.grown.get(full_name).copied().unwrap_or(0)
    }

    fn growth(
        &mut self,
        name: &str,
        grow: &GrowEntry,
        position: Position,
        reports: &mut Reports,
    ) -> Result<Growth, ErrorGuaranteed> {
        let counter = self.resolve(&grow.counter, position, reports)?;
        let resource = self.get(counter.id);
        let is_own = resource.origin == Origin::Own;
        if !(is_own && matches!(resource.kind, ResourceKind::Buffer(_))) {
            let what = if is_own {
                resource.kind.describe()
            } else {
                "not made by this graph"
            };
            let text = grow.counter.text().to_owned();
            let name = Located::new(text, grow.counter.span.clone());
            return Err(reports.report(SizeError::Counter { name, what }));
        }
        let max = match grow.max.count(&mut self.at(position, None, reports))? {
            0 if grow.max.is_taken() => 1,
            0 => {
                let name = Located::new(name.to_owned(), grow.max.span.clone());
                return Err(reports.report(SizeError::GrowToNothing(name)));
            }
            max => max,
        };
        Ok(Growth { counter, max })
    }
}
