//! Turns values into RGB colours, each with a legend.
//!
//! ```
//! use skiagraph_compare::pictures::colours::{STATUS, floats, integers};
//!
//! let (rgb, legend) = integers("status", &[2, 3]);
//! assert_eq!(rgb, [STATUS[2].0, STATUS[3].0].concat());
//! println!("{legend}");
//! let (grey, _) = floats(&[0.0, 0.5, 1.0], 1);
//! assert_eq!((grey[0], grey[6]), (0, 255));
//! ```

use crate::wording::thousands;
use skiagraph_reference::BACKGROUND;
use skiagraph_scene::View;
use std::collections::BTreeSet;

/// RGB colour and legend of each value of an output `status`, at the index of the value, 0 to 4.
pub const STATUS: [([u8; 3], &str); 5] = [
    ([96, 112, 128], "grey background"),
    ([0, 128, 0], "green facing away"),
    ([255, 255, 255], "white certain light"),
    ([0, 0, 0], "black certain shadow"),
    ([160, 32, 240], "purple uncertain"),
];
/// RGB colour of pixels that show no triangle, and of depths that still have the value to which
/// they were cleared.
pub const EMPTY: [u8; 3] = STATUS[0].0;
/// RGB colour of NaN, and of integers that are not a value of `status`.
pub const INVALID: [u8; 3] = [255, 0, 255];
/// RGB colour of positive infinity.
pub const POSITIVE_INFINITY: [u8; 3] = [255, 128, 0];
/// RGB colour of negative infinity.
pub const NEGATIVE_INFINITY: [u8; 3] = [0, 192, 255];

/// Near and far plane of a perspective camera, to turn its stored depths into distances.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ClipPlanes {
    /// Distance of the near plane from the eye in scene units; it has depth 1.
    pub near: f64,
    /// Distance of the far plane from the eye in scene units; it has depth 0, the cleared value.
    pub far: f64,
}

impl ClipPlanes {
    /// Returns the near and far plane of a view.
    pub fn new(view: &View) -> Self {
        let View { near, far, .. } = *view;
        Self { near, far }
    }

    /// Returns the distance from the eye along the viewing direction, in scene units, for a
    /// reversed depth: 1 at the near plane, 0 at the far plane.
    pub fn distance(self, depth: f32) -> f32 {
        let Self { near, far } = self;
        (near * far / (near + f64::from(depth) * (far - near))) as f32
    }
}

/// Colours integers: by [`STATUS`] if the material `name` is `status`, otherwise 0 and 1 as black
/// and white, or each number in a colour of its own if there are others. Returns three bytes (RGB)
/// per value, and the legend.
pub fn integers(name: &str, values: &[u32]) -> (Vec<u8>, String) {
    let (colour, legend): (fn(u32) -> [u8; 3], _) = match () {
        // An include puts its instance's name before that of the material.
        () if name.rsplit('.').next() == Some("status") => (status_colour, statuses(values)),
        () if values.iter().all(|&value| value <= 1) => {
            let [zeros, ones] = [0, 1].map(|bit| count(values, |value| value == bit));
            let legend = vec![counted("black 0", zeros), counted("white 1", ones)];
            (|value| [value as u8 * 255; 3], legend)
        }
        () => (id_colour, ids(values)),
    };
    let rgb = values.iter().flat_map(|&value| colour(value));
    (rgb.collect(), legend.join(", "))
}

fn status_colour(status: u32) -> [u8; 3] {
    let entry = STATUS.get(status as usize);
    entry.map_or(INVALID, |(colour, _)| *colour)
}

fn statuses(values: &[u32]) -> Vec<String> {
    let entry = |(status, (_, meaning))| counted(meaning, count(values, |value| value == status));
    let strangers = count(values, |value| value as usize >= STATUS.len());
    let legend = (0..).zip(STATUS).map(entry);
    legend.chain(mark("magenta no status", strangers)).collect()
}

fn ids(values: &[u32]) -> Vec<String> {
    let mut ids: BTreeSet<u32> = values.iter().copied().collect();
    let background = count(values, |value| value == BACKGROUND);
    ids.remove(&BACKGROUND);
    let of_ids = match (ids.first(), ids.last()) {
        (Some(first), Some(last)) => format!(
            "a colour per number, {} of them from {first} to {last}",
            thousands(ids.len() as u64)
        ),
        _ => "no number".into(),
    };
    let of_background = mark("grey 0xffffffff", background);
    [of_ids].into_iter().chain(of_background).collect()
}

fn count<T: Copy>(values: &[T], is: impl Fn(T) -> bool) -> usize {
    values.iter().filter(|value| is(**value)).count()
}

/// Says what a colour stands for and how often.
fn counted(meaning: &str, count: usize) -> String {
    format!("{meaning} ({})", thousands(count as u64))
}

/// The same, where there is any.
fn mark(meaning: &str, count: usize) -> Option<String> {
    (count > 0).then(|| counted(meaning, count))
}

/// Returns the RGB colour of an id, such as a triangle's, by a multiplicative hash (Knuth's 2³²/φ),
/// so that consecutive ids look different; [`EMPTY`] for 0xffffffff, the id of a pixel that shows
/// no triangle.
pub fn id_colour(id: u32) -> [u8; 3] {
    if id == BACKGROUND {
        return EMPTY;
    }
    let hash = (id.wrapping_add(1))
        .wrapping_mul(0x9e37_79b9)
        .rotate_left(15)
        .wrapping_mul(0x85eb_ca6b);
    [hash >> 24, hash >> 16 & 0xff, hash >> 8 & 0xff]
        .map(|channel| 48 + (channel * 207 / 255) as u8)
}

/// Returns the depth of a texel in which nothing was drawn: 0 with `planes`, as a camera's depths
/// are reversed, 1 with `None` for a light.
pub fn cleared(planes: Option<ClipPlanes>) -> f32 {
    planes.map_or(1.0, |_| 0.0)
}

/// Colours depths from black for the nearest to white for the farthest. Cleared depths have the
/// colour [`EMPTY`]. With `planes`, the depths are those of a camera and are shown as distances, as
/// the depths themselves crowd just above 0. Returns three bytes (RGB) per depth, and the legend.
pub fn depths(values: &[f32], planes: Option<ClipPlanes>) -> (Vec<u8>, String) {
    let is_cleared = |depth: f32| depth == cleared(planes);
    let distance = |depth| planes.map_or(depth, |planes| planes.distance(depth));
    let written = || values.iter().copied().filter(|&depth| !is_cleared(depth));
    let (stored, shown) = (range(written()), range(written().map(distance)));
    let colour = |&depth: &f32| match non_finite_colour(distance(depth)) {
        _ if is_cleared(depth) => EMPTY,
        Some(colour) => colour,
        None => [grey_level(distance(depth), shown); 3],
    };
    let mut legend = vec![match planes {
        Some(_) => format!(
            "distance along the view, black to white {} (stored {})",
            span(shown),
            span(stored)
        ),
        None => format!("stored depth, black to white {}", span(stored)),
    }];
    let nothing = format!("grey {}, nothing there", cleared(planes));
    legend.extend(mark(&nothing, count(values, is_cleared)));
    let distances: Vec<f32> = values.iter().copied().map(distance).collect();
    legend.extend(non_finite_marks(&distances));
    (values.iter().flat_map(colour).collect(), legend.join(", "))
}

/// Colours texels of `channels` values each, in which 0 and less is black, and 1 and more is full
/// intensity. A texel with a value that is not finite has that value's colour, such as [`INVALID`].
/// There are 1 to 4 channels: one channel is grey, others are red, green and blue; a fourth is not
/// shown. Returns three bytes (RGB) per texel, and the legend.
pub fn fractions(values: &[f32], channels: usize) -> (Vec<u8>, String) {
    let whole = [(0.0, 1.0); 4];
    let rgb = coloured(values, channels, &whole[..channels.min(3)]);
    let legend = format!("0 to 1 as it is, holds {}", ranges(values, channels));
    (rgb, legend)
}

/// Colours texels of `channels` values each; each channel is scaled between its own least and
/// greatest finite value. A texel with a value that is not finite has that value's colour, such as
/// [`INVALID`]. There are 1 to 4 channels: one channel is grey, others are red, green and blue; a
/// fourth is not shown. Returns three bytes (RGB) per texel, and the legend.
pub fn floats(values: &[f32], channels: usize) -> (Vec<u8>, String) {
    let shown = (0..channels.min(3)).map(|index| range(channel(values, channels, index)));
    let shown: Vec<(f32, f32)> = shown.collect();
    let rgb = coloured(values, channels, &shown);
    let mut legend = vec![ranges(values, channels)];
    legend.extend(non_finite_marks(values));
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
    if low <= high {
        format!("{low} … {high}")
    } else {
        "without a finite value".into()
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

fn grey_level(value: f32, (low, high): (f32, f32)) -> u8 {
    // In f64, where the difference of two f32 cannot overflow.
    let share = (f64::from(value) - f64::from(low))
        / (f64::from(high) - f64::from(low)).max(f64::MIN_POSITIVE);
    (share.clamp(0.0, 1.0) * 255.0).round() as u8
}

type NonFinite = (fn(f32) -> bool, [u8; 3], &'static str);

/// Kinds of values that are no numbers to draw: a test, the colour, and the words of the legend.
const NON_FINITE: [NonFinite; 3] = [
    (f32::is_nan, INVALID, "magenta NaN"),
    (|it| it == f32::INFINITY, POSITIVE_INFINITY, "orange +∞"),
    (
        |it| it == f32::NEG_INFINITY,
        NEGATIVE_INFINITY,
        "light blue -∞",
    ),
];

fn non_finite_colour(value: f32) -> Option<[u8; 3]> {
    let mut kinds = NON_FINITE.iter();
    kinds.find_map(|(is, colour, _)| is(value).then_some(*colour))
}

fn non_finite_marks(values: &[f32]) -> impl Iterator<Item = String> {
    let marks = NON_FINITE.iter();
    marks.filter_map(|(is, _, meaning)| mark(meaning, count(values, is)))
}

/// The first channels between these ranges; a texel with a value that is not finite shows that,
/// whichever channel it is in.
fn coloured(values: &[f32], channels: usize, shown: &[(f32, f32)]) -> Vec<u8> {
    let texel = |texel: &[f32]| {
        if let Some(colour) = texel.iter().find_map(|&value| non_finite_colour(value)) {
            return colour;
        }
        let mut colour = [0; 3];
        for ((colour, &value), &range) in colour.iter_mut().zip(texel).zip(shown) {
            *colour = grey_level(value, range);
        }
        match shown.len() {
            1 => [colour[0]; 3],
            _ => colour,
        }
    };
    values.chunks_exact(channels).flat_map(texel).collect()
}
