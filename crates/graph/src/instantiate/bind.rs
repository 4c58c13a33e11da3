//! Values of params: the root's from the request, an included document's from the including one, fallbacks for features
//! that are missing.

use super::{Builder, Fallback, ScopeId};
use crate::{
    diagnostics::{Code, Diagnostic, Severity},
    document::{
        Document, IncludeEntry,
        located::Located,
        params::{Param, ParamType, ParamValue},
        value::Value,
    },
    registry::{Asked, BoundParam, Params},
};
use std::{collections::BTreeMap, sync::Arc};

/// The params of the root document.
pub(super) fn root(declared: &[Param], values: &BTreeMap<String, ParamValue>) -> Params {
    let bound = |param: &Param| {
        let asked = values.get(param.name.as_str());
        BoundParam {
            param: param.clone(),
            value: asked.unwrap_or(&param.default).clone(),
            root: Some(param.name.value.clone()),
            asked: asked.map(|_| Asked::Request),
        }
    };
    Params {
        list: declared.iter().map(bound).collect(),
    }
}

/// Whether every value of the one is a value of the other.
fn agree(inner: &ParamType, outer: &ParamType) -> bool {
    match (inner, outer) {
        (ParamType::Choice(inner), ParamType::Choice(outer)) => {
            outer.iter().all(|word| inner.contains(word))
        }
        _ => inner == outer,
    }
}

impl Builder<'_, '_> {
    /// The params of an included document.
    pub(super) fn bind(
        &mut self,
        include: &IncludeEntry,
        document: &Document,
        scope: ScopeId,
    ) -> Params {
        let outer = Arc::clone(&self.scopes.get(scope).params);
        for (name, _) in &include.params {
            if document.params.iter().all(|param| *param.name != **name) {
                let error = Diagnostic::error(
                    Code::UnknownParam,
                    format!("`{}` has no param `{}`", document.file.name, **name),
                );
                let error = error.at(name.span.clone(), "");
                let found = self.diagnostics.len();
                self.diagnostics.push(error.suggest_to(found, name, || {
                    document.params.iter().map(|param| param.name.as_str())
                }));
            }
        }
        let mut list = Vec::new();
        for param in &document.params {
            let mut bound = BoundParam {
                param: param.clone(),
                value: param.default.clone(),
                root: None,
                asked: None,
            };
            let given = include
                .params
                .iter()
                .find(|(name, _)| **name == *param.name.value);
            if let Some((_, given)) = given
                && let Err(error) = give(&mut bound, given, &outer, self.diagnostics.len())
            {
                self.diagnostics.push(error);
            }
            list.push(bound);
        }
        Params { list }
    }

    /// Gives params their fallback values where the device lacks a feature.
    pub(super) fn require(&mut self, document: &Document, params: &mut Params, prefix: &str) {
        let Some(features) = self.features else {
            return;
        };
        for requirement in &document.requires {
            if features.contains(requirement.flag) {
                continue;
            }
            let lacking = |what: String| {
                Diagnostic::error(Code::Feature, what).at(
                    requirement.feature.span.clone(),
                    "the device does not have this feature",
                )
            };
            let feature = &requirement.feature.value;
            let Some(fallback) = &requirement.fallback else {
                self.diagnostics.push(
                    lacking(format!(
                        "`{}` cannot run without the feature `{feature}`",
                        document.file.name
                    ))
                    .help("run it on an adapter that has the feature, or give a `fallback: {\"param\": value}` that does without it"),
                );
                continue;
            };
            for (name, value) in fallback {
                let bound = params
                    .list
                    .iter_mut()
                    .find(|bound| bound.param.name.value == **name);
                let Some(bound) = bound.filter(|bound| bound.value != *value) else {
                    continue;
                };
                if let Some(asked) = &bound.asked {
                    let message = format!(
                        "param `{}` = {} needs the feature `{feature}`",
                        **name, bound.value
                    );
                    let error = match asked {
                        Asked::Request => lacking(message),
                        Asked::Include(span) => {
                            lacking(message).at(span.clone(), "this value is asked for here")
                        }
                    };
                    self.diagnostics
                        .push(error.help(format!("without it, the value must be {value}")));
                    continue;
                }
                let fallback = Fallback {
                    feature: feature.clone(),
                    param: format!("{prefix}{}", **name),
                    instead_of: std::mem::replace(&mut bound.value, value.clone()),
                    value: value.clone(),
                };
                let message = format!(
                    "param `{}` is {value} instead of {}",
                    fallback.param, fallback.instead_of
                );
                self.diagnostics.push(Diagnostic {
                    severity: Severity::Warning,
                    ..lacking(message)
                });
                self.fallbacks.push(fallback);
            }
        }
    }
}

/// Gives an included document's param the value that the including document says.
fn give(
    bound: &mut BoundParam,
    given: &Located<Value<crate::document::params::Written>>,
    outer: &Params,
    found: usize,
) -> Result<(), Diagnostic> {
    let param = &bound.param;
    let does_not_fit = |why: String| {
        Diagnostic::error(
            Code::ParamValue,
            format!("the value for param `{}` does not fit", *param.name),
        )
        .at(given.span.clone(), why)
        .at(
            param.name.span.clone(),
            format!("declared {} here", param.ty),
        )
    };
    match &given.value {
        Value::Literal(written) => {
            bound.value = param.read(written).map_err(does_not_fit)?;
            bound.asked = Some(Asked::Include(given.span.clone()));
        }
        Value::Param(name) => {
            let Some(source) = outer.bound(name) else {
                return Err(Diagnostic::error(
                    Code::UnknownParam,
                    format!("no param is called `{}`", **name),
                )
                .at(name.span.clone(), "")
                .suggest_to(found, name, || outer.names()));
            };
            if !agree(&param.ty, &source.param.ty) {
                let ty = &source.param.ty;
                return Err(does_not_fit(format!("this param is of type {ty}")).at(
                    source.param.name.span.clone(),
                    format!("declared {ty} here"),
                ));
            }
            param.check(&source.value).map_err(does_not_fit)?;
            bound.value = source.value.clone();
            bound.root.clone_from(&source.root);
            bound.asked.clone_from(&source.asked);
        }
    }
    Ok(())
}
