//! Draws: colour, depth and stencil attachments, their formats and sizes, outputs of the fragment
//! shader.

use super::pass::{Attachment, Ids, LinkedProgram, Usage};
use super::scope::PassScope;
use super::textures::scalar_of;
use super::{canvas, dispatch, limits, programs};
use crate::diagnostics::Reported;
use crate::errors::link::LinkError;
use crate::kinds::{ColorTarget, DepthTarget, Draw, Names, StencilTarget};
use crate::language::Reference;
use crate::resource::{ResourceKind, Target, Texture};
use crate::scalar_class::ItemScalar;
use crate::shader::{Varying, Varyings};
use crate::source::{Located, Span};
use wgt::{
    Features, TextureAspect, TextureFormat, TextureFormatFeatureFlags as Flags, TextureUsages,
};

const ATTACHMENT: Usage = Usage::Texture(TextureUsages::RENDER_ATTACHMENT);

pub(super) fn link(draw: &Draw<Names>, scope: &mut PassScope<'_>) -> Reported<Draw<Ids>> {
    let (stages, depth_only) = canvas::stages_of(draw, || scope.shader(&draw.program));
    let mut program = programs::link(&draw.program, stages, depth_only, scope);
    if let Ok(linked) = &program
        && let Err(reported) = limits::stages(linked, draw, scope)
    {
        program = Err(reported);
    }
    let colors = colors(draw, program.as_ref().ok(), scope);
    let depth = draw.depth.as_ref();
    let depth = depth.map(|depth| link_depth(depth, scope));
    let stencil = draw.stencil.as_ref();
    let stencil = stencil.map(|stencil| link_stencil(stencil, scope));
    let canvas = canvas::texture(draw, program.as_ref().ok(), scope);
    let canvas = canvas.map(|texture| {
        let (texture, span) = (texture?, &draw.canvas.as_ref()?.span);
        let (format, samples) = (texture.format, texture.samples);
        // A slash stands in no name: nothing in a document can mean this texture.
        let name = format!("{}/canvas", scope.pass.value);
        let target = scope.add(name, ResourceKind::Texture(texture));
        // It is no content: nothing is written, and nothing of before is needed.
        scope.access(&target, (false, false, true), ATTACHMENT, span);
        Some(Attachment {
            target,
            format,
            samples,
        })
    });
    let arguments = |name: &_| dispatch::indirect(name, 16, scope);
    let call = draw.call.in_stage(arguments);
    features(draw, scope)?;
    let linked = Draw {
        program: program?,
        fullscreen: draw.fullscreen,
        colors: colors?,
        depth: depth.transpose()?,
        stencil: stencil.transpose()?,
        canvas: canvas?,
        area: draw.area,
        call: call?,
        primitive: draw.primitive,
    };
    scope.check(alike(&linked, scope))?;
    Ok(linked)
}

/// Checks features of the rasteriser that not every device has.
fn features(draw: &Draw<Names>, scope: &mut PassScope<'_>) -> Reported<()> {
    let features = scope.request().features;
    let primitive = &draw.primitive;
    #[rustfmt::skip] // A line each.
    let asked = [
        (primitive.conservative, "conservative: true", Features::CONSERVATIVE_RASTERIZATION),
        (primitive.unclipped_depth, "unclipped: true", Features::DEPTH_CLIP_CONTROL),
    ];
    for (is_asked, field, feature) in asked {
        if is_asked && !features.contains(feature) {
            scope.unsupported(LinkError::DrawFeature {
                pass: scope.pass.clone(),
                field,
                feature: feature.iter_names().next().map_or("", |(name, _)| name),
            })?;
        }
    }
    Ok(())
}

fn colors(
    draw: &Draw<Names>,
    program: Option<&LinkedProgram>,
    scope: &mut PassScope<'_>,
) -> Reported<Vec<Option<ColorTarget<Ids>>>> {
    let outputs = program.and_then(|program| {
        let entry = *program.entries.last()?;
        let outputs = Varyings::outputs(program.shader.module(), entry).locations;
        Some((outputs, program.shader.entry_span(entry)))
    });
    let limits = scope.request().limits.clone();
    let most = limits.max_color_attachments;
    if draw.colors.len() > most as usize {
        let (pass, count) = (scope.pass.clone(), draw.colors.len());
        scope.unsupported(LinkError::TooManyTargets(pass, count, most))?;
    }
    let mut colors = Vec::with_capacity(draw.colors.len());
    let mut bytes_per_sample = 0u32;
    let mut wrong = None;
    for (location, color) in (0u32..).zip(&draw.colors) {
        let Some(color) = color else {
            colors.push(None);
            continue;
        };
        let linked = match link_color(color, scope) {
            Ok(linked) => linked,
            Err(reported) => {
                wrong = Some(reported);
                continue;
            }
        };
        let format = linked.target.format;
        if let (Some(cost), Some(alignment)) = (
            format.target_pixel_byte_cost(),
            format.target_component_alignment(),
        ) {
            bytes_per_sample = bytes_per_sample.next_multiple_of(alignment.max(1)) + cost;
        }
        if let Some((outputs, span)) = &outputs {
            let checked = check_output(location, &color.target, format, outputs, span);
            wrong = scope.check(checked).err().or(wrong);
        }
        colors.push(Some(linked));
    }
    let targets = draw.colors.len() as u32;
    if let Some((outputs, span)) = outputs.as_ref().filter(|_| draw.canvas.is_none()) {
        let mut locations = outputs.iter().map(|output| output.location);
        if let Some(location) = locations.find(|location| *location >= targets) {
            let (pass, entry) = (scope.pass.clone(), span.clone());
            let error = LinkError::NoTarget(pass, location, entry);
            scope.symbols.reports.warn(error);
        }
    }
    let most = limits.max_color_attachment_bytes_per_sample;
    if bytes_per_sample > most {
        scope.unsupported(LinkError::BytesPerPixel {
            pass: scope.pass.clone(),
            bytes: bytes_per_sample,
            most,
        })?;
    }
    wrong.map_or(Ok(colors), Err)
}

fn link_color(color: &ColorTarget<Names>, scope: &mut PassScope<'_>) -> Reported<ColorTarget<Ids>> {
    let name = color.target.located();
    let target = attachment(&color.target, scope)?;
    let format = target.format;
    let features = format.guaranteed_format_features(scope.request().features);
    let usages = features.allowed_usages;
    if format.is_depth_stencil_format() || !usages.contains(TextureUsages::RENDER_ATTACHMENT) {
        return Err(scope.report(LinkError::NotDrawable(name, format)));
    }
    if color.blend.is_some() && !features.flags.contains(Flags::BLENDABLE) {
        return Err(scope.report(LinkError::NotBlendable(name, format)));
    }
    if let Some(value) = color.clear {
        scope.check(clear_value(&name, format, value))?;
    }
    let clears = color.clear.is_some();
    let used = (!clears, true, clears);
    scope.access(&target.target, used, ATTACHMENT, &name.span);
    let resolve = match &color.resolve {
        Some(resolve) => Some(resolved(&target, resolve, scope)?),
        None => None,
    };
    Ok(ColorTarget {
        target,
        resolve,
        clear: color.clear,
        blend: color.blend,
        blend_constant: color.blend_constant,
        write: color.write,
    })
}

/// Links the single-sampled texture that a multisampled target is resolved into.
fn resolved(
    target: &Attachment,
    resolve: &Reference,
    scope: &mut PassScope<'_>,
) -> Reported<Attachment> {
    let name = resolve.located();
    let resolved = attachment(resolve, scope)?;
    let format = target.format;
    let features = format.guaranteed_format_features(scope.request().features);
    let why = if target.samples == 1 {
        Some("what is drawn to has one sample")
    } else if resolved.samples != 1 {
        Some("it has several samples itself")
    } else if resolved.format != format {
        Some("it has another format than what is drawn to")
    } else if !features.flags.contains(Flags::MULTISAMPLE_RESOLVE) {
        Some("this format cannot be resolved")
    } else {
        None
    };
    if let Some(why) = why {
        return Err(scope.report(LinkError::Resolve(name, why)));
    }
    let used = (false, true, true);
    scope.access(&resolved.target, used, ATTACHMENT, &name.span);
    Ok(resolved)
}

fn check_output(
    location: u32,
    target: &Reference,
    format: TextureFormat,
    outputs: &[Varying],
    entry: &Span,
) -> Result<(), LinkError> {
    let name = target.located();
    let Some(output) = outputs.iter().find(|output| output.location == location) else {
        return Err(LinkError::NoFragmentOutput(name, location, entry.clone()));
    };
    let needed = u32::from(format.components());
    let expected = scalar_of(format, TextureAspect::All);
    let Varying { scalar, width, .. } = output;
    if expected == Some(*scalar) && *width >= needed {
        return Ok(());
    }
    Err(LinkError::FragmentOutput {
        name,
        format,
        expected: expected.map_or("…", ItemScalar::as_str).to_owned(),
        needed,
        written: format!("{width} × {}", scalar.as_str()),
        location,
        entry: entry.clone(),
    })
}

fn link_depth(depth: &DepthTarget<Names>, scope: &mut PassScope<'_>) -> Reported<DepthTarget<Ids>> {
    let name = depth.target.located();
    let target = attachment(&depth.target, scope)?;
    let format = target.format;
    if !format.has_depth_aspect() {
        return Err(scope.report(LinkError::NoDepth(name, format)));
    }
    if let Some(value) = depth.clear {
        scope.check(clear_value(&name, format, [value.into(), 0.0, 0.0, 0.0]))?;
    }
    let clears = depth.clear.is_some();
    let used = (!clears, depth.write || clears, clears);
    let depth_of = aspect_of(&target.target, format, TextureAspect::DepthOnly);
    scope.access(&depth_of, used, ATTACHMENT, &name.span);
    Ok(DepthTarget {
        target,
        clear: depth.clear,
        compare: depth.compare,
        write: depth.write,
        bias: depth.bias,
    })
}

fn link_stencil(
    stencil: &StencilTarget<Names>,
    scope: &mut PassScope<'_>,
) -> Reported<StencilTarget<Ids>> {
    let name = stencil.target.located();
    let target = attachment(&stencil.target, scope)?;
    let format = target.format;
    if !format.has_stencil_aspect() {
        return Err(scope.report(LinkError::NoStencil(name, format)));
    }
    if let Some(wrong) = stencil.clear.filter(|value| *value > u32::from(u8::MAX)) {
        return Err(scope.report(LinkError::ClearValue {
            name,
            wrong: wrong.into(),
            format,
            expected: "a stencil from 0 to 255",
        }));
    }
    let clears = stencil.clear.is_some();
    let writes = !stencil.state.is_read_only(None);
    let used = (!clears, writes || clears, clears);
    let stencil_of = aspect_of(&target.target, format, TextureAspect::StencilOnly);
    scope.access(&stencil_of, used, ATTACHMENT, &name.span);
    Ok(StencilTarget {
        target,
        clear: stencil.clear,
        state: stencil.state.clone(),
        reference: stencil.reference,
    })
}

/// Checks that a clear value fits into the format.
pub(super) fn clear_value(
    name: &Located<String>,
    format: TextureFormat,
    value: [f64; 4],
) -> Result<(), LinkError> {
    let mut channels = &value[..usize::from(format.components()).min(4)];
    let is_stencil = |value: f64| value.fract() == 0.0 && (0.0..=255.0).contains(&value);
    if format.is_combined_depth_stencil_format() && is_stencil(value[1]) {
        channels = &value[..1];
    } else if format.has_stencil_aspect() && !format.has_depth_aspect() {
        // A single number stands in all four; of two the second is the stencil.
        channels = &value[1..2];
    }
    let (is_whole, range, expected) = match scalar_of(format, TextureAspect::All) {
        _ if format.is_combined_depth_stencil_format() => {
            let expected = "a depth from 0 to 1, and a stencil from 0 to 255";
            (false, 0.0..=1.0, expected)
        }
        _ if format.has_depth_aspect() => (false, 0.0..=1.0, "a depth from 0 to 1"),
        _ if format.has_stencil_aspect() => (true, 0.0..=255.0, "a whole number from 0 to 255"),
        Some(ItemScalar::U32) => (true, 0.0..=u32::MAX.into(), "whole numbers from 0"),
        Some(ItemScalar::I32) => {
            let range = i32::MIN.into()..=i32::MAX.into();
            (true, range, "whole numbers of 32 bits")
        }
        _ => (false, f64::MIN..=f64::MAX, "finite numbers"),
    };
    let fits = |value: &f64| range.contains(value) && !(is_whole && value.fract() != 0.0);
    match channels.iter().find(|value| !fits(value)) {
        None => Ok(()),
        Some(&wrong) => Err(LinkError::ClearValue {
            name: name.clone(),
            wrong,
            format,
            expected,
        }),
    }
}

fn attachment(reference: &Reference, scope: &mut PassScope<'_>) -> Reported<Attachment> {
    let target = scope.resolve(reference)?;
    let name = reference.located();
    let resource = scope.get(target.id);
    let ResourceKind::Texture(texture) = &resource.kind else {
        let kind = resource.kind.describe();
        return Err(scope.report(LinkError::NoTexture(scope.pass.value.clone(), name, kind)));
    };
    let Texture {
        format, samples, ..
    } = *texture;
    if !target.part.is_single() {
        return Err(scope.report(LinkError::SeveralLayers(name)));
    }
    scope.writable(target.id, &name.span)?;
    Ok(Attachment {
        target,
        format,
        samples,
    })
}

/// Checks that all attachments of a draw have the same size and number of samples, that the area
/// lies within them, and that depth and stencil are the same texture.
fn alike(draw: &Draw<Ids>, scope: &PassScope<'_>) -> Result<(), LinkError> {
    let colors = draw.colors.iter().flatten().map(|color| &color.target);
    let resolved = draw.colors.iter().flatten();
    let resolved = resolved.filter_map(|color| color.resolve.as_ref());
    let depth = draw.depth.as_ref().map(|depth| &depth.target);
    let stencil = draw.stencil.as_ref().map(|stencil| &stencil.target);
    let drawn = colors.chain(depth).chain(stencil).chain(&draw.canvas);
    let drawn: Vec<&Attachment> = drawn.collect();
    let Some(first) = drawn.first() else {
        return Err(LinkError::NoTargets(scope.pass.clone(), draw.fullscreen));
    };
    if let (Some(depth), Some(stencil)) = (depth, stencil)
        && depth.target != stencil.target
    {
        return Err(LinkError::TwoDepthStencils(scope.pass.clone()));
    }
    let size = |attachment: &Attachment| match &scope.get(attachment.target.id).kind {
        ResourceKind::Texture(texture) => texture.mip_size(attachment.target.part.mips.start),
        _ => [0, 0],
    };
    let name = |attachment: &Attachment| scope.get(attachment.target.id).name.clone();
    let whole = size(first);
    let differs = |other: &&Attachment| size(other) != whole;
    if let Some(other) = drawn.iter().copied().chain(resolved).find(differs) {
        return Err(LinkError::TargetSizes {
            pass: scope.pass.clone(),
            names: [name(first), name(other)],
            sizes: [whole, size(other)],
        });
    }
    if let Some(other) = drawn.iter().find(|other| other.samples != first.samples) {
        return Err(LinkError::TargetSamples {
            pass: scope.pass.clone(),
            names: [name(first), name(other)],
            samples: [first.samples, other.samples],
        });
    }
    let Some([x, y, width, height]) = draw.area else {
        return Ok(());
    };
    let fits = |start: u32, length: u32, whole: u32| {
        length > 0 && start.checked_add(length).is_some_and(|end| end <= whole)
    };
    if fits(x, width, whole[0]) && fits(y, height, whole[1]) {
        Ok(())
    } else {
        let area = [x, y, width, height];
        Err(LinkError::AreaOutside(scope.pass.clone(), area, whole))
    }
}

/// Returns the target for one aspect of a texture that has depth and stencil; any other target as
/// it is.
fn aspect_of(target: &Target, format: TextureFormat, aspect: TextureAspect) -> Target {
    let mut target = target.clone();
    if format.is_combined_depth_stencil_format() {
        target.part = target.part.of_aspect(aspect);
    }
    target
}
