//! [`Graph`]: a document with its shaders, ready to be planned.

use crate::{
    Plan, PlanRequest,
    diagnostics::{Code, Diagnostic, Diagnostics, Severity, suggestion},
    document::{
        self, Document, Run,
        located::Located,
        materials::{BufferEntry, Count, Material, Size, TextureEntry},
        params::{Param, ParamValue},
        value::Value,
    },
    registry::{Lowering, Params, Registry},
    source::{SourceFile, Sources, Span},
    step::{Program, Step},
    wgsl::{Shader, ShaderFiles},
};
use std::{collections::BTreeMap, collections::HashMap, collections::HashSet, sync::Arc};

/// A document that was read, with all shaders that its passes name. No GPU has been touched.
#[derive(Debug)]
pub struct Graph {
    pub(crate) document: Document,
    /// `None` for those with a mistake that was reported.
    pub(crate) shaders: HashMap<String, Option<Arc<Shader>>>,
    warnings: Vec<Diagnostic>,
}

/// Why a param cannot be set.
#[derive(Clone, Debug, thiserror::Error)]
#[non_exhaustive]
pub enum ParamError {
    /// The graph declares no such param.
    #[error("`{graph}` has no param `{name}`{hint}")]
    Unknown {
        /// The graph's path.
        graph: String,
        /// The name.
        name: String,
        /// A suggestion, or the list of params.
        hint: String,
    },
    /// The value has the wrong type or is out of range.
    #[error("param `{name}` of `{graph}`: {why}")]
    Value {
        /// The graph's path.
        graph: String,
        /// The name.
        name: String,
        /// What was expected.
        why: String,
    },
}

/// A pass with its body lowered to steps.
pub(crate) struct LoweredPass {
    pub name: Located<String>,
    pub kind: &'static str,
    pub run: Run,
    pub overwrites: Vec<Located<String>>,
    pub steps: Vec<Step>,
    pub scratch: Vec<(String, u64)>,
}

impl Graph {
    /// Reads the document at `path` and every shader it names, from `sources`. Parses and validates all WGSL.
    ///
    /// # Errors
    /// Everything that is wrong with the document and its shaders, as far as it can be said without sizes and a device.
    pub fn load(
        path: &str,
        registry: &Registry,
        sources: &dyn Sources,
    ) -> Result<Self, Diagnostics> {
        let (graph, errors) = Self::read(path, registry, sources)?;
        if errors.is_empty() {
            Ok(graph)
        } else {
            Err(Diagnostics::new(errors))
        }
    }

    /// [`Graph::load`] and [`Graph::plan`] in one, for everything that is wrong at once: what could be read of a document is
    /// planned even where something else in it is wrong.
    ///
    /// # Errors
    /// Everything that is wrong. Reads before writes and cycles are looked for above the first pass that has a mistake.
    pub fn check(
        path: &str,
        registry: &Registry,
        sources: &dyn Sources,
        request: &PlanRequest<'_>,
    ) -> Result<(Self, Plan), Diagnostics> {
        let (graph, mut errors) = Self::read(path, registry, sources)?;
        // Without its params nothing of the document has a size.
        let (plan, found) = match graph.document.broken.params {
            false => graph.plan_all(request),
            true => (None, Vec::new()),
        };
        errors.extend(found);
        match plan {
            Some(plan) if errors.is_empty() => Ok((graph, plan)),
            // What nobody uses may be what a misspelt name was meant to be: warnings wait until the errors are gone.
            _ => Err(Diagnostics::new(errors)),
        }
    }

    /// What could be read of a document, and what is wrong with it.
    fn read(
        path: &str,
        registry: &Registry,
        sources: &dyn Sources,
    ) -> Result<(Self, Vec<Diagnostic>), Diagnostics> {
        let missing =
            |message: String| Diagnostics::from(Diagnostic::error(Code::MissingFile, message));
        let text = match sources.read(path) {
            Ok(Some(text)) => text,
            Ok(None) => {
                let (folder, name) = path.rsplit_once('/').unwrap_or(("", path));
                let listed: Vec<String> = sources
                    .list(folder)
                    .into_iter()
                    .filter(|name| name.ends_with(".ron"))
                    .collect();
                let hint = suggestion(name, listed.iter().map(String::as_str))
                    .filter(|hint| hint.starts_with("did"));
                let error =
                    Diagnostic::error(Code::MissingFile, format!("there is no document `{path}`"));
                return Err(match hint {
                    Some(hint) => error.help(hint),
                    None => error,
                }
                .into());
            }
            Err(why) => {
                return Err(missing(format!(
                    "the document `{path}` cannot be read: {why}"
                )));
            }
        };
        let mut diagnostics = Vec::new();
        let Some(document) =
            document::parse(SourceFile::new(path, text), registry, &mut diagnostics)
        else {
            return Err(Diagnostics::new(diagnostics));
        };
        if document.outputs.is_empty() && diagnostics.is_empty() {
            let end = document.file.text.trim_end().len();
            diagnostics.push(
                Diagnostic::error(
                    Code::Output,
                    "the document has no outputs, so none of its passes is needed",
                )
                .at(document.file.span(end.saturating_sub(1)..end), "")
                .help("add `outputs: [(name: \"…\")]`"),
            );
        }
        let mut graph = Self {
            document,
            shaders: HashMap::new(),
            warnings: Vec::new(),
        };
        let passes = graph.lower(&BTreeMap::new(), &mut diagnostics);
        graph.load_shaders(&passes, sources, &mut diagnostics);
        graph.unused(&passes, &mut diagnostics);
        let (errors, warnings): (Vec<_>, Vec<_>) = diagnostics
            .into_iter()
            .partition(|diagnostic| diagnostic.severity == Severity::Error);
        graph.warnings = warnings;
        Ok((graph, errors))
    }

    /// Where the document was read from.
    pub fn path(&self) -> &str {
        &self.document.file.name
    }

    /// What the document says about itself.
    pub fn description(&self) -> &str {
        &self.document.description
    }

    /// The params that the document declares.
    pub fn params(&self) -> &[Param] {
        &self.document.params
    }

    /// Names of the declared outputs.
    pub fn outputs(&self) -> Vec<&str> {
        self.document
            .outputs
            .iter()
            .map(|output| output.name.as_str())
            .collect()
    }

    /// What is suspicious in the document.
    pub fn warnings(&self) -> &[Diagnostic] {
        &self.warnings
    }

    /// Reads a param's value from text, as the command line gives it.
    ///
    /// # Errors
    /// If there is no such param, or the value has the wrong type or is out of range.
    pub fn parse_param(&self, name: &str, text: &str) -> Result<ParamValue, ParamError> {
        let param = self.param(name)?;
        param.parse(text).map_err(|why| ParamError::Value {
            graph: self.path().to_owned(),
            name: name.to_owned(),
            why,
        })
    }

    pub(crate) fn param(&self, name: &str) -> Result<&Param, ParamError> {
        let params = self.params();
        params
            .iter()
            .find(|param| param.name.value == name)
            .ok_or_else(|| {
                let hint = suggestion(name, params.iter().map(|param| param.name.as_str()));
                ParamError::Unknown {
                    graph: self.path().to_owned(),
                    name: name.to_owned(),
                    hint: hint.map_or(", it has none".to_owned(), |hint| format!(": {hint}")),
                }
            })
    }

    /// Lowers every pass with these values of params.
    pub(crate) fn lower(
        &self,
        values: &BTreeMap<String, ParamValue>,
        diagnostics: &mut Vec<Diagnostic>,
    ) -> Vec<LoweredPass> {
        let params = Params {
            declared: &self.document.params,
            values,
        };
        let lower = |pass: &document::PassEntry| {
            let mut lowering = Lowering {
                name: &pass.name,
                shader: pass.shader.as_ref(),
                bind: &pass.bind,
                params: &params,
                steps: Vec::new(),
                scratch: Vec::new(),
                diagnostics: Vec::new(),
            };
            pass.body.lower(&mut lowering);
            diagnostics.append(&mut lowering.diagnostics);
            if let Run::When(name) = &pass.run {
                params.value::<bool>(&Value::Param(name.clone()), diagnostics);
            }
            LoweredPass {
                name: pass.name.clone(),
                kind: pass.kind,
                run: pass.run.clone(),
                overwrites: pass.overwrites.clone(),
                steps: lowering.steps,
                scratch: lowering.scratch,
            }
        };
        self.document.passes.iter().map(lower).collect()
    }

    fn load_shaders(
        &mut self,
        passes: &[LoweredPass],
        sources: &dyn Sources,
        diagnostics: &mut Vec<Diagnostic>,
    ) {
        let path = self.document.file.name.to_string();
        let mut files = ShaderFiles::new(sources, &path);
        for name in passes
            .iter()
            .flat_map(|pass| &pass.steps)
            .filter_map(program)
            .filter_map(|program| program.shader.as_ref())
        {
            if self.shaders.contains_key(&name.value) {
                continue;
            }
            match files.expand(name, &name.span).and_then(Shader::new) {
                Ok(shader) => {
                    self.shaders
                        .insert(name.value.clone(), Some(Arc::new(shader)));
                }
                Err(error) => {
                    self.shaders.insert(name.value.clone(), None);
                    diagnostics.push(error);
                }
            }
        }
    }

    /// Warns of materials that nothing names.
    fn unused(&self, passes: &[LoweredPass], diagnostics: &mut Vec<Diagnostic>) {
        // With a shader missing nobody can say what it would have used.
        if !diagnostics.is_empty() {
            return;
        }
        let mut used: HashSet<String> = HashSet::new();
        for step in passes.iter().flat_map(|pass| &pass.steps) {
            names_of(step, &mut |name| {
                used.insert(name.to_owned());
            });
            if let Some(shader) = program(step)
                .and_then(|program| self.shaders.get(&program.shader.as_ref()?.value)?.as_ref())
            {
                used.extend(
                    shader
                        .module
                        .global_variables
                        .iter()
                        .filter_map(|(_, global)| global.name.clone()),
                );
            }
        }
        for material in &self.document.materials {
            let mut size = |name: &str| {
                used.insert(name.to_owned());
            };
            match material {
                Material::Texture(TextureEntry {
                    size:
                        Located {
                            value: Size::Like(other),
                            ..
                        },
                    ..
                }) => size(other),
                Material::Buffer(BufferEntry {
                    count: Some(count), ..
                }) => names_in(count, &mut size),
                _ => {}
            }
        }
        for output in &self.document.outputs {
            used.insert(
                output
                    .material
                    .as_ref()
                    .unwrap_or(&output.name)
                    .value
                    .clone(),
            );
        }
        for material in &self.document.materials {
            let mut names: Vec<&Located<String>> = vec![material.name()];
            if let Material::Texture(texture) = material {
                names.extend(texture.views.iter().map(|view| &view.name));
            }
            let is_used = |name: &&Located<String>| {
                used.contains(name.as_str()) || used.contains(&name.replace('.', "_"))
            };
            if !names.iter().any(is_used) {
                let name = material.name();
                diagnostics.push(
                    Diagnostic::warning(
                        Code::Unused,
                        format!("no pass uses the material `{}`", name.value),
                    )
                    .at(name.span.clone(), "")
                    .help("remove it, or check the names of the shader globals that should be it"),
                );
            }
        }
    }

    /// The place of the document itself, for mistakes of a request.
    pub(crate) fn place(&self) -> Span {
        self.document.file.span(0..0)
    }
}

fn program(step: &Step) -> Option<&Program> {
    match step {
        Step::Draw(draw) => Some(&draw.program),
        Step::Dispatch(dispatch) => Some(&dispatch.program),
        _ => None,
    }
}

/// Calls `each` with every resource that a count is derived from.
fn names_in(count: &Count, each: &mut dyn FnMut(&str)) {
    match count {
        Count::PixelsOf(name) | Count::CountOf(name) => each(name),
        Count::Times(a, b) => {
            names_in(a, each);
            names_in(b, each);
        }
        Count::Number(_) | Count::Pixels => {}
    }
}

/// Calls `each` with every resource name that a step holds.
fn names_of(step: &Step, each: &mut dyn FnMut(&str)) {
    use crate::step::{DrawCall, Groups};
    match step {
        Step::Draw(draw) => {
            draw.colors.iter().for_each(|color| each(&color.target));
            draw.depth.iter().for_each(|depth| each(&depth.target));
            match &draw.call {
                DrawCall::Direct {
                    count: vertices,
                    instances,
                } => {
                    names_in(vertices, each);
                    names_in(instances, each);
                }
                DrawCall::Indirect(name) => each(name),
            }
        }
        Step::Dispatch(dispatch) => match &dispatch.groups {
            Groups::Over(name) | Groups::Indirect(name) => each(name),
            Groups::Fixed(_) => {}
        },
        Step::Copy { from, to } => {
            each(from);
            each(to);
        }
        Step::Clear { target, .. } => each(target),
    }
    if let Some(program) = program(step) {
        program.bind.iter().for_each(|(_, name)| each(name));
    }
}
