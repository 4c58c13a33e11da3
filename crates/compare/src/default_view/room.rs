//! Looks around in a mesh: rays, pictures of few pixels, and their worth.

use crate::records::statistics::median;
use glam::{DVec2, DVec3};
use itertools::Itertools;
use skiagraph_reference::sight::{Sight, sights};
use skiagraph_reference::{BACKGROUND, Class, GroundTruthPixels, Oracle, OracleMode, Progress};
use skiagraph_scene::{Camera, LightKind, Mesh, Parts, PointLight, View};
use std::cell::OnceCell;
use std::collections::BTreeMap;
use std::f64::consts::TAU;

/// Pixels of the pictures by which views are judged, and of those by which the best are once more:
/// wide ones, whose middle is judged as a square one, too.
pub(super) const FEW: [u32; 2] = [36, 20];
pub(super) const MORE: [u32; 2] = [84, 48];

/// Share of a picture that shows the mesh, and of the pixels that face the light those that are lit
/// and those in shadow: what surely makes a quarter and 3 % though few pixels err, and what is
/// enough to look no further.
const SURE: [f64; 2] = [0.265, 0.04];
const PLENTY: [f64; 2] = [0.29, 0.06];

/// Share of the pixels that face the light at which rounding may decide, up to which these are left
/// out as edges.
const MOST_DOUBTFUL: f64 = 0.25;

/// Directions that no mesh is built along, to count the surfaces around a place.
const OBLIQUE: [DVec3; 3] = [
    DVec3::new(0.137, 0.971, 0.193),
    DVec3::new(-0.833, 0.227, 0.504),
    DVec3::new(0.419, -0.311, -0.853),
];

/// Surfaces on a ray after which its parity is given up.
const MOST_SURFACES: usize = 400;

/// Share of the mesh's diagonal that the box of a shell has around everything else.
const SHELL: f64 = 0.9;

/// Small picture of a view.
#[derive(Clone)]
pub(super) struct Picture {
    pub(super) view: View,
    camera: Camera,
    primitives: Vec<u32>,
    /// The first triangle that is not the subject's.
    first_other: usize,
    /// Places on the subject, one for each pixel that shows it.
    pub(super) subject: Vec<DVec3>,
    /// Median distance of all places that it shows, as a share of the mesh, a half at most.
    far: f64,
}

/// The shares of light and shadow in a view, in a wide or a square picture, whichever has less.
#[derive(Clone, Copy)]
pub(super) struct Worth {
    /// Share of the pixels that show anything, and that show the subject.
    pub(super) shown: f64,
    subject: f64,
    /// Shares of all pixels of the wide picture.
    lit: f64,
    shadow: f64,
    /// The lesser of the two among the pixels that face the light.
    contrast: f64,
    far: f64,
}

impl Picture {
    /// The place on the subject with the most others within a radius.
    pub(super) fn densest(&self, radius: f64) -> Option<DVec3> {
        let places = || self.subject.iter().copied();
        let near = |place: &DVec3| places().filter(|it| it.distance(*place) < radius).count();
        places().max_by_key(near)
    }

    /// True if the subject fills enough of it.
    pub(super) fn is_filled(&self) -> bool {
        self.subject.len() as f64 >= PLENTY[0] * self.primitives.len() as f64
    }
}

impl Worth {
    /// Returns the worth of the columns in the middle of a picture.
    fn within(picture: &Picture, truth: &GroundTruthPixels, columns: u32) -> Self {
        let [width, height] = picture.camera.viewport;
        let is_within = |index: usize| {
            let twice = 2 * (index as u32 % width) + 1;
            twice.abs_diff(width) < columns
        };
        let count = |is_one: &dyn Fn(usize) -> bool| {
            let pixels = (0..truth.classes.len()).filter(|index| is_within(*index));
            pixels.filter(|index| is_one(*index)).count() as f64
        };
        let faces = |it: usize| [Class::Lit, Class::Shadow].contains(&truth.classes[it]);
        // Pixels on edges would count for much among few. Where f32 hardly holds the mesh, most
        // pixels are doubtful, and count.
        let doubtful = count(&|it| faces(it) && truth.indeterminate[it]);
        let is_sharp = doubtful < MOST_DOUBTFUL * count(&faces);
        let is_counted = |it: usize| !is_sharp || !truth.indeterminate[it];
        let class = |class| count(&|it| truth.classes[it] == class && is_counted(it));
        let [lit, shadow] = [Class::Lit, Class::Shadow].map(class);
        let pixels = f64::from(columns * height);
        let subject = 0..picture.first_other as u32;
        Self {
            shown: count(&|it| picture.primitives[it] != BACKGROUND) / pixels,
            subject: count(&|it| subject.contains(&picture.primitives[it])) / pixels,
            lit: lit / pixels,
            shadow: shadow / pixels,
            contrast: lit.min(shadow) / count(&faces).max(1.0),
            far: picture.far,
        }
    }

    /// Light beside shadow first, then how far it sees.
    pub(super) fn total(self) -> f64 {
        (self.lit.min(self.shadow) + 0.02) * (0.1 + self.far) * self.shown
    }

    fn reaches(self, [shown, lit]: [f64; 2]) -> bool {
        self.shown >= shown && self.contrast >= lit
    }

    /// True if enough of the mesh, lit and in shadow, is surely shown.
    pub(super) fn holds(self) -> bool {
        self.reaches(SURE)
    }

    /// How near a view comes to being plenty: less than 1.1 if it does not surely hold, less than
    /// 2.1 if it does, and more if it is.
    pub(super) fn rank(self) -> f64 {
        let [shown, lit] = PLENTY;
        let share = |value: f64, enough: f64| (value / enough).min(1.0);
        let near =
            share(self.contrast, lit) * share(self.subject, shown) * share(self.shown, shown);
        let is_plenty = self.reaches(PLENTY) && self.subject >= shown;
        let steps = [self.holds(), is_plenty].map(|step| f64::from(u8::from(step)));
        steps.iter().sum::<f64>() + near + 0.1 * self.total()
    }
}

/// A mesh that is looked around in.
pub(super) struct Room<'a> {
    pub(super) oracle: Oracle<'a>,
    parts: OnceCell<Parts>,
    /// The part around everything else, if there is one.
    shell: OnceCell<Option<u32>>,
    /// Number of its first triangles that are to be seen: without an added ground.
    pub(super) subject: usize,
    pub(super) middle: DVec3,
    /// Half the extent of the subject's box.
    pub(super) half: DVec3,
    pub(super) up: DVec3,
    pub(super) across: [DVec3; 2],
}

/// So many turns around, evenly.
pub(super) fn turns(count: u32) -> impl Iterator<Item = f64> + Clone {
    (0..count).map(move |number| TAU * f64::from(number) / f64::from(count))
}

/// The middles of so many squares by so many, from −1 to 1 on both sides.
pub(super) fn squares(count: u32) -> impl Iterator<Item = (f64, f64)> {
    let middle = move |number: u32| (f64::from(number) + 0.5) / f64::from(count) * 2.0 - 1.0;
    let numbers = (0..count).cartesian_product(0..count);
    numbers.map(move |(x, y)| (middle(x), middle(y)))
}

/// The box of the first `count` triangles, as its middle and half its extent.
fn bounds(mesh: &Mesh, primitives: impl Iterator<Item = usize>) -> Option<[DVec3; 2]> {
    let corners = primitives.flat_map(|it| mesh.corners(it as u32));
    let boxes = corners.map(|corner| [corner, corner]);
    let [min, max] = boxes.reduce(|[min, max], [low, high]| [min.min(low), max.max(high)])?;
    Some([(min + max) * 0.5, (max - min) * 0.5])
}

impl<'a> Room<'a> {
    /// `None` for an empty mesh, or without a direction up.
    pub(super) fn new(mesh: &'a Mesh, subject: usize, up: DVec3) -> Option<Self> {
        let up = up.try_normalize()?;
        let [middle, half] = bounds(mesh, 0..subject)?;
        Some(Self {
            oracle: Oracle::new(mesh),
            parts: OnceCell::new(),
            shell: OnceCell::new(),
            subject,
            middle,
            half,
            up,
            across: up.any_orthonormal_pair().into(),
        })
    }

    /// Half the extent of the box along an axis.
    pub(super) fn reach(&self, axis: DVec3) -> f64 {
        axis.abs().dot(self.half)
    }

    pub(super) fn around(&self, turn: f64) -> DVec3 {
        let (sin, cos) = turn.sin_cos();
        self.across[0] * cos + self.across[1] * sin
    }

    pub(super) fn sight(&self, from: DVec3, direction: DVec3) -> Option<Sight> {
        sights(&self.oracle, &[(from, direction)])[0]
    }

    /// The first surfaces on rays from a place, evenly around it, that rise by `slopes` in turn.
    pub(super) fn all_around(
        &self,
        place: DVec3,
        count: u32,
        slopes: &[f64],
    ) -> Vec<Option<Sight>> {
        let rays = turns(count).zip(slopes.iter().cycle());
        let rays = rays.map(|(turn, slope)| (place, self.around(turn) + self.up * *slope));
        sights(&self.oracle, &rays.collect_vec())
    }

    /// The normal of a triangle, of any length.
    pub(super) fn normal(&self, primitive: u32) -> DVec3 {
        let [a, b, c] = self.oracle.mesh().corners(primitive);
        (b - a).cross(c - a)
    }

    pub(super) fn parts(&self) -> &Parts {
        self.parts.get_or_init(|| Parts::new(self.oracle.mesh()))
    }

    /// The closed part whose box is nearly that of all, if there are others: walls around what
    /// stands in a room.
    fn shell(&self) -> Option<u32> {
        *self.shell.get_or_init(|| {
            let parts = self.parts();
            let part = |primitive: usize| parts.of[primitive];
            let mut boxes = BTreeMap::<u32, Vec<usize>>::new();
            for primitive in 0..self.subject {
                boxes.entry(part(primitive)).or_default().push(primitive);
            }
            let is_shell = |primitives: &[usize]| {
                let own = bounds(self.oracle.mesh(), primitives.iter().copied());
                own.is_some_and(|[_, half]| half.length() > SHELL * self.half.length())
            };
            let shell = boxes.iter().find(|(_, primitives)| is_shell(primitives));
            shell.map(|(part, _)| *part).filter(|_| boxes.len() > 1)
        })
    }

    /// True if a closed part has the place in it: by the surfaces on most of three rays. The walls
    /// of a room, which are turned inwards around what stands in it, do not count.
    pub(super) fn is_buried(&self, place: DVec3) -> bool {
        let buried = OBLIQUE.iter().filter(|way| {
            let mut leaves = self.leaves(place, **way).into_iter();
            leaves.any(|(part, count)| count > 0 || count < 0 && self.shell() != Some(part))
        });
        buried.count() >= 2
    }

    /// How often a ray leaves each closed part more than it enters it.
    fn leaves(&self, mut from: DVec3, way: DVec3) -> BTreeMap<u32, i32> {
        let (parts, mut leaves) = (self.parts(), BTreeMap::new());
        let least = self.half.length() * 1e-9;
        for _ in 0..MOST_SURFACES {
            let Some(sight) = self.sight(from, way) else {
                break;
            };
            if !parts.is_open(sight.primitive) {
                let side = self.normal(sight.primitive).dot(way).signum() as i32;
                let part = parts.of[sight.primitive as usize];
                *leaves.entry(part).or_default() += side;
            }
            from += way * (sight.distance + least);
        }
        leaves
    }

    pub(super) fn view(&self, eye: DVec3, direction: DVec3, fov_y_degrees: f64) -> View {
        let far = ((eye - self.middle).length() + self.half.length()) * 1.01;
        View {
            name: String::new(),
            eye,
            direction,
            up: self.up,
            fov_y_degrees,
            near: far * 1e-4,
            far,
            ..View::default()
        }
    }

    /// From outside along a way, as near as all of the subject is seen in a square picture.
    pub(super) fn framing(&self, way: DVec3, fov_y_degrees: f64) -> View {
        let camera = self.view(self.middle, way, fov_y_degrees).camera([1, 1]);
        let mesh = self.oracle.mesh();
        let tangent = camera.half_height * 0.95;
        let needed = |corner: DVec3| {
            let place = corner - self.middle;
            let aside = DVec2::new(place.dot(camera.right), place.dot(camera.up));
            aside.abs().max_element() / tangent - place.dot(camera.forward)
        };
        let corners = (0..self.subject).flat_map(|it| mesh.corners(it as u32));
        let distance = corners.map(needed).fold(f64::MIN_POSITIVE, f64::max);
        self.view(self.middle - camera.forward * distance, way, fov_y_degrees)
    }

    /// On the way from the eye to the ceiling in its middle distance.
    pub(super) fn lamp(&self, view: &View) -> LightKind {
        let way = view.direction.normalize() + self.up * 0.8;
        let ceiling = self.sight(view.eye, way);
        let distance = ceiling.map_or(self.half.length(), |sight| sight.distance);
        let position = view.eye + way * (0.7 * distance);
        let radius = 0.0;
        PointLight { position, radius }.into()
    }

    /// A small picture of a view; `None` of one that no camera has.
    pub(super) fn picture(&self, view: View, size: [u32; 2]) -> Option<Picture> {
        view.check().ok()?;
        // Off the symmetry of a mesh, whose edges pixels would lie on.
        let camera = view.camera(size).jittered(1, 8);
        let primitives = self.oracle.primary(&camera, Progress::default()).ok()?;
        let [width, height] = size;
        let pixels = (0..height).cartesian_product(0..width);
        let shown = primitives.iter().zip(pixels);
        let shown = shown.filter(|(primitive, _)| **primitive != BACKGROUND);
        let places = shown.map(|(&primitive, (y, x))| {
            let (way, normal) = (camera.pixel_direction(x, y), self.normal(primitive));
            let [corner, ..] = self.oracle.mesh().corners(primitive);
            let distance = normal.dot(corner - view.eye) / normal.dot(way);
            (primitive, view.eye + way * distance)
        });
        let places = places.collect_vec();
        let distances = places.iter().map(|(_, place)| place.distance(view.eye));
        let median = median(distances.collect());
        let is_own = |(primitive, _): &&(u32, DVec3)| (*primitive as usize) < self.subject;
        let subject = places.iter().filter(is_own);
        Some(Picture {
            subject: subject.map(|(_, place)| *place).collect(),
            first_other: self.subject,
            view,
            camera,
            primitives,
            far: (median / self.half.length()).min(0.5),
        })
    }

    /// How much a view is worth under a light.
    pub(super) fn worth(&self, picture: &Picture, light: &LightKind) -> Option<Worth> {
        let (mode, progress) = (OracleMode::Exact, Progress::default());
        let (oracle, camera, primitives) = (&self.oracle, &picture.camera, &picture.primitives);
        let truth = oracle.shade(camera, *light, primitives, mode, progress);
        let truth = truth.ok()?;
        let within = |columns| Worth::within(picture, &truth, columns);
        let [wide, square] = camera.viewport.map(within);
        Some(Worth {
            shown: wide.shown.min(square.shown),
            subject: wide.subject.min(square.subject),
            contrast: wide.contrast.min(square.contrast),
            ..wide
        })
    }
}
