//! Values of params: those of the root document come from the request, those of an included
//! document from the document that includes it.

use crate::adapter_facts::AdapterFacts;
use crate::diagnostics::{ErrorGuaranteed, Reported, Reports};
use crate::document::{ClaimEntry, Document};
use crate::errors::evaluation::EvaluationError;
use crate::errors::instantiate::ParamError;
use crate::expressions::{Environment, eval};
use crate::language::{AdapterFact, Attribute, Expr, Name, Reference, Value, wgsl_identifier};
use crate::param::{Param, ParamValue, find};
use crate::source::{Located, Span};
use std::collections::{BTreeMap, BTreeSet};

/// Entry of a document's section `claims`: a property that the document's author promises of the
/// graph's outputs, under a condition. This crate does not know the meaning of the property; a
/// host, such as a test, checks it.
#[derive(Clone, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub struct Claim {
    /// Name of the property, as the document writes it, such as `exact`.
    pub name: String,
    /// Text of the expression under which the document promises the property; empty if the promise
    /// has no condition.
    pub condition: String,
    /// Reason that the document gives for the promise; may be empty.
    pub because: String,
    /// True if the document promises the property for the params given to
    /// [`Graph::claims`](crate::Graph::claims): the condition is true, or there is none.
    pub holds: bool,
}

/// The params of a document with the values of one plan.
#[derive(Clone, Debug, Default)]
pub(crate) struct Params {
    pub list: Vec<BoundParam>,
}

/// A param with its value.
#[derive(Clone, Debug)]
pub(crate) struct BoundParam {
    pub param: Param,
    pub value: Reported<ParamValue>,
    /// Name of the param of the root document from which the value is taken unchanged, which for a
    /// param of the root document is its own name; `None` if it is not taken from one.
    pub root: Option<String>,
    /// Names of the params of the root document that the value depends on, for a param of the root
    /// document its own name.
    pub roots: BTreeSet<String>,
}

impl BoundParam {
    fn in_expression(&self) -> Reported<Value> {
        let value = self.value.as_ref().map_err(|reported| *reported)?;
        Ok(self.param.value(value))
    }
}

impl Params {
    pub fn bound(&self, name: &str) -> Option<&BoundParam> {
        let mut list = self.list.iter();
        list.find(|bound| bound.param.name.value == name)
    }

    /// Returns the param that a shader finds under this WGSL identifier: of the same name, or with
    /// `_` for the dots of its name. `None` if there is no such param.
    pub fn wgsl_name(&self, identifier: &str) -> Option<&BoundParam> {
        let wgsl_name = |bound: &&BoundParam| wgsl_identifier(&bound.param.name) == identifier;
        self.bound(identifier)
            .or_else(|| self.list.iter().find(wgsl_name))
    }

    /// Returns the values of the params by name, without those that are not valid.
    pub fn values(&self) -> BTreeMap<String, ParamValue> {
        let values = self.list.iter().filter_map(|bound| {
            let value = bound.value.clone().ok()?;
            Some((bound.param.name.value.clone(), value))
        });
        values.collect()
    }

    pub fn names(&self) -> impl Iterator<Item = &str> {
        self.list.iter().map(|bound| bound.param.name.as_str())
    }

    /// Returns the value of the param `name` for an expression, and notes in `reports` that the
    /// plan depends on it; `None` for an unknown name.
    pub fn value(&self, name: &str, reports: &mut Reports) -> Option<Reported<Value>> {
        let bound = self.bound(name)?;
        reports.depend_on(bound.roots.iter());
        Some(bound.in_expression())
    }

    /// Returns the value of a param if the expression is this param alone, without noting that the
    /// plan depends on it; `None` for any other expression.
    pub fn forwarded(&self, expr: &Expr) -> Option<Reported<Value>> {
        Some(self.bound(expr.as_param()?)?.in_expression())
    }

    /// Returns the names of the params of the loaded document that an expression depends on.
    pub fn roots(&self, expr: &Expr) -> BTreeSet<String> {
        let mut roots = BTreeSet::new();
        expr.visit(&mut |leaf| {
            let bound = leaf.named().and_then(|name| self.bound(name));
            roots.extend(bound.iter().flat_map(|bound| bound.roots.clone()));
        });
        roots
    }
}

/// Viewport (width and height in pixels), device features and facts about the adapter, which
/// expressions in defaults and claims can use besides params.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Surroundings {
    pub viewport: [u32; 2],
    pub features: wgt::Features,
    pub adapter: AdapterFacts,
    /// Bytes.
    pub storage_binding: u64,
}

impl Surroundings {
    /// Returns those of an adapter of which only the features are known.
    pub fn of(viewport: [u32; 2], features: wgt::Features) -> Self {
        Self {
            viewport,
            features,
            adapter: AdapterFacts::default(),
            storage_binding: wgt::Limits::default().max_storage_buffer_binding_size,
        }
    }

    pub fn fact(&self, fact: AdapterFact) -> Value {
        match fact {
            AdapterFact::Software => Value::Bool(self.adapter.is_software),
            AdapterFact::SubgroupSize => Value::whole(self.adapter.subgroup_size),
            AdapterFact::StorageBinding => {
                Value::whole(i64::try_from(self.storage_binding).unwrap_or(i64::MAX))
            }
        }
    }
}

/// Environment for defaults and claims: only params, the viewport and features have values.
struct ParamsAlone<'a> {
    params: &'a Params,
    context: Surroundings,
    reports: &'a mut Reports,
}

impl Environment for ParamsAlone<'_> {
    fn viewport(&self) -> [u32; 2] {
        self.context.viewport
    }

    fn has(&self, feature: wgt::Features) -> bool {
        self.context.features.contains(feature)
    }

    fn adapter(&self, fact: AdapterFact) -> Value {
        self.context.fact(fact)
    }

    fn param(&mut self, name: &str, span: &Span) -> Reported<Value> {
        match self.params.value(name, self.reports) {
            Some(value) => value,
            None => {
                let names = self.reports.known(self.params.names());
                Err(self.report(EvaluationError::param(name, span, |_| false, names)))
            }
        }
    }

    fn is_param(&self, name: &str) -> bool {
        self.params.bound(name).is_some()
    }

    fn index(&mut self, entry: Option<&Name>, span: &Span) -> Reported<u32> {
        Err(self.report(EvaluationError::no_index(span, entry)))
    }

    fn attribute(&mut self, material: &Reference, _: Attribute, span: &Span) -> Reported<Value> {
        let name = material.text().to_owned();
        Err(self.report(EvaluationError::NoSizes(span.clone(), name)))
    }

    fn constant(&mut self, _: &str, span: &Span) -> Reported<Value> {
        Err(self.report(EvaluationError::NoShader(span.clone())))
    }

    fn reports(&mut self) -> &mut Reports {
        self.reports
    }
}

/// Evaluates the default of a param. Exposed params are evaluated before declared ones, so `params`
/// may lack the later ones.
fn default(
    params: &Params,
    param: &Param,
    context: Surroundings,
    reports: &mut Reports,
) -> Reported<ParamValue> {
    let Some(default) = &param.default else {
        return Ok(param.stand_in());
    };
    if let Some(word) = default.as_param()
        && params.bound(word).is_none()
        && param.words().any(|choice| **choice == *word)
    {
        let (word, span) = (word.to_owned(), default.span.clone());
        return Err(reports.report(ParamError::QuotedWord(word, span)));
    }
    let mut environment = ParamsAlone {
        params,
        context,
        reports,
    };
    let value = eval::value(default, &mut environment)?;
    param.convert(&value).map_err(|why| {
        reports.report(ParamError::Default {
            param: Located::new(param.name.value.clone(), default.span.clone()),
            why,
        })
    })
}

/// Returns the params of a document in the order in which their values are found: exposed ones
/// first.
fn in_order(document: &Document) -> impl Iterator<Item = &Param> {
    let (declared, exposed) = document.params.split_at(document.declared);
    exposed.iter().chain(declared)
}

/// Value to which an include sets a param.
pub(crate) struct SetParam {
    pub expr: Located<Expr>,
    pub value: Reported<Value>,
    /// Names of the params of the loaded document that the value depends on.
    pub roots: BTreeSet<String>,
}

/// Settings from which the params of an included document get their values.
pub(crate) struct Given<'a> {
    /// Name under which the including document exposes each exposed param of the included one, by
    /// name there: with the include's name in front, if the include has a name.
    pub exposed: BTreeMap<&'a str, String>,
    /// Params of the including document, with their values.
    pub outer: &'a Params,
    /// Place of the include, for messages.
    pub span: &'a Span,
    pub context: Surroundings,
}

/// Reports that a param is handed, at a place, to one that does not hold all of its values.
fn misfit(param: &Param, outer: &BoundParam, at: &Span, reports: &mut Reports) -> ErrorGuaranteed {
    reports.report(ParamError::Misfit {
        name: Located::new(param.name.value.clone(), at.clone()),
        outer: Box::new(outer.param.clone()),
        param: Box::new(param.clone()),
    })
}

impl Given<'_> {
    /// Returns the params of an included document with their values: exposed ones first, then those
    /// that the document declares. `set` holds the values that the include sets, by name of the
    /// param.
    pub fn bind(
        &self,
        document: &Document,
        set: &BTreeMap<String, SetParam>,
        reports: &mut Reports,
    ) -> Params {
        let mut params = Params::default();
        for param in in_order(document) {
            let bound = match set.get(&param.name.value) {
                Some(given) => self.set(param, given, reports),
                None => self.unset(document, param, &params, reports),
            };
            params.list.push(bound);
        }
        params
    }

    fn set(
        &self,
        param: &Param,
        SetParam { expr, value, roots }: &SetParam,
        reports: &mut Reports,
    ) -> BoundParam {
        let source = expr.value.as_param();
        let source = source.and_then(|name| self.outer.bound(name));
        let narrow = source.filter(|source| !param.holds_all_of(&source.param));
        let value = match (value, narrow) {
            (Err(reported), _) => Err(*reported),
            (Ok(_), Some(source)) => Err(misfit(param, source, &expr.span, reports)),
            (Ok(value), None) => param.convert(value).map_err(|why| {
                reports.report(ParamError::Set {
                    name: Located::new(param.name.value.clone(), expr.span.clone()),
                    declared: param.name.span.clone(),
                    why,
                })
            }),
        };
        BoundParam {
            param: param.clone(),
            value,
            root: source.and_then(|source| source.root.clone()),
            roots: roots.clone(),
        }
    }

    /// Returns the value of a param that the include does not set: that of a param of the outer
    /// document, if it is exposed there or has no default, or else its own default.
    fn unset(
        &self,
        document: &Document,
        param: &Param,
        params: &Params,
        reports: &mut Reports,
    ) -> BoundParam {
        let name = param.name.as_str();
        let outer = match self.exposed.get(name) {
            // Another param of that name was told where it is exposed.
            Some(exposed) => {
                let outer = self.outer.bound(exposed);
                outer.filter(|outer| outer.param.name.span == param.name.span)
            }
            None if param.default.is_none() => self.outer.bound(name),
            None => None,
        };
        let mut bound = BoundParam {
            param: param.clone(),
            value: Ok(param.stand_in()),
            root: None,
            roots: BTreeSet::new(),
        };
        match outer {
            Some(outer) if !param.holds_all_of(&outer.param) => {
                bound.value = Err(misfit(param, outer, self.span, reports));
            }
            Some(outer) => {
                bound.value = outer.value.clone();
                bound.root.clone_from(&outer.root);
                bound.roots.clone_from(&outer.roots);
            }
            None if param.default.is_none() => {
                bound.value = Err(reports.report(ParamError::Required {
                    name: name.to_owned(),
                    document: document.file.name.to_string(),
                    span: self.span.clone(),
                    declared: param.name.span.clone(),
                }));
            }
            None => {
                bound.value = default(params, param, self.context, reports);
                let roots = param.default.as_ref().map(|default| params.roots(default));
                bound.roots = roots.unwrap_or_default();
            }
        }
        bound
    }
}

/// Returns the params of the root document with their values, after checking the values in `asked`.
pub(crate) fn checked(
    document: &Document,
    asked: &BTreeMap<String, ParamValue>,
    context: Surroundings,
    reports: &mut Reports,
) -> Reported<Params> {
    let mut wrong = None;
    for (name, value) in asked {
        let mistake = match find(&document.params, name, &document.file.name) {
            Ok(param) => param.check(value).err().map(|why| ParamError::Asked {
                name: Located::new(name.clone(), param.name.span.clone()),
                value: value.clone(),
                why,
            }),
            Err(error) => Some(ParamError::Unknown(error.to_string())),
        };
        wrong = mistake.map(|mistake| reports.report(mistake)).or(wrong);
    }
    let mut params = Params::default();
    for param in in_order(document) {
        let name = &param.name.value;
        let value = match asked.get(name) {
            Some(value) => Ok(value.clone()),
            None => default(&params, param, context, reports),
        };
        wrong = wrong.or(value.as_ref().err().copied());
        params.list.push(BoundParam {
            param: param.clone(),
            value,
            root: Some(name.clone()),
            roots: BTreeSet::from([name.clone()]),
        });
    }
    wrong.map_or(Ok(params), Err)
}

/// Returns the claims of a document for these values of params.
pub(crate) fn claims(
    document: &Document,
    asked: &BTreeMap<String, ParamValue>,
    context: Surroundings,
    reports: &mut Reports,
) -> Vec<Claim> {
    let mut claims = Vec::new();
    if let Ok(params) = checked(document, asked, context, reports) {
        for (name, ClaimEntry(claim)) in &document.claims {
            let mut environment = ParamsAlone {
                params: &params,
                context,
                reports,
            };
            let condition = claim.condition.as_ref();
            let holds = condition.map_or(Ok(true), |c| eval::boolean(c, &mut environment));
            claims.extend(holds.ok().map(|holds| Claim {
                name: name.value.clone(),
                condition: condition.map_or("", |c| c.text()).to_owned(),
                because: claim.because.clone(),
                holds,
            }));
        }
    }
    claims
}
