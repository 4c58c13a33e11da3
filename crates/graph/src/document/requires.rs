//! `requires`: features of the device that a document cannot do without, or has an answer for.

use super::{
    located::Located,
    params::{Param, ParamValue, Written},
    value::Map,
};
use crate::diagnostics::{Code, Diagnostic};
use serde::Deserialize;

/// A requirement as the document writes it.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct RequireEntry {
    feature: Located<String>,
    #[serde(default)]
    fallback: Option<Map<Located<Written>>>,
}

/// A feature of the device, and the values that params get where it is missing.
#[derive(Clone, Debug)]
pub(crate) struct Requirement {
    pub feature: Located<String>,
    pub flag: wgpu::Features,
    /// `None`: there is no way without it.
    pub fallback: Option<Vec<(Located<String>, ParamValue)>>,
}

impl RequireEntry {
    /// Looks the feature and the params up; unknown params are no mistake where some of them could not be read.
    pub fn resolve(
        self,
        params: &[Param],
        some_are_broken: bool,
    ) -> Result<Requirement, Diagnostic> {
        let Some(flag) = wgpu::Features::from_name(&self.feature) else {
            let known = wgpu::Features::all();
            return Err(Diagnostic::error(
                Code::Feature,
                format!("wgpu has no feature `{}`", *self.feature),
            )
            .at(self.feature.span.clone(), "")
            .suggest(&self.feature, known.iter_names().map(|(name, _)| name)));
        };
        let Some(fallback) = self.fallback else {
            return Ok(Requirement {
                feature: self.feature,
                flag,
                fallback: None,
            });
        };
        let mut values = Vec::new();
        for (name, written) in fallback.unique("given")? {
            let Some(param) = params.iter().find(|param| param.name.value == *name) else {
                if some_are_broken {
                    continue;
                }
                return Err(Diagnostic::error(
                    Code::UnknownParam,
                    format!("no param is called `{}`", *name),
                )
                .at(name.span.clone(), "")
                .suggest(&name, params.iter().map(|param| param.name.as_str())));
            };
            let value = param.read(&written).map_err(|why| {
                Diagnostic::error(
                    Code::ParamValue,
                    format!("the fallback of param `{}` does not fit", *name),
                )
                .at(written.span.clone(), why)
                .at(param.name.span.clone(), "declared here")
            })?;
            values.push((name, value));
        }
        Ok(Requirement {
            feature: self.feature,
            flag,
            fallback: Some(values),
        })
    }
}
