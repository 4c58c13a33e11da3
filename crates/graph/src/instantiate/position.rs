//! Expressions and selections at their places in a document.

use super::{scopes::Position, symbols::SymbolTable};
use crate::{
    diagnostics::reports::{ErrorGuaranteed, Reports},
    errors::{evaluation::EvaluationError, instantiate::InterfaceError},
    language::{
        eval::Environment,
        name::Name,
        syntax::{Attribute, Reference, Selection},
        value::{Scalar, Value},
    },
    provided_kind::ProvidedKind,
    resource::{ResourceKind, SubresourceRange, Target},
    shader::reflect::Shader,
    source::span::{Located, Span},
};
use std::{ops::Range, sync::Arc};

/// Meaning of the names of an expression at a place of a document.
pub(crate) struct At<'w, 'a, 'r> {
    symbols: &'w mut SymbolTable<'a>,
    position: Position,
    /// The shader of the pass, where it is one's expression.
    shader: Option<Result<Arc<Shader>, ErrorGuaranteed>>,
    reports: &'r mut Reports,
}

impl<'a> SymbolTable<'a> {
    pub fn at<'w, 'r>(
        &'w mut self,
        position: Position,
        shader: Option<Result<Arc<Shader>, ErrorGuaranteed>>,
        reports: &'r mut Reports,
    ) -> At<'w, 'a, 'r> {
        At {
            symbols: self,
            position,
            shader,
            reports,
        }
    }

    /// Narrows a target to some of its layers, slices or items.
    pub(super) fn select_layers(
        &mut self,
        target: &mut Target,
        selection: &Selection,
        reference: &Reference,
        position: Position,
        reports: &mut Reports,
    ) -> Result<(), ErrorGuaranteed> {
        let resource = self.get(target.id);
        let (what, count) = match &resource.kind {
            ResourceKind::Texture(texture) => {
                let what = if texture.is_3d { "slices" } else { "layers" };
                (what, Some(target.part.layers.len() as u64))
            }
            ResourceKind::Buffer(buffer) => ("items", buffer.count),
            ResourceKind::Provided(provided) => ("items", provided.items),
            ResourceKind::Sampler(_)
            | ResourceKind::AccelerationStructure
            | ResourceKind::Frame => {
                return Err(reports.report(InterfaceError::NoPart {
                    text: reference.text().to_owned(),
                    span: reference.span.clone(),
                    what: "only textures and buffers have parts",
                }));
            }
        };
        let items = match target.part.items() {
            Some(items) if what == "items" => Some(items.len() as u64),
            _ => count,
        };
        let Some(count) = items else {
            let name = Located::new(reference.path(), reference.span.clone());
            return Err(reports.report(self.uncounted(target, name)));
        };
        let range = self.range(
            selection,
            (what, count),
            reference,
            target,
            position,
            reports,
        )?;
        let start = if target.part == SubresourceRange::WHOLE {
            0
        } else {
            target.part.layers.start
        };
        target.part.layers = start + range.start..start + range.end;
        Ok(())
    }

    /// The items of a buffer are asked for, and not known.
    fn uncounted(&self, target: &Target, name: Located<String>) -> EvaluationError {
        match &self.get(target.id).kind {
            ResourceKind::Provided(_) => EvaluationError::Uncounted(name),
            _ => EvaluationError::NoCount(name),
        }
    }

    /// Narrows a target to some of its mips.
    pub(super) fn select_mips(
        &mut self,
        target: &mut Target,
        selection: &Selection,
        reference: &Reference,
        position: Position,
        reports: &mut Reports,
    ) -> Result<(), ErrorGuaranteed> {
        if !matches!(self.get(target.id).kind, ResourceKind::Texture(_)) {
            return Err(reports.report(InterfaceError::NoPart {
                text: reference.path(),
                span: reference.span.clone(),
                what: "only textures have mips",
            }));
        }
        let have = ("mips", target.part.mips.len() as u64);
        let range = self.range(selection, have, reference, target, position, reports)?;
        let start = target.part.mips.start;
        target.part.mips = start + range.start..start + range.end;
        if let ResourceKind::Texture(texture) = &self.get(target.id).kind
            && texture.is_3d
        {
            let layers = texture.mip_layers(target.part.mips.start);
            if target.part.layers.start >= layers {
                return Err(reports.report(InterfaceError::NoPart {
                    text: reference.text().to_owned(),
                    span: reference.span.clone(),
                    what: "this mip has fewer slices",
                }));
            }
            target.part.layers.end = target.part.layers.end.min(layers);
        }
        Ok(())
    }

    /// The range that is selected of so many layers, items or mips.
    fn range(
        &mut self,
        selection: &Selection,
        (what, count): (&str, u64),
        reference: &Reference,
        target: &Target,
        position: Position,
        reports: &mut Reports,
    ) -> Result<Range<u32>, ErrorGuaranteed> {
        let at = &mut self.at(position, None, reports);
        let (range, span) = match selection {
            Selection::One(one) => {
                let first = one.count(at)?;
                (first..first.saturating_add(1), &one.span)
            }
            Selection::Range(ends) => {
                let [first, end] = &**ends;
                (first.count(at)?..end.count(at)?, &end.span)
            }
        };
        let fits = range.start < range.end && range.end <= count;
        let narrow = || Some(u32::try_from(range.start).ok()?..u32::try_from(range.end).ok()?);
        narrow().filter(|_| fits).ok_or_else(|| {
            let last = count.saturating_sub(1);
            reports.report(InterfaceError::Range {
                text: reference.text().to_owned(),
                span: span.clone(),
                what: match count {
                    1 => format!("its {what} are [0] alone, this is [{}]", range.start),
                    _ => format!("its {what} are [0] to [{last}], this is [{}]", range.start),
                },
                declared: self.get(target.id).declared.clone(),
            })
        })
    }

    /// An attribute of a target; `None` if it has no such one.
    fn attribute(&self, target: &Target, attribute: Attribute) -> Option<Value> {
        let part = &target.part;
        let texture = match &self.get(target.id).kind {
            ResourceKind::Texture(texture) => texture,
            ResourceKind::Buffer(_) | ResourceKind::Provided(_)
                if attribute == Attribute::Count =>
            {
                return self.items(target).map(Value::count);
            }
            ResourceKind::Provided(provided) if attribute == Attribute::Kind => {
                return provided.kind.map(Value::kind);
            }
            _ => return None,
        };
        let [width, height] = texture.mip_size(part.mips.start);
        let layers = if texture.is_3d {
            part.layers
                .len()
                .min(texture.mip_layers(part.mips.start) as usize)
        } else {
            part.layers.len()
        };
        let whole = |number: u32| Scalar::Whole(number.into());
        Some(match attribute {
            Attribute::Size if texture.is_3d => Value::List(vec![
                whole(width),
                whole(height),
                Scalar::Whole(layers as i64),
            ]),
            Attribute::Size => Value::List(vec![whole(width), whole(height)]),
            Attribute::Width => Value::whole(width),
            Attribute::Height => Value::whole(height),
            Attribute::Layers => Value::count(layers as u64),
            Attribute::Mips => Value::count(part.mips.len() as u64),
            Attribute::Samples => Value::whole(texture.samples),
            Attribute::Count => {
                let depth = if texture.is_3d { layers as u64 } else { 1 };
                let count = u64::from(width).saturating_mul(height.into());
                Value::count(count.saturating_mul(depth))
            }
            Attribute::Format => Value::Format(texture.format),
            Attribute::Kind | Attribute::Index => return None,
        })
    }

    /// How many items of a buffer a target is, where that is known.
    pub fn items(&self, target: &Target) -> Option<u64> {
        let selected = target.part.items().map(|items| items.len() as u64);
        selected.or(match &self.get(target.id).kind {
            ResourceKind::Buffer(buffer) => buffer.count,
            ResourceKind::Provided(provided) => provided.items,
            _ => None,
        })
    }
}

impl Environment for At<'_, '_, '_> {
    fn viewport(&self) -> [u32; 2] {
        self.symbols.request.viewport
    }

    fn has(&self, feature: wgt::Features) -> bool {
        self.symbols.request.features.contains(feature)
    }

    fn provided_items(&self, name: &str) -> Option<u64> {
        self.symbols.request.provider.describe(name)?.items
    }

    fn param(&mut self, name: &str, span: &Span) -> Result<Value, ErrorGuaranteed> {
        let instance = self.symbols.scopes.document(self.position.scope);
        if let Some(value) = instance.params.value(name, self.reports) {
            return value;
        }
        if let Some(id) = self.symbols.scopes.find_value(self.position.scope, name) {
            return self.symbols.value(id, self.reports);
        }
        if let Some(reported) = instance.document.invalid_params {
            return Err(reported);
        }
        let is_material = self
            .symbols
            .scopes
            .find(self.position.scope, name)
            .is_some();
        let values = instance
            .document
            .values
            .iter()
            .map(|(name, _)| name.as_str());
        let known = self.reports.known(instance.params.names().chain(values));
        Err(self.report(EvaluationError::param(name, span, is_material, known)))
    }

    fn word_or_param(&mut self, name: &Name) -> Option<Value> {
        let instance = self.symbols.scopes.document(self.position.scope);
        if let Some(value) = instance.params.value(name, self.reports) {
            return value.ok();
        }
        let id = self.symbols.scopes.find_value(self.position.scope, name)?;
        self.symbols.value(id, self.reports).ok()
    }

    fn index(&mut self, of: Option<&Name>, span: &Span) -> Result<u32, ErrorGuaranteed> {
        let index = self.symbols.scopes.index(self.position, of);
        let missing = || EvaluationError::NoIndex(span.clone(), of.cloned());
        index.ok_or_else(|| self.reports.report(missing()))
    }

    fn attribute(
        &mut self,
        of: &Reference,
        attribute: Attribute,
        span: &Span,
    ) -> Result<Value, ErrorGuaranteed> {
        let target = self.symbols.resolve(of, self.position, self.reports)?;
        if let Some(value) = self.symbols.attribute(&target, attribute) {
            return Ok(value);
        }
        if attribute == Attribute::Kind
            && let Some(kind) = self.symbols.provided_kind(&of.path(), self.position.scope)
        {
            return Ok(Value::kind(kind));
        }
        let resource = self.symbols.get(target.id);
        let error = match (attribute, &resource.kind) {
            (Attribute::Count, ResourceKind::Buffer(_) | ResourceKind::Provided(_)) => {
                let name = Located::new(of.path(), of.span.clone());
                self.symbols.uncounted(&target, name)
            }
            _ => EvaluationError::NoAttribute {
                span: span.clone(),
                of: format!("`{}`, {},", resource.name, resource.kind.describe()),
            },
        };
        let counts = matches!(error, EvaluationError::NoCount(_));
        let reported = self.report(error);
        if counts {
            // Its shaders would miss the same number.
            self.symbols.mark_invalid(target.id, reported);
        }
        Err(reported)
    }

    fn constant(&mut self, name: &str, span: &Span) -> Result<Value, ErrorGuaranteed> {
        let shader = match &self.shader {
            Some(shader) => shader.as_ref().map_err(|reported| *reported)?,
            None => return Err(self.reports.report(EvaluationError::NoShader(span.clone()))),
        };
        if let Some(value) = shader.constant(name) {
            return Ok(Value::Scalar(value));
        }
        let known = self.reports.known(shader.constants());
        Err(self.reports.report(EvaluationError::NoConstant {
            span: span.clone(),
            file: shader.source.file.name.to_string(),
            name: name.to_owned(),
            known,
        }))
    }

    fn kind(&mut self, of: &str) -> Option<ProvidedKind> {
        self.symbols.provided_kind(of, self.position.scope)
    }

    fn report(&mut self, error: EvaluationError) -> ErrorGuaranteed {
        self.reports.report(error)
    }
}
