//! Draws without attachments. wgpu has none: a texture that is never read stands in their place.

use super::{
    attachments::{ATTACHMENT, located},
    linker::{Linker, access},
    pass::{Attachment, LinkedPass, LinkedProgram},
};
use crate::{
    diagnostics::reports::ErrorGuaranteed,
    errors::{link::LinkError, resource::SizeError},
    kinds::step::{Draw, Names},
    resource::{Origin, Resource, ResourceKind, Texture},
    source::span::Located,
};
use naga::ShaderStage;
use wgt::TextureFormat;

/// Format of one byte that every device draws to.
const FORMAT: TextureFormat = TextureFormat::R8Unorm;

impl Linker<'_, '_> {
    /// The stages of a draw, and whether its fragment shader is to be one without colour outputs.
    pub(super) fn stages_of(&mut self, draw: &Draw<Names>) -> (&'static [ShaderStage], bool) {
        let program = &draw.program;
        // Without colours, a fragment shader that yields none may still discard and set depths.
        let is_colourless = draw.colors.is_empty()
            && !draw.fullscreen
            && self
                .shader(program)
                .is_ok_and(|shader| shader.colourless_fragments().next().is_some());
        let is_asked = !program.no_fragment && (is_colourless || draw.canvas.is_some());
        let has_fragment = !draw.colors.is_empty() || program.fragment.is_some() || is_asked;
        let stages: &[ShaderStage] = match (draw.fullscreen, has_fragment) {
            (true, _) => &[ShaderStage::Fragment],
            (false, true) => &[ShaderStage::Vertex, ShaderStage::Fragment],
            (false, false) => &[ShaderStage::Vertex],
        };
        // Where all have outputs, one of them is told with its place.
        let depth_only = draw.colors.is_empty() && (draw.canvas.is_none() || is_colourless);
        (stages, depth_only)
    }

    /// The texture in the place of the attachments of a draw that has none.
    pub(super) fn canvas(
        &mut self,
        draw: &Draw<Names>,
        program: Option<&LinkedProgram>,
        pass: &mut LinkedPass,
    ) -> Result<Option<Attachment>, ErrorGuaranteed> {
        let Some(canvas) = &draw.canvas else {
            return Ok(None);
        };
        let colors = draw.colors.iter().map(|color| &color.target);
        let depth = draw.depth.as_ref().map(|depth| &depth.target);
        let stencil = draw.stencil.as_ref().map(|stencil| &stencil.target);
        if let Some(target) = colors.chain(depth).chain(stencil).next() {
            return Err(self.report(LinkError::CanvasBeside {
                pass: pass.name.value.clone(),
                size: canvas.span.clone(),
                target: located(target),
            }));
        }
        if let Some(program) = program {
            self.returns_nothing(program, canvas, pass)?;
        }
        let size = self.canvas_size(canvas, pass)?;
        let id = self.symbols.add(Resource {
            // A slash stands in no name: nothing in a document can mean this texture.
            name: format!("{}/canvas", pass.name.value),
            declared: None,
            kind: ResourceKind::Texture(Texture {
                format: FORMAT,
                size,
                layers: 1,
                is_3d: false,
                mips: 1,
                samples: 1,
                picture: None,
            }),
            origin: Origin::Own,
            keep: false,
            growth: None,
        });
        let target = self.symbols.whole(id);
        // It is no content: nothing is written, and nothing of before is needed.
        let used = (false, false, true);
        pass.accesses
            .push(access(&target, used, ATTACHMENT, &canvas.span));
        Ok(Some(Attachment {
            target,
            format: FORMAT,
            samples: 1,
        }))
    }

    /// A fragment shader has to be there, and what it returns would be lost.
    fn returns_nothing(
        &mut self,
        program: &LinkedProgram,
        canvas: &Located<[u64; 2]>,
        pass: &LinkedPass,
    ) -> Result<(), ErrorGuaranteed> {
        let stages = program.stages.iter().zip(&program.entries);
        let fragment = stages
            .filter(|(stage, _)| **stage == ShaderStage::Fragment)
            .map(|(_, entry)| *entry)
            .next();
        let Some(entry) = fragment else {
            return Err(self.report(LinkError::CanvasWithoutFragment {
                pass: pass.name.clone(),
                size: canvas.span.clone(),
            }));
        };
        let shader = &program.shader;
        let result = &shader.module().entry_points[entry].function.result;
        match result {
            None => Ok(()),
            Some(_) => Err(self.report(LinkError::CanvasOutput {
                pass: pass.name.value.clone(),
                size: canvas.span.clone(),
                entry: shader.entry_span(entry),
            })),
        }
    }

    fn canvas_size(
        &mut self,
        canvas: &Located<[u64; 2]>,
        pass: &LinkedPass,
    ) -> Result<[u32; 2], ErrorGuaranteed> {
        let name = Located::new(pass.name.value.clone(), canvas.span.clone());
        let [Ok(width), Ok(height)] = canvas.value.map(u32::try_from) else {
            return Err(self.reports.report(SizeError::Absurd { name }));
        };
        let size = [width, height];
        if size.contains(&0) {
            return Err(self.reports.report(SizeError::NoTexels {
                name,
                size,
                layers: 1,
                mips: 1,
                samples: 1,
            }));
        }
        let most = self.symbols.request.limits.max_texture_dimension_2d;
        if width > most || height > most {
            self.reports
                .unsupported(SizeError::Texels { name, size, most })?;
        }
        Ok(size)
    }
}
