//! Turns a frame into the content of a pane: a picture, its legend, and its numbers.

use crate::desired_state::{FrameSnapshot, MethodSnapshot};
use crate::ground_truth::{Answer, thin, thinned_size};
use crate::texels::{Histogram, Texels};
use skiagraph_compare::graphs::ground_truth::Judgement;
use skiagraph_compare::graphs::preset::{STATUS, VISIBILITY};
use skiagraph_compare::graphs::shadow_method::Outputs;
use skiagraph_compare::pictures::buffer_csv;
use skiagraph_compare::pictures::material::Picture;
use skiagraph_compare::wording::{percent, thousands};
use skiagraph_gpu::Content;
use skiagraph_graph::{Capture, PartSummary};
use skiagraph_reference::{GroundTruthPixels, Image, statistics::UNANSWERED};
use std::collections::BTreeMap;

/// Kinds of pictures that a pane, one of the two pictures of the window, can show.
#[derive(Clone, Debug, Default, PartialEq)]
pub enum Show {
    /// The scene, shaded with the method's visibility.
    #[default]
    Shaded,
    /// The output `visibility`, with colours for the background and for surfaces that face away.
    Visibility,
    /// The shaded scene, with those pixels in purple that the method's output `status` calls
    /// uncertain.
    Uncertain,
    /// The errors of the method against the reference: blue where too light, red where too dark.
    Difference,
    /// Content of a material, after a pass or at the end of the frame.
    Material(Capture),
}

/// Mip or layer, channel and colours with which a pane, one of the window's two pictures, shows a
/// material.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Reading {
    /// Index of the shown part in [`Drawn::parts`]: the layers of the first mip, then those of the
    /// next.
    pub part: usize,
    /// Index of the channel to show as a heat map; `None` for the colours of the pictures that `run
    /// --save` writes.
    pub heat: Option<usize>,
    /// Index of the channel whose values the histogram counts.
    pub channel: usize,
}

/// Content of a pane: picture, legend and numbers.
#[derive(Default)]
pub struct Drawn {
    /// The picture; `None` for a buffer, or if there is none.
    pub image: Option<Image>,
    /// Meaning of the picture's colours; for a buffer, which of its items the table shows; or the
    /// reason why there is neither. Empty for a method that the snapshot lacks.
    pub legend: String,
    /// The numbers of the picture's pixels; `None` if the picture has none.
    pub texels: Option<Texels>,
    /// Histogram of one channel of a material; `None` for pictures of other kinds.
    pub histogram: Option<Histogram>,
    /// Values at the ends of the heat map's colours; `None` without a heat map.
    pub heat: Option<[f64; 2]>,
    /// Names of the mips and layers to choose from; empty if there is only one.
    pub parts: Vec<String>,
    /// The items of a buffer as text, a line each; `None` for pictures.
    pub table: Option<String>,
}

/// Lines of a buffer that are shown.
const MOST_LINES: usize = 200;

impl Drawn {
    fn only(legend: String) -> Self {
        Self {
            legend,
            ..Self::default()
        }
    }
}

/// Draws the content of a pane for the method with the index `index` in the snapshot. `reading`
/// applies to materials only. `answer` is the reference's answer to this frame; `None` if there is
/// none yet.
pub fn draw(
    snapshot: &FrameSnapshot,
    index: usize,
    show: &Show,
    reading: &Reading,
    answer: Option<&Answer>,
) -> Drawn {
    let Some(method) = snapshot.methods.get(index) else {
        return Drawn::default();
    };
    if method.contents.is_empty() {
        return Drawn::only("nothing was drawn yet".into());
    }
    let drawn = match (show, answer) {
        (Show::Material(capture), _) => Ok(material(method, &capture.name(), reading)),
        (Show::Difference, None) => Err("the reference has no answer to this frame yet".into()),
        (Show::Difference, Some(answer)) => difference(snapshot, method, answer),
        (show, _) => lit(snapshot, method, show),
    };
    drawn.unwrap_or_else(Drawn::only)
}

/// Said in the place of a picture under a light that the method does not read.
const OTHER_LIGHTS: &str = "it answers for other lights of the scene, not for this one";

/// The method's answer on the scene.
fn lit(snapshot: &FrameSnapshot, method: &MethodSnapshot, show: &Show) -> Result<Drawn, String> {
    let facing = &*snapshot.facing;
    let contents = (*method.contents).clone();
    let layer = method.layer.ok_or(OTHER_LIGHTS)?;
    let outputs = Outputs::from_contents(contents, layer, facing)?;
    let shown = outputs.shown();
    let image = match show {
        Show::Visibility => Image::visibility(facing.viewport, &shown, &outputs.status),
        Show::Uncertain => Image::uncertain(&shown, &outputs.status, facing),
        _ => Image::shaded(&shown, facing),
    };
    let uncertain = outputs.status.iter().filter(|&&status| status == 4).count() as u64;
    let mut legend = match show {
        Show::Visibility => "black shadow, white light, green facing away".to_owned(),
        Show::Uncertain => format!(
            "purple: uncertain, {} of the pixels that face the light",
            percent(uncertain, facing_light(facing))
        ),
        _ => "lit by what the method sees of the light".to_owned(),
    };
    if let Some(rays) = outputs.rays {
        legend += &format!("; {} rays", thousands(rays));
    }
    let unanswered = outputs.visibility.iter();
    let unanswered = unanswered.filter(|&&shown| shown == UNANSWERED).count() as u64;
    if unanswered > 0 {
        legend += &format!("; {} pixels without an answer", thousands(unanswered));
    }
    // The numbers under the cursor are those of the answer.
    let numbers = method.contents.get(VISIBILITY).map(Content::split);
    let numbers = numbers.as_ref().and_then(|layers| layers.get(layer));
    Ok(Drawn {
        image: Some(image.map_err(|error| error.to_string())?),
        legend,
        texels: numbers.and_then(|part| Texels::new(part, None)),
        ..Drawn::default()
    })
}

/// Where the method is wrong, of the pixels that the reference has answered.
fn difference(
    snapshot: &FrameSnapshot,
    method: &MethodSnapshot,
    answer: &Answer,
) -> Result<Drawn, String> {
    let ground_truth = answer.ground_truth.as_ref().map_err(Clone::clone)?;
    let size = snapshot.facing.viewport;
    let judged = [VISIBILITY, STATUS].into_iter();
    let contents: BTreeMap<String, Content> = judged
        .filter_map(|name| Some((name.to_owned(), method.contents.get(name)?)))
        .map(|(name, content)| (name, thin_content(content, size, answer.stride)))
        .collect();
    let layer = method.layer.ok_or(OTHER_LIGHTS)?;
    let outputs = Outputs::from_contents(contents, layer, &ground_truth.pixels)?;
    let wrong = |error: skiagraph_reference::Error| error.to_string();
    let judgement = Judgement::new(&outputs, ground_truth).map_err(wrong)?;
    let truth = &ground_truth.pixels;
    let image = judgement.errors(&outputs, ground_truth);
    Ok(Drawn {
        image: Some(image.map_err(wrong)?),
        legend: format!(
            "{}; {}",
            verdict(&judgement, truth),
            of_pixels(answer.stride)
        ),
        ..Drawn::default()
    })
}

/// Returns the words of a legend for the pixels that have a reference: every `stride`-th (1, 3 or
/// 9) of each row and column.
pub fn of_pixels(stride: u32) -> &'static str {
    match stride {
        1 => "of all pixels",
        3 => "of every third pixel in each row and column so far",
        _ => "of every ninth pixel in each row and column so far",
    }
}

/// Pixels that face the light.
fn facing_light(truth: &GroundTruthPixels) -> u64 {
    let facing = truth.classes.iter().filter(|class| class.faces_light());
    facing.count() as u64
}

fn verdict(judgement: &Judgement, truth: &GroundTruthPixels) -> String {
    let graded = &judgement.graded;
    if !judgement.is_hard {
        return format!(
            "blue too light, red too dark; RMSE {:.4}, mean {:.4}, FLIP {:.4}",
            graded.rmse, graded.mean_absolute_error, graded.flip
        );
    }

    let wrong = &judgement.counts.wrong;
    let outside = wrong.total - wrong.in_band;
    format!(
        "blue wrongly lit, red wrongly in shadow, paler in the band; {} wrong outside the band \
         ({}), {} in it",
        thousands(outside),
        percent(outside, facing_light(truth)),
        thousands(wrong.in_band)
    )
}

/// One texel of `stride` in each row and column of every layer of a content of the viewport's size.
fn thin_content(content: &Content, size: [u32; 2], stride: u32) -> Content {
    let Content::Texture { format, .. } = content else {
        return content.clone();
    };
    let texel = format.block_copy_size(None).unwrap_or(4) as usize;
    let layers = content.split();
    let thinned = layers.iter().flat_map(|layer| {
        let texels: Vec<&[u8]> = layer.bytes().chunks_exact(texel).collect();
        if texels.len() == size[0] as usize * size[1] as usize {
            thin(&texels, size, stride).concat()
        } else {
            // Texels of another size, which judging refuses by name.
            Vec::new()
        }
    });
    Content::Texture {
        format: *format,
        bytes: thinned.collect(),
        parts: vec![thinned_size(size, stride); layers.len()],
    }
}

/// A material, decoded as files of it are.
fn material(method: &MethodSnapshot, name: &str, reading: &Reading) -> Drawn {
    let Some(content) = method.contents.get(name) else {
        return Drawn::only(format!("`{name}` was not read yet"));
    };
    let decoding = method.readings.get(name).cloned().unwrap_or_default();
    if let Content::Buffer(bytes) = content {
        return match buffer_csv::to_csv(bytes, decoding.item.as_ref(), decoding.first_item()) {
            Ok(text) => {
                let table = table(&text);
                let legend = decoding.part_text(content) + &table.legend;
                Drawn { legend, ..table }
            }
            Err(error) => Drawn::only(error.to_string()),
        };
    }
    let parts = content.split();
    let part = &parts[reading.part.min(parts.len() - 1)];
    let texels = Texels::new(part, decoding.planes);
    let channel = |desired: usize| {
        let last = texels.as_ref().map_or(0, |texels| texels.channels - 1);
        desired.min(last)
    };
    let histogram = texels
        .as_ref()
        .map(|texels| texels.histogram(channel(reading.channel)));
    let material = name.split('@').next().unwrap_or(name);
    let picture = Picture::new(material, part, decoding.planes);
    let (mut image, mut legend) = match picture {
        Ok(picture) => (
            Some(picture.image),
            decoding.part_text(content) + &picture.legend,
        ),
        Err(why) => (None, format!("`{name}` {why}")),
    };
    let mut heat = None;
    if let (Some(desired), Some(texels)) = (reading.heat, &texels) {
        let range = texels.histogram(channel(desired)).range;
        if range[0] <= range[1] {
            image = Some(texels.heat(channel(desired), range));
            legend = format!("heat map of channel {}", channel(desired));
            heat = Some(range);
        }
    }
    Drawn {
        image,
        legend,
        histogram,
        heat,
        texels,
        parts: part_names(content, decoding.part.as_ref()),
        table: None,
    }
}

fn table(text: &str) -> Drawn {
    let lines = text.lines().count().saturating_sub(1);
    let items = thousands(lines as u64);
    let shown: Vec<&str> = text.lines().take(MOST_LINES + 1).collect();
    Drawn {
        legend: if lines > MOST_LINES {
            format!("the first {MOST_LINES} of {items} items")
        } else {
            format!("{items} items")
        },
        table: Some(shown.join("\n")),
        ..Drawn::default()
    }
}

/// Names of the mips and layers of a texture or of a part of one; empty where there is only one.
fn part_names(content: &Content, summary: Option<&PartSummary>) -> Vec<String> {
    let Content::Texture { parts, .. } = content else {
        return Vec::new();
    };
    if parts.len() < 2 {
        return Vec::new();
    }
    let first = summary.map_or([0, 0], |part| [part.mips.start, part.layers.start]);
    let [mut mip, mut layer] = first;
    let name = |(index, size): (usize, &[u32; 2])| {
        match index.checked_sub(1).map(|before| parts[before]) {
            Some(before) if before != *size => (mip, layer) = (mip + 1, first[1]),
            Some(_) => layer += 1,
            None => {}
        }
        format!("mip {mip}, layer {layer}, {}x{}", size[0], size[1])
    };
    parts.iter().enumerate().map(name).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use wgpu::TextureFormat as F;

    #[test]
    fn parts_are_layers_of_mips() {
        let content = Content::Texture {
            format: F::R8Unorm,
            parts: vec![[4, 4], [4, 4], [2, 2], [2, 2], [1, 1], [1, 1]],
            bytes: vec![0; 42],
        };
        let names = part_names(&content, None);
        assert_eq!(names[1], "mip 0, layer 1, 4x4");
        assert_eq!(names[2], "mip 1, layer 0, 2x2");
        assert_eq!(names[5], "mip 2, layer 1, 1x1");
        let part = PartSummary {
            mips: 1..4,
            layers: 3..5,
            of: [4, 9],
        };
        let names = part_names(&content, Some(&part));
        assert_eq!(names[0], "mip 1, layer 3, 4x4");
        assert_eq!(names[3], "mip 2, layer 4, 2x2");
    }

    #[test]
    fn a_thinned_content_keeps_the_middle_of_each_block_in_every_layer() {
        let content = Content::Texture {
            format: F::R16Uint,
            parts: vec![[4, 3]; 2],
            bytes: (0..24u16).flat_map(u16::to_le_bytes).collect(),
        };
        let thin = thin_content(&content, [4, 3], 3);
        assert_eq!(thin.as_u32(), Some(vec![5, 17]));
        assert_eq!(thin.split().len(), 2);
    }

    #[test]
    fn a_long_table_is_cut_and_says_so() {
        let text: String = (0..300).map(|line| format!("{line}\n")).collect();
        let drawn = table(&text);
        assert_eq!(drawn.legend, "the first 200 of 299 items");
        assert_eq!(drawn.table.unwrap().lines().count(), 201);
    }
}
