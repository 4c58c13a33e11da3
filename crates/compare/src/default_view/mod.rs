//! Chooses views of a mesh that comes without one, and a light if it has none: from outside, from
//! inside where there is a place to stand, and in the street of a town, such that both light and
//! shadow are seen.
//!
//! ```
//! use skiagraph_compare::default_view::{ViewRequest, default_views};
//! use skiagraph_scene::Mesh;
//!
//! let request = ViewRequest::default();
//! // There is nothing to be seen here.
//! assert!(default_views(&Mesh::default(), &request).is_none());
//! ```

mod coarse;
mod inside;
mod more;
mod room;
mod town;

pub use more::more_views;

use glam::DVec3;
use inside::{Inside, SLOPE};
use itertools::Itertools;
use room::{FEW, MORE, Picture, Room, Worth, turns};
use skiagraph_scene::{DirectionalLight, Light, LightKind, Mesh, View};
use std::cell::Cell;

/// Directions that are tried from each place.
const DIRECTIONS: u32 = 8;

/// Upward slopes of the way to an eye outside, the one to be preferred first.
const ABOVE: [f64; 3] = [0.55, 0.15, 1.3];

/// Downward slope of a view in a street.
const STREET_SLOPE: f64 = 0.05;

/// Distances of an eye outside, in those from which the whole mesh is seen.
const NEARER: [f64; 10] = [0.78, 0.6, 0.47, 0.37, 0.29, 0.23, 0.19, 0.16, 0.13, 0.1];

/// Distances from which the mesh fills enough of a picture that are tried under every light.
const LIT_GROUPS: usize = 2;

/// Eyes inside whose views are weighed against each other.
const EYES: usize = 4;

/// The direction in which the light of the first sun travels, along the right, up and back of a
/// camera that y is up for: high, and from the side.
const SUN: [f64; 3] = [-0.4, -1.0, -0.55];

/// Heights of further suns, as slopes, and their turns around the scene.
const LOWER: [f64; 4] = [1.47, 0.8, 0.4, 0.2];
const SUNS: u32 = 8;

/// Trials of views under lights for each view of a large mesh.
const MOST_TRIALS: usize = 64;

/// Rank of views below which they show hardly any shadow.
const NO_SHADOW: f64 = 0.05;

/// Share of the places inside that a sun should light, and suns that are tried there.
const SUNNY: f64 = 0.3;
const INSIDE_SUNS: usize = 3;

/// Conditions that chosen views are to meet.
#[derive(Clone, Copy, Debug)]
pub struct ViewRequest {
    /// Direction up, world space, of any length above 0.
    pub up: DVec3,
    /// Vertical field of view of all views, degrees.
    pub fov_y_degrees: f64,
    /// Direction in which all views look, world space, of any length above 0; `None` chooses.
    pub direction: Option<DVec3>,
    /// The light; `None` chooses a sun, or a lamp inside where no sun comes in.
    pub light: Option<LightKind>,
    /// True to stay outside even where there is a place to stand inside.
    pub outside: bool,
    /// Number of the mesh's first triangles that views are to show, such as all but those of an
    /// added ground; `None` for all.
    pub subject: Option<usize>,
}

impl Default for ViewRequest {
    /// Returns a request for views of 60 degrees with y up, of everything under a light to be
    /// chosen.
    fn default() -> Self {
        Self {
            up: DVec3::Y,
            fov_y_degrees: 60.0,
            direction: None,
            light: None,
            outside: false,
            subject: None,
        }
    }
}

/// Kind of place from which a chosen view looks.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Place {
    /// Around the mesh.
    Outside,
    /// In a room, at a share of its height.
    Inside,
    /// In a town, at so many scene units above its floor.
    Street(f64),
}

/// A view that [`default_views`] chose.
#[derive(Clone, Debug, PartialEq)]
pub struct DefaultView {
    /// The view, named `main`, `inside` or `street`. Its far plane lies behind the whole mesh, its
    /// near plane at 1/10,000 of the far plane's distance. It has a light of its own, a sun, if
    /// none was given and the chosen one would leave it without light or shadow.
    pub view: View,
    /// Kind of place from which it looks.
    pub place: Place,
    /// True if a quarter of its pixels and more show the mesh, and of those that face the light 3 %
    /// and more are lit and 3 % and more in shadow, by a margin for few pixels.
    pub holds: bool,
}

/// Views that [`default_views`] chose, with their light.
#[derive(Clone, Debug, PartialEq)]
pub struct DefaultViews {
    /// The views, the one to begin with first, at least one.
    pub views: Vec<DefaultView>,
    /// The given light, or the one that was chosen.
    pub light: LightKind,
}

/// Chooses views of a mesh. Where there is a place to stand inside the mesh, it is seen from there:
/// on a level floor, in no closed part, with surfaces all around, under a roof (that walls with one
/// side, turned inwards, need not have), in a quarter or more of the mesh's columns. A town is seen
/// from one of its streets. Views from outside show the whole mesh, or come nearer if it fills too
/// little of the picture. Both are returned of a town, and where it is not sure that the inside is
/// what is to be seen. Of each kind it is the view that shows most of lit and shadowed surfaces.
/// Returns `None` if the mesh is empty, `up` is zero or no candidate is a valid view.
pub fn default_views(mesh: &Mesh, request: &ViewRequest) -> Option<DefaultViews> {
    let subject = request.subject.unwrap_or(mesh.triangles.len());
    let (traced, subject, error) = coarse::coarse(mesh, subject);
    let room = Room::new(&traced, subject, request.up)?;
    let search = Search {
        room: &room,
        request,
        most_trials: if error > 0.0 { MOST_TRIALS } else { usize::MAX },
        trials: Cell::new(0),
    };
    let inside = (!request.outside).then(|| Inside::new(&room)).flatten();
    let street = inside.is_none().then(|| town::street_eyes(&room));
    let mut near = match (&inside, street.flatten()) {
        (Some(inside), _) => search.inside(inside),
        (None, Some((eyes, height))) => search.street(&eyes, height),
        (None, None) => None,
    };
    if let Some(Found { view, .. }) = &mut near
        && let Place::Street(height) = view.place
        && error > 0.0
    {
        let eye = &mut view.view.eye;
        *eye = town::raised(mesh, *eye, room.up, (height, error));
    }
    if let (Some(near), Some(Inside { is_shell: true, .. })) = (&near, &inside) {
        return Some(near.clone().alone());
    }
    search.trials.set(0);
    let Some(outside) = search.outside(near.as_ref().map(|near| near.light)) else {
        return near.map(Found::alone);
    };
    let Some(near) = near else {
        return Some(outside.alone());
    };
    let light = near.light;
    let mut far = outside.view;
    if outside.light != light {
        far.view.light = Some(Light::only(outside.light));
    }
    let is_sure = inside.as_ref().is_none_or(|inside| inside.is_sure);
    let mut views = vec![near.view, far];
    // Views that hold come first, and of a house its outside if it may be all that is meant.
    views.sort_by_key(|view| (!view.holds, !is_sure && view.place != Place::Outside));
    if inside.is_some() {
        views.truncate(views.iter().filter(|view| view.holds).count().max(1));
    }
    Some(DefaultViews { views, light })
}

/// A view with the light that it was found under.
#[derive(Clone)]
struct Found {
    view: DefaultView,
    light: LightKind,
    rank: f64,
}

impl Found {
    fn alone(self) -> DefaultViews {
        DefaultViews {
            views: vec![self.view],
            light: self.light,
        }
    }

    fn is_plenty(&self) -> bool {
        self.rank >= 2.5
    }
}

/// The search for views of a mesh.
struct Search<'a> {
    room: &'a Room<'a>,
    request: &'a ViewRequest,
    /// Trials of a view under a light after which what was found must do, and how many there were.
    most_trials: usize,
    trials: Cell<usize>,
}

impl Search<'_> {
    /// Directions with a slope, evenly around; or the one that was asked for.
    fn directions(&self, slope: f64) -> Vec<DVec3> {
        let around = turns(DIRECTIONS).map(|turn| self.room.around(turn) - self.room.up * slope);
        let given = self.request.direction;
        given.map_or_else(|| around.collect(), |direction| vec![direction])
    }

    /// Pictures of few pixels of the views that have one.
    fn few(&self, views: impl Iterator<Item = View>) -> Vec<Picture> {
        let pictures = views.filter_map(|view| self.room.picture(view, FEW));
        pictures.collect()
    }

    fn pictures(&self, eyes: &[DVec3], slope: f64) -> Vec<Picture> {
        let directions = self.directions(slope);
        let views = eyes.iter().cartesian_product(&directions);
        let views = views.map(|(eye, way)| self.room.view(*eye, *way, self.request.fov_y_degrees));
        self.few(views)
    }

    /// A sun from a height, turned around the scene from the place of the first one.
    fn sun(&self, slope: f64, turn: f64) -> LightKind {
        let back = -self.room.up.any_orthonormal_vector();
        let right = self.room.up.cross(back);
        let (sin, cos) = turn.sin_cos();
        let [x, _, z] = SUN;
        let across = right * (x * cos - z * sin) + back * (x * sin + z * cos);
        let sun = across - self.room.up * (slope * DVec3::new(x, 0.0, z).length());
        DirectionalLight::new(sun).into()
    }

    /// The given light, or suns: each height from one side, then from others.
    fn lights(&self) -> Vec<LightKind> {
        let suns = || {
            let sides = turns(4).cartesian_product(LOWER);
            sides.map(|(turn, slope)| self.sun(slope, turn)).collect()
        };
        self.request.light.map_or_else(suns, |light| vec![light])
    }

    /// Suns that shine on some of the places inside and not on all, the first one before others.
    fn suns_inside(&self, places: &[DVec3]) -> Vec<LightKind> {
        let suns = LOWER.into_iter().cartesian_product(turns(SUNS));
        let suns = suns.filter_map(|(slope, turn)| {
            let light = self.sun(slope, turn);
            let way = light.directional()?.to_light();
            let rays = places.iter().map(|place| (*place, way)).collect_vec();
            let seen = skiagraph_reference::sights(&self.room.oracle, &rays);
            let lit = seen.iter().filter(|sight| sight.is_none()).count();
            Some((lit as f64 / places.len() as f64, light))
        });
        let far_off = |share: f64| (share - SUNNY).abs();
        let mut suns = suns.collect_vec();
        let first = suns.remove(0);
        suns.retain(|(share, _)| *share > 0.0);
        suns.sort_by(|(one, _), (other, _)| far_off(*one).total_cmp(&far_off(*other)));
        suns.truncate(INSIDE_SUNS);
        suns.insert(0, first);
        suns.into_iter().map(|(_, light)| light).collect()
    }

    /// The best of some views under one of some lights; the first of equal ones.
    fn best(&self, pictures: &[Picture], lights: &[LightKind], place: Place) -> Option<Found> {
        let mut best: Option<Found> = None;
        for (number, light) in lights.iter().enumerate() {
            // A convex body has no shadow under any sun.
            if number > LOWER.len() && best.as_ref().is_none_or(|best| best.rank < NO_SHADOW) {
                break;
            }
            for picture in pictures {
                if self.trials.get() >= self.most_trials && best.is_some() {
                    return best;
                }
                self.trials.update(|trials| trials + 1);
                let least = best.as_ref().map_or(f64::NEG_INFINITY, |best| best.rank);
                let worth = self.room.worth(picture, light);
                if let Some(worth) = worth.filter(|worth| worth.rank() > least)
                    && let Some(worth) = self.more_exactly(picture, worth, light)
                    && worth.rank() > least
                {
                    best = Some(Found {
                        view: self.named(picture, place, worth.holds()),
                        light: *light,
                        rank: worth.rank(),
                    });
                }
            }
            if best.as_ref().is_some_and(Found::is_plenty) {
                break;
            }
        }
        best
    }

    /// The worth of a view that seems to hold, by a picture of more pixels.
    fn more_exactly(&self, picture: &Picture, worth: Worth, light: &LightKind) -> Option<Worth> {
        if !worth.holds() {
            return Some(worth);
        }
        let picture = self.room.picture(picture.view.clone(), MORE)?;
        self.room.worth(&picture, light)
    }

    fn named(&self, picture: &Picture, place: Place, holds: bool) -> DefaultView {
        let name = match place {
            Place::Outside => "main",
            Place::Inside => "inside",
            Place::Street(_) => "street",
        };
        let view = View {
            name: name.into(),
            ..picture.view.clone()
        };
        DefaultView { view, place, holds }
    }

    /// The first that is plenty of the groups' best views, or the best of all.
    fn first_plenty(&self, candidates: impl Iterator<Item = Option<Found>>) -> Option<Found> {
        let mut best: Option<Found> = None;
        for candidate in candidates.flatten() {
            if best.as_ref().is_none_or(|best| candidate.rank > best.rank) {
                best = Some(candidate);
            }
            if best.as_ref().is_some_and(Found::is_plenty) {
                break;
            }
        }
        best
    }

    fn inside(&self, inside: &Inside) -> Option<Found> {
        let places = inside.eyes.iter().map(|eye| eye.place).collect_vec();
        let group = |eyes| self.pictures(eyes, SLOPE);
        let groups = places.chunks(EYES).map(group).collect_vec();
        let suns = || self.suns_inside(&places);
        let lights = self.request.light.map_or_else(suns, |light| vec![light]);
        let groups = || groups.iter();
        let candidates = groups().map(|group| self.best(group, &lights, Place::Inside));
        let best = self.first_plenty(candidates);
        if self.request.light.is_some() || best.as_ref().is_some_and(|it| it.view.holds) {
            return best;
        }
        // Where no light comes in, that of a lamp tells the views apart.
        let lit = |picture: &Picture| {
            let lamp = self.room.lamp(&picture.view);
            self.best(std::slice::from_ref(picture), &[lamp], Place::Inside)
        };
        let lamps = self.first_plenty(groups().flatten().map(lit));
        self.first_plenty([best, lamps].into_iter())
    }

    fn street(&self, eyes: &[DVec3], height: f64) -> Option<Found> {
        let lights = self.lights();
        let groups = eyes.chunks(EYES / 2).map(|eyes| {
            let pictures = self.pictures(eyes, STREET_SLOPE);
            self.best(&pictures, &lights, Place::Street(height))
        });
        self.first_plenty(groups)
    }

    /// The view from outside, under the light of another view if that does: from a middle height
    /// if there is one that shows enough.
    fn outside(&self, light: Option<LightKind>) -> Option<Found> {
        let light = light.filter(|it| it.directional().is_some());
        let lights = light.into_iter().chain(self.lights()).dedup().collect_vec();
        let mut best = None;
        for slope in ABOVE {
            let candidate = self.outside_from(slope, &lights);
            best = self.first_plenty([best, candidate].into_iter());
            let is_last = |best: &Found| best.is_plenty() || best.rank < NO_SHADOW;
            if best.as_ref().is_some_and(is_last) {
                break;
            }
        }
        best
    }

    /// The view from outside and a height: of the whole mesh if it fills enough of the picture, or
    /// else from nearer.
    fn outside_from(&self, slope: f64, lights: &[LightKind]) -> Option<Found> {
        let fov = self.request.fov_y_degrees;
        let ways = self.directions(slope);
        let framed = ways.iter().map(|way| self.room.framing(*way, fov));
        let framed = self.few(framed);
        let nearer = NEARER.iter().map(|share| self.nearer(&framed, *share));
        let (mut best, mut filled) = (None::<Found>, 0);
        for group in std::iter::once(framed.clone()).chain(nearer) {
            filled += usize::from(group.iter().any(Picture::is_filled));
            let lights = if filled > 0 { lights } else { &lights[..1] };
            let candidate = self.best(&group, lights, Place::Outside);
            best = self.first_plenty([best, candidate].into_iter());
            if filled >= LIT_GROUPS || best.as_ref().is_some_and(Found::is_plenty) {
                break;
            }
        }
        best
    }

    /// Views from nearer, towards where most of the subject is seen.
    fn nearer(&self, framed: &[Picture], share: f64) -> Vec<Picture> {
        let views = framed.iter().map(|picture| {
            let (eye, fov_y_degrees) = (picture.view.eye, picture.view.fov_y_degrees);
            let direction = picture.view.direction;
            let way = direction.normalize();
            let distance = (self.room.middle - eye).dot(way) * share;
            let radius = distance * (fov_y_degrees * 0.5).to_radians().tan();
            let seen = picture.densest(radius).unwrap_or(self.room.middle);
            let eye = seen - way * distance;
            self.room.view(eye, direction, fov_y_degrees)
        });
        let views = views.filter(|view| !self.room.is_buried(view.eye));
        self.few(views)
    }
}
