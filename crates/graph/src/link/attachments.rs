//! Colour and depth attachments: formats, sizes, what the fragment shader writes.

use super::{Access, LinkedColor, LinkedDepth, LinkedPass, LinkedProgram, Linker, Usage};
use crate::{
    diagnostics::{Code, Diagnostic},
    document::located::Located,
    resolve::{ResourceKind, Target, Texture},
    step::{DepthTarget, Draw},
    wgsl::ScalarClass,
};

/// What a fragment shader must write for a colour format.
pub(super) fn scalar_of(format: wgpu::TextureFormat) -> Option<ScalarClass> {
    match format.sample_type(None, None)? {
        wgpu::TextureSampleType::Float { .. } | wgpu::TextureSampleType::Depth => {
            Some(ScalarClass::Float)
        }
        wgpu::TextureSampleType::Uint => Some(ScalarClass::Uint),
        wgpu::TextureSampleType::Sint => Some(ScalarClass::Sint),
    }
}

impl Linker<'_, '_> {
    pub(super) fn colors(
        &mut self,
        draw: &Draw,
        program: Option<&LinkedProgram>,
        pass: &mut LinkedPass,
    ) -> Option<Vec<LinkedColor>> {
        let outputs = program.and_then(|program| {
            let entry = *program.entries.last()?;
            Some((
                program.shader.fragment_outputs(entry),
                program.shader.entry_span(entry),
            ))
        });
        let most = self.limits.max_color_attachments as usize;
        if draw.colors.len() > most {
            self.report(
                Diagnostic::error(
                    Code::Limit,
                    format!(
                        "{} colour targets are more than the adapter can draw to",
                        draw.colors.len()
                    ),
                )
                .at(pass.name.span.clone(), "")
                .help(format!("its limit is {most}")),
            );
        }
        let mut colors = Vec::new();
        let mut bytes_per_sample = 0u32;
        for (location, color) in (0u32..).zip(&draw.colors) {
            let (target, texture) = self.attachment(&color.target, pass)?;
            let format = texture.format;
            let features = format.guaranteed_format_features(self.features);
            if format.is_depth_stencil_format()
                || !features
                    .allowed_usages
                    .contains(wgpu::TextureUsages::RENDER_ATTACHMENT)
            {
                self.report(
                    Diagnostic::error(
                        Code::FormatMismatch,
                        format!("a texture of format {format:?} cannot be a colour target"),
                    )
                    .at(color.target.span.clone(), "")
                    .help("use a colour format that can be drawn to, or `depth: (target: …)`"),
                );
                return None;
            }
            if color.blend.is_some()
                && !features
                    .flags
                    .contains(wgpu::TextureFormatFeatureFlags::BLENDABLE)
            {
                self.report(
                    Diagnostic::error(
                        Code::FormatMismatch,
                        format!("a target of format {format:?} cannot be blended"),
                    )
                    .at(color.target.span.clone(), ""),
                );
            }
            if let (Some(cost), Some(alignment)) = (
                format.target_pixel_byte_cost(),
                format.target_component_alignment(),
            ) {
                bytes_per_sample = bytes_per_sample.next_multiple_of(alignment.max(1)) + cost;
            }
            if let Some((outputs, span)) = &outputs {
                self.check_output(location, &color.target, format, outputs, span);
            }
            let clear = color.clear;
            if let Some(value) = clear {
                self.clear_value(&color.target, format, value);
            }
            pass.accesses.push(Access {
                resource: target.id,
                part: target.part.clone(),
                reads: clear.is_none(),
                writes: true,
                covers: clear.is_some(),
                usage: Usage::Texture(wgpu::TextureUsages::RENDER_ATTACHMENT),
                span: color.target.span.clone(),
                step: 0,
            });
            colors.push(LinkedColor {
                target,
                format,
                clear,
                blend: color.blend,
            });
        }
        let most = self.limits.max_color_attachment_bytes_per_sample;
        if bytes_per_sample > most {
            self.report(
                Diagnostic::error(
                    Code::Limit,
                    format!(
                        "the colour targets of `{}` take {bytes_per_sample} bytes per pixel",
                        *pass.name
                    ),
                )
                .at(pass.name.span.clone(), "")
                .help(format!(
                    "the adapter's limit is {most}: use smaller formats or two passes"
                )),
            );
        }
        Some(colors)
    }

    fn check_output(
        &mut self,
        location: u32,
        target: &Located<String>,
        format: wgpu::TextureFormat,
        outputs: &[(u32, ScalarClass, u32)],
        entry: &crate::source::Span,
    ) {
        let Some((_, scalar, width)) = outputs.iter().find(|(at, ..)| *at == location) else {
            self.report(
                Diagnostic::error(
                    Code::FormatMismatch,
                    format!("the fragment shader writes nothing to `{}`", target.value),
                )
                .at(
                    target.span.clone(),
                    format!("this target has location {location}"),
                )
                .at(
                    entry.clone(),
                    format!("no output @location({location}) here"),
                ),
            );
            return;
        };
        let needed = u32::from(format.components());
        if scalar_of(format) != Some(*scalar) || *width < needed {
            let expected = scalar_of(format).map_or("…".to_owned(), |scalar| scalar.to_string());
            self.report(
                Diagnostic::error(
                    Code::FormatMismatch,
                    format!(
                        "`{}` has the format {format:?}, the shader writes {width} × {scalar}",
                        target.value
                    ),
                )
                .at(target.span.clone(), format!("needs {needed} × {expected}"))
                .at(
                    entry.clone(),
                    format!("writes {width} × {scalar} at @location({location})"),
                ),
            );
        }
    }

    pub(super) fn depth(
        &mut self,
        depth: &DepthTarget,
        pass: &mut LinkedPass,
    ) -> Option<LinkedDepth> {
        let (target, texture) = self.attachment(&depth.target, pass)?;
        let format = texture.format;
        if !format.has_depth_aspect() {
            self.report(
                Diagnostic::error(
                    Code::FormatMismatch,
                    format!("a texture of format {format:?} cannot be a depth target"),
                )
                .at(depth.target.span.clone(), "")
                .help("use Depth32Float, Depth24Plus or Depth16Unorm"),
            );
            return None;
        }
        if let Some(value) = depth.clear {
            self.clear_value(&depth.target, format, [value.into(), 0.0, 0.0, 0.0]);
        }
        pass.accesses.push(Access {
            resource: target.id,
            part: target.part.clone(),
            reads: depth.clear.is_none(),
            writes: depth.write || depth.clear.is_some(),
            covers: depth.clear.is_some(),
            usage: Usage::Texture(wgpu::TextureUsages::RENDER_ATTACHMENT),
            span: depth.target.span.clone(),
            step: 0,
        });
        let state = wgpu::DepthStencilState {
            format,
            depth_write_enabled: Some(depth.write),
            depth_compare: Some(depth.compare.into()),
            stencil: wgpu::StencilState::default(),
            bias: depth.bias,
        };
        Some(LinkedDepth {
            target,
            clear: depth.clear,
            state,
        })
    }

    /// A clear value that the format can hold.
    pub(super) fn clear_value(
        &mut self,
        target: &Located<String>,
        format: wgpu::TextureFormat,
        value: [f64; 4],
    ) {
        let channels = &value[..usize::from(format.components()).min(4)];
        let (fits, expected): (fn(&f64) -> bool, _) = match scalar_of(format) {
            _ if format.is_depth_stencil_format() => {
                (|v| (0.0..=1.0).contains(v), "a depth from 0 to 1")
            }
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
        if let Some(wrong) = channels.iter().find(|value| !fits(value)) {
            self.report(
                Diagnostic::error(
                    Code::FormatMismatch,
                    format!("`{}` cannot be cleared to {wrong}", target.value),
                )
                .at(
                    target.span.clone(),
                    format!("a texture of format {format:?}, which takes {expected}"),
                ),
            );
        }
    }

    fn attachment(
        &mut self,
        name: &Located<String>,
        pass: &LinkedPass,
    ) -> Option<(Target, Texture)> {
        let target = self.expect(name)?;
        let resource = self.resources.get(target.id);
        let ResourceKind::Texture(texture) = &resource.kind else {
            let what = resource.kind.describe();
            self.report(
                Diagnostic::error(
                    Code::ResourceKind,
                    format!("pass `{}` cannot draw to `{}`", *pass.name, name.value),
                )
                .at(
                    name.span.clone(),
                    format!("this is {what}, a texture is needed"),
                ),
            );
            return None;
        };
        let texture = texture.clone();
        if !target.part.is_single() {
            self.report(
                Diagnostic::error(Code::ResourceKind, format!("`{}` has several mips or layers", name.value))
                    .at(name.span.clone(), "a pass draws to one mip of one layer")
                    .help("declare a view of one mip and layer: `views: [(name: \"…\", mip: 0, mips: 1, layer: 0, layers: 1)]`"),
            );
            return None;
        }
        self.writable(&target, name, &name.span);
        Some((target, texture))
    }

    /// All attachments of a pass have one size.
    pub(super) fn attachment_sizes(
        &mut self,
        colors: &[LinkedColor],
        depth: Option<&LinkedDepth>,
        pass: &LinkedPass,
    ) {
        let targets: Vec<&Target> = colors
            .iter()
            .map(|color| &color.target)
            .chain(depth.map(|depth| &depth.target))
            .collect();
        if targets.is_empty() {
            self.report(
                Diagnostic::error(
                    Code::MissingField,
                    format!("pass `{}` draws to nothing", *pass.name),
                )
                .at(
                    pass.name.span.clone(),
                    "give it `color: […]` or `depth: (…)`",
                ),
            );
            return;
        }
        let sizes: Vec<(String, [u32; 2])> = targets
            .iter()
            .filter_map(|target| match &self.resources.get(target.id).kind {
                ResourceKind::Texture(texture) => {
                    let mip = target.part.mips.start;
                    let size = texture.size.map(|edge| (edge >> mip).max(1));
                    Some((self.resources.get(target.id).name.clone(), size))
                }
                _ => None,
            })
            .collect();
        let Some((first, size)) = sizes.first() else {
            return;
        };
        if let Some((other, different)) = sizes.iter().find(|(_, other)| other != size) {
            self.report(
                Diagnostic::error(
                    Code::Size,
                    format!("the targets of pass `{}` differ in size", *pass.name),
                )
                .at(
                    pass.name.span.clone(),
                    format!(
                        "`{first}` has {}×{} texels, `{other}` {}×{}",
                        size[0], size[1], different[0], different[1]
                    ),
                ),
            );
        }
    }
}
