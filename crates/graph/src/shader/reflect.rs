//! Reflection of a WGSL module: every resource global with its type, place, binding number and use
//! per entry point.

use super::class::{Class, TextureClass, class_of};
use super::compiled::{compiled, specialised};
use super::expand::Expanded;
use super::footprint::Footprint;
use super::guard;
use super::items::{Item, item};
use super::text::words;
use super::varyings::Varyings;
use super::wgsl_errors::function_span;
use crate::errors::shader::ShaderError;
use crate::language::Scalar;
use crate::scalar_class::ItemScalar;
use crate::source::{Located, Span};
use naga::proc::Layouter;
use naga::valid::{GlobalUse, ModuleInfo};
use naga::{Handle, ShaderStage, TypeInner};
use std::collections::{BTreeMap, BTreeSet, HashMap};
use std::hash::{DefaultHasher, Hash, Hasher};
use std::sync::{Arc, Mutex, PoisonError};

/// A parsed and validated WGSL shader with its imports in place. Each of its resource globals
/// (buffers, textures, samplers) has a binding number. Two shaders are equal if their texts with
/// imports in place are.
#[derive(Debug)]
pub struct Shader {
    pub(crate) source: Expanded,
    pub(crate) module: naga::Module,
    info: ModuleInfo,
    layouter: Layouter,
    /// Hash of the text with imports in place.
    digest: u64,
    /// Footprints of entry points with the values of their overrides, as far as they were asked
    /// for.
    footprints: Mutex<HashMap<Specialisation, Result<Arc<Footprint>, ShaderError>>>,
}

/// An entry point, and the values of overrides by key, in bits.
type Specialisation = (usize, Vec<(String, u64)>);

/// As many specialisations are remembered of a shader: a slider has many values.
const MOST_FOOTPRINTS: usize = 64;

/// Shaders of one text are one.
impl PartialEq for Shader {
    fn eq(&self, other: &Self) -> bool {
        // Most often it is the very same one, of a plan made again of one graph.
        std::ptr::eq(self, other) || self.source.text == other.source.text
    }
}

impl Eq for Shader {}

impl Hash for Shader {
    fn hash<H: Hasher>(&self, state: &mut H) {
        state.write_u64(self.digest);
    }
}

/// A resource global of a shader, with its use by some of the shader's entry points together.
#[derive(Clone, Debug)]
pub(crate) struct Global {
    pub handle: Handle<naga::GlobalVariable>,
    pub name: String,
    /// Place of the global's name in the file that declares it.
    pub span: Span,
    pub group: u32,
    pub binding: u32,
    /// Type of the global: uniform, storage buffer, texture, sampler or acceleration structure,
    /// with its layout.
    pub class: Class,
    /// True if one of the entry points reads the global.
    pub reads: bool,
    /// True if one of the entry points writes the global.
    pub writes: bool,
    /// Layout of the global's items; `None` if an item has scalars other than 32-bit numbers, or
    /// more than 64.
    pub item: Option<Item>,
    /// Stages of the entry points that use the global.
    pub stages: wgt::ShaderStages,
}

impl Global {
    /// Returns the name of the global, with its place.
    pub(crate) fn located(&self) -> Located<String> {
        Located::new(self.name.clone(), self.span.clone())
    }
}

impl Shader {
    /// Parses and validates a shader. Globals without `@group` and `@binding` get free numbers: in
    /// group 0 if an imported module declares them, in group 1 if the shader's own file does.
    pub(crate) fn new(source: Expanded) -> Result<Self, ShaderError> {
        guard::check(&source)?;
        let (module, info, layouter) = compiled(&source)?;
        let mut digest = DefaultHasher::new();
        source.text.hash(&mut digest);
        Ok(Self {
            digest: digest.finish(),
            source,
            module,
            info,
            layouter,
            footprints: Mutex::default(),
        })
    }

    /// Returns the memory that an entry point takes, compiled as on a device. `constants` holds the
    /// values of overrides by key.
    pub(crate) fn footprint(
        &self,
        entry: usize,
        constants: &[(String, f64)],
    ) -> Result<Arc<Footprint>, ShaderError> {
        let bits = constants
            .iter()
            .map(|(key, value)| (key.clone(), value.to_bits()));
        let key = (entry, bits.collect());
        let footprints = &self.footprints;
        let lock = || footprints.lock().unwrap_or_else(PoisonError::into_inner);
        if let Some(footprint) = lock().get(&key) {
            return footprint.clone();
        }
        let point = &self.module.entry_points[entry];
        let point = (point.stage, point.name.as_str());
        let footprint = specialised((&self.module, &self.info), point, constants, &self.source)
            .map(|specialised| Arc::new(Footprint::new(&specialised, point, &self.source)));
        let mut footprints = lock();
        if footprints.len() >= MOST_FOOTPRINTS {
            footprints.clear();
        }
        footprints.insert(key, footprint.clone());
        footprint
    }

    /// Iterates over the indices of the fragment entry points without colour outputs.
    pub(crate) fn colourless_fragments(&self) -> impl Iterator<Item = usize> {
        let entries = self.module.entry_points.iter().enumerate();
        entries
            .filter(|(index, entry)| {
                entry.stage == ShaderStage::Fragment && self.is_colourless(*index)
            })
            .map(|(index, _)| index)
    }

    fn is_colourless(&self, entry: usize) -> bool {
        Varyings::outputs(&self.module, entry).locations.is_empty()
    }

    /// Returns the index of the entry point of `stage` that is called `name`, or, without a name,
    /// of the only one of the stage. With `depth_only`, only fragment entry points without colour
    /// outputs count then. `wanted` is the place for errors.
    pub(crate) fn entry(
        &self,
        stage: ShaderStage,
        depth_only: bool,
        name: Option<&Located<String>>,
        wanted: &Span,
    ) -> Result<usize, ShaderError> {
        let fits = |index: usize, entry: &naga::EntryPoint| {
            entry.stage == stage
                && (stage != ShaderStage::Fragment
                    || !depth_only
                    || name.is_some()
                    || self.is_colourless(index))
        };
        let entries = self.module.entry_points.iter().enumerate();
        let of_stage: Vec<(usize, &str)> = entries
            .filter(|(index, entry)| fits(*index, entry))
            .map(|(index, entry)| (index, entry.name.as_str()))
            .collect();
        let stage = format!("{stage:?}").to_lowercase();
        let file = self.source.file.name.to_string();
        let names = of_stage.iter().map(|(_, name)| (*name).to_owned());
        match (name, of_stage.as_slice()) {
            (Some(name), _) => {
                let mut named = of_stage.iter().filter(|(_, entry)| *entry == name.as_str());
                let error = || ShaderError::NoSuchEntry {
                    file,
                    stage,
                    name: name.clone(),
                    entries: names.collect(),
                };
                named.next().map(|(index, _)| *index).ok_or_else(error)
            }
            (None, [(index, _)]) => Ok(*index),
            (None, []) => Err(ShaderError::NoEntry(file, stage, wanted.clone())),
            (None, _) => Err(ShaderError::SeveralEntries {
                file,
                stage,
                at: wanted.clone(),
                entries: names.collect(),
            }),
        }
    }

    /// Returns the naga module, in which every resource global has a binding number.
    pub fn module(&self) -> &naga::Module {
        &self.module
    }

    /// Returns the text with imports in place and with the binding numbers of
    /// [`module`](Self::module) written in, for compilers that read WGSL, such as a browser's.
    pub fn wgsl(&self) -> String {
        let mut text = self.source.text.clone();
        let own = naga::front::wgsl::parse_str(&text).ok();
        let own = own.iter().flat_map(|own| own.global_variables.iter());
        let without = own.filter(|(_, global)| global.binding.is_none());
        let places = without.filter_map(|(handle, _)| {
            let variables = &self.module.global_variables;
            let place = variables.get_span(handle).to_range()?;
            Some((place.start, variables[handle].binding?))
        });
        let places: BTreeMap<usize, naga::ResourceBinding> = places.collect();
        for (at, naga::ResourceBinding { group, binding }) in places.into_iter().rev() {
            text.insert_str(at, &format!("@group({group}) @binding({binding}) "));
        }
        text
    }

    /// Returns the path in the store ([`Sources`](crate::Sources)) of the shader's own file, not of
    /// the modules that it imports.
    pub fn file(&self) -> &str {
        &self.source.file.name
    }

    /// Returns the name of the entry point with the index `entry` in the list `entry_points` of
    /// [`module`](Self::module).
    ///
    /// # Panics
    /// If there is no such entry point.
    pub fn entry_name(&self, entry: usize) -> &str {
        &self.module.entry_points[entry].name
    }

    /// Returns the entry point's workgroup size; `None` if it depends on an override.
    pub(crate) fn workgroup_size(&self, entry: usize) -> Option<[u32; 3]> {
        let entry = &self.module.entry_points[entry];
        let is_fixed = entry.workgroup_size_overrides.is_none();
        is_fixed.then_some(entry.workgroup_size)
    }

    /// Returns the place of an entry point's name, which naga does not keep.
    pub(crate) fn entry_span(&self, entry: usize) -> Span {
        function_span(&self.source, self.entry_name(entry))
    }

    /// Returns the resource globals that any of `entries` uses, in declaration order, with their
    /// use by these entry points together; without entries all globals.
    pub(crate) fn globals(&self, entries: &[usize]) -> Vec<Global> {
        let mut globals = Vec::with_capacity(self.module.global_variables.len());
        for (handle, variable) in self.module.global_variables.iter() {
            let Some(binding) = variable.binding else {
                continue;
            };
            let (mut usage, mut stages) = (GlobalUse::empty(), wgt::ShaderStages::NONE);
            for &entry in entries {
                let entry_use = self.info.get_entry_point(entry)[handle];
                usage |= entry_use;
                if !entry_use.is_empty() {
                    stages |= stages_of(self.module.entry_points[entry].stage);
                }
            }
            if usage.is_empty() && !entries.is_empty() {
                continue;
            }
            let class = class_of(&self.module, &self.layouter, variable);
            let storage_texture = match &class {
                Class::Texture(_, TextureClass::Storage(_, access)) => Some(*access),
                _ => None,
            };
            // Atomics read what they add to; a storage texture's declared access is what the device
            // is told.
            let atomic = usage.contains(GlobalUse::ATOMIC);
            let reads = match storage_texture {
                Some(wgt::StorageTextureAccess::WriteOnly) => false,
                Some(_) => true,
                None => usage.contains(GlobalUse::READ) || atomic,
            };
            globals.push(Global {
                handle,
                name: variable.name.clone().unwrap_or_default(),
                span: self.global_span(handle, variable),
                group: binding.group,
                binding: binding.binding,
                class,
                reads,
                writes: usage.contains(GlobalUse::WRITE) || atomic,
                item: item(&self.module, variable.ty),
                stages,
            });
        }
        globals
    }

    /// Iterates over all resource globals, used or not: name, group, and place.
    pub(crate) fn groups(&self) -> impl Iterator<Item = (&str, u32, Span)> {
        let globals = self.module.global_variables.iter();
        globals.filter_map(|(handle, variable)| {
            let group = variable.binding?.group;
            let name = variable.name.as_deref().unwrap_or_default();
            Some((name, group, self.global_span(handle, variable)))
        })
    }

    fn global_span(
        &self,
        handle: Handle<naga::GlobalVariable>,
        variable: &naga::GlobalVariable,
    ) -> Span {
        let span = self.module.global_variables.get_span(handle);
        let range = span.to_range().unwrap_or(0..0);
        let name = variable.name.as_deref().unwrap_or("");
        // The declaration begins with its attributes; the name is what matters, and the type
        // follows it.
        let declaration = self.source.text.get(range.clone()).unwrap_or("");
        let declaration = declaration.split(':').next().unwrap_or("");
        let at = range.start + words(declaration, name).last().unwrap_or(0);
        self.source.locate(at..at + name.len())
    }

    /// Returns the names of the sampler globals through which `entries` sample the global
    /// `texture`, without comparison samplers.
    pub(crate) fn samplers_of(
        &self,
        entries: &[usize],
        texture: Handle<naga::GlobalVariable>,
    ) -> BTreeSet<String> {
        entries
            .iter()
            .flat_map(|&entry| &self.info.get_entry_point(entry).sampling_set)
            .filter(|key| key.image == texture)
            .map(|key| &self.module.global_variables[key.sampler])
            .filter(|sampler| {
                !matches!(
                    self.module.types[sampler.ty].inner,
                    TypeInner::Sampler { comparison: true }
                )
            })
            .filter_map(|sampler| sampler.name.clone())
            .collect()
    }

    /// Iterates over the overrides with a name: the name; the key by which wgpu knows it, which is
    /// its `@id` if it has one; true if it has a default value; and its place.
    pub(crate) fn overrides(&self) -> impl Iterator<Item = (&str, String, bool, Span)> {
        let overrides = self.module.overrides.iter();
        overrides.filter_map(|(handle, constant)| {
            let name = constant.name.as_deref()?;
            let id = constant.id.map(|id| id.to_string());
            let key = id.unwrap_or_else(|| name.to_owned());
            let span = self.module.overrides.get_span(handle);
            Some((name, key, constant.init.is_some(), self.source.place(span)))
        })
    }

    /// Returns the scalar class of an override; `None` for a `bool`, and if there is no such
    /// override.
    pub(crate) fn override_class(&self, name: &str) -> Option<ItemScalar> {
        let mut overrides = self.module.overrides.iter();
        let (_, declared) =
            overrides.find(|(_, declared)| declared.name.as_deref() == Some(name))?;
        let scalar = self.module.types[declared.ty].inner.scalar()?;
        ItemScalar::from_kind(scalar.kind)
    }

    /// Returns the value of a scalar constant at module scope; `None` if there is no such constant,
    /// or it is a `bool` or not a literal.
    pub(crate) fn constant(&self, name: &str) -> Option<Scalar> {
        let mut constants = self.module.constants.iter();
        let (_, constant) =
            constants.find(|(_, constant)| constant.name.as_deref() == Some(name))?;
        match &self.module.global_expressions[constant.init] {
            naga::Expression::Literal(literal) => Some(match *literal {
                naga::Literal::F64(value) | naga::Literal::AbstractFloat(value) => {
                    Scalar::Number(value)
                }
                naga::Literal::F32(value) => Scalar::Number(value.into()),
                naga::Literal::U32(value) => Scalar::Whole(value.into()),
                naga::Literal::I32(value) => Scalar::Whole(value.into()),
                naga::Literal::I64(value) | naga::Literal::AbstractInt(value) => {
                    Scalar::Whole(value)
                }
                _ => return None,
            }),
            naga::Expression::ZeroValue(_) => Some(Scalar::Whole(0)),
            _ => None,
        }
    }

    /// Iterates over the names of the constants at module scope.
    pub(crate) fn constants(&self) -> impl Iterator<Item = &str> {
        let constants = self.module.constants.iter();
        constants.filter_map(|(_, constant)| constant.name.as_deref())
    }

    /// Returns the place of the name of a constant at module scope.
    pub(crate) fn constant_span(&self, name: &str) -> Span {
        let text = &self.source.text;
        let declared = |at: &usize| text[..*at].trim_end().ends_with("const");
        let at = words(text, name).find(declared).unwrap_or(0);
        self.source.locate(at..at + name.len())
    }

    /// Iterates over the names of the params that the module takes: members of the uniform
    /// `params`, and overrides.
    pub(crate) fn params(&self) -> impl Iterator<Item = &str> {
        let uniform = self.uniform_params();
        let members = uniform.map_or(&[][..], |(_, members)| members);
        let members = members.iter().filter_map(|member| member.name.as_deref());
        let overrides = self.module.overrides.iter();
        members.chain(overrides.filter_map(|(_, constant)| constant.name.as_deref()))
    }

    /// Returns the uniform `params` with its members; `None` if the module has none.
    pub(super) fn uniform_params(
        &self,
    ) -> Option<(Handle<naga::GlobalVariable>, &[naga::StructMember])> {
        let mut globals = self.module.global_variables.iter();
        let (handle, global) = globals.find(|(_, var)| var.name.as_deref() == Some("params"))?;
        match &self.module.types[global.ty].inner {
            TypeInner::Struct { members, .. } => Some((handle, members)),
            _ => None,
        }
    }

    /// True if the entry point with the index `entry` uses a global.
    pub(super) fn uses(&self, entry: usize, global: Handle<naga::GlobalVariable>) -> bool {
        self.info.get_entry_point(entry)[global] != GlobalUse::empty()
    }

    /// Iterates over the names of all globals of the module, used or not.
    pub(crate) fn global_names(&self) -> impl Iterator<Item = &str> {
        let globals = self.module.global_variables.iter();
        globals.filter_map(|(_, global)| global.name.as_deref())
    }
}

/// A shader stage as wgpu's flag.
fn stages_of(stage: ShaderStage) -> wgt::ShaderStages {
    match stage {
        ShaderStage::Vertex => wgt::ShaderStages::VERTEX,
        ShaderStage::Fragment => wgt::ShaderStages::FRAGMENT,
        _ => wgt::ShaderStages::COMPUTE,
    }
}
