//! [`Graph`]: a document with its shaders, ready to be planned.

use crate::{
    compose::{
        loaded::Loaded,
        reader::{Reader, label},
    },
    diagnostics::{diagnostic::Diagnostic, list::Diagnostics, reports::Reports},
    document::flat::{flat, keep},
    instantiate::params::{Claim, Surroundings, checked, claims},
    kinds::registry::Registry,
    language::name::Name,
    param::{Param, ParamError, ParamValue},
    plan::{check::check, plan::Plan},
    request::PlanRequest,
    source::{sources::Sources, span::Located},
};
use std::{collections::BTreeMap, sync::Arc};

/// A graph loaded from a document: its materials and passes, with every shader that the passes
/// name. Loading touches no GPU.
///
/// Clones share their content and are cheap.
#[derive(Clone, Debug)]
pub struct Graph(Arc<Loaded>);

impl Graph {
    /// Loads the document at `path` and every shader that it names from `sources`, and parses and
    /// validates all WGSL. `registry` holds the pass kinds that the document may use.
    ///
    /// # Errors
    /// All mistakes in the document and its shaders that can be found without sizes and a device.
    pub fn load(
        path: &str,
        registry: &Registry,
        sources: &dyn Sources,
    ) -> Result<Self, Diagnostics> {
        Self::load_over(path, registry, sources, &BTreeMap::new())
    }

    /// Loads the document at `path` as [`Graph::load`] does, with other documents in place of its
    /// open includes (`Include(open: "over", …)`). `chosen` maps the name of an open include
    /// ([`Graph::openings`]) to the path of the document to include instead.
    ///
    /// # Errors
    /// The mistakes that [`Graph::load`] reports, and a name in `chosen` that no open include of
    /// the document has.
    pub fn load_over(
        path: &str,
        registry: &Registry,
        sources: &dyn Sources,
        chosen: &BTreeMap<String, String>,
    ) -> Result<Self, Diagnostics> {
        let (loaded, errors) = Loaded::read(path, registry, sources, chosen)?;
        if errors.is_empty() {
            Ok(Self(Arc::new(loaded)))
        } else {
            Err(loaded.diagnostics(errors))
        }
    }

    /// Plans the graph: resolves names and sizes, links shaders, orders the passes and drops those
    /// that no output needs. Touches no GPU.
    ///
    /// # Errors
    /// All mistakes found while planning, each with its place in a document or shader.
    pub fn plan(&self, request: &PlanRequest<'_>) -> Result<Plan, Diagnostics> {
        Plan::new(&self.0, request)
    }

    /// Loads and plans the document at `path` and reports all mistakes at once. The readable part
    /// of a document is planned even if another part is wrong. The graph is also planned once for
    /// each other value of each param and feature in an `if`, changed one at a time. For an input
    /// that the request does not import, the check assumes the texture, buffer or sampler that the
    /// document asks for.
    ///
    /// # Errors
    /// All mistakes of loading and planning. Reads before writes, and cycles, are only reported for
    /// passes above the first pass with a mistake.
    pub fn check(
        path: &str,
        registry: &Registry,
        sources: &dyn Sources,
        request: &PlanRequest<'_>,
    ) -> Result<(Self, Plan), Diagnostics> {
        let (loaded, errors) = Loaded::read(path, registry, sources, &BTreeMap::new())?;
        let loaded = Arc::new(loaded);
        let plan = check(&loaded, errors, request)?;
        Ok((Self(loaded), plan))
    }

    /// Returns the document at `path` as one text, with everything that it extends merged in. A
    /// comment at the end of a line names the file and line that it comes from. The text loads as
    /// the document does. Params, values, inputs and materials that nothing uses are left out,
    /// unless the document has mistakes.
    ///
    /// # Errors
    /// Mistakes in the syntax of one of the documents, or in an edit that one makes to another.
    pub fn flat(
        path: &str,
        registry: &Registry,
        sources: &dyn Sources,
    ) -> Result<String, Diagnostics> {
        let mut reports = Reports::default();
        let chosen = BTreeMap::new();
        let mut reader = Reader::new(registry, sources, &chosen, &mut reports);
        let document = reader.flat(path);
        let asked = std::mem::take(&mut reader.include_sites);
        match document {
            Ok(mut document) if reports.errors() == 0 => {
                if let Ok((loaded, errors)) = Loaded::read(path, registry, sources, &chosen)
                    && errors.is_empty()
                {
                    keep(&mut document, &loaded.document);
                }
                Ok(flat(&document))
            }
            _ => {
                let mut list = reports.into_list();
                label(&mut list, path, &asked);
                Err(Diagnostics::new(list))
            }
        }
    }

    /// Returns the path that the document was loaded from.
    pub fn path(&self) -> &str {
        self.0.path()
    }

    /// Returns the `description` of the document; empty if it has none.
    pub fn description(&self) -> &str {
        &self.0.document.description
    }

    /// Returns the params of the graph: those that the document declares, then those of included
    /// documents that it exposes.
    pub fn params(&self) -> &[Param] {
        &self.0.document.params
    }

    /// Returns the names of the outputs that are textures or buffers, those on request and those
    /// whose conditions are false included.
    pub fn outputs(&self) -> Vec<&str> {
        let outputs = self.0.document.material_outputs();
        outputs.map(|output| output.name.as_str()).collect()
    }

    /// Returns the names of the outputs that a host gets without naming them: those of
    /// [`Graph::outputs`] that are not `on_request`.
    pub fn default_outputs(&self) -> Vec<&str> {
        let outputs = self.0.document.material_outputs();
        let outputs = outputs.filter(|output| !output.on_request);
        outputs.map(|output| output.name.as_str()).collect()
    }

    /// Returns the words of the document's section `lights`: the kinds of light that the method
    /// takes, each with its place. The graph does not know their meaning. If the section is empty,
    /// the method takes the first kind that the provider knows.
    pub fn lights(&self) -> impl Iterator<Item = &Located<Name>> {
        self.0.document.lights.iter()
    }

    /// Returns the words of the document's section `proven_on`: names of backends that lack part of
    /// WebGPU ([`PartialBackend`](crate::PartialBackend)), on which the graph is known to be right.
    pub fn proven_on(&self) -> impl Iterator<Item = &Located<Name>> {
        self.0.document.proven_on.iter()
    }

    /// Returns the open includes of the document, which [`Graph::load_over`] can replace: pairs of
    /// the include's name and the path of the document that it includes now.
    pub fn openings(&self) -> impl Iterator<Item = (&str, &str)> {
        let openings = self.0.document.openings();
        openings.map(|(name, include)| (name.as_str(), include.graph.as_str()))
    }

    /// Returns the names of the document's inputs, for which the host must put an import into
    /// [`PlanRequest::imports`](crate::Request::imports).
    pub fn inputs(&self) -> Vec<&str> {
        let inputs = self.0.document.inputs.iter();
        inputs.map(|input| input.name.as_str()).collect()
    }

    /// Returns every device feature that the document or an included document requires, asks for by
    /// `has`, or can make use of in a pass. A device with all of these that its adapter offers runs
    /// the graph as well as that adapter can.
    pub fn features(&self) -> wgt::Features {
        self.0.features()
    }

    /// Returns the warnings that loading the document gave.
    pub fn warnings(&self) -> &[Diagnostic] {
        &self.0.warnings
    }

    /// Reads the value of the param `name` from text as the command line writes it: `1024`, `0.5`,
    /// `true`, `front`, `1,2,3`.
    ///
    /// # Errors
    /// If the graph has no param of this name, or the value has the wrong type or is out of range.
    pub fn parse_param(&self, name: &str, text: &str) -> Result<ParamValue, ParamError> {
        let param = self.0.param(name)?;
        param.parse(text).map_err(|why| ParamError::Value {
            graph: self.path().to_owned(),
            name: name.to_owned(),
            why,
        })
    }

    /// Returns the value of every param by name: the value in `asked`, or else the param's default
    /// for a viewport of this width and height in pixels on a device with these features.
    ///
    /// # Errors
    /// If `asked` names a param that the graph does not have, or a value has the wrong type or is
    /// out of range.
    pub fn values(
        &self,
        asked: &BTreeMap<String, ParamValue>,
        viewport: [u32; 2],
        features: wgt::Features,
    ) -> Result<BTreeMap<String, ParamValue>, Diagnostics> {
        let mut reports = Reports::default();
        let context = Surroundings { viewport, features };
        match checked(&self.0.document, asked, context, &mut reports) {
            Ok(params) => Ok(params.values()),
            Err(_) => Err(self.0.diagnostics(reports.into_list())),
        }
    }

    /// Returns the entries of the document's section `claims`, each with the value of its
    /// condition. Params have the values in `asked` or else their defaults for a viewport of this
    /// width and height in pixels on a device with these features.
    ///
    /// # Errors
    /// If a value in `asked` does not fit its param, or a condition cannot be evaluated.
    pub fn claims(
        &self,
        asked: &BTreeMap<String, ParamValue>,
        viewport: [u32; 2],
        features: wgt::Features,
    ) -> Result<Vec<Claim>, Diagnostics> {
        let mut reports = Reports::default();
        let context = Surroundings { viewport, features };
        let claims = claims(&self.0.document, asked, context, &mut reports);
        match reports.errors() {
            0 => Ok(claims),
            _ => Err(self.0.diagnostics(reports.into_list())),
        }
    }
}
