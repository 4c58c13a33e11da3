//! Draws: colour, depth and stencil attachments, their formats and sizes, outputs of the fragment
//! shader.

use super::{
    linker::{Linker, access},
    pass::{Attachment, Ids, LinkedPass, LinkedProgram, Usage},
    textures::scalar_of,
};
use crate::{
    diagnostics::reports::ErrorGuaranteed,
    errors::link::LinkError,
    kinds::step::{ColorTarget, DepthTarget, Draw, DrawCall, Names, StencilTarget},
    language::syntax::Reference,
    resource::{ResourceKind, SubresourceRange, Texture},
    shader::class::ScalarClass,
    source::span::{Located, Span},
};
use wgt::{TextureAspect, TextureFormat, TextureFormatFeatureFlags, TextureUsages};

pub(super) const ATTACHMENT: Usage = Usage::Texture(TextureUsages::RENDER_ATTACHMENT);

impl Linker<'_, '_> {
    pub(super) fn draw(
        &mut self,
        draw: &Draw<Names>,
        pass: &mut LinkedPass,
    ) -> Result<Draw<Ids>, ErrorGuaranteed> {
        let (stages, depth_only) = self.stages_of(draw);
        let mut program = self.program(&draw.program, stages, depth_only, pass);
        if let Ok(linked) = &program
            && let Err(reported) = self.stages(linked, draw)
        {
            program = Err(reported);
        }
        let colors = self.colors(draw, program.as_ref().ok(), pass);
        let depth = draw
            .depth
            .as_ref()
            .map(|depth| self.depth(depth, pass))
            .transpose();
        let stencil = draw
            .stencil
            .as_ref()
            .map(|entry| self.stencil(entry, pass))
            .transpose();
        let canvas = self.canvas(draw, program.as_ref().ok(), pass);
        let call = match &draw.call {
            DrawCall::Direct {
                vertices,
                instances,
            } => Ok(DrawCall::Direct {
                vertices: *vertices,
                instances: *instances,
            }),
            DrawCall::Indirect(name) => self.indirect(name, 16, pass).map(DrawCall::Indirect),
        };
        self.features(draw, pass)?;
        let linked = Draw {
            program: program?,
            fullscreen: draw.fullscreen,
            colors: colors?,
            depth: depth?,
            stencil: stencil?,
            canvas: canvas?,
            area: draw.area,
            call: call?,
            primitive: draw.primitive,
        };
        self.alike(&linked, pass)?;
        Ok(linked)
    }

    /// Checks features of the rasteriser that not every device has.
    fn features(&mut self, draw: &Draw<Names>, pass: &LinkedPass) -> Result<(), ErrorGuaranteed> {
        let asked = [
            (
                draw.primitive.conservative,
                "conservative: true",
                wgt::Features::CONSERVATIVE_RASTERIZATION,
                "CONSERVATIVE_RASTERIZATION",
            ),
            (
                draw.primitive.unclipped_depth,
                "unclipped: true",
                wgt::Features::DEPTH_CLIP_CONTROL,
                "DEPTH_CLIP_CONTROL",
            ),
        ];
        for (is_asked, field, feature, name) in asked {
            if is_asked && !self.symbols.request.features.contains(feature) {
                self.reports.unsupported(LinkError::DrawFeature {
                    pass: pass.name.clone(),
                    field,
                    feature: name,
                })?;
            }
        }
        Ok(())
    }

    fn colors(
        &mut self,
        draw: &Draw<Names>,
        program: Option<&LinkedProgram>,
        pass: &mut LinkedPass,
    ) -> Result<Vec<ColorTarget<Ids>>, ErrorGuaranteed> {
        let outputs = program.and_then(|program| {
            let entry = *program.entries.last()?;
            let outputs = program.shader.fragment_outputs(entry);
            Some((outputs, program.shader.entry_span(entry)))
        });
        let limits = self.symbols.request.limits.clone();
        let most = limits.max_color_attachments;
        if draw.colors.len() > most as usize {
            self.reports.unsupported(LinkError::TooManyTargets {
                pass: pass.name.clone(),
                count: draw.colors.len(),
                most,
            })?;
        }
        let mut colors = Vec::with_capacity(draw.colors.len());
        let mut bytes_per_sample = 0u32;
        let mut wrong = None;
        for (location, color) in (0u32..).zip(&draw.colors) {
            let linked = match self.color(color, pass) {
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
                let checked = self.check_output(location, &color.target, format, outputs, span);
                wrong = checked.err().or(wrong);
            }
            colors.push(linked);
        }
        let most = limits.max_color_attachment_bytes_per_sample;
        if bytes_per_sample > most {
            self.reports.unsupported(LinkError::BytesPerPixel {
                pass: pass.name.clone(),
                bytes: bytes_per_sample,
                most,
            })?;
        }
        wrong.map_or(Ok(colors), Err)
    }

    fn color(
        &mut self,
        color: &ColorTarget<Names>,
        pass: &mut LinkedPass,
    ) -> Result<ColorTarget<Ids>, ErrorGuaranteed> {
        let name = located(&color.target);
        let target = self.attachment(&color.target, pass)?;
        let format = target.format;
        let features = format.guaranteed_format_features(self.symbols.request.features);
        let drawable = features
            .allowed_usages
            .contains(TextureUsages::RENDER_ATTACHMENT);
        if format.is_depth_stencil_format() || !drawable {
            return Err(self.report(LinkError::NotDrawable { name, format }));
        }
        if color.blend.is_some()
            && !features
                .flags
                .contains(TextureFormatFeatureFlags::BLENDABLE)
        {
            return Err(self.report(LinkError::NotBlendable { name, format }));
        }
        if let Some(value) = color.clear {
            self.clear_value(&name, format, value)?;
        }
        let clears = color.clear.is_some();
        let used = (!clears, true, clears);
        pass.accesses
            .push(access(&target.target, used, ATTACHMENT, &name.span));
        let resolve = match &color.resolve {
            Some(resolve) => Some(self.resolved(&target, resolve, pass)?),
            None => None,
        };
        Ok(ColorTarget {
            target,
            resolve,
            clear: color.clear,
            blend: color.blend,
            write: color.write,
        })
    }

    /// The texture of one sample that a multisampled target ends in.
    fn resolved(
        &mut self,
        target: &Attachment,
        resolve: &Reference,
        pass: &mut LinkedPass,
    ) -> Result<Attachment, ErrorGuaranteed> {
        let name = located(resolve);
        let resolved = self.attachment(resolve, pass)?;
        let features = target
            .format
            .guaranteed_format_features(self.symbols.request.features);
        let why = if target.samples == 1 {
            Some("what is drawn to has one sample")
        } else if resolved.samples != 1 {
            Some("it has several samples itself")
        } else if resolved.format != target.format {
            Some("it has another format than what is drawn to")
        } else if !features
            .flags
            .contains(TextureFormatFeatureFlags::MULTISAMPLE_RESOLVE)
        {
            Some("this format cannot be resolved")
        } else {
            None
        };
        if let Some(why) = why {
            return Err(self.report(LinkError::Resolve { name, why }));
        }
        let used = (false, true, true);
        pass.accesses
            .push(access(&resolved.target, used, ATTACHMENT, &name.span));
        Ok(resolved)
    }

    fn check_output(
        &mut self,
        location: u32,
        target: &Reference,
        format: TextureFormat,
        outputs: &[(u32, ScalarClass, u32)],
        entry: &Span,
    ) -> Result<(), ErrorGuaranteed> {
        let name = located(target);
        let Some((_, scalar, width)) = outputs.iter().find(|(at, ..)| *at == location) else {
            return Err(self.report(LinkError::NoFragmentOutput {
                name,
                location,
                entry: entry.clone(),
            }));
        };
        let needed = u32::from(format.components());
        let expected = scalar_of(format, TextureAspect::All);
        if expected == Some(*scalar) && *width >= needed {
            return Ok(());
        }
        Err(self.report(LinkError::FragmentOutput {
            name,
            format,
            expected: expected.map_or("…".to_owned(), |scalar| scalar.to_string()),
            needed,
            written: format!("{width} × {scalar}"),
            location,
            entry: entry.clone(),
        }))
    }

    fn depth(
        &mut self,
        depth: &DepthTarget<Names>,
        pass: &mut LinkedPass,
    ) -> Result<DepthTarget<Ids>, ErrorGuaranteed> {
        let name = located(&depth.target);
        let target = self.attachment(&depth.target, pass)?;
        let format = target.format;
        if !format.has_depth_aspect() {
            return Err(self.report(LinkError::NoDepth { name, format }));
        }
        if let Some(value) = depth.clear {
            self.clear_value(&name, format, [value.into(), 0.0, 0.0, 0.0])?;
        }
        let clears = depth.clear.is_some();
        let used = (!clears, depth.write || clears, clears);
        let mut accessed = access(&target.target, used, ATTACHMENT, &name.span);
        accessed.part = aspect_of(&accessed.part, format, TextureAspect::DepthOnly);
        pass.accesses.push(accessed);
        Ok(DepthTarget {
            target,
            clear: depth.clear,
            compare: depth.compare,
            write: depth.write,
            bias: depth.bias,
        })
    }

    fn stencil(
        &mut self,
        stencil: &StencilTarget<Names>,
        pass: &mut LinkedPass,
    ) -> Result<StencilTarget<Ids>, ErrorGuaranteed> {
        let name = located(&stencil.target);
        let target = self.attachment(&stencil.target, pass)?;
        let format = target.format;
        if !format.has_stencil_aspect() {
            return Err(self.report(LinkError::NoStencil { name, format }));
        }
        if let Some(wrong) = stencil.clear.filter(|value| *value > u32::from(u8::MAX)) {
            return Err(self.report(LinkError::ClearValue {
                name,
                wrong: wrong.into(),
                format,
                expected: "a stencil from 0 to 255",
            }));
        }
        let clears = stencil.clear.is_some();
        let writes = !stencil.state.is_read_only(None);
        let used = (!clears, writes || clears, clears);
        let mut accessed = access(&target.target, used, ATTACHMENT, &name.span);
        accessed.part = aspect_of(&accessed.part, format, TextureAspect::StencilOnly);
        pass.accesses.push(accessed);
        Ok(StencilTarget {
            target,
            clear: stencil.clear,
            state: stencil.state.clone(),
            reference: stencil.reference,
        })
    }

    /// A clear value that the format can hold.
    pub(super) fn clear_value(
        &mut self,
        name: &Located<String>,
        format: TextureFormat,
        value: [f64; 4],
    ) -> Result<(), ErrorGuaranteed> {
        let mut channels = &value[..usize::from(format.components()).min(4)];
        let is_stencil = |v: &f64| v.fract() == 0.0 && (0.0..=255.0).contains(v);
        if format.is_combined_depth_stencil_format() && is_stencil(&value[1]) {
            channels = &value[..1];
        }
        let (fits, expected): (fn(&f64) -> bool, _) = match scalar_of(format, TextureAspect::All) {
            _ if format.is_combined_depth_stencil_format() => (
                |v| (0.0..=1.0).contains(v),
                "a depth from 0 to 1, and a stencil from 0 to 255",
            ),
            _ if format.has_depth_aspect() => (|v| (0.0..=1.0).contains(v), "a depth from 0 to 1"),
            _ if format.has_stencil_aspect() => (
                |v| v.fract() == 0.0 && (0.0..=255.0).contains(v),
                "a whole number from 0 to 255",
            ),
            Some(ScalarClass::Uint) => (
                |v| v.fract() == 0.0 && (0.0..=f64::from(u32::MAX)).contains(v),
                "whole numbers from 0",
            ),
            Some(ScalarClass::Sint) => (
                |v| v.fract() == 0.0 && (f64::from(i32::MIN)..=f64::from(i32::MAX)).contains(v),
                "whole numbers of 32 bits",
            ),
            _ => (|v| v.is_finite(), "finite numbers"),
        };
        match channels.iter().find(|value| !fits(value)) {
            None => Ok(()),
            Some(&wrong) => Err(self.report(LinkError::ClearValue {
                name: name.clone(),
                wrong,
                format,
                expected,
            })),
        }
    }

    fn attachment(
        &mut self,
        reference: &Reference,
        pass: &LinkedPass,
    ) -> Result<Attachment, ErrorGuaranteed> {
        let target = self.resolve(reference)?;
        let name = located(reference);
        let resource = self.symbols.get(target.id);
        let ResourceKind::Texture(texture) = &resource.kind else {
            let found = resource.kind.describe();
            return Err(self.report(LinkError::NoTexture {
                pass: pass.name.value.clone(),
                name,
                found,
            }));
        };
        let Texture {
            format, samples, ..
        } = *texture;
        if !target.part.is_single() {
            return Err(self.report(LinkError::SeveralLayers(name)));
        }
        self.writable(target.id, &name.span)?;
        Ok(Attachment {
            target,
            format,
            samples,
        })
    }

    /// All attachments of a draw have one size and number of samples; the area lies in them; depth
    /// and stencil are one texture.
    fn alike(&mut self, draw: &Draw<Ids>, pass: &LinkedPass) -> Result<(), ErrorGuaranteed> {
        let colors = draw.colors.iter().map(|color| &color.target);
        let resolved = draw
            .colors
            .iter()
            .filter_map(|color| color.resolve.as_ref());
        let depth = draw.depth.as_ref().map(|depth| &depth.target);
        let stencil = draw.stencil.as_ref().map(|stencil| &stencil.target);
        let drawn = colors.chain(depth).chain(stencil).chain(&draw.canvas);
        let drawn: Vec<&Attachment> = drawn.collect();
        let Some(first) = drawn.first() else {
            return Err(self.report(LinkError::NoTargets {
                pass: pass.name.clone(),
                fullscreen: draw.fullscreen,
            }));
        };
        if let (Some(depth), Some(stencil)) = (depth, stencil)
            && depth.target != stencil.target
        {
            return Err(self.report(LinkError::TwoDepthStencils(pass.name.clone())));
        }
        let size = |attachment: &Attachment| match &self.symbols.get(attachment.target.id).kind {
            ResourceKind::Texture(texture) => texture.mip_size(attachment.target.part.mips.start),
            _ => [0, 0],
        };
        let name = |attachment: &Attachment| self.symbols.get(attachment.target.id).name.clone();
        let whole = size(first);
        let differs = |other: &&Attachment| size(other) != whole;
        if let Some(other) = drawn.iter().copied().chain(resolved).find(differs) {
            let error = LinkError::TargetSizes {
                pass: pass.name.clone(),
                names: [name(first), name(other)],
                sizes: [whole, size(other)],
            };
            return Err(self.report(error));
        }
        if let Some(other) = drawn.iter().find(|other| other.samples != first.samples) {
            let error = LinkError::TargetSamples {
                pass: pass.name.clone(),
                names: [name(first), name(other)],
                samples: [first.samples, other.samples],
            };
            return Err(self.report(error));
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
            Err(self.report(LinkError::AreaOutside {
                pass: pass.name.clone(),
                area: [x, y, width, height],
                whole,
            }))
        }
    }
}

pub(super) fn located(reference: &Reference) -> Located<String> {
    Located::new(reference.text().to_owned(), reference.span.clone())
}

/// One aspect of a texture that has two.
fn aspect_of(
    part: &SubresourceRange,
    format: TextureFormat,
    aspect: TextureAspect,
) -> SubresourceRange {
    if format.is_combined_depth_stencil_format() {
        part.of_aspect(aspect)
    } else {
        part.clone()
    }
}
