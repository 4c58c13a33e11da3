//! Imports, buffers and views become resources.

use super::{
    Buffer, Origin, Part, ResourceId, ResourceKind, Resources, Target, Texture, size_error,
};
use crate::{
    diagnostics::{Code, Diagnostic},
    document::materials::{BufferEntry, Material, TextureEntry},
    provider::Import,
    registry::Params,
};
use std::collections::{BTreeMap, HashSet};

impl Resources<'_> {
    /// Enters what the host imports. A material of the same name would hide it.
    pub(super) fn add_imports(
        &mut self,
        materials: &[Material],
        imports: &BTreeMap<String, Import>,
        diagnostics: &mut Vec<Diagnostic>,
    ) {
        for (name, import) in imports {
            if let Some(material) = materials.iter().find(|m| m.name().as_str() == name) {
                diagnostics.push(
                    Diagnostic::error(
                        Code::DuplicateName,
                        format!("the host imports `{name}`, which is a material of the document"),
                    )
                    .at(material.name().span.clone(), "declared here")
                    .help("import it under another name, or remove the material"),
                );
                continue;
            }
            let kind = match *import {
                Import::Texture {
                    format,
                    size,
                    mips,
                    layers,
                    ..
                } => ResourceKind::Texture(Texture {
                    format,
                    size,
                    mips,
                    layers,
                }),
                Import::Buffer { bytes, items, .. } => ResourceKind::Buffer(Buffer {
                    count: items,
                    bytes,
                }),
            };
            let id = self.add(name.clone(), None, kind);
            self.list[id.0].origin = Origin::Host;
        }
    }

    /// Adds the buffers, each after those that its count refers to.
    pub(super) fn add_buffers(
        &mut self,
        materials: &[Material],
        params: &Params,
        diagnostics: &mut Vec<Diagnostic>,
    ) {
        let mut waiting: Vec<&BufferEntry> = materials
            .iter()
            .filter_map(|material| match material {
                Material::Buffer(entry) => Some(entry),
                _ => None,
            })
            .collect();
        while !waiting.is_empty() {
            let names: HashSet<&str> = waiting.iter().map(|entry| entry.name.as_str()).collect();
            let is_ready = |entry: &&BufferEntry| {
                entry
                    .count
                    .as_ref()
                    .is_none_or(|count| !count.refers_to(&names))
            };
            let (ready, others): (Vec<_>, Vec<_>) = waiting.iter().copied().partition(is_ready);
            if ready.is_empty() {
                for entry in others {
                    let place = entry
                        .count
                        .as_ref()
                        .map_or(&entry.name.span, |count| &count.span);
                    diagnostics.push(size_error(
                        &entry.name,
                        place,
                        "its count is that of itself",
                        "give one of these buffers a count of its own",
                    ));
                    self.spoil(&entry.name);
                }
                return;
            }
            for entry in ready {
                self.add_buffer(entry, params, diagnostics);
            }
            waiting = others;
        }
    }

    pub(super) fn add_buffer(
        &mut self,
        entry: &BufferEntry,
        params: &Params,
        diagnostics: &mut Vec<Diagnostic>,
    ) {
        let count = match &entry.count {
            None => None,
            Some(written) => match self.count(written, params, diagnostics) {
                // As for what a host provides: wgpu binds nothing of size zero.
                Some(0) if written.is_taken() => Some(1),
                Some(0) => {
                    diagnostics.push(size_error(
                        &entry.name,
                        &written.span,
                        "a buffer of no items",
                        "give it one at least",
                    ));
                    return self.spoil(&entry.name);
                }
                Some(count) => Some(count),
                None => return self.spoil(&entry.name),
            },
        };
        let kind = ResourceKind::Buffer(Buffer { count, bytes: 0 });
        self.add(
            entry.name.value.clone(),
            Some(entry.name.span.clone()),
            kind,
        );
    }

    pub(super) fn add_views(
        &mut self,
        entry: &TextureEntry,
        id: ResourceId,
        diagnostics: &mut Vec<Diagnostic>,
    ) {
        let ResourceKind::Texture(texture) = &self.list[id.0].kind else {
            return;
        };
        let (mips, layers) = (texture.mips, texture.layers);
        for view in &entry.views {
            let end = |first: u32, count: Option<u32>, all: u32| {
                count.map_or(Some(all), |count| first.checked_add(count))
            };
            let range = |first: u32, count: Option<u32>, all: u32| {
                end(first, count, all)
                    .filter(|&end| first < end && end <= all)
                    .map(|end| first..end)
            };
            match (
                range(view.mip, view.mips, mips),
                range(view.layer, view.layers, layers),
            ) {
                (Some(mips), Some(layers)) => {
                    self.names.insert(
                        view.name.value.clone(),
                        Target {
                            id,
                            part: Part { mips, layers },
                        },
                    );
                    self.spell(&view.name);
                }
                _ => {
                    self.spoil(&view.name);
                    diagnostics.push(
                        Diagnostic::error(
                            Code::Size,
                            format!("the view `{}` lies outside its texture", *view.name),
                        )
                        .at(view.name.span.clone(), "")
                        .help(format!(
                            "`{}` has {mips} mips and {layers} layers, counted from 0",
                            *entry.name
                        )),
                    );
                }
            }
        }
    }
}
