//! Pixels of a G-buffer that show a surface which is not seen there are counted, and no others.

use glam::DVec3;
use skiagraph_reference::{
    BACKGROUND, Candidate, Class, Oracle, OracleMode, Progress, candidates, ground_truth,
    unattributable, wrong_surfaces,
};
use skiagraph_scene::{
    Camera, DirectionalLight, Indexed, LightKind, Mesh, Scene, SceneLibrary, View,
};

const VIEWPORT: [u32; 2] = [64, 64];

/// A floor of 100 × 100 around the origin, and a plate of 20 × 20 by so much above it.
fn plate_over_floor(gap: f32) -> Mesh {
    let square = |half: f32, y: f32| {
        [(-half, -half), (-half, half), (half, half), (half, -half)].map(|(x, z)| [x, y, z])
    };
    Indexed {
        positions: &[square(50.0, 0.0), square(10.0, gap)].concat(),
        normals: &[],
        indices: &[0, 1, 2, 0, 2, 3, 4, 5, 6, 4, 6, 7],
    }
    .mesh()
    .unwrap()
}

/// From far above, so narrow that the floor fills the picture.
fn far_above(near: f64) -> Camera {
    let view = View {
        name: "far".into(),
        eye: DVec3::new(300.0, 3000.0, 10.0),
        direction: DVec3::new(-300.0, -3000.0, -10.0),
        fov_y_degrees: 1.0,
        near,
        far: 10_000.0,
        ..View::default()
    };
    view.camera(VIEWPORT)
}

fn wrong(mesh: &Mesh, camera: &Camera, shown: &[u32]) -> u64 {
    wrong_surfaces(&Oracle::new(mesh), camera, shown, Progress::default()).unwrap()
}

fn seen(mesh: &Mesh, camera: &Camera) -> Vec<u32> {
    Oracle::new(mesh)
        .primary(camera, Progress::default())
        .unwrap()
}

fn of_plate(id: u32) -> bool {
    (2..4).contains(&id)
}

#[test]
fn a_floor_that_stands_before_its_plate_is_counted() {
    let mesh = plate_over_floor(1.0);
    for near in [100.0, 0.1, 1e-10] {
        let camera = far_above(near);
        let right = seen(&mesh, &camera);
        assert_eq!(wrong(&mesh, &camera, &right), 0);
        let plate = right.iter().filter(|id| of_plate(**id)).count() as u64;
        assert!(plate > 300, "{plate}");
        let counted = wrong(&mesh, &camera, &seen(&plate_over_floor(-1.0), &camera));
        // But for pixels that plate and floor, or the plate's halves, share.
        assert!(
            counted <= plate && counted * 10 > plate * 8,
            "{counted} of {plate}"
        );
        // Nothing at all is wrong wherever there is something.
        let nothing = wrong(&mesh, &camera, &[BACKGROUND; 64 * 64]);
        assert!(nothing > 64 * 60, "{nothing}");
        // A plate where it is not.
        let elsewhere = wrong(&mesh, &camera, &[2; 64 * 64]);
        assert!(elsewhere > 64 * 40, "{elsewhere}");
    }
}

#[test]
fn what_rounding_cannot_tell_apart_is_not_counted() {
    // An ulp of 3000 is 2.4e-4.
    let mesh = plate_over_floor(2e-4);
    let camera = far_above(0.1);
    let swapped = seen(&plate_over_floor(-1.0), &camera);
    assert!(swapped != seen(&mesh, &camera));
    assert_eq!(wrong(&mesh, &camera, &swapped), 0);
}

/// The ids that a rasteriser might write whose corners are off by so many pixels.
fn snapped(camera: &Camera, by: f64) -> Camera {
    let step = |half: f64, pixels: u32| 2.0 * half / f64::from(pixels) * by;
    Camera {
        forward: camera.forward + camera.right * step(camera.half_width, camera.viewport[0])
            - camera.up * step(camera.half_height, camera.viewport[1]),
        ..*camera
    }
}

fn park() -> Scene {
    SceneLibrary::default().load("park").unwrap().0
}

/// Receivers lie within their triangles however coarse the grid is, and touch no neighbour.
#[test]
fn a_coarse_grid_makes_no_more_pixels_indeterminate() {
    let park = park();
    let oracle = Oracle::new(&park.mesh);
    for view in &park.views[..3] {
        let camera = view.camera([160, 120]);
        let [fine, coarse] = [1.0 / 512.0, 1.0 / 32.0].map(|by| {
            let shown = oracle.primary(&snapped(&camera, by), Progress::default());
            let (mode, progress) = (OracleMode::Exact, Progress::default());
            let right = oracle.shade(&camera, park.light(), &shown.unwrap(), mode, progress);
            let indeterminate = right.unwrap().indeterminate;
            indeterminate.into_iter().filter(|it| *it).count()
        });
        println!("{}: {fine} and {coarse} indeterminate", view.name);
        assert!(
            coarse <= fine + 5 && coarse < 30,
            "{}: {fine}, {coarse}",
            view.name
        );
    }
}

#[test]
fn a_rasterisers_grid_is_allowed_for() {
    let park = park();
    let oracle = Oracle::new(&park.mesh);
    for view in &park.views[..3] {
        let camera = view.camera([160, 120]);
        let counted = |by| {
            let shown = oracle.primary(&snapped(&camera, by), Progress::default());
            let progress = Progress::default();
            wrong_surfaces(&oracle, &camera, &shown.unwrap(), progress).unwrap()
        };
        assert_eq!(counted(1.0 / 32.0), 0, "{}", view.name);
        assert_eq!(counted(1.0 / 512.0), 0, "{}", view.name);
        // A pixel further is no rounding.
        assert!(counted(1.0) > 100, "{}", view.name);
    }
}

#[test]
fn surfaces_that_meet_in_a_pixel_are_candidates_and_hidden_ones_are_not() {
    let mesh = plate_over_floor(1.0);
    let camera = far_above(0.1);
    let oracle = Oracle::new(&mesh);
    let lists = candidates(&oracle, &camera, Progress::default()).unwrap();
    let seen = seen(&mesh, &camera);
    for (list, id) in lists.iter().zip(&seen) {
        let own = list.iter().find(|candidate| candidate.primitive == *id);
        let [least, greatest] = own.expect("what is seen may be seen").distances;
        assert!(
            least < greatest && greatest - least < 0.1,
            "{least} {greatest}"
        );
        // Two triangles of the floor hide together what is behind their edge.
        let is_behind = list
            .iter()
            .any(|candidate| candidate.primitive == BACKGROUND);
        assert!(!is_behind, "the floor fills the picture");
    }
    let meets = |list: &&Vec<Candidate>| {
        let of_plates = list
            .iter()
            .filter(|candidate| of_plate(candidate.primitive))
            .count();
        of_plates > 0 && of_plates < list.len()
    };
    // A rim of about 96 pixels, an eighth of which has the edge near its centre.
    let rim = lists.iter().filter(meets).count();
    assert!((4..48).contains(&rim), "{rim}");
    let alone = lists.iter().filter(|list| list.len() == 1).count();
    assert!(alone * 10 > lists.len() * 9, "{alone}");
    // Truth differs at the rim alone: plate and floor are lit, what faces away is not seen.
    let light: LightKind = DirectionalLight::new(DVec3::new(0.3, -1.0, 0.1)).into();
    let how = (OracleMode::Exact, 4);
    let truth = ground_truth(&oracle, &camera, light, &seen, how, Progress::default()).unwrap();
    let seen_under = (&camera, &light);
    let open = unattributable(
        &oracle,
        seen_under,
        &lists,
        &truth,
        how,
        Progress::default(),
    );
    let open = open.unwrap();
    let shadow = truth
        .pixels
        .classes
        .iter()
        .filter(|class| **class == Class::Shadow)
        .count();
    let open = open.iter().filter(|is_open| **is_open).count();
    assert!(open <= rim && shadow > 0, "{open} of {rim}, {shadow}");
}
