//! [`Graph`]: a document with its shaders, ready to be planned.

use crate::{
    Plan, PlanRequest,
    diagnostics::{Code, Diagnostic, Diagnostics, Severity, suggestion},
    document::{
        self, Document,
        located::Located,
        materials::{Material, Size},
        params::{Param, ParamValue},
    },
    include::{self, Includes},
    instantiate::{Instance, LoweredPass, Purpose, instantiate, split_layer},
    registry::Registry,
    source::{self, SourceFile, Sources, Span},
    step::Step,
    wgsl::{Shader, ShaderFiles},
};
use std::{
    collections::{HashMap, HashSet},
    sync::Arc,
};

/// A document that was read, with all shaders that its passes name. No GPU has been touched.
///
/// Cheap to clone.
#[derive(Clone, Debug)]
pub struct Graph {
    pub(crate) document: Arc<Document>,
    pub(crate) shaders: Shaders,
    /// Every include, the nested ones too, with the path of what it includes.
    includes: Vec<(String, Span)>,
    features: wgpu::Features,
    warnings: Vec<Diagnostic>,
}

/// Shaders by the folder of the document that names them, and their name; `None` for those with a mistake that was reported.
pub(crate) type Shaders = HashMap<(Arc<str>, String), Option<Arc<Shader>>>;

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
            Err(graph.diagnostics(errors))
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
            _ => Err(graph.diagnostics(errors)),
        }
    }

    /// What is wrong with the graph; in included documents with the place of the include.
    pub(crate) fn diagnostics(&self, mut list: Vec<Diagnostic>) -> Diagnostics {
        include::label(&mut list, self.path(), &self.includes);
        Diagnostics::new(list)
    }

    /// What could be read of a document, and what is wrong with it.
    fn read(
        path: &str,
        registry: &Registry,
        sources: &dyn Sources,
    ) -> Result<(Self, Vec<Diagnostic>), Diagnostics> {
        let missing =
            |message: String| Diagnostics::from(Diagnostic::error(Code::MissingFile, message));
        let text = match source::read(sources, path) {
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
        let Some(mut document) =
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
        let mut includes = Includes::new(path, registry, sources);
        document.include_depth = includes.attach(&mut document.entries, &mut diagnostics);
        let mut graph = Self {
            features: includes.features() | document.features(),
            document: Arc::new(document),
            shaders: HashMap::new(),
            includes: includes.places,
            warnings: Vec::new(),
        };
        let mut found = Vec::new();
        let instance = instantiate(&graph.document, Purpose::Load, &mut found);
        // What is not known of a param may be in the one that could not be read.
        found.retain(|found| !graph.document.broken.params || found.code != Code::UnknownParam);
        diagnostics.append(&mut found);
        graph.load_shaders(&instance.passes, sources, &mut diagnostics);
        graph.unused(&instance, &mut diagnostics);
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

    /// The features that the document and those that it includes require or have a fallback for. A device that has those of
    /// them that its adapter offers runs the graph as well as it can be run there.
    pub fn features(&self) -> wgpu::Features {
        self.features
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

    fn load_shaders(
        &mut self,
        passes: &[LoweredPass],
        sources: &dyn Sources,
        diagnostics: &mut Vec<Diagnostic>,
    ) {
        let mut files = ShaderFiles::new(sources);
        for pass in passes {
            let programs = pass.steps.iter().filter_map(Step::program);
            for name in programs.filter_map(|program| program.shader.as_ref()) {
                let key = (Arc::clone(&pass.scope.folder), name.value.clone());
                if self.shaders.contains_key(&key) {
                    continue;
                }
                let expanded = files.expand(&key.0, name, &name.span);
                let shader = match expanded.and_then(Shader::new) {
                    Ok(shader) => Some(Arc::new(shader)),
                    Err(error) => {
                        diagnostics.push(error);
                        None
                    }
                };
                self.shaders.insert(key, shader);
            }
        }
    }

    /// Warns of materials of the document that nothing names; those of included documents need not all be of use.
    fn unused(&self, instance: &Instance, diagnostics: &mut Vec<Diagnostic>) {
        // With a shader missing nobody can say what it would have used.
        if !diagnostics.is_empty() {
            return;
        }
        let mut used: HashSet<String> = HashSet::new();
        let mut see = |name: &str| {
            used.insert(name.to_owned());
            // A layer is a part of its texture.
            used.extend(split_layer(name).map(|(whole, _)| whole.to_owned()));
        };
        for pass in &instance.passes {
            for step in &pass.steps {
                step.clone().names(&mut |name| see(name));
                let shader = step.program().and_then(|program| {
                    let name = program.shader.as_ref()?.value.clone();
                    let key = (Arc::clone(&pass.scope.folder), name);
                    self.shaders.get(&key)?.as_ref()
                });
                for (_, global) in shader
                    .iter()
                    .flat_map(|shader| shader.module.global_variables.iter())
                {
                    see(pass
                        .scope
                        .global(global.name.as_deref().unwrap_or_default()));
                }
            }
        }
        for material in &instance.materials {
            match material {
                Material::Texture(texture) => {
                    if let Size::Like(other) = &texture.size.value {
                        see(other);
                    }
                }
                Material::Buffer(buffer) => {
                    if let Some(count) = &buffer.count {
                        count.value.clone().names(&mut |name| see(name));
                    }
                }
                Material::Sampler(_) => {}
            }
        }
        for output in &self.document.outputs {
            see(output.material.as_ref().unwrap_or(&output.name));
        }
        for material in &instance.materials {
            let name = material.name();
            let mut names: Vec<&Located<String>> = vec![name];
            if let Material::Texture(texture) = material {
                names.extend(texture.views.iter().map(|view| &view.name));
            }
            if name.span.file == self.document.file
                && !names.iter().any(|name| used.contains(name.as_str()))
            {
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
