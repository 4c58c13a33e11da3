//! Merges includes without a name that have the same document, params and bindings. For example, an
//! include of the G-buffer beside a method that includes it too is drawn once.

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

/// Everything that the work of an include depends on: two includes with equal content do the same
/// work and can be merged.
#[derive(PartialEq)]
pub(super) struct Content {
    /// Each path is read once, so equal pointers are equal documents.
    document: *const Document,
    params: Vec<ParamContent>,
    /// Targets that are bound to the inputs of the document, in the order of the inputs.
    pub inputs: Vec<Target>,
    /// Targets of names of the scene; the innermost include that binds a name decides.
    scene: BTreeMap<String, Target>,
    replaced: Replaced,
    run: Option<(Run, Vec<bool>)>,
}

/// Value of a param, the param of the root document that it is (if any), and the params of the root
/// document that it depends on.
type ParamContent = (ParamValue, Option<String>, BTreeSet<String>);

/// An include that later includes of the same content are merged into.
pub(super) struct Site {
    pub content: Content,
    /// Names that the include gives to the including document.
    pub names: Names,
    /// Number of passes of the graph up to the end of the include, its own included.
    pub end: usize,
    /// Indices, in the list of the plan's resources, of those that the include declares.
    pub owned: Range<usize>,
}

impl Site {
    /// Returns the merge of a later include with the same content, above which there are `passes`
    /// passes.
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
    /// Creates the content of an include; `None` if a part of it has a mistake.
    pub fn new(
        document: &Arc<Document>,
        params: &super::params::Params,
        inputs: &[Reported<Target>],
        scene: BTreeMap<String, Reported<Target>>,
        replaced: &Replaced,
        run: Option<(Run, Vec<bool>)>,
    ) -> Option<Self> {
        let params = params.list.iter().map(|bound| {
            let value = bound.value.clone().ok()?;
            Some((value, bound.root.clone(), bound.roots.clone()))
        });
        let scene = scene.into_iter();
        let scene = scene.map(|(name, target)| Some((name, target.ok()?)));
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
