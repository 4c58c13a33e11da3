//! Merges includes without a name that have the same document, params and bindings. For example, an
//! include of the G-buffer beside a method that includes it too is drawn once.

use super::flat::{Merge, Runs};
use super::scopes::Names;
use crate::diagnostics::Reported;
use crate::document::{Document, Include};
use crate::language::{Leaf, wgsl_identifier};
use crate::param::ParamValue;
use crate::resource::Target;
use crate::shader::{Replaced, Shaders};
use std::collections::{BTreeMap, BTreeSet};
use std::ops::Range;
use std::sync::Arc;

/// Everything that the work of an include depends on: two includes with equal content do the same
/// work and can be merged.
#[derive(PartialEq)]
pub(super) struct Content {
    /// Each path is read once, so equal pointers are equal documents.
    document: *const Document,
    params: Vec<ParamContent>,
    /// Targets that are bound to the inputs of the document, in the order of the inputs.
    pub inputs: Vec<Target>,
    /// Targets of names of the scene that the document asks for; the innermost include that binds a
    /// name decides.
    scene: BTreeMap<String, Target>,
    /// Modules that replace others which its shaders import.
    replaced: Replaced,
    run: Option<Runs>,
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
        (document, asks): (&Arc<Document>, &Asks),
        params: &super::params::Params,
        inputs: &[Reported<Target>],
        scene: BTreeMap<String, Reported<Target>>,
        replaced: &Replaced,
        run: Option<Runs>,
    ) -> Option<Self> {
        let params = params.list.iter().map(|bound| {
            let value = bound.value.clone().ok()?;
            Some((value, bound.root.clone(), bound.roots.clone()))
        });
        let scene = scene.into_iter().filter(|(name, _)| asks.asks_for(name));
        let scene = scene.map(|(name, target)| Some((name, target.ok()?)));
        Some(Self {
            document: Arc::as_ptr(document),
            params: params.collect::<Option<_>>()?,
            inputs: inputs.iter().cloned().collect::<Result<_, _>>().ok()?,
            scene: scene.collect::<Option<_>>()?,
            replaced: (replaced.iter())
                .filter(|(module, _)| asks.modules.contains(*module))
                .map(|(module, is)| (module.clone(), is.clone()))
                .collect(),
            run,
        })
    }
}

/// Names outside of a document that the document and its includes ask for.
#[derive(Debug, Default)]
pub(super) struct Asks {
    /// Globals and overrides of shaders.
    identifiers: BTreeSet<String>,
    /// Names in expressions and bindings.
    paths: BTreeSet<String>,
    /// Paths of imported modules.
    modules: BTreeSet<String>,
    /// True if a pass kind of the host may ask for any name.
    is_open: bool,
}

impl Asks {
    pub fn new(document: &Document, shaders: &Shaders) -> Self {
        let mut asks = Self::default();
        asks.add(document, shaders);
        asks
    }

    fn add(&mut self, document: &Document, shaders: &Shaders) {
        document.visit(&mut |leaf| {
            if let Leaf::Material(reference) = leaf {
                self.paths.insert(reference.path());
            }
        });
        for pass in document.passes() {
            self.is_open |=
                !["Raster", "Fullscreen", "Compute", "Copy", "Clear"].contains(&pass.kind);
            let variants = pass.shaders.iter();
            for shader in variants.flat_map(|shader| shaders.variants(document, shader)) {
                let names = shader.global_names().map(str::to_owned);
                let overrides = shader.overrides().map(|(name, ..)| name.to_owned());
                self.identifiers.extend(names.chain(overrides));
                let lines = shader.source.imports.iter();
                self.modules.extend(lines.map(|line| line.path.to_string()));
            }
        }
        for (_, _, inner) in document.includes() {
            self.add(inner, shaders);
        }
    }

    /// True if the document can ask for the provided resource `name`, its version of the frame
    /// before or its kind.
    fn asks_for(&self, name: &str) -> bool {
        let identifier = wgsl_identifier(name);
        let endings = ["", "_previous", "_kind"];
        let is_in_shader =
            |ending: &&str| self.identifiers.contains(&format!("{identifier}{ending}"));
        let is_path = |path: &String| {
            let rest = path.strip_prefix(name);
            rest.is_some_and(|rest| rest.is_empty() || rest.starts_with('.'))
        };
        self.is_open || endings.iter().any(is_in_shader) || self.paths.iter().any(is_path)
    }
}
