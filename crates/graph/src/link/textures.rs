//! Checks that a texture fits a shader's declaration: format, dimension, filtering, storage access.

use super::{pass::LinkedProgram, scope::PassScope};
use crate::diagnostics::Reported;
use crate::document::Filter;
use crate::errors::link::{LinkError, TextureMisfit};
use crate::kinds::Program;
use crate::resource::{Target, Texture};
use crate::scalar_class::ItemScalar;
use crate::shader::{Global, SampledClass, TextureClass};
use wgt::{TextureAspect, TextureFormat, TextureFormatFeatureFlags as Flags, TextureUsages};

/// Returns the scalar type that a shader reads from a format, or from one aspect of a format with
/// two; `None` if it cannot be read.
pub(super) fn scalar_of(format: TextureFormat, aspect: TextureAspect) -> Option<ItemScalar> {
    Some(match format.sample_type(Some(aspect), None)? {
        wgt::TextureSampleType::Float { .. } | wgt::TextureSampleType::Depth => ItemScalar::F32,
        wgt::TextureSampleType::Uint => ItemScalar::U32,
        wgt::TextureSampleType::Sint => ItemScalar::I32,
    })
}

/// Type of a binding, usage of its texture, and the aspect that is bound.
type Bound = (wgt::BindingType, TextureUsages, TextureAspect);

pub(super) fn texture(
    global: &Global,
    (dimension, class): (wgt::TextureViewDimension, &TextureClass),
    (texture, target): (&Texture, &Target),
    (linked, program): (&LinkedProgram, &Program),
    scope: &mut PassScope<'_>,
) -> Reported<Bound> {
    let grows = scope.get(target.id).growth.is_some();
    let misfit = wrong_shape(dimension, texture, target, grows);
    let bound = match (misfit, class) {
        (Some(misfit), _) => Err(misfit),
        (None, TextureClass::Sampled(class)) => sampled(
            global,
            (dimension, *class),
            texture,
            (linked, program),
            scope,
        ),
        (None, TextureClass::Storage(format, access)) => {
            storage((format, *access, dimension), texture, target, scope)
        }
    };
    bound.map_err(|misfit| {
        let resource = scope.get(target.id);
        let error = LinkError::Texture {
            name: resource.name.clone(),
            format: texture.format,
            global: global.located(),
            declared: resource.declared.clone(),
            misfit: Box::new(misfit),
        };
        scope.report(error)
    })
}

fn sampled(
    global: &Global,
    (dimension, class): (wgt::TextureViewDimension, SampledClass),
    texture: &Texture,
    (linked, program): (&LinkedProgram, &Program),
    scope: &mut PassScope<'_>,
) -> Result<Bound, TextureMisfit> {
    let SampledClass {
        scalar,
        depth,
        multisampled,
    } = class;
    let format = texture.format;
    let features = format.guaranteed_format_features(scope.request().features);
    // For a texture with both, the shader's type says which is meant.
    let aspect = match (format.is_combined_depth_stencil_format(), scalar) {
        (false, _) => TextureAspect::All,
        (true, ItemScalar::U32) => TextureAspect::StencilOnly,
        (true, _) => TextureAspect::DepthOnly,
    };
    let declared = scalar_of(format, aspect);
    if declared != Some(scalar) || (depth && !format.is_depth_stencil_format()) {
        return Err(TextureMisfit::Scalar(scalar, declared, depth));
    }
    if multisampled != (texture.samples > 1) {
        return Err(TextureMisfit::Samples(texture.samples));
    }
    let is_depth = format.is_depth_stencil_format();
    let filterable = features.flags.contains(Flags::FILTERABLE) && !is_depth;
    let able = wgt::Features::FLOAT32_FILTERABLE;
    let with_feature = format.guaranteed_format_features(able).flags;
    let by_feature = with_feature.contains(Flags::FILTERABLE);
    let asks = by_feature && scope.symbols.graph.features().contains(able);
    let suits = filterable || asks && scope.symbols.reports.any_adapter;
    let is_linear = |name: &String| {
        let sampler = scope.sampler(program, name);
        sampler.is_some_and(|it| it.filter == Filter::Linear && it.compare.is_none())
    };
    let samplers = linked.shader.samplers_of(&linked.entries, global.handle);
    if !suits && let Some(sampler) = samplers.into_iter().find(is_linear) {
        return Err(TextureMisfit::Filtered(sampler, by_feature));
    }
    let sample_type = match (scalar, depth) {
        (_, true) => wgt::TextureSampleType::Depth,
        (ItemScalar::F32, _) => wgt::TextureSampleType::Float {
            filterable: filterable && !multisampled,
        },
        (ItemScalar::U32, _) => wgt::TextureSampleType::Uint,
        (ItemScalar::I32, _) => wgt::TextureSampleType::Sint,
    };
    let ty = wgt::BindingType::Texture {
        sample_type,
        view_dimension: dimension,
        multisampled,
    };
    Ok((ty, TextureUsages::TEXTURE_BINDING, aspect))
}

fn storage(
    (declared, access, dimension): (&str, wgt::StorageTextureAccess, wgt::TextureViewDimension),
    texture: &Texture,
    target: &Target,
    scope: &PassScope<'_>,
) -> Result<Bound, TextureMisfit> {
    let format = texture.format;
    let features = if scope.symbols.reports.any_adapter {
        // A device may have any.
        wgt::Features::all()
    } else {
        scope.request().features
    };
    let features = format.guaranteed_format_features(features);
    // naga's storage formats bear wgpu's names.
    if declared != format!("{format:?}") {
        return Err(TextureMisfit::StorageFormat(declared.to_owned()));
    }
    if texture.samples > 1 {
        return Err(TextureMisfit::StorageSamples(texture.samples));
    }
    let both = access == wgt::StorageTextureAccess::ReadWrite;
    let usages = features.allowed_usages;
    let allowed = usages.contains(TextureUsages::STORAGE_BINDING)
        && (!both || features.flags.contains(Flags::STORAGE_READ_WRITE));
    if !allowed {
        return Err(TextureMisfit::NoStorage);
    }
    if target.part.mips.len() > 1 {
        return Err(TextureMisfit::StorageMips);
    }
    let ty = wgt::BindingType::StorageTexture {
        access,
        format,
        view_dimension: dimension,
    };
    Ok((ty, TextureUsages::STORAGE_BINDING, TextureAspect::All))
}

fn wrong_shape(
    dimension: wgt::TextureViewDimension,
    texture: &Texture,
    target: &Target,
    grows: bool,
) -> Option<TextureMisfit> {
    use wgt::TextureViewDimension as D;
    let layers = target.part.layers.len();
    match dimension {
        D::D3 if !texture.is_3d => Some(TextureMisfit::Flat),
        D::D3 if layers < texture.mip_layers(target.part.mips.start) as usize => {
            Some(TextureMisfit::Slice)
        }
        D::D3 => None,
        _ if texture.is_3d => Some(TextureMisfit::Solid),
        D::D2 if layers > 1 => Some(TextureMisfit::Layers(layers)),
        D::Cube | D::CubeArray if grows && target.part.layers == (0..texture.layers) => {
            Some(TextureMisfit::Grows)
        }
        D::Cube if layers != 6 => Some(TextureMisfit::Cube(layers)),
        D::CubeArray if !layers.is_multiple_of(6) => Some(TextureMisfit::Cube(layers)),
        _ => None,
    }
}
