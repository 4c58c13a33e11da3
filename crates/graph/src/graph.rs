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

/// A document that was read, with all shaders that its passes name. No GPU has been touched.
///
/// Cheap to clone.
#[derive(Clone, Debug)]
pub struct Graph(Arc<Loaded>);

impl Graph {
    /// Reads the document at `path` and every shader it names, from `sources`. Parses and validates
    /// all WGSL.
    ///
    /// # Errors
    /// Everything that is wrong with the document and its shaders, as far as it can be said without
    /// sizes and a device.
    pub fn load(
        path: &str,
        registry: &Registry,
        sources: &dyn Sources,
    ) -> Result<Self, Diagnostics> {
        Self::load_over(path, registry, sources, &BTreeMap::new())
    }

    /// Reads the document at `path` as [`Graph::load`] does, with other documents in its open
    /// includes (`Include(open: "over", …)`). `chosen`: their paths, by the names of the includes
    /// ([`Graph::openings`]).
    ///
    /// # Errors
    /// As [`Graph::load`]; a name that is no open include of the document at `path`.
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

    /// Plans the graph: resolves names and sizes, links shaders, orders and culls passes. Touches
    /// no GPU.
    ///
    /// # Errors
    /// Everything that is wrong, with its place.
    pub fn plan(&self, request: &PlanRequest<'_>) -> Result<Plan, Diagnostics> {
        Plan::new(&self.0, request)
    }

    /// [`Graph::load`] and [`Graph::plan`] in one, for all mistakes at once. The readable part of a
    /// document is planned even if another part is wrong, and for each param and feature in an `if`
    /// changed alone. Inputs that the request does not import are taken for what the document asks
    /// for.
    ///
    /// # Errors
    /// Everything that is wrong. Reads before writes and cycles are looked for above the first pass
    /// that has a mistake.
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

    /// The text of the document at `path` with all that it extends written out, each line with its
    /// origin. It reads as the document does; one with mistakes keeps what nothing uses.
    ///
    /// # Errors
    /// Mistakes in one of the documents as a file, or in an edit.
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

    /// Where the document was read from.
    pub fn path(&self) -> &str {
        self.0.path()
    }

    /// Returns the document's description of itself.
    pub fn description(&self) -> &str {
        &self.0.document.description
    }

    /// The params that the document declares, and those of included documents that it exposes.
    pub fn params(&self) -> &[Param] {
        &self.0.document.params
    }

    /// Names of the declared outputs that are materials, whatever their conditions.
    pub fn outputs(&self) -> Vec<&str> {
        let outputs = self.0.document.material_outputs();
        outputs.map(|output| output.name.as_str()).collect()
    }

    /// The same without those that a host gets only if it names them.
    pub fn default_outputs(&self) -> Vec<&str> {
        let outputs = self.0.document.material_outputs();
        let outputs = outputs.filter(|output| !output.on_request);
        outputs.map(|output| output.name.as_str()).collect()
    }

    /// The words of the section `lights`: the kinds of light that the method takes, each where it
    /// was written. The graph does not know what they mean.
    pub fn lights(&self) -> impl Iterator<Item = &Located<Name>> {
        self.0.document.lights.iter()
    }

    /// The words of the section `proven_on`: backends that give less than WebGPU, on which the
    /// graph is known to be right.
    pub fn proven_on(&self) -> impl Iterator<Item = &Located<Name>> {
        self.0.document.proven_on.iter()
    }

    /// The open includes of the document: each one's name, and the document that stands there.
    pub fn openings(&self) -> impl Iterator<Item = (&str, &str)> {
        let openings = self.0.document.openings();
        openings.map(|(name, include)| (name.as_str(), include.graph.as_str()))
    }

    /// Names of what the host must import.
    pub fn inputs(&self) -> Vec<&str> {
        let inputs = self.0.document.inputs.iter();
        inputs.map(|input| input.name.as_str()).collect()
    }

    /// The features that the document and those that it includes require, ask for by `has`, or have
    /// passes that can make use of. A device that has those of them that its adapter offers runs
    /// the graph as well as it can be run there.
    pub fn features(&self) -> wgt::Features {
        self.0.features()
    }

    /// Returns the warnings about the document.
    pub fn warnings(&self) -> &[Diagnostic] {
        &self.0.warnings
    }

    /// Reads a param's value from text, as the command line gives it.
    ///
    /// # Errors
    /// If there is no such param, or the value has the wrong type or is out of range.
    pub fn parse_param(&self, name: &str, text: &str) -> Result<ParamValue, ParamError> {
        let param = self.0.param(name)?;
        param.parse(text).map_err(|why| ParamError::Value {
            graph: self.path().to_owned(),
            name: name.to_owned(),
            why,
        })
    }

    /// The value of every param: that which is asked for, else the default for this viewport on a
    /// device with these features.
    ///
    /// # Errors
    /// If there is no such param, or a value does not fit.
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

    /// Returns the promises of the document about itself for these values of params and this
    /// viewport, on a device with these features.
    ///
    /// # Errors
    /// If a value does not fit, or a condition has no value.
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
