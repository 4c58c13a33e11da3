//! Sizes of materials, each found once, when it is first asked for.

use super::{
    scopes::{Position, Symbol},
    state::{Declared, State},
    symbols::SymbolTable,
};
use crate::{
    diagnostics::reports::{ErrorGuaranteed, Reports},
    document::materials::{BufferEntry, FormatEntry, Material, Mips, SamplerEntry, TextureEntry},
    errors::{evaluation::EvaluationError, resource::SizeError},
    language::{
        syntax::{Expr, Leaf},
        value::Value,
    },
    resource::{Buffer, Growth, Origin, ResourceId, ResourceKind, Sampler, Texture},
    source::{
        sources::Picture,
        span::{Located, Span},
    },
};
use std::{collections::BTreeSet, sync::Arc};

/// Most sizes of which each is asked for while another is found.
const NESTED: usize = 8;

impl SymbolTable<'_> {
    /// Finds the size of a resource if it is not known yet. Materials that it is made of come
    /// first, so that no chain of sizes is as deep as the stack. The exception is a material in an
    /// expression that is itself made of the expression's material: it is found on the way.
    pub fn resolve_size(
        &mut self,
        id: ResourceId,
        reports: &mut Reports,
    ) -> Result<(), ErrorGuaranteed> {
        if matches!(self.states[id.index()], State::Declared(_)) {
            match self.evaluating.len() {
                0 => self.resolve_sizes_of_parts(id, reports),
                1..NESTED => self.evaluate(id, reports),
                _ => return Err(self.circular(id, reports)),
            }
        }
        match &self.states[id.index()] {
            State::Known => Ok(()),
            State::Invalid(reported) => Err(*reported),
            State::Declared(_) | State::Resolving => Err(self.circular(id, reports)),
        }
    }

    fn circular(&self, id: ResourceId, reports: &mut Reports) -> ErrorGuaranteed {
        // The walk began with the one that is evaluated last, which is the one that the first asks
        // for.
        let mut found = self.evaluating.iter().skip_while(|found| **found != id);
        let resource = self.get(found.nth(1).copied().unwrap_or(id));
        let span = resource.declared.clone();
        let span = span.unwrap_or_else(|| self.graph.place());
        reports.report(EvaluationError::Circular(Located::new(
            resource.name.clone(),
            span,
        )))
    }

    fn resolve_sizes_of_parts(&mut self, id: ResourceId, reports: &mut Reports) {
        let mut seen = BTreeSet::from([id]);
        let mut open = vec![(id, self.parts(id))];
        while let Some((last, parts)) = open.last_mut() {
            match parts.pop() {
                Some(part) if seen.insert(part) => open.push((part, self.parts(part))),
                Some(_) => {}
                None => {
                    let last = *last;
                    open.pop();
                    self.evaluate(last, reports);
                }
            }
        }
    }

    /// Returns the materials that the size of one is made of, if their own sizes are not found yet.
    fn parts(&self, id: ResourceId) -> Vec<ResourceId> {
        let State::Declared(declared) = &self.states[id.index()] else {
            return Vec::new();
        };
        let mut parts = Vec::new();
        declared.material().visit(&mut |leaf| {
            let Leaf::Material(of) = leaf else {
                return;
            };
            let mut names = of.segments.iter().map(|segment| &segment.name.value);
            let first = names.next();
            let Some(first) = first.and_then(|name| self.scopes.find(declared.scope, name)) else {
                return;
            };
            let mut meanings = vec![first];
            for name in names {
                meanings = meanings.iter().flat_map(|of| of.named(name)).collect();
            }
            parts.extend(meanings.iter().filter_map(|symbol| match symbol {
                Symbol::Target(target) => Some(target.id),
                _ => None,
            }));
        });
        parts.retain(|part| matches!(self.states[part.index()], State::Declared(_)));
        parts
    }

    fn evaluate(&mut self, id: ResourceId, reports: &mut Reports) {
        let state = &mut self.states[id.index()];
        let State::Declared(declared) = std::mem::replace(state, State::Resolving) else {
            return;
        };
        self.evaluating.push(id);
        let full_name = self.resources[id.index()].name.clone();
        let kind = self.kind(&declared, &full_name, reports);
        self.evaluating.pop();
        self.states[id.index()] = match kind {
            Ok((kind, growth)) => {
                let is_constant = match &kind {
                    ResourceKind::Texture(texture) => texture.picture.is_some(),
                    ResourceKind::Buffer(buffer) => buffer.data.is_some(),
                    _ => false,
                };
                if is_constant {
                    self.resources[id.index()].origin = Origin::Constant;
                }
                self.resources[id.index()].kind = kind;
                self.resources[id.index()].growth = growth;
                State::Known
            }
            Err(reported) => State::Invalid(reported),
        };
    }

    fn kind(
        &mut self,
        declared: &Declared,
        full_name: &str,
        reports: &mut Reports,
    ) -> Result<(ResourceKind, Option<Growth>), ErrorGuaranteed> {
        let position = Position {
            scope: declared.scope,
            index: None,
        };
        let (material, is_constant) = match declared.material() {
            material @ Material::Texture(entry) => (material, entry.file.is_some()),
            material @ Material::Buffer(entry) => (material, entry.data.is_some()),
            material @ Material::Sampler(_) => (material, false),
        };
        if material.keeps() && is_constant {
            let name = material.name();
            let name = Located::new(name.value.to_string(), name.span.clone());
            return Err(reports.report(SizeError::KeepsConstant(name)));
        }
        match material {
            Material::Texture(entry) => {
                let mut texture = self.texture(entry, declared, position, reports)?;
                let growth =
                    self.grow_texture(entry, &mut texture, full_name, position, reports)?;
                self.check_texture(entry, &texture, reports)?;
                Ok((ResourceKind::Texture(texture), growth))
            }
            Material::Buffer(entry) => {
                let mut buffer = self.buffer(entry, position, reports)?;
                let growth = self.grow_buffer(entry, &mut buffer, full_name, position, reports)?;
                Ok((ResourceKind::Buffer(buffer), growth))
            }
            Material::Sampler(entry) => Ok((ResourceKind::Sampler(sampler(entry)), None)),
        }
    }

    fn texture(
        &mut self,
        entry: &TextureEntry,
        declared: &Declared,
        position: Position,
        reports: &mut Reports,
    ) -> Result<Texture, ErrorGuaranteed> {
        let format = match &entry.format {
            FormatEntry::Named(format) => *format,
            FormatEntry::Expr(expr) => self.format(expr, position, reports)?,
        };
        let picture = match &entry.file {
            None => None,
            Some(file) => Some(self.picture(entry, file, declared, format, reports)?),
        };
        let edges = match (&entry.size, &picture) {
            (_, Some(picture)) => picture.size.map(u64::from).to_vec(),
            (Some(size), None) => size.edges(&mut self.at(position, None, reports))?,
            (None, None) => self.request.viewport.map(u64::from).to_vec(),
        };
        let mut one = |expr: &Option<Expr>| match expr {
            Some(expr) => expr.count32(&mut self.at(position, None, reports)),
            None => Ok(1),
        };
        let (layers, samples) = (one(&entry.layers)?, one(&entry.samples)?);
        let name = entry.name.value.clone();
        let span = size_span(entry);
        let too_large = || SizeError::Absurd {
            name: Located::new(name.to_string(), span.clone()),
        };
        let narrow = |edge: &u64| u32::try_from(*edge).ok();
        let narrow: Option<Vec<u32>> = edges.iter().map(narrow).collect();
        let narrow = narrow.ok_or_else(|| reports.report(too_large()))?;
        let size = [narrow[0], narrow[1]];
        let is_3d = narrow.len() == 3;
        let depth = narrow.get(2).copied().unwrap_or(1);
        let mips = match &entry.mips {
            Mips::One => 1,
            Mips::All => {
                let longest = size[0].max(size[1]).max(if is_3d { depth } else { 1 });
                longest.max(1).ilog2() + 1
            }
            Mips::Number(expr) => expr.count32(&mut self.at(position, None, reports))?,
        };
        if is_3d && layers != 1 {
            let name = Located::new(name.to_string(), entry.name.span.clone());
            return Err(reports.report(SizeError::LayersOf3d(name)));
        }
        Ok(Texture {
            format,
            size,
            layers: if is_3d { depth } else { layers },
            is_3d,
            mips,
            samples,
            picture,
        })
    }

    fn format(
        &mut self,
        expr: &Expr,
        position: Position,
        reports: &mut Reports,
    ) -> Result<wgt::TextureFormat, ErrorGuaranteed> {
        match expr.value(&mut self.at(position, None, reports))? {
            Value::Format(format) => Ok(format),
            found => Err(reports.report(EvaluationError::Type {
                span: expr.span.clone(),
                expected: "a format",
                found,
            })),
        }
    }

    fn picture(
        &self,
        entry: &TextureEntry,
        file: &Located<String>,
        declared: &Declared,
        format: wgt::TextureFormat,
        reports: &mut Reports,
    ) -> Result<Picture, ErrorGuaranteed> {
        let picture = self.graph.pictures.get(&declared.document, file)?;
        let takes = [
            (entry.size.is_some(), "size"),
            (!matches!(entry.mips, Mips::One), "mips"),
            (entry.layers.is_some(), "layers"),
            (entry.samples.is_some(), "samples"),
        ];
        if let Some((_, field)) = takes.into_iter().find(|(given, _)| *given) {
            return Err(reports.report(SizeError::FileHas(file.clone(), field)));
        }
        if !crate::picture::can_hold(format) {
            let position = Located::new(format!("{format:?}"), file.span.clone());
            return Err(reports.report(SizeError::PictureFormat(position)));
        }
        Ok(picture)
    }

    fn buffer(
        &mut self,
        entry: &BufferEntry,
        position: Position,
        reports: &mut Reports,
    ) -> Result<Buffer, ErrorGuaranteed> {
        let name = |span: &Span| Located::new(entry.name.value.to_string(), span.clone());
        let count = match (&entry.count, &entry.data) {
            (Some(count), Some(_)) => {
                return Err(reports.report(SizeError::DataHas(name(&count.span))));
            }
            (None, Some(data)) if data.0.is_empty() => {
                return Err(reports.report(SizeError::NoItems(name(&data.span))));
            }
            (None, Some(data)) => Some(data.0.len() as u64),
            (None, None) => None,
            (Some(expr), None) => match expr.count(&mut self.at(position, None, reports))? {
                // As for what a host provides: wgpu binds nothing of size zero.
                0 if expr.is_taken() => Some(1),
                0 => return Err(reports.report(SizeError::NoItems(name(&expr.span)))),
                count => Some(count),
            },
        };
        let data = entry.data.as_ref().map(|data| Arc::new(data.0.clone()));
        Ok(Buffer {
            count,
            data,
            ..Buffer::default()
        })
    }

    fn check_texture(
        &self,
        entry: &TextureEntry,
        texture: &Texture,
        reports: &mut Reports,
    ) -> Result<(), ErrorGuaranteed> {
        let format = texture.format;
        let feature = format.required_features() - self.graph.features();
        if !feature.is_empty() {
            let name = Located::new(entry.name.value.to_string(), entry.name.span.clone());
            return Err(reports.report(SizeError::FormatFeature {
                name,
                format,
                feature,
            }));
        }
        let limits = &self.request.limits;
        let Texture {
            size: [width, height],
            layers,
            mips,
            samples,
            ..
        } = *texture;
        let name = |span: Span| Located::new(entry.name.value.to_string(), span);
        let (whole, sized) = (entry.name.span.clone(), size_span(entry));
        if [width, height, layers, mips, samples].contains(&0) {
            return Err(reports.report(SizeError::NoTexels {
                name: name(sized),
                size: [width, height],
                layers,
                mips,
                samples,
            }));
        }
        let (most, third) = if texture.is_3d {
            (
                limits.max_texture_dimension_3d,
                limits.max_texture_dimension_3d,
            )
        } else {
            (
                limits.max_texture_dimension_2d,
                limits.max_texture_array_layers,
            )
        };
        if width > most || height > most {
            let size = [width, height];
            let name = name(sized);
            reports.unsupported(SizeError::Texels { name, size, most })?;
        }
        if layers > third {
            reports.unsupported(SizeError::Layers {
                name: name(whole.clone()),
                layers,
                most: third,
            })?;
        }
        let longest = width
            .max(height)
            .max(if texture.is_3d { layers } else { 1 });
        let full = longest.ilog2() + 1;
        if mips > full {
            return Err(reports.report(SizeError::Mips {
                name: name(whole),
                mips,
                full,
            }));
        }
        if samples > 1 {
            self.check_samples(name(whole), texture, reports)?;
        }
        Ok(())
    }

    fn check_samples(
        &self,
        name: Located<String>,
        texture: &Texture,
        reports: &mut Reports,
    ) -> Result<(), ErrorGuaranteed> {
        if texture.is_3d || texture.layers > 1 || texture.mips > 1 {
            return Err(reports.report(SizeError::SamplesOfMany(name)));
        }
        let format = texture.format;
        let features = format.guaranteed_format_features(self.request.features);
        let counts = [1, 2, 4, 8, 16];
        let known = counts
            .into_iter()
            .filter(|count| features.flags.sample_count_supported(*count));
        let known: Vec<u32> = known.collect();
        if known.contains(&texture.samples) {
            Ok(())
        } else {
            reports.unsupported(SizeError::Samples {
                name,
                format,
                samples: texture.samples,
                known,
            })
        }
    }
}

fn size_span(entry: &TextureEntry) -> Span {
    match &entry.size {
        Some(size) => size.span.clone(),
        None => entry.name.span.clone(),
    }
}

fn sampler(entry: &SamplerEntry) -> Sampler {
    Sampler {
        filter: entry.filter,
        address: entry.address,
        compare: entry.compare.map(Into::into),
    }
}
