//! Params, values, materials and constants, as expressions in a document ask for them.

use super::{parts, scopes::Symbol, symbols::At};
use crate::diagnostics::{Reported, Reports};
use crate::errors::evaluation::EvaluationError;
use crate::expressions::Environment;
use crate::language::{AdapterFact, Attribute, Name, Reference, Value, least_common_multiple};
use crate::provided_kind::ProvidedKind;
use crate::resource::ResourceKind;
use crate::source::Span;

impl Environment for At<'_, '_> {
    fn viewport(&self) -> [u32; 2] {
        self.symbols.request.viewport
    }

    fn has(&self, feature: wgt::Features) -> bool {
        self.symbols.request.features.contains(feature)
    }

    fn adapter(&self, fact: AdapterFact) -> Value {
        self.symbols.request.surroundings().fact(fact)
    }

    fn provided_items(&self, name: &str) -> Option<u64> {
        self.symbols.ask(name)?.items
    }

    fn is_provided(&self, name: &str) -> bool {
        self.symbols.ask(name).is_some()
    }

    fn param(&mut self, name: &str, span: &Span) -> Reported<Value> {
        let instance = self.symbols.scopes.document(self.position.scope);
        if let Some(value) = instance.params.value(name, &mut self.symbols.reports) {
            return value;
        }
        if let Some(id) = self.symbols.scopes.find_value(self.position.scope, name) {
            return self.symbols.value(id);
        }
        if let Some(reported) = instance.document.invalid_params {
            return Err(reported);
        }
        let scope = self.position.scope;
        let is_material = |name: &str| {
            let own = self.symbols.scopes.find(scope, name);
            own.is_some_and(|symbol| matches!(symbol, Symbol::Target(_)))
                || self.symbols.request.provider.describe(name).is_some()
        };
        let values = instance.document.values.iter();
        let names = instance.params.names();
        let names = names.chain(values.map(|(name, _)| name.as_str()));
        let names = self.symbols.reports.known(names);
        let error = EvaluationError::param(name, span, is_material, names);
        Err(self.report(error))
    }

    fn is_param(&self, name: &str) -> bool {
        let scopes = &self.symbols.scopes;
        let scope = self.position.scope;
        scopes.document(scope).params.bound(name).is_some()
            || scopes.find_value(scope, name).is_some()
    }

    fn index(&mut self, entry: Option<&Name>, span: &Span) -> Reported<u32> {
        let index = self.symbols.scopes.index(self.position, entry);
        index.ok_or_else(|| self.report(EvaluationError::no_index(span, entry)))
    }

    fn turn(&mut self, length: u32) -> Option<u32> {
        let (frame, period) = self.frame.as_mut()?;
        *period = least_common_multiple(*period, length.into());
        u32::try_from(*frame % u64::from(length)).ok()
    }

    fn attribute(
        &mut self,
        material: &Reference,
        attribute: Attribute,
        span: &Span,
    ) -> Reported<Value> {
        let target = self.symbols.resolve(material, self.position)?;
        let resource = self.symbols.get(target.id);
        if let ResourceKind::Provided(provided) = resource.kind {
            self.symbols.note_asked(resource, provided);
        }
        if let Some(value) = parts::attribute(resource, &target, attribute) {
            return Ok(value);
        }
        if attribute == Attribute::Kind
            && let Some(kind) = self
                .symbols
                .provided_kind(&material.path(), self.position.scope)
        {
            return Ok(Value::kind(kind));
        }
        let resource = self.symbols.get(target.id);
        let error = match (attribute, &resource.kind) {
            (Attribute::Count, ResourceKind::Buffer(_) | ResourceKind::Provided(_)) => {
                parts::uncounted(resource, material)
            }
            _ => {
                let owner = format!("`{}`, {},", resource.name, resource.kind.describe());
                EvaluationError::NoAttribute(span.clone(), owner)
            }
        };
        let counts = matches!(error, EvaluationError::NoCount(_));
        let reported = self.report(error);
        if counts {
            // Its shaders would miss the same number.
            self.symbols.mark_invalid(target.id, reported);
        }
        Err(reported)
    }

    fn constant(&mut self, name: &str, span: &Span) -> Reported<Value> {
        let shader = match &self.shader {
            Some(shader) => shader.as_ref().map_err(|reported| *reported)?,
            None => return Err(self.report(EvaluationError::NoShader(span.clone()))),
        };
        if let Some(value) = shader.constant(name) {
            return Ok(Value::Scalar(value));
        }
        let constants = self.symbols.reports.known(shader.constants());
        Err(self.report(EvaluationError::NoConstant {
            span: span.clone(),
            file: shader.source.file.name.to_string(),
            name: name.to_owned(),
            constants,
        }))
    }

    fn kind(&mut self, name: &str) -> Option<ProvidedKind> {
        self.symbols.provided_kind(name, self.position.scope)
    }

    fn reports(&mut self) -> &mut Reports {
        &mut self.symbols.reports
    }
}
