//! Finds places to stand inside of a mesh.

use super::room::{Room, squares, turns};
use glam::DVec3;
use itertools::Itertools;
use skiagraph_reference::sight::{Sight, sights};

/// Columns of places that are tried along each of the two horizontal axes.
const COLUMNS: u32 = 9;

/// Floors that are looked at in a column, from the top.
const FLOORS: usize = 8;

/// The eye's height as a share of that to the ceiling, or of the width where that is less, as in a
/// corridor, and the most of the mesh's width that it is in wider rooms.
const EYE_HEIGHT: f64 = 0.4;
const MOST_EYE_HEIGHT: f64 = 0.1;

/// Least height of a room, as a share of the mesh's diagonal: a gap below a house is none.
const HIGH: f64 = 0.005;

/// Rays around an eye, half of them a little upwards, half a little downwards.
const AROUND: u32 = 24;
const TILT: f64 = 0.15;

/// Share of the rays around an eye that must meet fronts of surfaces: windows and a door are open.
const SURROUNDED: f64 = 0.85;

/// Shares of the columns in which there must be a place to stand: a cup is no room, and of a house
/// with small rooms it is not sure that they are what is to be seen.
const INSIDE: f64 = 0.25;
const SURELY_INSIDE: f64 = 0.3;

/// Cosine of the steepest floor.
const LEVEL: f64 = 0.82;

/// Mean distance of the walls, as a share of the height to the ceiling: a bottle is no room.
const WIDE: f64 = 0.35;

/// Downward slope of a view inside.
pub(super) const SLOPE: f64 = 0.15;

/// Eyes that are looked through.
const EYES: usize = 16;

/// Rays from the corners of a grid on each side of the box, to tell whether fronts or backs are
/// seen from there.
const HULL_RAYS: u32 = 6;

/// A place inside of a mesh.
#[derive(Clone, Copy)]
pub(super) struct Eye {
    pub(super) place: DVec3,
    /// Mean distance of the surfaces around it.
    openness: f64,
    is_roofed: bool,
}

/// The places to stand inside of a mesh.
pub(super) struct Inside {
    /// The most open ones, the most open first.
    pub(super) eyes: Vec<Eye>,
    /// True if the mesh's outer sides are not to be seen: walls with one side, turned inwards.
    pub(super) is_shell: bool,
    /// True if there are places to stand in enough of its columns to be sure.
    pub(super) is_sure: bool,
}

impl Inside {
    /// Returns the places from which surfaces stand all around, on a floor, in no closed part,
    /// under a roof; walls that are seen from inside alone need none. `None` if there are too few,
    /// or if they are within a body that neither light nor things get into.
    pub(super) fn new(room: &Room<'_>) -> Option<Self> {
        let is_shell = is_shell(room);
        let columns = columns(room);
        let count = columns.len() as f64;
        let eyes = columns.into_iter().filter_map(|places| {
            let eyes = places.into_iter().filter_map(|place| standing(room, place));
            let eyes = eyes.filter(|eye| is_shell || eye.is_roofed);
            // One of a column: the most open one.
            eyes.max_by(|a, b| a.openness.total_cmp(&b.openness))
        });
        let mut eyes = eyes.filter(|eye| !room.is_buried(eye.place)).collect_vec();
        let share = eyes.len() as f64 / count.max(1.0);
        eyes.sort_by(|a, b| b.openness.total_cmp(&a.openness));
        eyes.truncate(EYES);
        let is_room = share >= INSIDE && (is_shell || is_used(room, &eyes));
        is_room.then_some(Self {
            eyes,
            is_shell,
            is_sure: is_shell || share >= SURELY_INSIDE,
        })
    }
}

/// True if half of what is seen from around a mesh are backs.
fn is_shell(room: &Room<'_>) -> bool {
    let places = squares(HULL_RAYS).cartesian_product(turns(4));
    let rays = places.map(|((x, y), turn)| {
        let side = room.around(turn);
        let beside = side.cross(room.up);
        let aside = beside * (x * room.reach(beside)) + room.up * (y * room.reach(room.up));
        let from = room.middle + aside + side * (room.half.length() * 1.1);
        (from, -side)
    });
    let seen = sights(&room.oracle, &rays.collect_vec());
    let fronts = seen.iter().flatten().filter(|sight| sight.is_front).count();
    2 * fronts < seen.iter().flatten().count()
}

/// True if light gets to some of the eyes, or if closed parts stand around them: furniture.
fn is_used(room: &Room<'_>, eyes: &[Eye]) -> bool {
    let slopes = [-0.8, 0.1, 0.3, 1.0, 3.0];
    let around = |eye: &Eye| room.all_around(eye.place, 60, &slopes);
    let seen = eyes.iter().flat_map(around).collect_vec();
    let part = |sight: &Sight| room.parts().of[sight.primitive as usize];
    let parts = seen.iter().flatten().map(part);
    let is_thing = |part: &u32| !room.parts().open[*part as usize];
    let (things, walls): (Vec<u32>, Vec<u32>) = parts.unique().partition(is_thing);
    seen.contains(&None) || !things.is_empty() && things.len() + walls.len() > 1
}

/// Places above the floors of each column that has one.
fn columns(room: &Room<'_>) -> Vec<Vec<DVec3>> {
    let [right, back] = room.across;
    let top = room.reach(room.up);
    let columns = squares(COLUMNS).map(|(x, z)| {
        let place = room.middle + right * (x * room.reach(right)) + back * (z * room.reach(back));
        above_floors(room, place + room.up * (top * 1.01))
    });
    columns.filter(|column| !column.is_empty()).collect()
}

/// Places above the floors below a place.
fn above_floors(room: &Room<'_>, from: DVec3) -> Vec<DVec3> {
    let [right, back] = room.across;
    let width = 2.0 * room.reach(right).min(room.reach(back));
    let (mut from, mut eyes) = (from, Vec::new());
    for number in 0..FLOORS {
        let Some(sight) = room.sight(from, -room.up) else {
            break;
        };
        if sight.is_front {
            let is_narrow = number > 0 && width < sight.distance;
            let share = if is_narrow {
                EYE_HEIGHT
            } else {
                MOST_EYE_HEIGHT
            };
            let height = (EYE_HEIGHT * sight.distance).min(share * width);
            eyes.push(from - room.up * (sight.distance - height));
        }
        // A hair further, for the next one below.
        let step = sight.distance * (1.0 + 1e-9) + room.reach(room.up) * 1e-6;
        from -= room.up * step;
    }
    eyes
}

/// The eye at a place, if surfaces stand all around it, far enough, and the floor is level.
fn standing(room: &Room<'_>, place: DVec3) -> Option<Eye> {
    let floor = room.sight(place, -room.up)?;
    let normal = room.normal(floor.primitive).normalize_or_zero();
    let slope = normal.dot(room.up);
    let seen = room.all_around(place, AROUND, &[TILT, -TILT]);
    let walls = seen.iter().flatten().filter(|sight| sight.is_front);
    let walls = walls.map(|sight| sight.distance).collect_vec();
    let share = walls.len() as f64 / f64::from(AROUND);
    let openness = walls.iter().sum::<f64>() / walls.len().max(1) as f64;
    let ceiling = room.sight(place, room.up).map(|sight| sight.distance);
    let height = floor.distance + ceiling.unwrap_or(0.0);
    let is_room = openness >= WIDE * height && height >= HIGH * 2.0 * room.half.length();
    let stands = slope.abs() >= LEVEL && share >= SURROUNDED;
    (stands && is_room).then_some(Eye {
        place,
        openness,
        is_roofed: ceiling.is_some(),
    })
}
