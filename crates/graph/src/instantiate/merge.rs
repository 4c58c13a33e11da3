//! Includes without a name whose document, params and bindings equal another's are that one: a step
//! over a method includes the G-buffer beside it, and it is drawn once.

use super::{
    flat::{Merge, Run},
    scopes::Names,
};
use crate::{
    diagnostics::reports::Reported,
    document::typed::{Document, Include},
    param::ParamValue,
    resource::Target,
    shader::expand::Replaced,
};
use std::{
    collections::{BTreeMap, BTreeSet},
    ops::Range,
    sync::Arc,
};

/// All that decides what an include does.
#[derive(PartialEq)]
pub(super) struct Content {
    /// Documents are read once each, so two of one path are one.
    document: *const Document,
    params: Vec<ParamContent>,
    pub inputs: Vec<Target>,
    /// Targets of names of the scene; the nearest one counts.
    scene: BTreeMap<String, Target>,
    replaced: Replaced,
    run: Option<(Run, bool)>,
}

/// A param's value, the param of the root document that it is, and those that it is made of.
type ParamContent = (ParamValue, Option<String>, BTreeSet<String>);

/// An include that others may be.
pub(super) struct Site {
    pub content: Content,
    pub names: Names,
    /// Number of passes above its end.
    pub end: usize,
    /// The resources that were declared in it.
    pub owned: Range<usize>,
}

impl Site {
    /// Notes that another include of the same content stands behind so many passes.
    pub fn merge(&self, passes: usize, include: &Include) -> Merge {
        Merge {
            between: self.end..passes,
            inputs: self.content.inputs.iter().map(|target| target.id).collect(),
            owned: self.owned.clone(),
            graph: include.graph.value.clone(),
            span: include.graph.span.clone(),
        }
    }
}

impl Content {
    /// `None` where something in it is wrong.
    pub fn new(
        document: &Arc<Document>,
        params: &super::params::Params,
        inputs: &[Reported<Target>],
        scene: BTreeMap<String, Reported<Target>>,
        replaced: &Replaced,
        run: Option<(Run, bool)>,
    ) -> Option<Self> {
        let params = params.list.iter().map(|bound| {
            let value = bound.value.clone().ok()?;
            Some((value, bound.root.clone(), bound.roots.clone()))
        });
        let scene = scene
            .into_iter()
            .map(|(name, target)| Some((name, target.ok()?)));
        Some(Self {
            document: Arc::as_ptr(document),
            params: params.collect::<Option<_>>()?,
            inputs: inputs.iter().cloned().collect::<Result<_, _>>().ok()?,
            scene: scene.collect::<Option<_>>()?,
            replaced: replaced.clone(),
            run,
        })
    }
}
