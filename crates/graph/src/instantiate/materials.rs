//! Kinds and sizes of materials.

use super::growth::{Sizing, grow_buffer, grow_texture};
use super::state::Declared;
use crate::compose::Loaded;
use crate::diagnostics::{Reported, Reports};
use crate::document::{BufferEntry, FormatEntry, Material, Mips, SamplerEntry, TextureEntry};
use crate::errors::evaluation::EvaluationError;
use crate::errors::resource::SizeError;
use crate::expressions::eval;
use crate::language::{Expr, ExprKind, Scalar, Value};
use crate::request::PlanRequest;
use crate::resource::{Buffer, Growth, ResourceKind, Sampler, Texture};
use crate::source::{Located, Span};
use std::sync::Arc;

/// Finds kind, size and growth of a declared material. `full_name` is its key among the sizes that
/// earlier frames needed.
pub(super) fn kind(
    declared: &Declared,
    full_name: &str,
    (graph, request): (&Loaded, &PlanRequest<'_>),
    at: &mut impl Sizing,
) -> Reported<(ResourceKind, Option<Growth>)> {
    let (material, is_constant) = match declared.material() {
        material @ Material::Texture(entry) => (material, entry.file.is_some()),
        material @ Material::Buffer(entry) => (material, entry.data.is_some()),
        material @ Material::Sampler(_) => (material, false),
    };
    if material.keeps() && is_constant {
        let name = material.name().text();
        return Err(at.reports().report(SizeError::KeepsConstant(name)));
    }
    // The items or layers that a frame before has asked for; 0 if none has.
    let grown = request.grown.get(full_name).copied().unwrap_or(0);
    match material {
        Material::Texture(entry) => {
            let mut texture = texture(entry, declared, graph, at)?;
            let most = request.limits.max_texture_array_layers;
            let growth = grow_texture(entry, &mut texture, (grown, most), at)?;
            check_texture(entry, &texture, (graph, request), at.reports())?;
            Ok((ResourceKind::Texture(texture), growth))
        }
        Material::Buffer(entry) => {
            let mut buffer = buffer(entry, at)?;
            let growth = grow_buffer(entry, &mut buffer, grown, at)?;
            Ok((ResourceKind::Buffer(buffer), growth))
        }
        Material::Sampler(entry) => Ok((ResourceKind::Sampler(sampler(entry)), None)),
    }
}

fn texture(
    entry: &TextureEntry,
    declared: &Declared,
    graph: &Loaded,
    at: &mut impl Sizing,
) -> Reported<Texture> {
    let format = match &entry.format {
        FormatEntry::Named(format) => *format,
        FormatEntry::Expr(expr) => named_format(expr, at)?,
    };
    let picture = match &entry.file {
        None => None,
        Some(file) => {
            let picture = graph.pictures.get(&declared.document, &entry.name)?;
            at.reports().check(check_picture(entry, file, format))?;
            Some(picture)
        }
    };
    let edges = match (&entry.size, &picture) {
        (_, Some(picture)) => picture.size.map(u64::from).to_vec(),
        (Some(size), None) => eval::edges(size, at)?,
        (None, None) => at.viewport().map(u64::from).to_vec(),
    };
    let mut one = |expr: &Option<Expr>| match expr {
        Some(expr) => eval::count32(expr, at),
        None => Ok(1),
    };
    let (layers, samples) = (one(&entry.layers)?, one(&entry.samples)?);
    let name = entry.name.value.clone();
    let span = size_span(entry);
    let too_large = || SizeError::Absurd(Located::new(name.to_string(), span.clone()));
    let narrow = |edge: &u64| u32::try_from(*edge).ok();
    let narrow: Option<Vec<u32>> = edges.iter().map(narrow).collect();
    let narrow = narrow.ok_or_else(|| at.reports().report(too_large()))?;
    let size = [narrow[0], narrow[1]];
    let is_3d = narrow.len() == 3;
    let depth = narrow.get(2).copied().unwrap_or(1);
    let mips = match &entry.mips {
        Mips::One => 1,
        Mips::All => {
            let longest = size[0].max(size[1]).max(if is_3d { depth } else { 1 });
            longest.max(1).ilog2() + 1
        }
        Mips::Number(expr) => eval::count32(expr, at)?,
    };
    if is_3d && layers != 1 {
        let name = Located::new(name.to_string(), entry.name.span.clone());
        return Err(at.reports().report(SizeError::LayersOf3d(name)));
    }
    Ok(Texture {
        format,
        size,
        layers: if is_3d { depth } else { layers },
        is_3d,
        mips,
        samples,
        picture,
    })
}

fn named_format(expr: &Expr, at: &mut impl Sizing) -> Reported<wgt::TextureFormat> {
    match eval::value(expr, at)? {
        Value::Format(format) => Ok(format),
        value => {
            let error = EvaluationError::Type(expr.span.clone(), "a format", value);
            Err(at.reports().report(error))
        }
    }
}

/// Checks that the format of a texture with a picture can hold it, and that the document gives no
/// size, mips, layers or samples beside it.
fn check_picture(
    entry: &TextureEntry,
    file: &Located<String>,
    format: wgt::TextureFormat,
) -> Result<(), SizeError> {
    let takes = [
        (entry.size.is_some(), "size"),
        (!matches!(entry.mips, Mips::One), "mips"),
        (entry.layers.is_some(), "layers"),
        (entry.samples.is_some(), "samples"),
    ];
    if let Some((_, field)) = takes.into_iter().find(|(given, _)| *given) {
        return Err(SizeError::FileHas(file.clone(), field));
    }
    if !crate::picture::can_hold(format) {
        let position = Located::new(format!("{format:?}"), file.span.clone());
        return Err(SizeError::PictureFormat(position));
    }
    Ok(())
}

fn buffer(entry: &BufferEntry, at: &mut impl Sizing) -> Reported<Buffer> {
    let name = |span: &Span| Located::new(entry.name.value.to_string(), span.clone());
    let count = match (&entry.count, &entry.data) {
        (Some(count), Some(_)) => {
            return Err(at.reports().report(SizeError::DataHas(name(&count.span))));
        }
        (None, Some(data)) if data.0.is_empty() => {
            return Err(at.reports().report(SizeError::NoItems(name(&data.span))));
        }
        (None, Some(data)) => Some(data.0.len() as u64),
        (None, None) => None,
        (Some(expr), None) => match eval::count(expr, at)? {
            // As for what a host provides: wgpu binds nothing of size zero.
            0 if expr.is_taken() => Some(1),
            0 => return Err(at.reports().report(SizeError::NoItems(name(&expr.span)))),
            count => Some(count),
        },
    };
    let data = match &entry.data {
        None => None,
        Some(data) => {
            let items = data.0.iter().map(|item| {
                let mut numbers = Vec::new();
                flatten(item, &mut numbers, at).map(|()| numbers)
            });
            Some(Arc::new(items.collect::<Reported<Vec<_>>>()?))
        }
    };
    Ok(Buffer {
        count,
        data,
        ..Buffer::default()
    })
}

/// Appends the numbers of an item, those of tuples and vectors in it in their places.
fn flatten(item: &Expr, numbers: &mut Vec<f64>, at: &mut impl Sizing) -> Reported<()> {
    if let ExprKind::Tuple(parts) = &item.kind {
        return parts.iter().try_for_each(|part| flatten(part, numbers, at));
    }
    match eval::value(item, at)? {
        Value::List(list) => numbers.extend(list.into_iter().map(Scalar::number)),
        Value::Scalar(number) => numbers.push(number.number()),
        value => {
            let error = EvaluationError::Type(item.span.clone(), "a number", value);
            return Err(at.reports().report(error));
        }
    }
    Ok(())
}

fn check_texture(
    entry: &TextureEntry,
    texture: &Texture,
    (graph, request): (&Loaded, &PlanRequest<'_>),
    reports: &mut Reports,
) -> Reported<()> {
    let format = texture.format;
    let feature = format.required_features() - graph.features();
    if !feature.is_empty() {
        let name = entry.name.text();
        return Err(reports.report(SizeError::FormatFeature(name, format, feature)));
    }
    let limits = &request.limits;
    let Texture {
        size: [width, height],
        layers,
        mips,
        samples,
        ..
    } = *texture;
    let name = |span: Span| Located::new(entry.name.value.to_string(), span);
    let (whole, sized) = (entry.name.span.clone(), size_span(entry));
    if [width, height, layers, mips, samples].contains(&0) {
        return Err(reports.report(SizeError::NoTexels {
            name: name(sized),
            size: [width, height],
            layers,
            mips,
            samples,
        }));
    }
    let [most, third] = if texture.is_3d {
        [limits.max_texture_dimension_3d; 2]
    } else {
        [
            limits.max_texture_dimension_2d,
            limits.max_texture_array_layers,
        ]
    };
    if width > most || height > most {
        let size = [width, height];
        let name = name(sized);
        reports.unsupported(SizeError::Texels(name, size, most))?;
    }
    if layers > third {
        reports.unsupported(SizeError::Layers {
            name: name(whole.clone()),
            layers,
            most: third,
        })?;
    }
    let depth = if texture.is_3d { layers } else { 1 };
    let longest = width.max(height).max(depth);
    let full = longest.ilog2() + 1;
    if mips > full {
        return Err(reports.report(SizeError::Mips {
            name: name(whole),
            mips,
            full,
        }));
    }
    if samples > 1 {
        check_samples(name(whole), texture, request.features, reports)?;
    }
    Ok(())
}

fn check_samples(
    name: Located<String>,
    texture: &Texture,
    features: wgt::Features,
    reports: &mut Reports,
) -> Reported<()> {
    if texture.is_3d || texture.layers > 1 || texture.mips > 1 {
        return Err(reports.report(SizeError::SamplesOfMany(name)));
    }
    let format = texture.format;
    let flags = format.guaranteed_format_features(features).flags;
    let supported = flags.supported_sample_counts();
    if supported.contains(&texture.samples) {
        Ok(())
    } else {
        reports.unsupported(SizeError::Samples(name, format, texture.samples, supported))
    }
}

fn size_span(entry: &TextureEntry) -> Span {
    match &entry.size {
        Some(size) => size.span.clone(),
        None => entry.name.span.clone(),
    }
}

fn sampler(entry: &SamplerEntry) -> Sampler {
    Sampler {
        filter: entry.filter,
        address: entry.address,
        compare: entry.compare.map(Into::into),
    }
}
