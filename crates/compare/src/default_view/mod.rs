//! Chooses a view of a mesh that comes without one: from inside if surfaces surround the camera,
//! otherwise from outside, such that both light and shadow are seen.
//!
//! ```
//! use skiagraph_compare::default_view::default_view;
//! use skiagraph_scene::{DirectionalLight, Mesh};
//! use glam::DVec3;
//!
//! let sun = DirectionalLight::new(DVec3::NEG_Y).into();
//! // There is nothing to be seen here.
//! assert!(default_view(&Mesh::default(), &sun, DVec3::Y, 60.0).is_none());
//! ```

use glam::{DQuat, DVec3};
use itertools::Itertools;
use skiagraph_reference::{
    BACKGROUND, Class, Oracle, OracleMode, Progress, sight::Sight, sight::sights,
};
use skiagraph_scene::{LightKind, Mesh, PointLight, View};
use std::f64::consts::TAU;

/// Columns of places that are tried along each of the two horizontal axes.
const COLUMNS: u32 = 9;

/// Floors that are looked at in a column, from the top.
const FLOORS: usize = 8;

/// The eye's height as a share of that to the ceiling, and the most of the mesh's width that it is.
const EYE_HEIGHT: f64 = 0.4;
const MOST_EYE_HEIGHT: f64 = 0.1;

/// Rays around an eye, half of them a little upwards, half a little downwards.
const AROUND: u32 = 24;
const TILT: f64 = 0.15;

/// Share of the rays around an eye that must meet fronts of surfaces: windows and a door are open.
const SURROUNDED: f64 = 0.85;

/// Share of the columns in which an eye must be surrounded: a cup is no room.
const INSIDE: f64 = 0.25;

/// Eyes and directions of each that are looked through, in small pictures.
const EYES: usize = 16;
const DIRECTIONS: u32 = 8;
const PICTURE: [u32; 2] = [24, 16];

/// Share of a picture that is lit below which it is dark: pixels on an edge may be by rounding.
const DARK: f64 = 0.01;

/// Upward slope of the way to an eye outside.
const ABOVE: f64 = 0.55;

/// Downward slope of a view inside.
const SLOPE: f64 = 0.15;

/// A place inside of a mesh.
#[derive(Clone, Copy)]
struct Eye {
    place: DVec3,
    /// Mean distance of the surfaces around it.
    openness: f64,
}

/// A view that [`default_view`] chose for a mesh, with a position for a lamp.
#[derive(Clone, Debug, PartialEq)]
pub struct DefaultView {
    /// The chosen view, named `inside` or `main`, without a light of its own. Its far plane lies
    /// behind the whole mesh, its near plane at 1/10,000 of the far plane's distance.
    pub view: View,
    /// True if the eye is inside the mesh, with surfaces all around it.
    pub is_inside: bool,
    /// True if the eye is inside, and even the best view under the given light has less than 1 % of
    /// its pixels lit. The view was then chosen as if a lamp at `lamp` were the light.
    pub is_dark: bool,
    /// Position at which a lamp would light the view, in front of the eye and above it, world
    /// space.
    pub lamp: DVec3,
}

/// Chooses a view of a mesh under a light, with an up direction and a vertical field of view in
/// degrees. Eyes are tried above the floors of a grid of 9 × 9 columns through the mesh. The view
/// is from inside if surfaces surround an eye in a quarter or more of the columns that have a
/// floor; otherwise it is from outside and shows the whole mesh. Views that show both lit and
/// shadowed surfaces, far away, are preferred. Returns `None` if the mesh is empty, `up` is zero or
/// no candidate is a valid view.
pub fn default_view(
    mesh: &Mesh,
    light: &LightKind,
    up: DVec3,
    fov_y_degrees: f64,
) -> Option<DefaultView> {
    let (min, max) = mesh.bounds()?;
    let room = Room::new(mesh, [min.as_dvec3(), max.as_dvec3()], up.try_normalize()?);
    let seen = |view: &View| room.worth(view, light);
    let turns = (0..DIRECTIONS).map(|turn| TAU * f64::from(turn) / f64::from(DIRECTIONS));
    let Some(eyes) = room.eyes() else {
        let views = turns.map(|turn| room.outside(turn, fov_y_degrees));
        let (_, view) = best(views, seen)?;
        return Some(room.chosen(view, false, false));
    };
    let views = eyes.iter().cartesian_product(turns);
    let views = views.map(|(eye, turn)| {
        let direction = room.around(turn) - room.up * SLOPE;
        room.view(eye.place, direction, fov_y_degrees)
    });
    match best(views.clone(), seen)? {
        (worth, _) if worth.lit < DARK => {
            // Where no light comes in, that of the lamp tells the views apart.
            let seen = |view: &View| room.worth(view, &bulb(room.lamp(view)));
            let (_, view) = best(views, seen)?;
            Some(room.chosen(view, true, true))
        }
        (_, view) => Some(room.chosen(view, true, false)),
    }
}

/// Angles in radians by which a view may go around what another one shows.
const ASIDE: [f64; 4] = [-0.6, 0.6, -1.2, 1.2];

/// Turns by which another view may look elsewhere than the given one, and angle in radians below
/// which two views from one place show the same.
const TURNS: u32 = 8;
const SAME_ANGLE: f64 = 0.7;

/// Chooses at most `count` views of a mesh other than `like`, for methods that are to be tried on
/// several views. First come at most two that show from other sides what `like` shows, then views
/// in other directions and from other places, inside the mesh if it surrounds the camera. Views
/// that show both lit and shadowed surfaces, far away, are preferred. Their names are empty, and
/// their own light is that of `like`. The list is shorter if there are too few views that differ
/// and show any surface.
pub fn more_views(mesh: &Mesh, light: &LightKind, like: &View, count: usize) -> Vec<View> {
    let (Some((min, max)), Some(up)) = (mesh.bounds(), like.up.try_normalize()) else {
        return Vec::new();
    };
    let room = Room::new(mesh, [min.as_dvec3(), max.as_dvec3()], up);
    let mut chosen = vec![like.clone()];
    let elsewhere = room.turned(like).chain(room.elsewhere(like)).collect();
    for (candidates, most) in [(room.aside(like), count.min(2)), (elsewhere, count)] {
        let worth = |view: View| Some((room.worth(&view, light)?.total(), view));
        let candidates = candidates.into_iter().filter_map(worth);
        let candidates = candidates.filter(|(total, _)| *total > 0.0);
        let candidates = candidates.sorted_by(|(one, _), (other, _)| other.total_cmp(one));
        for (_, view) in candidates {
            if chosen.len() <= most && chosen.iter().all(|other| room.differ(&view, other)) {
                chosen.push(view);
            }
        }
    }
    chosen.split_off(1)
}

fn bulb(position: DVec3) -> LightKind {
    PointLight {
        position,
        radius: 0.0,
    }
    .into()
}

/// The first of the best views, so that the same mesh always gives the same one.
fn best(
    views: impl Iterator<Item = View>,
    worth: impl Fn(&View) -> Option<Worth>,
) -> Option<(Worth, View)> {
    let views = views.filter_map(|view| Some((worth(&view)?, view)));
    views.reduce(|best, other| {
        if other.0.total() > best.0.total() {
            other
        } else {
            best
        }
    })
}

/// The shares of light and shadow in a view, as shares of its pixels.
#[derive(Clone, Copy)]
struct Worth {
    surfaces: f64,
    lit: f64,
    shadow: f64,
    /// Median distance of what it shows, as a share of the mesh, a half at most.
    far: f64,
}

impl Worth {
    /// Light beside shadow first, then how far it sees.
    fn total(self) -> f64 {
        (self.lit.min(self.shadow) + 0.02) * (0.1 + self.far) * self.surfaces
    }
}

/// A mesh that is looked around in.
struct Room<'a> {
    oracle: Oracle<'a>,
    middle: DVec3,
    /// Half the extent of its box.
    half: DVec3,
    up: DVec3,
    across: [DVec3; 2],
}

impl<'a> Room<'a> {
    fn new(mesh: &'a Mesh, [min, max]: [DVec3; 2], up: DVec3) -> Self {
        Self {
            oracle: Oracle::new(mesh),
            middle: (min + max) * 0.5,
            half: (max - min) * 0.5,
            up,
            across: up.any_orthonormal_pair().into(),
        }
    }

    /// Views of what another one shows in its middle, from other sides; from nearer where something
    /// stands in the way there.
    fn aside(&self, like: &View) -> Vec<View> {
        let Some(ahead) = self.sight(like.eye, like.direction) else {
            return Vec::new();
        };
        let middle = like.eye + like.direction * ahead.distance;
        let view = |turn: f64| {
            let turned = DQuat::from_axis_angle(self.up, turn);
            let way = middle + turned * (like.eye - middle) - like.eye;
            let free = self.sight(like.eye, way).map_or(1.0, |it| it.distance);
            let eye = like.eye + way * if free < 1.0 { 0.6 * free } else { 1.0 };
            View {
                name: String::new(),
                eye,
                direction: middle - eye,
                ..like.clone()
            }
        };
        ASIDE.map(view).into()
    }

    /// Views from the place of another one, in other directions.
    fn turned(&self, like: &View) -> impl Iterator<Item = View> {
        let turns = (1..TURNS).map(|turn| TAU * f64::from(turn) / f64::from(TURNS));
        turns.map(|turn| View {
            name: String::new(),
            direction: DQuat::from_axis_angle(self.up, turn) * like.direction,
            ..like.clone()
        })
    }

    /// Views from other places inside the mesh, or else from around it.
    fn elsewhere(&self, like: &View) -> Vec<View> {
        let turns = (0..TURNS).map(|turn| TAU * f64::from(turn) / f64::from(TURNS));
        let fov = like.fov_y_degrees;
        let views: Vec<View> = match self.eyes() {
            Some(eyes) => {
                let views = eyes.iter().cartesian_product(turns);
                let view = |(eye, turn): (&Eye, f64)| {
                    self.view(eye.place, self.around(turn) - self.up * SLOPE, fov)
                };
                views.map(view).collect()
            }
            None => {
                let around = |turn| {
                    let turned = DQuat::from_axis_angle(self.up, turn);
                    let eye = self.middle + turned * (like.eye - self.middle);
                    self.view(eye, turned * like.direction, fov)
                };
                turns.skip(1).map(around).collect()
            }
        };
        let lit = views.into_iter().map(|view| View {
            light: like.light.clone(),
            ..view
        });
        lit.collect()
    }

    /// True if two views show different parts of the mesh.
    fn differ(&self, one: &View, other: &View) -> bool {
        let is_near = one.eye.distance(other.eye) < 0.05 * self.half.length();
        !is_near || one.direction.angle_between(other.direction) > SAME_ANGLE
    }

    /// Half the extent of the box along an axis.
    fn reach(&self, axis: DVec3) -> f64 {
        axis.abs().dot(self.half)
    }

    fn around(&self, turn: f64) -> DVec3 {
        let (sin, cos) = turn.sin_cos();
        self.across[0] * cos + self.across[1] * sin
    }

    fn view(&self, eye: DVec3, direction: DVec3, fov_y_degrees: f64) -> View {
        let far = ((eye - self.middle).length() + self.half.length()) * 1.01;
        View {
            name: String::new(),
            eye,
            direction,
            up: self.up,
            fov_y_degrees,
            near: far * 1e-4,
            far,
            light: None,
        }
    }

    /// From above one side, as far away as all of it is seen.
    fn outside(&self, turn: f64, fov_y_degrees: f64) -> View {
        let radius = self.half.length().max(f64::MIN_POSITIVE);
        let distance = radius / (fov_y_degrees.to_radians() * 0.5).sin();
        let way = (self.around(turn) + self.up * ABOVE).normalize();
        self.view(self.middle + way * distance, -way, fov_y_degrees)
    }

    fn chosen(&self, view: View, is_inside: bool, is_dark: bool) -> DefaultView {
        let name = if is_inside { "inside" } else { "main" };
        DefaultView {
            lamp: self.lamp(&view),
            view: View {
                name: name.into(),
                ..view
            },
            is_inside,
            is_dark,
        }
    }

    /// The most open of the surrounded eyes; `None` if the mesh surrounds too few.
    fn eyes(&self) -> Option<Vec<Eye>> {
        let columns = self.columns();
        let count = columns.len();
        let eyes = columns.iter().map(|column| {
            let eyes = column.iter().filter_map(|&place| self.surrounded(place));
            // One of a column: the most open one.
            eyes.max_by(|a, b| a.openness.total_cmp(&b.openness))
        });
        let mut eyes: Vec<Eye> = eyes.flatten().collect();
        if eyes.is_empty() || (eyes.len() as f64) < INSIDE * count as f64 {
            return None;
        }
        eyes.sort_by(|a, b| b.openness.total_cmp(&a.openness));
        eyes.truncate(EYES);
        Some(eyes)
    }

    /// Places above the floors of each column that has one.
    fn columns(&self) -> Vec<Vec<DVec3>> {
        let [right, back] = self.across;
        let share = |number: u32| (f64::from(number) + 0.5) / f64::from(COLUMNS) * 2.0 - 1.0;
        let top = self.reach(self.up);
        let numbers = (0..COLUMNS).cartesian_product(0..COLUMNS);
        let columns = numbers.map(|(x, z)| {
            let place = self.middle
                + right * (share(x) * self.reach(right))
                + back * (share(z) * self.reach(back));
            self.above_floors(place + self.up * (top * 1.01))
        });
        columns.filter(|column| !column.is_empty()).collect()
    }

    /// Places above the floors below a place.
    fn above_floors(&self, from: DVec3) -> Vec<DVec3> {
        let [right, back] = self.across;
        let most = MOST_EYE_HEIGHT * 2.0 * self.reach(right).min(self.reach(back));
        let (mut from, mut eyes) = (from, Vec::new());
        for _ in 0..FLOORS {
            let Some(sight) = self.sight(from, -self.up) else {
                break;
            };
            if sight.is_front {
                let height = (EYE_HEIGHT * sight.distance).min(most);
                eyes.push(from - self.up * (sight.distance - height));
            }
            // A hair further, for the next one below.
            let step = sight.distance * (1.0 + 1e-9) + self.reach(self.up) * 1e-6;
            from -= self.up * step;
        }
        eyes
    }

    fn sight(&self, from: DVec3, direction: DVec3) -> Option<Sight> {
        sights(&self.oracle, &[(from, direction)])[0]
    }

    /// The eye at a place, if surfaces stand all around it.
    fn surrounded(&self, place: DVec3) -> Option<Eye> {
        let rays = (0..AROUND).map(|number| {
            let tilt = if number % 2 == 0 { TILT } else { -TILT };
            let turn = TAU * f64::from(number) / f64::from(AROUND);
            (place, self.around(turn) + self.up * tilt)
        });
        let seen = sights(&self.oracle, &rays.collect_vec());
        let walls = seen.iter().flatten().filter(|sight| sight.is_front);
        let walls: Vec<f64> = walls.map(|sight| sight.distance).collect();
        let share = walls.len() as f64 / f64::from(AROUND);
        (share >= SURROUNDED).then(|| Eye {
            place,
            openness: walls.iter().sum::<f64>() / walls.len() as f64,
        })
    }

    /// On the way from the eye to the ceiling in its middle distance.
    fn lamp(&self, view: &View) -> DVec3 {
        let way = view.direction.normalize() + self.up * 0.8;
        let ceiling = self.sight(view.eye, way);
        let distance = ceiling.map_or(self.half.length(), |sight| sight.distance);
        view.eye + way * (0.7 * distance)
    }

    /// How much a view is worth; `None` of one that no camera has.
    fn worth(&self, view: &View, light: &LightKind) -> Option<Worth> {
        view.check().ok()?;
        let camera = view.camera(PICTURE);
        let progress = Progress::default();
        let primitives = self.oracle.primary(&camera, progress).ok()?;
        let shown = primitives.iter().filter(|&&it| it != BACKGROUND).count();
        let mode = OracleMode::Exact;
        let truth = self
            .oracle
            .shade(&camera, light, &primitives, mode, progress);
        let classes = truth.ok()?.classes;
        let share = |class: Class| {
            let count = classes.iter().filter(|&&of| of == class).count();
            count as f64 / classes.len() as f64
        };
        let [width, height] = PICTURE;
        let pixels = (0..height).cartesian_product(0..width);
        let rays = pixels.map(|(y, x)| (view.eye, camera.pixel_direction(x, y)));
        let seen = sights(&self.oracle, &rays.collect_vec());
        let distances = seen.iter().flatten().map(|sight| sight.distance);
        let distances: Vec<f64> = distances.sorted_by(f64::total_cmp).collect();
        let median = distances.get(distances.len() / 2).copied().unwrap_or(0.0);
        Some(Worth {
            surfaces: shown as f64 / classes.len() as f64,
            lit: share(Class::Lit),
            shadow: share(Class::Shadow),
            far: (median / self.half.length()).min(0.5),
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::Vec3;
    use skiagraph_scene::DirectionalLight;

    /// Boxes, those that are turned inwards seen from inside; a face that is left out.
    fn mesh(boxes: &[([f32; 3], [f32; 3], bool)], without: Option<usize>) -> Mesh {
        let axes = [Vec3::Z, Vec3::Y, Vec3::X];
        let mut mesh = Mesh {
            normals: axes.iter().flat_map(|&axis| [-axis, axis]).collect(),
            ..Mesh::default()
        };
        for &(low, high, is_inward) in boxes {
            let first = mesh.positions.len() as u32;
            let corner = |at: u32| {
                let pick = |axis: usize| {
                    if at >> axis & 1 == 0 {
                        low[axis]
                    } else {
                        high[axis]
                    }
                };
                Vec3::new(pick(0), pick(1), pick(2))
            };
            mesh.positions.extend((0..8).map(corner));
            let faces = [
                [0, 2, 3, 1],
                [4, 5, 7, 6],
                [0, 1, 5, 4],
                [2, 6, 7, 3],
                [0, 4, 6, 2],
                [1, 3, 7, 5],
            ];
            for (face, [a, b, c, d]) in faces.into_iter().enumerate() {
                if is_inward && without == Some(face) {
                    continue;
                }
                for [a, b, c] in [[a, b, c], [a, c, d]] {
                    let corners = if is_inward { [a, c, b] } else { [a, b, c] };
                    mesh.triangles.push(corners.map(|corner| first + corner));
                    // The other one of its axis.
                    let normal = if is_inward { face ^ 1 } else { face };
                    mesh.normal_indices.push([normal as u32; 3]);
                }
            }
        }
        mesh
    }

    const WALLS: ([f32; 3], [f32; 3], bool) = ([-4.0, 0.0, -3.0], [4.0, 3.0, 3.0], true);
    const TABLE: ([f32; 3], [f32; 3], bool) = ([-1.0, 0.7, -0.5], [1.0, 0.9, 0.5], false);

    fn view(mesh: &Mesh) -> Option<DefaultView> {
        let sun = DirectionalLight::new(DVec3::new(-0.3, -1.0, -0.4)).into();
        default_view(mesh, &sun, DVec3::Y, 60.0)
    }

    fn is_inside(mesh: &Mesh) -> bool {
        view(mesh).unwrap().is_inside
    }

    #[test]
    fn a_room_is_seen_from_inside_with_light_and_shadow() {
        let without_ceiling = mesh(&[WALLS, TABLE], Some(3));
        let inside = view(&without_ceiling).unwrap();
        assert!(inside.is_inside && !inside.is_dark);
        let seen = inside.view;
        assert!(seen.eye.x.abs() < 4.0 && seen.eye.z.abs() < 3.0, "{seen:?}");
        assert!(seen.eye.y > 0.2 && seen.eye.y < 3.0, "{seen:?}");
        seen.check().unwrap();
        let camera = seen.camera([32, 24]);
        let oracle = Oracle::new(&without_ceiling);
        let primitives = oracle.primary(&camera, Progress::default()).unwrap();
        let sun = DirectionalLight::new(DVec3::new(-0.3, -1.0, -0.4));
        let (mode, progress) = (OracleMode::Exact, Progress::default());
        let truth = oracle.shade(&camera, sun, &primitives, mode, progress);
        let classes = truth.unwrap().classes;
        let count = |class| classes.iter().filter(|&&of| of == class).count();
        assert!(count(Class::Lit) > 30 && count(Class::Shadow) > 30);
        // A closed one as well, though it is dark; a lamp hangs in it.
        let closed = view(&mesh(&[WALLS, TABLE], None)).unwrap();
        assert!(closed.is_dark);
        let lamp = closed.lamp;
        assert!(lamp.y > closed.view.eye.y && lamp.y < 3.0, "{lamp}");
        assert!(lamp.x.abs() < 4.0 && lamp.z.abs() < 3.0, "{lamp}");
    }

    #[test]
    fn what_surrounds_nothing_is_seen_from_outside() {
        assert!(!is_inside(&mesh(&[TABLE], None)));
        // A yard with a wall on two sides only, and a cup on a large plate.
        let plate = ([-9.0, -0.2, -9.0], [9.0, 0.0, 9.0], false);
        let walls = ([-9.0, 0.0, -9.0], [-8.0, 5.0, 9.0], false);
        assert!(!is_inside(&mesh(&[plate, walls], None)));
        let cup = ([-1.0, 0.1, -1.0], [1.0, 2.0, 1.0], true);
        assert!(!is_inside(&mesh(&[plate, cup], Some(3))));
    }

    #[test]
    fn from_outside_the_side_with_the_shadow_is_seen() {
        // A wall on a plate: its shadow lies on the side away from the sun, which is behind it.
        let plate = ([-9.0, -0.2, -9.0], [9.0, 0.0, 9.0], false);
        let wall = ([-6.0, 0.01, -0.2], [6.0, 6.0, 0.2], false);
        let seen = view(&mesh(&[plate, wall], None)).unwrap();
        assert_eq!((seen.is_inside, seen.view.name.as_str()), (false, "main"));
        assert!(seen.view.eye.z < 0.0 && seen.view.eye.y > 0.0, "{seen:?}");
    }

    #[test]
    fn other_views_of_a_room_are_inside_and_those_of_a_table_around_it() {
        let sun = DirectionalLight::new(DVec3::new(-0.3, -1.0, -0.4)).into();
        let room = mesh(&[WALLS, TABLE], Some(3));
        let like = view(&room).unwrap().view;
        let others = more_views(&room, &sun, &like, 3);
        assert_eq!(others.len(), 3);
        assert_eq!(others, more_views(&room, &sun, &like, 3), "the same again");
        for other in &others {
            other.check().unwrap();
            assert!(
                other.eye.x.abs() < 4.0 && other.eye.z.abs() < 3.0,
                "{other:?}"
            );
            assert!(other.eye.y > 0.0 && other.eye.y < 3.0, "{other:?}");
            let same = other.eye == like.eye && other.direction == like.direction;
            assert!(!same && other.fov_y_degrees == like.fov_y_degrees);
        }
        let plate = ([-9.0, -0.2, -9.0], [9.0, 0.0, 9.0], false);
        let table = mesh(&[plate, TABLE], None);
        let like = view(&table).unwrap().view;
        for other in more_views(&table, &sun, &like, 2) {
            assert!(
                (other.eye.length() - like.eye.length()).abs() < 1.0,
                "{other:?}"
            );
        }
        assert!(more_views(&Mesh::default(), &sun, &like, 2).is_empty());
    }

    #[test]
    fn other_axes_may_be_up() {
        let turned = |mesh: Mesh| Mesh {
            positions: mesh
                .positions
                .iter()
                .map(|p| Vec3::new(p.x, -p.z, p.y))
                .collect(),
            ..mesh
        };
        let room = turned(mesh(&[WALLS, TABLE], Some(3)));
        let sun = DirectionalLight::new(DVec3::new(-0.3, 0.4, -1.0)).into();
        let seen = default_view(&room, &sun, DVec3::Z, 60.0).unwrap().view;
        assert!(seen.eye.z > 0.2 && seen.eye.y.abs() < 3.0, "{seen:?}");
        // The length of the axis counts for nothing.
        let same = default_view(&room, &sun, 5.0 * DVec3::Z, 60.0);
        assert_eq!(same.unwrap().view, seen);
    }
}
