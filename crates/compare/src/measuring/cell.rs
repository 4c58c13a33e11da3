//! Ids of cells. A cell is one method in one setting on one view or path, in one viewport, under
//! one protocol; its id tells it from all other cells, on every machine and in every version.
//!
//! ```
//! use skiagraph_compare::{comparison::Comparison, graphs::shadow_method::load_methods};
//! use skiagraph_compare::measuring::cell;
//! use skiagraph_passes::EmbeddedSources;
//! use skiagraph_scene::{SceneLibrary, SceneRequest};
//! use std::sync::Arc;
//!
//! let request = SceneRequest { argument: "park".into(), obj: None };
//! let (scene, _) = SceneLibrary::default().load(&request)?;
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
use skiagraph_scene::{CameraPath, DirectionalLight, LightKind, PointLight, SpotLight, View};

/// Returns the id of a cell, 16 hexadecimal digits: a hash of the scene's name and number of
/// triangles; the name, camera and light of the view or path; the viewport in pixels; the preset
/// with all params that it runs with; and the protocol. The method's name is not part of the hash:
/// two settings with the same params are one cell. Neither are shaders and the mesh; a change of
/// these changes the run's [`fingerprint`](crate::records::results::Run::fingerprint).
pub fn id(
    comparison: &Comparison,
    view: &ViewOrPath,
    viewport: [u32; 2],
    method: &Method,
) -> String {
    let scene = &comparison.scene;
    let light = view.light(scene);
    let mut lines = vec![
        format!("scene {} {}", scene.name, scene.mesh.triangles.len()),
        light_text(light),
        format!("viewport {}", size(viewport)),
        format!("method {}", method.preset.name),
    ];
    match view {
        ViewOrPath::Still(view) => lines.push(format!("view {}", view_text(view))),
        ViewOrPath::Path(path) => path_lines(path, &mut lines),
    }
    let params = method.all_params().into_iter();
    lines.extend(params.map(|(name, value)| format!("param {name}={value}")));
    lines.extend(protocol_lines(comparison, light.has_extent()));
    let all = lines.iter();
    let hash = all.fold(Fingerprint::EMPTY, |hash, line| hash.with_text(line));
    hash.to_string()
}

fn protocol_lines(comparison: &Comparison, has_extent: bool) -> Vec<String> {
    let protocol = &comparison.protocol;
    let mut lines = vec![
        format!("oracle {}", protocol.oracle),
        format!("frames {}", protocol.frames),
        format!("warmup {}", protocol.warmup),
        format!("cached frames {}", protocol.cached_frames),
    ];
    if has_extent {
        lines.push(format!("samples {}", protocol.reference_samples));
    }
    lines.extend(protocol.jitter.map(|count| format!("jitter {count}")));
    lines
}

/// Three numbers, each as the shortest decimal that reads back as it.
fn vector(of: DVec3) -> String {
    format!("{},{},{}", of.x, of.y, of.z)
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
        let [direction, position] = [key.direction, key.position].map(|of| of.map(vector));
        let text = |of: Option<String>| of.unwrap_or_else(|| "-".into());
        let (direction, position) = (text(direction), text(position));
        lines.push(format!("light key {} {direction} {position}", key.at));
    }
    lines.extend(path.moves.iter().map(|part| format!("{part:?}")));
}

fn light_text(light: LightKind) -> String {
    let word = light.word();
    let numbers = match light {
        LightKind::Directional(DirectionalLight {
            direction,
            angle_degrees,
        }) => format!("{} {angle_degrees}", vector(direction)),
        LightKind::Spot(SpotLight {
            position,
            direction,
            cone_degrees,
            radius,
        }) => {
            let [position, direction] = [position, direction].map(vector);
            format!("{position} {direction} {cone_degrees} {radius}")
        }
        LightKind::Point(PointLight { position, radius }) => {
            format!("{} {radius}", vector(position))
        }
    };
    format!("light {word} {numbers}")
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::graphs::shadow_method::load_methods;
    use skiagraph_passes::EmbeddedSources;
    use skiagraph_scene::{SceneLibrary, SceneRequest};
    use std::collections::BTreeSet;
    use std::sync::Arc;

    /// `nsm` in a map of 512² on the views of `park`.
    fn comparison() -> Comparison {
        let request = SceneRequest {
            argument: "park".into(),
            obj: None,
        };
        let (scene, _) = SceneLibrary::default().load(&request).unwrap();
        let methods = load_methods(&["nsm"], &[], &[512], &EmbeddedSources).unwrap();
        Comparison::new(Arc::new(scene), methods).unwrap()
    }

    fn id_of(comparison: &Comparison) -> String {
        let (view, method) = (&comparison.views[0], &comparison.methods[0]);
        id(comparison, view, comparison.viewports[0], method)
    }

    /// Results and plans of other versions and machines hold ids: this one never changes.
    #[test]
    fn an_id_is_the_same_in_every_version() {
        insta::assert_snapshot!(id_of(&comparison()));
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
            |of| of.viewports[0] = [512, 511],
            |of| of.protocol.frames = 3,
            |of| of.protocol.oracle = "offset:0.5".parse().unwrap(),
            |of| of.protocol.jitter = Some(4),
            |of| of.methods = load_methods(&["rt"], &[], &[], &EmbeddedSources).unwrap(),
            |of| of.methods = load_methods(&["nsm"], &[], &[1024], &EmbeddedSources).unwrap(),
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
