//! Ids of cells. A cell is one method in one setting on one view or path, in one viewport, under
//! one protocol; its id tells it from all other cells, on every machine and in every version.
//!
//! ```
//! use skiagraph_compare::{comparison::Comparison, graphs::shadow_method::load_methods};
//! use skiagraph_compare::measuring::cell;
//! use skiagraph_passes::EmbeddedSources;
//! use skiagraph_scene::SceneLibrary;
//! use std::sync::Arc;
//!
//! let (scene, _) = SceneLibrary::default().load("park")?;
//! let words = ["nsm", "nsm@bias=0", "nsm@bias=0.01"];
//! let methods = load_methods(&words, &[], &[512], &EmbeddedSources)?;
//! let comparison = Comparison::new(Arc::new(scene), methods)?;
//! let [one, same, other] = [0, 1, 2].map(|method| {
//!     cell::id(&comparison, &comparison.views[0], [64, 64], &comparison.methods[method])
//! });
//! assert_eq!(one.len(), 16);
//! assert_eq!(one, same, "0 is the default");
//! assert_ne!(one, other);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

use crate::comparison::Comparison;
use crate::files::fingerprint::Fingerprint;
use crate::graphs::method::Method;
use crate::measuring::view_or_path::ViewOrPath;
use crate::wording::size;
use glam::DVec3;
use skiagraph_scene::{CameraPath, LightKind, LightParameters, Motion, View};

/// Returns the id of a cell, 16 hexadecimal digits: a hash of the scene's name and number of
/// triangles; the name, camera and light of the view or path; the viewport in pixels; the preset
/// with all params that it runs with; and the protocol. The method's name is not part of the hash:
/// two settings with the same params are one cell. Neither are shaders and the mesh: a change of
/// these changes the run's [`fingerprint`](crate::records::results::Run::fingerprint). A preset
/// that gets a param has other cells than before. Defaults of params may depend on the viewport:
/// call [`Method::at`] with it first.
pub fn id(
    comparison: &Comparison,
    view: &ViewOrPath,
    viewport: [u32; 2],
    method: &Method,
) -> String {
    let mut lines = scene_lines(comparison, view, viewport);
    lines.push(format!("method {}", method.preset.name));
    view_lines(view, &mut lines);
    let params = method.all_params().into_iter();
    lines.extend(params.map(|(name, value)| format!("param {name}={value}")));
    let protocol = &comparison.protocol;
    lines.extend([
        format!("oracle {}", protocol.oracle),
        format!("frames {}", protocol.frames),
        format!("warmup {}", protocol.warmup),
        format!("cached frames {}", protocol.regime_frames),
    ]);
    lines.extend(sampling_lines(comparison, view));
    hash(&lines)
}

/// Returns the id of the truth that the cells of a view or path in a viewport wait for, 16
/// hexadecimal digits: a hash of scene, view and viewport as in [`id`], and of all that changes the
/// reference's answers: its mode, its rays to a light with an extent, and the jitter.
pub fn truth_id(comparison: &Comparison, view: &ViewOrPath, viewport: [u32; 2]) -> String {
    let mut lines = scene_lines(comparison, view, viewport);
    view_lines(view, &mut lines);
    lines.push(format!("truth {}", comparison.protocol.oracle));
    lines.extend(sampling_lines(comparison, view));
    hash(&lines)
}

fn hash(lines: &[String]) -> String {
    let lines = lines.iter();
    let hash = lines.fold(Fingerprint::EMPTY, |hash, line| hash.with_text(line));
    hash.to_string()
}

fn scene_lines(comparison: &Comparison, view: &ViewOrPath, viewport: [u32; 2]) -> Vec<String> {
    let scene = &comparison.scene;
    vec![
        format!("scene {} {}", scene.name, scene.mesh.triangles.len()),
        light_text(view.light(scene)),
        format!("viewport {}", size(viewport)),
    ]
}

fn view_lines(view: &ViewOrPath, lines: &mut Vec<String>) {
    match view {
        ViewOrPath::Still(view) => lines.push(format!("view {}", view_text(view))),
        ViewOrPath::Path(path) => path_lines(path, lines),
    }
}

/// Where a pixel is sampled, and how often a light with an extent.
fn sampling_lines(comparison: &Comparison, view: &ViewOrPath) -> Vec<String> {
    let protocol = &comparison.protocol;
    let has_extent = view.light(&comparison.scene).has_extent();
    let samples = has_extent.then(|| format!("samples {}", protocol.reference_samples));
    let jitter = protocol.jitter.map(|count| format!("jitter {count}"));
    samples.into_iter().chain(jitter).collect()
}

/// Three numbers, each as the shortest decimal that reads back as it.
fn vector(vector: DVec3) -> String {
    format!("{},{},{}", vector.x, vector.y, vector.z)
}

fn view_text(view: &View) -> String {
    let [eye, direction, up] = [view.eye, view.direction, view.up].map(vector);
    let (fov, near, far) = (view.fov_y_degrees, view.near, view.far);
    format!("{} {eye} {direction} {up} {fov} {near} {far}", view.name)
}

fn path_lines(path: &CameraPath, lines: &mut Vec<String>) {
    let rate = path.frames_per_second;
    lines.push(format!("path {} {rate}", view_text(&path.view)));
    for key in &path.keys {
        let [eye, direction] = [key.eye, key.direction].map(vector);
        lines.push(format!("key {} {eye} {direction}", key.at));
    }
    for key in &path.light_keys {
        let [direction, position] = [key.direction, key.position].map(|coords| coords.map(vector));
        let text = |numbers: Option<String>| numbers.unwrap_or_else(|| "-".into());
        let (direction, position) = (text(direction), text(position));
        lines.push(format!("light key {} {direction} {position}", key.at));
    }
    for motion in &path.moves {
        lines.push(format!("moves {}", motion.part()));
        motion_lines(motion, lines);
    }
}

fn motion_lines(motion: &Motion, lines: &mut Vec<String>) {
    match motion {
        Motion::Rigid {
            pivot, axis, keys, ..
        } => {
            let [pivot, axis] = [*pivot, *axis].map(vector);
            lines.push(format!("rigid {pivot} {axis}"));
            for key in keys {
                let (at, shift, turn) = (key.at, vector(key.translation), key.degrees);
                lines.push(format!("rigid key {at} {shift} {turn}"));
            }
        }
        Motion::Posed { keys, .. } => {
            lines.push("posed".into());
            for key in keys {
                let (at, shift) = (key.at, vector(key.translation));
                let [x, y, z, w] = key.rotation.to_array();
                lines.push(format!("posed key {at} {shift} {x},{y},{z},{w}"));
            }
        }
        Motion::Sway {
            axis,
            up,
            degrees,
            seconds,
            ..
        } => {
            let [axis, up] = [*axis, *up].map(vector);
            lines.push(format!("sway {axis} {up} {degrees} {seconds}"));
        }
    }
}

pub(crate) fn light_text(mut light: LightKind) -> String {
    let word = light.word();
    let LightParameters {
        position,
        direction,
        angle_degrees,
        cone_degrees,
        radius,
    } = light.parameters();
    let vectors = [position, direction].into_iter().flatten();
    let numbers = [angle_degrees, cone_degrees, radius].into_iter().flatten();
    let vectors = vectors.map(|it| vector(*it));
    let words = vectors.chain(numbers.map(|it| it.to_string()));
    format!("light {word} {}", words.collect::<Vec<_>>().join(" "))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::graphs::shadow_method::load_methods;
    use glam::DQuat;
    use skiagraph_passes::EmbeddedSources;
    use skiagraph_scene::{DirectionalLight, PoseKey, RigidKey, SceneLibrary};
    use std::collections::BTreeSet;
    use std::sync::Arc;

    /// `nsm` in a map of 512² on the views of `park`.
    fn comparison() -> Comparison {
        let (scene, _) = SceneLibrary::default().load("park").unwrap();
        let methods = load_methods(&["nsm"], &[], &[512], &EmbeddedSources).unwrap();
        Comparison::new(Arc::new(scene), methods).unwrap()
    }

    fn id_of(comparison: &Comparison) -> String {
        let (view, method) = (&comparison.views[0], &comparison.methods[0]);
        id(comparison, view, comparison.viewports[0], method)
    }

    /// Results and plans of other versions and machines hold ids: this one changes only if `nsm`
    /// gets another param, as it did with `two_sided`.
    #[test]
    fn an_id_is_the_same_in_every_version() {
        insta::assert_snapshot!(id_of(&comparison()));
    }

    /// Ids are hashes of this text, not of how a version of Rust shows a type.
    #[test]
    fn motions_are_written_down_in_text_of_their_own() {
        let mut lines = Vec::new();
        let rigid = RigidKey {
            at: 1.5,
            translation: DVec3::X,
            degrees: 90.0,
        };
        let pose = PoseKey {
            at: 0.0,
            translation: DVec3::ZERO,
            rotation: DQuat::IDENTITY,
        };
        let motions = [
            Motion::Rigid {
                part: "leg".into(),
                pivot: DVec3::ZERO,
                axis: DVec3::Y,
                keys: vec![rigid],
            },
            Motion::Posed {
                part: "leg".into(),
                keys: vec![pose],
            },
            Motion::Sway {
                part: "leg".into(),
                axis: DVec3::X,
                up: DVec3::Y,
                degrees: 6.0,
                seconds: 1.7,
            },
        ];
        for motion in &motions {
            motion_lines(motion, &mut lines);
        }
        let expected = [
            "rigid 0,0,0 0,1,0",
            "rigid key 1.5 1,0,0 90",
            "posed",
            "posed key 0 0,0,0 0,0,0,1",
            "sway 1,0,0 0,1,0 6 1.7",
        ];
        assert_eq!(lines, expected);
    }

    /// A truth waits for no method, and is another one of another light, size or mode.
    #[test]
    fn all_cells_of_a_view_wait_for_one_truth() {
        let truth = |comparison: &Comparison| {
            truth_id(comparison, &comparison.views[0], comparison.viewports[0])
        };
        let (one, mut other) = (comparison(), comparison());
        other.methods = load_methods(&["rt"], &[], &[], &EmbeddedSources).unwrap();
        other.protocol.frames = 3;
        assert_eq!(truth(&one), truth(&other));
        assert_ne!(truth(&one), id_of(&one));
        type Change = fn(&mut Comparison);
        let changes: [Change; 3] = [
            |other| other.viewports[0] = [512, 511],
            |other| other.protocol.oracle = "offset:0.5".parse().unwrap(),
            |other| other.protocol.jitter = Some(4),
        ];
        for change in changes {
            let mut other = comparison();
            change(&mut other);
            assert_ne!(truth(&one), truth(&other));
        }
    }

    #[test]
    fn everything_that_makes_a_cell_makes_another_id() {
        type Change = fn(&mut Comparison);
        let view = |comparison: &mut Comparison, change: fn(&mut View)| {
            let ViewOrPath::Still(view) = &mut comparison.views[0] else {
                panic!("park has still views")
            };
            change(view);
        };
        let mut ids = BTreeSet::from([id_of(&comparison())]);
        let views: [fn(&mut View); 4] = [
            |view| view.name = "other".into(),
            |view| view.eye.x += 1e-9,
            |view| view.far *= 2.0,
            |view| {
                let direction = DVec3::new(0.0, -1.0, 0.0);
                let angle_degrees = 0.0;
                view.light = Some(
                    DirectionalLight {
                        direction,
                        angle_degrees,
                    }
                    .into(),
                );
            },
        ];
        for change in views {
            let mut other = comparison();
            view(&mut other, change);
            assert!(ids.insert(id_of(&other)));
        }
        let changes: [Change; 6] = [
            |other| other.viewports[0] = [512, 511],
            |other| other.protocol.frames = 3,
            |other| other.protocol.oracle = "offset:0.5".parse().unwrap(),
            |other| other.protocol.jitter = Some(4),
            |other| other.methods = load_methods(&["rt"], &[], &[], &EmbeddedSources).unwrap(),
            |other| other.methods = load_methods(&["nsm"], &[], &[1024], &EmbeddedSources).unwrap(),
        ];
        for change in changes {
            let mut other = comparison();
            change(&mut other);
            assert!(ids.insert(id_of(&other)));
        }
    }

    #[test]
    fn a_label_and_settings_that_say_nothing_new_make_no_other_id() {
        let mut other = comparison();
        other.methods[0].name = "nsm@cull=as it is".into();
        // A hard light has no samples, and pictures are not measured.
        other.protocol.reference_samples = 7;
        other.protocol.pictures = true;
        other.command = Some("skiagraph compare".into());
        assert_eq!(id_of(&other), id_of(&comparison()));
    }
}
