//! Draws without attachments. wgpu does not allow them, so they draw into a texture that is never
//! read.

use super::{pass::LinkedProgram, scope::PassScope};
use crate::diagnostics::Reported;
use crate::errors::link::LinkError;
use crate::errors::resource::SizeError;
use crate::kinds::{Draw, Names};
use crate::resource::Texture;
use crate::shader::Shader;
use crate::source::Located;
use naga::ShaderStage;
use std::sync::Arc;
use wgt::TextureFormat;

/// Format of one byte that every device draws to.
const FORMAT: TextureFormat = TextureFormat::R8Unorm;

/// Returns the stages of a draw, and true if its fragment shader must have no colour outputs.
pub(super) fn stages_of(
    draw: &Draw<Names>,
    shader: impl FnOnce() -> Reported<Arc<Shader>>,
) -> (&'static [ShaderStage], bool) {
    let program = &draw.program;
    // Without colours, a fragment shader that yields none may still discard and set depths.
    let is_colourless = draw.colors.is_empty()
        && !draw.fullscreen
        && shader().is_ok_and(|shader| shader.colourless_fragments().next().is_some());
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

/// Returns the texture that serves as target of a draw without attachments; `None` for any other
/// draw.
pub(super) fn texture(
    draw: &Draw<Names>,
    program: Option<&LinkedProgram>,
    scope: &mut PassScope<'_>,
) -> Reported<Option<Texture>> {
    let Some(canvas) = &draw.canvas else {
        return Ok(None);
    };
    let colors = draw.colors.iter().flatten().map(|color| &color.target);
    let depth = draw.depth.as_ref().map(|depth| &depth.target);
    let stencil = draw.stencil.as_ref().map(|stencil| &stencil.target);
    if let Some(target) = colors.chain(depth).chain(stencil).next() {
        return Err(scope.report(LinkError::CanvasBeside {
            pass: scope.pass.value.clone(),
            size: canvas.span.clone(),
            target: target.located(),
        }));
    }
    if let Some(program) = program {
        returns_nothing(program, canvas, scope)?;
    }
    let size = canvas_size(canvas, scope)?;
    Ok(Some(Texture {
        format: FORMAT,
        size,
        layers: 1,
        is_3d: false,
        mips: 1,
        samples: 1,
        picture: None,
    }))
}

/// Checks that a draw without attachments has a fragment shader, which must not return anything.
fn returns_nothing(
    program: &LinkedProgram,
    canvas: &Located<[u64; 2]>,
    scope: &mut PassScope<'_>,
) -> Reported<()> {
    let Some(entry) = program.entry(ShaderStage::Fragment) else {
        let (pass, size) = (scope.pass.clone(), canvas.span.clone());
        return Err(scope.report(LinkError::CanvasWithoutFragment(pass, size)));
    };
    let shader = &program.shader;
    let result = &shader.module().entry_points[entry].function.result;
    match result {
        None => Ok(()),
        Some(_) => Err(scope.report(LinkError::CanvasOutput {
            pass: scope.pass.value.clone(),
            size: canvas.span.clone(),
            entry: shader.entry_span(entry),
        })),
    }
}

fn canvas_size(canvas: &Located<[u64; 2]>, scope: &mut PassScope<'_>) -> Reported<[u32; 2]> {
    let name = Located::new(scope.pass.value.clone(), canvas.span.clone());
    let [Ok(width), Ok(height)] = canvas.value.map(u32::try_from) else {
        return Err(scope.report(SizeError::Absurd(name)));
    };
    let size = [width, height];
    if size.contains(&0) {
        return Err(scope.report(SizeError::NoTexels {
            name,
            size,
            layers: 1,
            mips: 1,
            samples: 1,
        }));
    }
    let most = scope.request().limits.max_texture_dimension_2d;
    if width > most || height > most {
        scope.unsupported(SizeError::Texels(name, size, most))?;
    }
    Ok(size)
}
