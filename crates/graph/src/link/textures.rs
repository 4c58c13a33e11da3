//! Whether a texture can be what a shader declares: format, dimension, filtering, storage access.

use super::{LinkedProgram, Linker, attachments::scalar_of};
use crate::{
    diagnostics::{Code, Diagnostic},
    document::materials::Filter,
    resolve::{Part, Resource, ResourceKind},
    step::Program,
    wgsl::{Global, ScalarClass, TextureClass},
};

impl Linker<'_, '_> {
    pub(super) fn texture(
        &mut self,
        global: &Global,
        class: &TextureClass,
        (format, part): (wgpu::TextureFormat, &Part),
        (linked, program): (&LinkedProgram, &Program),
        resource: &Resource,
    ) -> Option<(wgpu::BindingType, wgpu::TextureUsages)> {
        let features = format.guaranteed_format_features(self.features);
        let name = &resource.name;
        let mismatch = |expected: String| {
            let message = format!(
                "the texture `{name}` has the format {format:?}, which the shader's `{}` cannot use",
                global.name
            );
            let error =
                Diagnostic::error(Code::FormatMismatch, message).at(global.span.clone(), expected);
            match &resource.declared {
                Some(declared) => error.at(declared.clone(), format!("{format:?}")),
                None => error,
            }
        };
        let dimension = match class {
            TextureClass::Sampled { dimension, .. } | TextureClass::Storage { dimension, .. } => {
                *dimension
            }
        };
        if dimension == wgpu::TextureViewDimension::D2 && part.layers.len() > 1 {
            self.report(
                Diagnostic::error(
                    Code::ResourceKind,
                    format!(
                        "`{name}` has {} layers, the shader sees one",
                        part.layers.len()
                    ),
                )
                .at(
                    global.span.clone(),
                    "declare an array texture, or bind a view of one layer",
                ),
            );
            return None;
        }
        let cube = matches!(
            dimension,
            wgpu::TextureViewDimension::Cube | wgpu::TextureViewDimension::CubeArray
        );
        if cube
            && (part.layers.len() % 6 != 0
                || dimension == wgpu::TextureViewDimension::Cube && part.layers.len() != 6)
        {
            self.report(
                Diagnostic::error(
                    Code::ResourceKind,
                    format!("`{name}` has {} layers, a cube has six", part.layers.len()),
                )
                .at(global.span.clone(), "the shader sees a cube"),
            );
            return None;
        }
        match class {
            TextureClass::Sampled { scalar, depth, .. } => {
                let declared = scalar_of(format);
                if declared != Some(*scalar) || (*depth && !format.is_depth_stencil_format()) {
                    let what = match declared {
                        _ if *depth => "the shader declares a depth texture".to_owned(),
                        Some(own) => format!("the shader reads {scalar}, the texture holds {own}"),
                        None => format!("the shader reads {scalar}"),
                    };
                    self.report(mismatch(what));
                    return None;
                }
                let filterable = features
                    .flags
                    .contains(wgpu::TextureFormatFeatureFlags::FILTERABLE);
                let is_depth = format.is_depth_stencil_format();
                if !filterable || is_depth {
                    for sampler in linked.shader.samplers_of(&linked.entries, global.handle) {
                        let bound = program
                            .bind
                            .iter()
                            .find(|(global, _)| global.value == sampler);
                        let name = match bound {
                            Some((_, name)) => &name.value,
                            None => self.global(&sampler),
                        };
                        let target = self.resources.find_spelt(name);
                        let linear = target.is_some_and(|target| {
                            matches!(&self.resources.get(target.id).kind, ResourceKind::Sampler(entry)
                                if entry.filter == Filter::Linear && entry.compare.is_none())
                        });
                        if linear {
                            self.report(mismatch(format!("sampled through `{sampler}`, but the format cannot be filtered"))
                                .help("use a sampler with `filter: Nearest`, textureLoad, or a filterable format"));
                            return None;
                        }
                    }
                }
                let sample_type = match (scalar, depth) {
                    (_, true) => wgpu::TextureSampleType::Depth,
                    (ScalarClass::Float, _) => wgpu::TextureSampleType::Float {
                        filterable: filterable && !is_depth,
                    },
                    (ScalarClass::Uint, _) => wgpu::TextureSampleType::Uint,
                    (ScalarClass::Sint, _) => wgpu::TextureSampleType::Sint,
                };
                let ty = wgpu::BindingType::Texture {
                    sample_type,
                    view_dimension: dimension,
                    multisampled: false,
                };
                Some((ty, wgpu::TextureUsages::TEXTURE_BINDING))
            }
            TextureClass::Storage {
                format: declared,
                access,
                ..
            } => {
                // naga's storage formats bear wgpu's names.
                if *declared != format!("{format:?}") {
                    self.report(mismatch(format!("the shader declares {declared}")));
                    return None;
                }
                let both = *access == wgpu::StorageTextureAccess::ReadWrite;
                let allowed = features
                    .allowed_usages
                    .contains(wgpu::TextureUsages::STORAGE_BINDING)
                    && (!both
                        || features
                            .flags
                            .contains(wgpu::TextureFormatFeatureFlags::STORAGE_READ_WRITE));
                if !allowed {
                    self.report(mismatch("the adapter offers no storage access of this kind".to_owned()).help(
                        "R32Uint, R32Float and the Rgba formats of 8, 16 and 32 bits can be written by every adapter",
                    ));
                    return None;
                }
                if part.mips.len() > 1 {
                    self.report(
                        Diagnostic::error(
                            Code::ResourceKind,
                            format!("`{name}` has several mips, a storage texture is one"),
                        )
                        .at(global.span.clone(), "bind a view of one mip"),
                    );
                    return None;
                }
                let ty = wgpu::BindingType::StorageTexture {
                    access: *access,
                    format,
                    view_dimension: dimension,
                };
                Some((ty, wgpu::TextureUsages::STORAGE_BINDING))
            }
        }
    }
}
