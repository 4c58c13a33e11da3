//! Renders charts as PNG pictures.

use resvg::{tiny_skia, usvg};
use skiagraph_compare::error::{CompareError, Result};

/// Renders an SVG chart as a PNG picture with two pixels per SVG unit, on white. The font comes
/// with the program, so every machine renders the same picture.
///
/// # Errors
/// If the text is not valid SVG, or the picture has no size or is too large.
pub fn png(svg: &str) -> Result<Vec<u8>> {
    const SCALE: f32 = 2.0;
    let failed = |what: &dyn std::fmt::Display| {
        CompareError::Input(format!("the chart cannot become a picture: {what}"))
    };
    let mut options = usvg::Options::default();
    let fonts = options.fontdb_mut();
    fonts.load_font_data(epaint_default_fonts::UBUNTU_LIGHT.to_vec());
    let families = fonts.faces().flat_map(|face| face.families.clone());
    let family = families.map(|(family, _)| family).next();
    let family = family.ok_or_else(|| failed(&"its font has no name"))?;
    fonts.set_sans_serif_family(family);
    let tree = usvg::Tree::from_str(svg, &options).map_err(|error| failed(&error))?;
    let size = tree.size().to_int_size().scale_by(SCALE);
    let size = size.ok_or_else(|| failed(&"it has no size"))?;
    let pixmap = tiny_skia::Pixmap::new(size.width(), size.height());
    let mut pixmap = pixmap.ok_or_else(|| failed(&"it is too large"))?;
    pixmap.fill(tiny_skia::Color::WHITE);
    let scaled = tiny_skia::Transform::from_scale(SCALE, SCALE);
    resvg::render(&tree, scaled, &mut pixmap.as_mut());
    pixmap.encode_png().map_err(|error| failed(&error))
}
