//! Chooses further views of a mesh, like a given one.

use super::inside::{Inside, SLOPE};
use super::room::{FEW, Room, turns};
use glam::DQuat;
use itertools::Itertools;
use skiagraph_scene::{LightKind, Mesh, View};

/// Angles in radians by which a view may go around what another one shows.
const ASIDE: [f64; 4] = [-0.6, 0.6, -1.2, 1.2];

/// Turns by which another view may look elsewhere than the given one, and angle in radians below
/// which two views from one place show the same.
const TURNS: u32 = 8;
const SAME_ANGLE: f64 = 0.7;

/// Chooses at most `count` views of a mesh other than `like`, for methods that are to be tried on
/// several views. First come at most two that show from other sides what `like` shows, then views
/// in other directions and from other places, inside the mesh if there are places to stand. Views
/// that show both lit and shadowed surfaces, far away, are preferred. Their names are empty, and
/// their own light is that of `like`. The list is shorter if there are too few views that differ
/// and show any surface.
pub fn more_views(mesh: &Mesh, light: &LightKind, like: &View, count: usize) -> Vec<View> {
    let Some(room) = Room::new(mesh, mesh.triangles.len(), like.up) else {
        return Vec::new();
    };
    let mut chosen = vec![like.clone()];
    let elsewhere = turned(&room, like).chain(elsewhere(&room, like)).collect();
    for (candidates, most) in [(aside(&room, like), count.min(2)), (elsewhere, count)] {
        let worth = |view: View| {
            let worth = room.worth(&room.picture(view.clone(), FEW)?, light)?;
            Some((worth.total(), view))
        };
        let candidates = candidates.into_iter().filter_map(worth);
        let candidates = candidates.filter(|(total, _)| *total > 0.0);
        let candidates = candidates.sorted_by(|(one, _), (other, _)| other.total_cmp(one));
        for (_, view) in candidates {
            if chosen.len() <= most && chosen.iter().all(|other| differ(&room, &view, other)) {
                chosen.push(view);
            }
        }
    }
    chosen.split_off(1)
}

/// Views of what another one shows in its middle, from other sides; from nearer where something
/// stands in the way there.
fn aside(room: &Room<'_>, like: &View) -> Vec<View> {
    let Some(ahead) = room.sight(like.eye, like.direction) else {
        return Vec::new();
    };
    let middle = like.eye + like.direction * ahead.distance;
    let view = |turn: f64| {
        let turned = DQuat::from_axis_angle(room.up, turn);
        let way = middle + turned * (like.eye - middle) - like.eye;
        let free = room.sight(like.eye, way).map_or(1.0, |it| it.distance);
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
fn turned(room: &Room<'_>, like: &View) -> impl Iterator<Item = View> {
    turns(TURNS).skip(1).map(|turn| View {
        name: String::new(),
        direction: DQuat::from_axis_angle(room.up, turn) * like.direction,
        ..like.clone()
    })
}

/// Views from other places inside the mesh, or else from around it.
fn elsewhere(room: &Room<'_>, like: &View) -> Vec<View> {
    let fov = like.fov_y_degrees;
    let views: Vec<View> = match Inside::new(room) {
        Some(inside) => {
            let way = |turn| room.around(turn) - room.up * SLOPE;
            let views = inside.eyes.iter().cartesian_product(turns(TURNS));
            views
                .map(|(eye, turn)| room.view(eye.place, way(turn), fov))
                .collect()
        }
        None => {
            let around = |turn| {
                let turned = DQuat::from_axis_angle(room.up, turn);
                let eye = room.middle + turned * (like.eye - room.middle);
                room.view(eye, turned * like.direction, fov)
            };
            turns(TURNS).skip(1).map(around).collect()
        }
    };
    let lit = views.into_iter().map(|view| View {
        light: like.light.clone(),
        ..view
    });
    lit.collect()
}

/// True if two views show different parts of the mesh.
fn differ(room: &Room<'_>, one: &View, other: &View) -> bool {
    let is_near = one.eye.distance(other.eye) < 0.05 * room.half.length();
    !is_near || one.direction.angle_between(other.direction) > SAME_ANGLE
}
