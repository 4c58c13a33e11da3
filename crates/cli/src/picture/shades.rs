//! From values to colours, each with a legend that says which is which.

use super::Planes;
use crate::table::thousands;
use skiagraph_reference::BACKGROUND;
use std::collections::BTreeSet;

/// Colours of the `status` values 0 to 4, with their meaning.
pub const STATUS: [([u8; 3], &str); 5] = [
    ([96, 112, 128], "grey background"),
    ([0, 128, 0], "green facing away"),
    ([255, 255, 255], "white certain light"),
    ([0, 0, 0], "black certain shadow"),
    ([160, 32, 240], "purple uncertain"),
];
/// Where there is no primitive, and depths that nothing has written since they were cleared.
pub const NOTHING: [u8; 3] = STATUS[0].0;
/// NaN, and integers that have no business being there.
pub const WRONG: [u8; 3] = [255, 0, 255];
pub const POSITIVE_INFINITY: [u8; 3] = [255, 128, 0];
pub const NEGATIVE_INFINITY: [u8; 3] = [0, 192, 255];

/// Integers by what they mean: `status` values, 0 and 1, or numbers such as ids.
pub fn integers(name: &str, values: &[u32]) -> (Vec<u8>, String) {
    // An include puts its instance's name before that of the material.
    if name.rsplit('.').next() == Some("status") {
        let colour = |&value: &u32| {
            STATUS
                .get(value as usize)
                .map_or(WRONG, |(colour, _)| *colour)
        };
        let count = |status: usize| {
            values
                .iter()
                .filter(|&&value| value as usize == status)
                .count()
        };
        let mut legend: Vec<String> = STATUS
            .iter()
            .enumerate()
            .map(|(status, (_, meaning))| counted(meaning, count(status)))
            .collect();
        let strangers = values
            .iter()
            .filter(|&&value| value as usize >= STATUS.len())
            .count();
        legend.extend(mark("magenta no status", strangers));
        return (values.iter().flat_map(colour).collect(), legend.join(", "));
    }
    let distinct: BTreeSet<u32> = values.iter().copied().collect();
    if distinct.last().is_none_or(|&last| last <= 1) {
        let ones = values.iter().filter(|&&value| value == 1).count();
        let legend = [
            counted("black 0", values.len() - ones),
            counted("white 1", ones),
        ]
        .join(", ");
        return (
            values
                .iter()
                .flat_map(|&value| [value as u8 * 255; 3])
                .collect(),
            legend,
        );
    }
    let ids: Vec<u32> = distinct
        .into_iter()
        .filter(|&id| id != BACKGROUND)
        .collect();
    let mut legend = vec![match (ids.first(), ids.last()) {
        (Some(first), Some(last)) => format!(
            "a colour per number, {} of them from {first} to {last}",
            thousands(ids.len() as u64)
        ),
        _ => "no number".into(),
    }];
    let background = values.iter().filter(|&&value| value == BACKGROUND).count();
    legend.extend(mark("grey 0xffffffff", background));
    (
        values.iter().flat_map(|&value| id_colour(value)).collect(),
        legend.join(", "),
    )
}

/// What a colour stands for and how often.
fn counted(meaning: &str, count: usize) -> String {
    format!("{meaning} ({})", thousands(count as u64))
}

/// The same, where there is any.
fn mark(meaning: &str, count: usize) -> Option<String> {
    (count > 0).then(|| counted(meaning, count))
}

/// Neighbouring ids must look different: a multiplicative hash (Knuth's 2³²/φ), its high bits as a bright colour.
pub fn id_colour(id: u32) -> [u8; 3] {
    if id == BACKGROUND {
        return NOTHING;
    }
    let hash = (id.wrapping_add(1))
        .wrapping_mul(0x9e37_79b9)
        .rotate_left(15)
        .wrapping_mul(0x85eb_ca6b);
    [hash >> 24, hash >> 16 & 0xff, hash >> 8 & 0xff]
        .map(|channel| 48 + (channel * 207 / 255) as u8)
}

/// Depths from the least to the greatest, 1 apart: that is what they are cleared to. A camera's are shown as distances, which
/// its depths would squeeze into a hair below 1.
pub fn depths(values: &[f32], planes: Option<Planes>) -> (Vec<u8>, String) {
    let is_cleared = |depth: f32| depth == 1.0;
    let shown: Vec<f32> = values
        .iter()
        .map(|&depth| match planes {
            Some(planes) => planes.distance(depth),
            None => depth,
        })
        .collect();
    let stored = range(values.iter().copied().filter(|&depth| !is_cleared(depth)));
    let cleared = |index: usize| is_cleared(values[index]);
    let near_far = range(
        (0..shown.len())
            .filter(|&index| !cleared(index))
            .map(|index| shown[index]),
    );
    let colour = |index: usize| match (cleared(index), odd(shown[index])) {
        (true, _) => NOTHING,
        (_, Some(colour)) => colour,
        _ => [level(shown[index], near_far); 3],
    };
    let rgb = (0..shown.len()).flat_map(colour).collect();
    let mut legend = vec![match planes {
        Some(_) => format!(
            "distance along the view, black to white {} (stored {})",
            span(near_far),
            span(stored)
        ),
        None => format!("stored depth, black to white {}", span(stored)),
    }];
    legend.extend(mark(
        "grey 1, nothing there",
        values.iter().filter(|&&depth| is_cleared(depth)).count(),
    ));
    legend.extend(odd_marks(&shown));
    (rgb, legend.join(", "))
}

/// Channels that reach from 0 to 1, as they are.
pub fn fractions(values: &[f32], channels: usize) -> (Vec<u8>, String) {
    let whole = [(0.0, 1.0); 4];
    let rgb = coloured(values, channels, &whole[..channels.min(3)]);
    (
        rgb,
        format!("0 to 1 as it is, holds {}", ranges(values, channels)),
    )
}

/// Each channel between its own least and greatest finite value; one channel is grey, two leave blue black, a fourth is not shown.
pub fn floats(values: &[f32], channels: usize) -> (Vec<u8>, String) {
    let shown: Vec<(f32, f32)> = (0..channels.min(3))
        .map(|index| range(channel(values, channels, index)))
        .collect();
    let rgb = coloured(values, channels, &shown);
    let mut legend = vec![ranges(values, channels)];
    legend.extend(odd_marks(values));
    (rgb, legend.join(", "))
}

fn channel(values: &[f32], channels: usize, index: usize) -> impl Iterator<Item = f32> {
    values.iter().skip(index).step_by(channels).copied()
}

/// Least and greatest finite value.
fn range(values: impl Iterator<Item = f32>) -> (f32, f32) {
    let finite = values.filter(|value| value.is_finite());
    finite.fold((f32::INFINITY, f32::NEG_INFINITY), |(low, high), value| {
        (low.min(value), high.max(value))
    })
}

fn span((low, high): (f32, f32)) -> String {
    match low <= high {
        true => format!("{low} … {high}"),
        false => "without a finite value".into(),
    }
}

/// The range of each channel.
fn ranges(values: &[f32], channels: usize) -> String {
    let names = match channels {
        1 => [""; 4],
        _ => ["red ", "green ", "blue ", "alpha (not shown) "],
    };
    let spans = names.iter().take(channels).enumerate();
    let spans = spans
        .map(|(index, name)| format!("{name}{}", span(range(channel(values, channels, index)))));
    spans.collect::<Vec<_>>().join(", ")
}

fn level(value: f32, (low, high): (f32, f32)) -> u8 {
    // In f64, where the difference of two f32 cannot overflow.
    let share = (f64::from(value) - f64::from(low))
        / (f64::from(high) - f64::from(low)).max(f64::MIN_POSITIVE);
    (share.clamp(0.0, 1.0) * 255.0).round() as u8
}

/// The colour that marks a value which is no number to draw.
fn odd(value: f32) -> Option<[u8; 3]> {
    match value {
        _ if value.is_nan() => Some(WRONG),
        f32::INFINITY => Some(POSITIVE_INFINITY),
        f32::NEG_INFINITY => Some(NEGATIVE_INFINITY),
        _ => None,
    }
}

fn odd_marks(values: &[f32]) -> impl Iterator<Item = String> {
    let count = |is: fn(f32) -> bool| values.iter().filter(|value| is(**value)).count();
    let marks = [
        ("magenta NaN", count(f32::is_nan)),
        ("orange +∞", count(|value| value == f32::INFINITY)),
        ("light blue -∞", count(|value| value == f32::NEG_INFINITY)),
    ];
    marks
        .into_iter()
        .filter_map(|(name, count)| mark(name, count))
}

/// The first channels between these ranges; a texel with an odd value among all its channels shows that.
fn coloured(values: &[f32], channels: usize, shown: &[(f32, f32)]) -> Vec<u8> {
    let texel = |texel: &[f32]| {
        if let Some(colour) = texel.iter().find_map(|&value| odd(value)) {
            return colour;
        }
        let mut colour = [0; 3];
        for (index, &range) in shown.iter().enumerate() {
            colour[index] = level(texel[index], range);
        }
        if shown.len() == 1 {
            [colour[0]; 3]
        } else {
            colour
        }
    };
    values.chunks_exact(channels).flat_map(texel).collect()
}
