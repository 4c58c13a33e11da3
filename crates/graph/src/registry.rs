//! Pass kinds: an open set. A kind is a type that deserialises its own body and lowers it to [`Step`]s.

use crate::{
    diagnostics::{Code, Diagnostic},
    document::{
        located::{Field, Located, from_fields},
        params::{Param, ParamValue},
        value::Value,
    },
    passes::{Clear, Compute, Copy, Fullscreen, Raster},
    source::Span,
    step::{Program, Step},
};
use serde::de::DeserializeOwned;
use std::{fmt, sync::Arc};

/// The body of a pass of some kind. Its fields are what the RON entry holds beside `name`, `shader`, `bind`,
/// `run`, `overwrites` and `repeat`.
pub trait PassKind: fmt::Debug + Send + Sync {
    /// Says which GPU work the pass is, in order. Called without a GPU, more than once; it must depend on nothing but the
    /// body and the params, and the shaders it names must not depend on params.
    fn lower(&self, pass: &mut Lowering<'_>);
}

/// What a [`PassKind`] lowers with: the pass's name, shader and params in, steps and diagnostics out.
#[derive(Debug)]
pub struct Lowering<'a> {
    pub(crate) name: &'a Located<String>,
    pub(crate) shader: Option<&'a Located<String>>,
    pub(crate) bind: &'a [(Located<String>, Located<String>)],
    pub(crate) params: &'a Params,
    pub(crate) steps: Vec<Step>,
    pub(crate) scratch: Vec<(String, u64)>,
    pub(crate) diagnostics: Vec<Diagnostic>,
}

impl Lowering<'_> {
    /// The pass's name with its place in the document.
    pub fn name(&self) -> &Located<String> {
        self.name
    }

    /// The program of the pass's own shader (its `shader` field, else its name) with the bindings the document gives.
    pub fn program(&self) -> Program {
        let shader = self.shader.unwrap_or(self.name).clone();
        Program {
            shader: Some(shader),
            bind: self.bind.to_vec(),
            ..Program::default()
        }
    }

    /// The program of a shader that comes with the pass kind.
    pub fn program_of(&self, shader: &str) -> Program {
        Program {
            shader: Some(self.named(shader)),
            bind: self.bind.to_vec(),
            ..Program::default()
        }
    }

    /// A name that the kind itself gives; errors about it point at the pass.
    pub fn named(&self, name: &str) -> Located<String> {
        Located::new(name.to_owned(), self.name.span.clone())
    }

    /// Adds a buffer of `bytes` that only this pass uses, and returns its name.
    pub fn scratch(&mut self, name: &str, bytes: u64) -> Located<String> {
        let name = format!("{}.{name}", self.name.value);
        self.scratch.push((name.clone(), bytes));
        self.named(&name)
    }

    /// Appends a step.
    pub fn step(&mut self, step: Step) {
        self.steps.push(step);
    }

    /// Reports a mistake in the body.
    pub fn report(&mut self, diagnostic: Diagnostic) {
        self.diagnostics.push(diagnostic);
    }

    /// The value behind a literal or a param; a param of the wrong type is reported, and `fallback` returned.
    pub fn value<T: FromParam>(&mut self, value: &Value<T>, fallback: T) -> T {
        self.params
            .value(value, &mut self.diagnostics)
            .unwrap_or(fallback)
    }
}

/// The params of a document with the values of one plan.
#[derive(Clone, Debug, Default)]
pub struct Params {
    pub(crate) list: Vec<BoundParam>,
}

/// A param with its value.
#[derive(Clone, Debug)]
pub(crate) struct BoundParam {
    pub param: Param,
    pub value: ParamValue,
    /// The param of the root document whose value this is; an included document may have been given a value of its own.
    pub root: Option<String>,
    /// Where the value was asked for: it is not the default, nor that of a fallback.
    pub asked: Option<Asked>,
}

/// Who asked for a param's value.
#[derive(Clone, Debug)]
pub(crate) enum Asked {
    /// The host, or the user on the command line.
    Request,
    /// An including document, at this place.
    Include(Span),
}

impl Params {
    /// The declaration and the value of a param.
    pub fn get(&self, name: &str) -> Option<(&Param, &ParamValue)> {
        let bound = self.bound(name)?;
        Some((&bound.param, &bound.value))
    }

    pub(crate) fn bound(&self, name: &str) -> Option<&BoundParam> {
        self.list
            .iter()
            .find(|bound| bound.param.name.value == name)
    }

    pub(crate) fn names(&self) -> impl Iterator<Item = &str> {
        self.list.iter().map(|bound| bound.param.name.as_str())
    }

    pub(crate) fn value<T: FromParam>(
        &self,
        value: &Value<T>,
        diagnostics: &mut Vec<Diagnostic>,
    ) -> Option<T> {
        let name = match value {
            Value::Literal(literal) => return Some(literal.clone()),
            Value::Param(name) => name,
        };
        let Some((param, value)) = self.get(name) else {
            let error = Diagnostic::error(
                Code::UnknownParam,
                format!("no param is called `{}`", name.value),
            );
            let error = error.at(name.span.clone(), "");
            diagnostics.push(error.suggest_to(diagnostics.len(), name, || self.names()));
            return None;
        };
        let converted = T::from_param(param, value);
        if converted.is_none() {
            diagnostics.push(
                Diagnostic::error(
                    Code::ParamValue,
                    format!("param `{}` ({}) cannot stand here", name.value, param.ty),
                )
                .at(name.span.clone(), format!("{} is needed", T::EXPECTED))
                .at(param.name.span.clone(), "declared here"),
            );
        }
        converted
    }
}

/// A type that a param's value can be turned into.
pub trait FromParam: Clone {
    /// What is needed, for messages.
    const EXPECTED: &'static str;

    /// The value, or `None` if the param's type does not fit.
    fn from_param(param: &Param, value: &ParamValue) -> Option<Self>;
}

impl FromParam for u32 {
    const EXPECTED: &'static str = "an unsigned integer";
    fn from_param(param: &Param, value: &ParamValue) -> Option<Self> {
        param.as_u32(value)
    }
}

impl FromParam for f32 {
    const EXPECTED: &'static str = "a number";
    fn from_param(_: &Param, value: &ParamValue) -> Option<Self> {
        match value {
            ParamValue::F32(value) => Some(*value),
            ParamValue::U32(value) => Some(*value as f32),
            ParamValue::I32(value) => Some(*value as f32),
            _ => None,
        }
    }
}

impl FromParam for bool {
    const EXPECTED: &'static str = "a Bool";
    fn from_param(_: &Param, value: &ParamValue) -> Option<Self> {
        match value {
            ParamValue::Bool(value) => Some(*value),
            _ => None,
        }
    }
}

/// How an entry of a kind is read.
type Parse = fn(&[Field], &Span) -> Result<Arc<dyn PassKind>, Diagnostic>;

pub(crate) struct Kind {
    pub name: &'static str,
    pub parse: Parse,
}

/// The pass kinds that documents may use.
#[derive(Default)]
pub struct Registry {
    kinds: Vec<Kind>,
}

impl Registry {
    /// `Raster`, `Fullscreen`, `Compute`, `Copy` and `Clear`.
    pub fn standard() -> Self {
        let mut registry = Self::default();
        registry.register::<Raster>("Raster");
        registry.register::<Fullscreen>("Fullscreen");
        registry.register::<Compute>("Compute");
        registry.register::<Copy>("Copy");
        registry.register::<Clear>("Clear");
        registry
    }

    /// Adds a kind under the tag that documents write; a kind of that tag that is already there is replaced. `Include` and
    /// `Group` are no kinds and stay what they are.
    pub fn register<K: PassKind + DeserializeOwned + 'static>(&mut self, tag: &'static str) {
        self.kinds.retain(|kind| kind.name != tag);
        let parse: Parse = |fields, whole| Ok(Arc::new(from_fields::<K>(fields, whole)?));
        self.kinds.push(Kind { name: tag, parse });
    }

    pub(crate) fn get(&self, tag: &str) -> Option<&Kind> {
        self.kinds.iter().find(|kind| kind.name == tag)
    }

    pub(crate) fn kinds(&self) -> impl Iterator<Item = &str> {
        self.kinds.iter().map(|kind| kind.name)
    }
}

impl fmt::Debug for Registry {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_list().entries(self.kinds()).finish()
    }
}
