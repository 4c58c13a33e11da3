//! [`Graph`]: a document with its shaders, ready to be planned.

use crate::compose::reader::label;
use crate::compose::{Loaded, Reader};
use crate::diagnostics::{Diagnostic, Diagnostics, Reports};
use crate::document::flat::{flat, keep};
use crate::instantiate::params::{checked, claims};
use crate::instantiate::{Claim, Surroundings};
use crate::kinds::Registry;
use crate::language::Name;
use crate::param::{Param, ParamError, ParamValue};
use crate::plan::Plan;
use crate::plan::check::check;
use crate::request::PlanRequest;
use crate::source::{Located, Sources};
use std::{collections::BTreeMap, sync::Arc};

/// A render graph loaded from a document (a RON file): its materials (textures, buffers and
/// samplers) and passes, with every shader that the passes name. Loading touches no GPU.
///
/// Clones share their content and are cheap.
#[derive(Clone, Debug)]
pub struct Graph(Arc<Loaded>);

impl Graph {
    /// Loads the document at `path` in `sources` and every shader that it names, and parses and
    /// validates all WGSL. `registry` holds the pass kinds that the document may use, such as
    /// `Raster`.
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

    /// Loads the document at `path` as [`Graph::load`] does, but with other documents in its open
    /// includes and other pictures in its textures. `chosen` maps the name of an open include
    /// (`over` in `Include(open: "over", …)`) to the path in `sources` of the document to include
    /// there, and the name of a texture with a `file` to the path of another picture, whose size
    /// the texture then has. What `chosen` does not name stays.
    ///
    /// # Errors
    /// The mistakes that [`Graph::load`] reports, and a name in `chosen` that neither an open
    /// include of the document at `path` nor a texture with a picture has
    /// ([`Graph::openings`], [`Graph::pictures`]).
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

    /// Plans the graph for a viewport, params and device: resolves names and sizes, connects the
    /// shaders' bindings with resources, and drops the passes that are not [live](crate#terms).
    /// Touches no GPU.
    ///
    /// # Errors
    /// All mistakes found while planning: those in a document or shader with their place in it,
    /// those of the request, such as an unknown param or output, without one. Planning stops early,
    /// with these mistakes alone, if the viewport or a param is wrong, the device lacks a feature
    /// in `requires`, a condition in `needs` does not hold, or `proven_on` lacks the backend.
    pub fn plan(&self, request: &PlanRequest<'_>) -> Result<Plan, Diagnostics> {
        Plan::new(&self.0, request)
    }

    /// Loads and plans the document at `path` in `sources` and reports all mistakes at once. The
    /// readable part of a document is planned even if another part is wrong. For an input that the
    /// request does not import, the check assumes the texture (of the viewport's size), buffer or
    /// sampler that the document asks for.
    ///
    /// If this finds no mistake, the graph is planned again for other values of each param that an
    /// `if` depends on, and of each `Choice` or `Bool` param in the fields of a pass's kind, one at
    /// a time: each word, true and false, or `min` and `max` (vectors are left out); and with and
    /// without each device feature that an `if` asks for.
    ///
    /// Returns the graph, and the plan for the values of `request`. The plan contains the assumed
    /// inputs and, with [`any_adapter`](crate::Request::any_adapter), features that the device may
    /// lack. Where either applies, only look at it, and make the plan to execute with
    /// [`Graph::plan`]; else it is the plan that `Graph::plan` makes.
    ///
    /// # Errors
    /// All mistakes of loading and planning. Reads before writes, and cycles, are only reported for
    /// passes above the first pass with a mistake. Limits, sizes, memory, features and lights are
    /// not checked for the other values of params and features.
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

    /// Returns the document at `path` as RON text, with the documents that it extends merged in;
    /// included documents stay separate. A comment at the end of a line names the file and line of
    /// its origin. The text loads as the same graph. Params, [named values](Plan::named_values),
    /// inputs and materials that nothing uses are left out, unless the document has mistakes.
    ///
    /// # Errors
    /// A document that is missing, a mistake in the syntax of a document, or in an edit that a
    /// document makes to the document that it extends.
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

    /// Returns the path of the document, as it was given to [`Graph::load`].
    pub fn path(&self) -> &str {
        self.0.path()
    }

    /// Returns the section `description` of the document, on one line; empty if it has none.
    pub fn description(&self) -> &str {
        &self.0.document.description
    }

    /// Returns the params of the graph: first those that the document declares, then those that it
    /// exposes from the documents that it includes, each in the order of the document.
    pub fn params(&self) -> &[Param] {
        &self.0.document.params
    }

    /// Returns the names of all outputs that are textures or buffers, in the order of the document;
    /// outputs that are [named values](Plan::named_values) are left out. Outputs marked
    /// `on_request`, and outputs whose `if` may be false, are in the list, too.
    pub fn outputs(&self) -> Vec<&str> {
        let outputs = self.0.document.material_outputs();
        outputs.map(|output| output.name.as_str()).collect()
    }

    /// Returns the names of the outputs that a plan computes if its request has no list of
    /// [`outputs`](crate::Request::outputs): those in [`Graph::outputs`] that are not marked
    /// `on_request`. An output whose `if` is false in the plan is left out by the plan, not here.
    pub fn default_outputs(&self) -> Vec<&str> {
        let outputs = self.0.document.material_outputs();
        let outputs = outputs.filter(|output| !output.on_request);
        outputs.map(|output| output.name.as_str()).collect()
    }

    /// Returns the words of the document's section `lights`, each with its place: the kinds of
    /// light that the graph can be planned with, such as `spot`. Words that the document in an open
    /// include ([`openings`](Self::openings)) does not take are left out. If there are no words,
    /// the graph takes the first kind in [`ProvidedKind::words`](crate::ProvidedKind::words) alone.
    pub fn lights(&self) -> impl Iterator<Item = &Located<Name>> {
        self.0.document.lights.iter()
    }

    /// Returns the words of the document's section `proven_on`, each with its place: names of
    /// backends that lack part of WebGPU ([`PartialBackend`](crate::PartialBackend)), on which the
    /// graph may run because its author has checked its outputs there.
    pub fn proven_on(&self) -> impl Iterator<Item = &Located<Name>> {
        self.0.document.proven_on.iter()
    }

    /// Returns the open includes of the document (`Include(open: "over", …)`), whose documents
    /// [`Graph::load_over`] can replace: pairs of the name in the field `open` and the path of the
    /// included document. The path is the one given to `load_over`, or else the one in the
    /// document.
    pub fn openings(&self) -> impl Iterator<Item = (&str, &str)> {
        let openings = self.0.document.openings();
        openings.map(|(name, include)| (name.as_str(), include.graph.as_str()))
    }

    /// Returns the textures of the document that hold a picture (`file: "noise.png"`), which
    /// [`Graph::load_over`] can replace: pairs of the texture's name and the name of the file in
    /// the document. An import of a texture's name
    /// ([`PlanRequest::imports`](crate::Request::imports)) takes the place of its picture, too.
    pub fn pictures(&self) -> impl Iterator<Item = (&str, &str)> {
        let pictures = self.0.document.pictures();
        pictures.map(|(name, file)| (name.as_str(), file.as_str()))
    }

    /// Returns the names of the document's inputs, in its order. For each of them the host must put
    /// an import into [`PlanRequest::imports`](crate::Request::imports).
    pub fn inputs(&self) -> Vec<&str> {
        let inputs = self.0.document.inputs.iter();
        inputs.map(|input| input.name.as_str()).collect()
    }

    /// Returns every device feature that the document or an included document requires, tests by
    /// `has(…)`, or uses in a pass if the device has it. A device that is created with all of these
    /// features that the adapter offers runs the graph as well as the adapter can.
    pub fn features(&self) -> wgt::Features {
        self.0.features()
    }

    /// Returns the warnings that loading the document gave, such as those about unused materials;
    /// empty without warnings. [`Plan::warnings`] has those of planning.
    pub fn warnings(&self) -> &[Diagnostic] {
        &self.0.warnings
    }

    /// Reads the value of the param `name` from text as the command line writes it: `1024`, `0.5`,
    /// `true`, the word `front`, the vector `1,2,3`. The graph does not change; pass the value in
    /// [`PlanRequest::params`](crate::Request::params).
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
    /// ([`Param::default`]) for a viewport of this width and height in pixels on a device with
    /// these features.
    ///
    /// # Errors
    /// If `asked` names a param that the graph does not have, a value has the wrong type or is out
    /// of range, or a default cannot be evaluated.
    pub fn values(
        &self,
        asked: &BTreeMap<String, ParamValue>,
        viewport: [u32; 2],
        features: wgt::Features,
    ) -> Result<BTreeMap<String, ParamValue>, Diagnostics> {
        let mut reports = Reports::default();
        let context = Surroundings::of(viewport, features);
        match checked(&self.0.document, asked, context, &mut reports) {
            Ok(params) => Ok(params.values()),
            Err(_) => Err(self.0.diagnostics(reports.into_list())),
        }
    }

    /// Returns the entries of the document's section `claims` in its order, each with the value of
    /// its condition ([`Claim::holds`]). Params have the values in `asked` or else their defaults
    /// for a viewport of this width and height in pixels on a device with these features.
    ///
    /// # Errors
    /// If [`values`](Self::values) returns an error, or a condition cannot be evaluated.
    pub fn claims(
        &self,
        asked: &BTreeMap<String, ParamValue>,
        viewport: [u32; 2],
        features: wgt::Features,
    ) -> Result<Vec<Claim>, Diagnostics> {
        let mut reports = Reports::default();
        let context = Surroundings::of(viewport, features);
        let claims = claims(&self.0.document, asked, context, &mut reports);
        match reports.errors() {
            0 => Ok(claims),
            _ => Err(self.0.diagnostics(reports.into_list())),
        }
    }
}
