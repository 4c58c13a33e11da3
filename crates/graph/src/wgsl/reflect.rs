//! What a WGSL module binds and how: every resource global with its type, place, binding number and use per entry point.

use super::Expanded;
use crate::{
    diagnostics::{Code, Diagnostic},
    document::located::Located,
    source::Span,
};
use naga::{
    AddressSpace, Handle, ImageClass, ShaderStage, TypeInner,
    proc::{GlobalCtx, Layouter},
    valid::{EntryPointError, GlobalUse, ModuleInfo, ValidationError, ValidationFlags, Validator},
};
use std::{collections::BTreeSet, fmt};

/// A parsed, validated shader whose resource globals all have binding numbers.
#[derive(Debug)]
pub(crate) struct Shader {
    pub source: Expanded,
    pub module: naga::Module,
    info: ModuleInfo,
    layouter: Layouter,
}

/// A resource global.
#[derive(Clone, Debug)]
pub(crate) struct Global {
    pub handle: Handle<naga::GlobalVariable>,
    pub name: String,
    pub span: Span,
    pub group: u32,
    pub binding: u32,
    pub class: Class,
    pub reads: bool,
    pub writes: bool,
}

/// What a global is.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) enum Class {
    Uniform {
        size: u64,
        members: Vec<Member>,
    },
    /// `fixed`: bytes before the runtime-sized array (or of the whole type); `stride`: bytes per item of that array.
    Storage {
        fixed: u64,
        stride: Option<u64>,
        read_only: bool,
        layout: String,
    },
    Texture(TextureClass),
    Sampler {
        comparison: bool,
    },
    Unsupported(&'static str),
}

/// A texture global, sampled or storage.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) enum TextureClass {
    Sampled {
        scalar: ScalarClass,
        dimension: wgpu::TextureViewDimension,
        depth: bool,
    },
    Storage {
        format: String,
        dimension: wgpu::TextureViewDimension,
        access: wgpu::StorageTextureAccess,
    },
}

/// What one channel of a texture is to a shader.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum ScalarClass {
    Float,
    Uint,
    Sint,
}

impl fmt::Display for ScalarClass {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Float => "f32",
            Self::Uint => "u32",
            Self::Sint => "i32",
        })
    }
}

impl ScalarClass {
    fn of(kind: naga::ScalarKind) -> Option<Self> {
        match kind {
            naga::ScalarKind::Float => Some(Self::Float),
            naga::ScalarKind::Uint => Some(Self::Uint),
            naga::ScalarKind::Sint => Some(Self::Sint),
            _ => None,
        }
    }
}

/// A member of a uniform struct.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct Member {
    pub name: String,
    pub offset: u64,
    /// Scalar class and number of components; `None` for matrices, arrays and structs.
    pub vector: Option<(ScalarClass, u32)>,
}

impl Shader {
    /// Parses and validates. Globals without `@group`/`@binding` get free numbers: group 0 those of imported modules,
    /// group 1 the shader's own.
    pub fn new(source: Expanded) -> Result<Self, Diagnostic> {
        let mut module = naga::front::wgsl::parse_str(&source.text)
            .map_err(|error| parse_error(&error, &source))?;
        assign_bindings(&mut module, &source);
        // What a device lacks is said when the pipeline is made for it; a document is checked against the language.
        let mut validator =
            Validator::new(ValidationFlags::all(), naga::valid::Capabilities::all());
        let info = validator
            .validate(&module)
            .map_err(|error| validation_error(&error, &module, &source))?;
        let mut layouter = Layouter::default();
        layouter
            .update(GlobalCtx {
                types: &module.types,
                constants: &module.constants,
                overrides: &module.overrides,
                global_expressions: &module.global_expressions,
            })
            .map_err(|error| {
                Diagnostic::error(Code::Shader, format!("a type has no layout: {error}"))
                    .at(source.file.span(0..0), "")
            })?;
        Ok(Self {
            source,
            module,
            info,
            layouter,
        })
    }

    /// The entry point of `stage`: the one called `name`, or the only one of the stage. `wanted` is where it is asked for.
    pub fn entry(
        &self,
        stage: ShaderStage,
        name: Option<&Located<String>>,
        wanted: &Span,
    ) -> Result<usize, Diagnostic> {
        let of_stage: Vec<(usize, &str)> = self
            .module
            .entry_points
            .iter()
            .enumerate()
            .filter(|(_, entry)| entry.stage == stage)
            .map(|(index, entry)| (index, entry.name.as_str()))
            .collect();
        let stage_name = format!("{stage:?}").to_lowercase();
        let file = &self.source.file.name;
        match (name, of_stage.as_slice()) {
            (Some(name), _) => of_stage
                .iter()
                .find(|(_, known)| *known == name.as_str())
                .map(|(index, _)| *index)
                .ok_or_else(|| {
                    Diagnostic::error(
                        Code::EntryPoint,
                        format!("`{file}` has no {stage_name} entry point `{}`", name.value),
                    )
                    .at(name.span.clone(), "")
                    .suggest(name, of_stage.iter().map(|(_, known)| *known))
                }),
            (None, [(index, _)]) => Ok(*index),
            (None, []) => Err(Diagnostic::error(
                Code::EntryPoint,
                format!("`{file}` has no {stage_name} entry point"),
            )
            .at(wanted.clone(), "this pass needs one")
            .help(format!("write a function with the attribute @{stage_name}"))),
            (None, several) => {
                let names: Vec<String> = several
                    .iter()
                    .map(|(_, name)| format!("`{name}`"))
                    .collect();
                Err(Diagnostic::error(
                    Code::EntryPoint,
                    format!("`{file}` has several {stage_name} entry points"),
                )
                .at(wanted.clone(), "it is not clear which one this pass runs")
                .help(format!("name one of {}", names.join(", "))))
            }
        }
    }

    pub fn entry_name(&self, entry: usize) -> &str {
        &self.module.entry_points[entry].name
    }

    /// `None` if it depends on an override.
    pub fn workgroup_size(&self, entry: usize) -> Option<[u32; 3]> {
        let entry = &self.module.entry_points[entry];
        entry
            .workgroup_size_overrides
            .is_none()
            .then_some(entry.workgroup_size)
    }

    /// The place of an entry point's name; naga keeps none.
    pub fn entry_span(&self, entry: usize) -> Span {
        function_span(&self.source, self.entry_name(entry))
    }

    /// Resource globals that the entry points use, in declaration order, with their use in any of them.
    pub fn globals(&self, entries: &[usize]) -> Vec<Global> {
        let mut globals = Vec::new();
        for (handle, variable) in self.module.global_variables.iter() {
            let Some(binding) = variable.binding else {
                continue;
            };
            let mut usage = GlobalUse::empty();
            for &entry in entries {
                usage |= self.info.get_entry_point(entry)[handle];
            }
            if usage.is_empty() {
                continue;
            }
            let class = self.class(variable);
            let storage_texture = match &class {
                Class::Texture(TextureClass::Storage { access, .. }) => Some(*access),
                _ => None,
            };
            // Atomics read what they add to; a storage texture's declared access is what the device is told.
            let atomic = usage.contains(GlobalUse::ATOMIC);
            let reads = match storage_texture {
                Some(wgpu::StorageTextureAccess::WriteOnly) => false,
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
            });
        }
        globals
    }

    fn global_span(
        &self,
        handle: Handle<naga::GlobalVariable>,
        variable: &naga::GlobalVariable,
    ) -> Span {
        let range = self
            .module
            .global_variables
            .get_span(handle)
            .to_range()
            .unwrap_or(0..0);
        let name = variable.name.as_deref().unwrap_or("");
        // The declaration begins with its attributes; the name is what matters, and the type follows it.
        let declaration = self.source.text.get(range.clone()).unwrap_or("");
        let declaration = declaration.split(':').next().unwrap_or("");
        let at = range.start + words(declaration, name).last().unwrap_or(0);
        self.source.locate(at..at + name.len())
    }

    /// Names of the sampler globals (but those that compare) through which the entry points sample a texture global.
    pub fn samplers_of(
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

    /// Overridable constants: name, the key that wgpu knows it by (its `@id` if it has one), whether it has a value of its
    /// own, and its place.
    pub fn overrides(&self) -> impl Iterator<Item = (&str, String, bool, Span)> {
        self.module
            .overrides
            .iter()
            .filter_map(|(handle, constant)| {
                let name = constant.name.as_deref()?;
                let key = constant
                    .id
                    .map_or_else(|| name.to_owned(), |id| id.to_string());
                let range = self
                    .module
                    .overrides
                    .get_span(handle)
                    .to_range()
                    .unwrap_or(0..0);
                Some((
                    name,
                    key,
                    constant.init.is_some(),
                    self.source.locate(range),
                ))
            })
    }

    /// Scalar class and component count of each colour output of a fragment entry point, by location.
    pub fn fragment_outputs(&self, entry: usize) -> Vec<(u32, ScalarClass, u32)> {
        let Some(result) = &self.module.entry_points[entry].function.result else {
            return Vec::new();
        };
        let mut outputs = Vec::new();
        let mut add = |binding: &Option<naga::Binding>, ty: Handle<naga::Type>| {
            if let (Some(naga::Binding::Location { location, .. }), Some((scalar, width))) =
                (binding, self.vector(ty))
            {
                outputs.push((*location, scalar, width));
            }
        };
        match &self.module.types[result.ty].inner {
            TypeInner::Struct { members, .. } => members
                .iter()
                .for_each(|member| add(&member.binding, member.ty)),
            _ => add(&result.binding, result.ty),
        }
        outputs.sort_by_key(|(location, ..)| *location);
        outputs
    }

    fn vector(&self, ty: Handle<naga::Type>) -> Option<(ScalarClass, u32)> {
        match self.module.types[ty].inner {
            TypeInner::Scalar(scalar) | TypeInner::Atomic(scalar) => {
                Some((ScalarClass::of(scalar.kind)?, 1))
            }
            TypeInner::Vector { size, scalar } => {
                Some((ScalarClass::of(scalar.kind)?, size as u32))
            }
            _ => None,
        }
    }

    fn class(&self, variable: &naga::GlobalVariable) -> Class {
        let inner = &self.module.types[variable.ty].inner;
        let size = u64::from(self.layouter[variable.ty].size);
        match (variable.space, inner) {
            (AddressSpace::Uniform, _) => {
                let members = match inner {
                    TypeInner::Struct { members, .. } => members
                        .iter()
                        .map(|member| Member {
                            name: member.name.clone().unwrap_or_default(),
                            offset: u64::from(member.offset),
                            vector: self.vector(member.ty),
                        })
                        .collect(),
                    _ => Vec::new(),
                };
                Class::Uniform { size, members }
            }
            (AddressSpace::Storage { access }, _) => {
                let (fixed, stride) = self.storage_size(variable.ty, size);
                let read_only = !access.contains(naga::StorageAccess::STORE);
                Class::Storage {
                    fixed,
                    stride,
                    read_only,
                    layout: self.layout(variable.ty),
                }
            }
            (
                AddressSpace::Handle,
                TypeInner::Image {
                    dim,
                    arrayed,
                    class,
                },
            ) => self.image(*dim, *arrayed, class),
            (AddressSpace::Handle, TypeInner::Sampler { comparison }) => Class::Sampler {
                comparison: *comparison,
            },
            (AddressSpace::Handle, TypeInner::AccelerationStructure { .. }) => {
                Class::Unsupported("an acceleration structure")
            }
            (AddressSpace::Handle, TypeInner::BindingArray { .. }) => {
                Class::Unsupported("a binding array")
            }
            _ => Class::Unsupported("a global of this address space"),
        }
    }

    fn image(&self, dim: naga::ImageDimension, arrayed: bool, class: &ImageClass) -> Class {
        let dimension = match (dim, arrayed) {
            (naga::ImageDimension::D2, false) => wgpu::TextureViewDimension::D2,
            (naga::ImageDimension::D2, true) => wgpu::TextureViewDimension::D2Array,
            (naga::ImageDimension::Cube, false) => wgpu::TextureViewDimension::Cube,
            (naga::ImageDimension::Cube, true) => wgpu::TextureViewDimension::CubeArray,
            _ => return Class::Unsupported("a 1D or 3D texture"),
        };
        match class {
            ImageClass::Sampled { multi: true, .. } | ImageClass::Depth { multi: true } => {
                Class::Unsupported("a multisampled texture")
            }
            ImageClass::Sampled { kind, .. } => match ScalarClass::of(*kind) {
                Some(scalar) => Class::Texture(TextureClass::Sampled {
                    scalar,
                    dimension,
                    depth: false,
                }),
                None => Class::Unsupported("a texture of this scalar type"),
            },
            ImageClass::Depth { .. } => Class::Texture(TextureClass::Sampled {
                scalar: ScalarClass::Float,
                dimension,
                depth: true,
            }),
            ImageClass::Storage { format, access } => {
                let load = access.contains(naga::StorageAccess::LOAD);
                let store = access.contains(naga::StorageAccess::STORE);
                let access = match (load, store) {
                    _ if access.contains(naga::StorageAccess::ATOMIC) => {
                        wgpu::StorageTextureAccess::Atomic
                    }
                    (true, true) => wgpu::StorageTextureAccess::ReadWrite,
                    (true, false) => wgpu::StorageTextureAccess::ReadOnly,
                    _ => wgpu::StorageTextureAccess::WriteOnly,
                };
                Class::Texture(TextureClass::Storage {
                    format: format!("{format:?}"),
                    dimension,
                    access,
                })
            }
            _ => Class::Unsupported("an external texture"),
        }
    }

    /// Bytes before the runtime-sized array and its stride, or the whole size.
    fn storage_size(&self, ty: Handle<naga::Type>, size: u64) -> (u64, Option<u64>) {
        match &self.module.types[ty].inner {
            TypeInner::Array {
                size: naga::ArraySize::Dynamic,
                stride,
                ..
            } => (0, Some(u64::from(*stride))),
            TypeInner::Struct { members, .. } => match members.last() {
                Some(last) => match self.module.types[last.ty].inner {
                    TypeInner::Array {
                        size: naga::ArraySize::Dynamic,
                        stride,
                        ..
                    } => (u64::from(last.offset), Some(u64::from(stride))),
                    _ => (size, None),
                },
                None => (size, None),
            },
            _ => (size, None),
        }
    }

    /// A type's memory layout in words, equal for equal layouts: `array<{0: vec3<f32>, 12: f32}, 16 bytes each>`. Names of
    /// members do not count.
    fn layout(&self, ty: Handle<naga::Type>) -> String {
        let mut text = String::new();
        self.write_layout(ty, &mut text, 0);
        text
    }

    fn write_layout(&self, ty: Handle<naga::Type>, text: &mut String, depth: usize) {
        // A struct of structs of structs … doubles with every level; what is longer than this is the same for our purpose.
        const LONGEST: usize = 4096;
        const DEEPEST: usize = 32;
        let scalar = |scalar: naga::Scalar| match scalar.kind {
            naga::ScalarKind::Float => format!("f{}", scalar.width * 8),
            naga::ScalarKind::Sint => format!("i{}", scalar.width * 8),
            _ => format!("u{}", scalar.width * 8),
        };
        if text.len() > LONGEST || depth > DEEPEST {
            text.push('…');
            return;
        }
        match &self.module.types[ty].inner {
            TypeInner::Scalar(kind) | TypeInner::Atomic(kind) => text.push_str(&scalar(*kind)),
            TypeInner::Vector { size, scalar: kind } => {
                text.push_str(&format!("vec{}<{}>", *size as u32, scalar(*kind)))
            }
            TypeInner::Matrix {
                columns,
                rows,
                scalar: kind,
            } => {
                text.push_str(&format!(
                    "mat{}x{}<{}>",
                    *columns as u32,
                    *rows as u32,
                    scalar(*kind)
                ));
            }
            TypeInner::Array { base, size, stride } => {
                text.push_str("array<");
                self.write_layout(*base, text, depth + 1);
                if let naga::ArraySize::Constant(count) = size {
                    text.push_str(&format!(", {count}"));
                }
                text.push_str(&format!(", {stride} bytes each>"));
            }
            TypeInner::Struct { members, .. } => {
                for (index, member) in members.iter().enumerate() {
                    let open = if index == 0 { "{" } else { ", " };
                    text.push_str(&format!("{open}{}: ", member.offset));
                    self.write_layout(member.ty, text, depth + 1);
                }
                text.push('}');
            }
            other => text.push_str(&format!("{other:?}")),
        }
    }
}

/// The place of the name of a function.
fn function_span(source: &Expanded, name: &str) -> Span {
    let text = &source.text;
    let at = words(text, name)
        .find(|&at| text[..at].trim_end().ends_with("fn"))
        .unwrap_or(0);
    source.locate(at..at + name.len())
}

/// Where `word` stands in `text` as a whole word.
fn words<'a>(text: &'a str, word: &'a str) -> impl Iterator<Item = usize> + 'a {
    let is_part = |c: char| c.is_alphanumeric() || c == '_';
    text.match_indices(word)
        .map(|(at, _)| at)
        .filter(move |&at| {
            !text[..at].ends_with(is_part) && !text[at + word.len()..].starts_with(is_part)
        })
}

/// Gives every resource global without numbers the next free ones of its group.
fn assign_bindings(module: &mut naga::Module, source: &Expanded) {
    let mut taken: BTreeSet<(u32, u32)> = module
        .global_variables
        .iter()
        .filter_map(|(_, v)| v.binding.map(|b| (b.group, b.binding)))
        .collect();
    let handles: Vec<_> = module
        .global_variables
        .iter()
        .map(|(handle, _)| handle)
        .collect();
    for handle in handles {
        let at = module
            .global_variables
            .get_span(handle)
            .to_range()
            .map_or(0, |range| range.start);
        let variable = module.global_variables.get_mut(handle);
        let is_resource = matches!(
            variable.space,
            AddressSpace::Uniform | AddressSpace::Storage { .. } | AddressSpace::Handle
        );
        if !is_resource || variable.binding.is_some() {
            continue;
        }
        let group = u32::from(!source.is_imported(at));
        let binding = (0..)
            .find(|&binding| !taken.contains(&(group, binding)))
            .unwrap_or(0);
        taken.insert((group, binding));
        variable.binding = Some(naga::ResourceBinding { group, binding });
    }
}

/// Two globals that one entry point uses under one number.
fn collision(
    handle: Handle<naga::GlobalVariable>,
    module: &naga::Module,
    source: &Expanded,
) -> Diagnostic {
    let binding = module.global_variables[handle].binding;
    let place = |handle| {
        module
            .global_variables
            .get_span(handle)
            .to_range()
            .unwrap_or(0..0)
    };
    let name = |handle: Handle<naga::GlobalVariable>| {
        module.global_variables[handle]
            .name
            .clone()
            .unwrap_or_default()
    };
    let number = binding.map_or(String::new(), |binding| {
        format!("@group({}) @binding({})", binding.group, binding.binding)
    });
    let message = format!(
        "`{}` of `{}` has a binding number that is taken: {number}",
        name(handle),
        source.file.name
    );
    let others = module
        .global_variables
        .iter()
        .filter(|(other, variable)| *other != handle && variable.binding == binding);
    others
        .fold(
            Diagnostic::error(Code::Binding, message).at(source.locate(place(handle)), "this one"),
            |diagnostic, (other, _)| {
                diagnostic.at(
                    source.locate(place(other)),
                    format!("`{}` has it too", name(other)),
                )
            },
        )
        .help("leave the numbers out: the graph gives them")
}

fn parse_error(error: &naga::front::wgsl::ParseError, source: &Expanded) -> Diagnostic {
    let mut diagnostic = Diagnostic::error(
        Code::Shader,
        format!(
            "`{}` does not compile: {}",
            source.file.name,
            error.message()
        ),
    );
    for (span, text) in error.labels() {
        if let Some(range) = span.to_range() {
            diagnostic = diagnostic.at(source.locate(range), text);
        }
    }
    let notes: Vec<&str> = error.notes().collect();
    if notes.is_empty() {
        diagnostic
    } else {
        diagnostic.help(notes.join("\n"))
    }
}

fn validation_error(
    error: &naga::WithSpan<ValidationError>,
    module: &naga::Module,
    source: &Expanded,
) -> Diagnostic {
    if let ValidationError::EntryPoint {
        source: EntryPointError::BindingCollision(handle),
        ..
    } = error.as_inner()
    {
        return collision(*handle, module, source);
    }
    // The causes say what is wrong; the outermost one only which function.
    let mut message = format!("`{}` is not valid: {}", source.file.name, error.as_inner());
    let mut cause = std::error::Error::source(error.as_inner());
    while let Some(inner) = cause {
        message.push_str(&format!(": {inner}"));
        cause = inner.source();
    }
    let mut diagnostic = Diagnostic::error(Code::Shader, message);
    for (span, text) in error.spans() {
        if let Some(range) = span.to_range() {
            // Some spans are labelled with a handle of naga's, which tells an author nothing.
            let text = if text.starts_with("naga::") { "" } else { text };
            diagnostic = diagnostic.at(source.locate(range), text);
        }
    }
    if diagnostic.labels.is_empty() {
        let place = match error.as_inner() {
            ValidationError::EntryPoint { name, .. } => function_span(source, name),
            _ => source.file.span(0..0),
        };
        diagnostic = diagnostic.at(place, "");
    }
    diagnostic
}
