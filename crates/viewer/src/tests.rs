//! Drives the window without a display: input by script, pictures by wgpu.

use super::desired_state::MethodSnapshot;
use super::drawn::Show;
use super::start::Opening;
use super::state::{Drag, Viewer};
use super::ui::{self, Surface};
use egui::{Modifiers, Vec2, accesskit::Role};
use egui_kittest::{Harness, kittest::Queryable};
use skiagraph_compare::files::watch::Watch;
use skiagraph_compare::measuring::device::GpuRequest;
use skiagraph_compare::sink::Silent;
use skiagraph_graph::ParamValue;
use skiagraph_scene::SceneLibrary;
use std::{
    path::Path,
    sync::Arc,
    time::{Duration, Instant},
};

/// Longer than any frame here takes on a busy machine.
const PATIENCE: Duration = Duration::from_secs(120);

struct Desk {
    viewer: Viewer,
    surface: Surface,
    _watch: Option<Watch>,
}

fn opening(methods: &[&str]) -> Opening {
    Opening {
        methods: methods.iter().map(|&it| it.to_owned()).collect(),
        params: Vec::new(),
        map_size: Some(128),
        size: [96, 64],
        scene: "park".to_owned(),
        load_scene: Box::new(|name| {
            let (scene, _) = SceneLibrary::from_environment().load(name)?;
            let views = scene.views.iter().take(1).cloned().collect();
            Ok((scene, views))
        }),
        gpu: GpuRequest::default(),
    }
}

fn desk(methods: &[&str]) -> Harness<'static, Desk> {
    desk_with(opening(methods))
}

fn desk_with(opening: Opening) -> Harness<'static, Desk> {
    let started = super::start::start(opening, &Silent, Arc::new(|| {}));
    let (viewer, watch) = started.unwrap_or_else(|error| panic!("{error}"));
    let desk = Desk {
        viewer,
        surface: Surface::default(),
        _watch: watch,
    };
    Harness::builder()
        .with_size(Vec2::new(1280.0, 800.0))
        .allow_missing_glyphs()
        .wgpu()
        .build_ui_state(
            |ui, desk: &mut Desk| ui::show(ui, &mut desk.viewer, &mut desk.surface),
            desk,
        )
}

/// Draws until something holds.
fn until(desk: &mut Harness<Desk>, what: &str, holds: impl Fn(&Viewer) -> bool) {
    let began = Instant::now();
    loop {
        desk.step();
        if holds(&desk.state().viewer) {
            // Once more, so that it is drawn.
            desk.step();
            return;
        }
        let notice = &desk.state().viewer.notice;
        assert!(
            began.elapsed() < PATIENCE,
            "not in time: {what}; {notice:?}"
        );
        std::thread::sleep(Duration::from_millis(20));
    }
}

fn shown(desk: &Harness<Desk>, index: usize) -> MethodSnapshot {
    desk.state().viewer.method(index).cloned().unwrap()
}

fn settled(desk: &mut Harness<Desk>) {
    until(desk, "a frame of what is wanted", Viewer::is_current);
}

/// The bytes of an output in the newest frame.
fn output(desk: &Harness<Desk>, index: usize, name: &str) -> Vec<u8> {
    shown(desk, index).contents[name].bytes().to_vec()
}

/// Writes a picture of the window where the environment names a folder for them.
fn keep(desk: &mut Harness<Desk>, name: &str) {
    let picture = desk.render().unwrap();
    let colours: std::collections::BTreeSet<_> = picture.pixels().map(|pixel| pixel.0).collect();
    assert!(colours.len() > 100, "{name}: {} colours", colours.len());
    if let Some(folder) = std::env::var_os("SKIAGRAPH_SCREENSHOTS") {
        picture.save(Path::new(&folder).join(name)).unwrap();
    }
}

#[test]
fn a_param_moved_changes_the_picture_and_defaults_bring_it_back() {
    let mut desk = desk(&["nsm"]);
    settled(&mut desk);
    let before = output(&desk, 0, "visibility");
    assert!(before.contains(&0) && before.contains(&1));
    desk.get_by_label("bias");
    let bias = ParamValue::F32(0.5);
    desk.state_mut().viewer.set_param(0, "bias", bias.clone());
    settled(&mut desk);
    assert_eq!(shown(&desk, 0).values["bias"], bias);
    assert_ne!(output(&desk, 0, "visibility"), before);
    keep(&mut desk, "params.png");
    desk.get_by_label("Defaults").click();
    settled(&mut desk);
    assert_ne!(shown(&desk, 0).values["bias"], bias);
}

#[test]
fn a_lamp_is_moved_and_its_cone_narrowed() {
    let mut opening = opening(&["rt"]);
    opening.scene = concat!(env!("CARGO_MANIFEST_DIR"), "/../../scenes/lamps.ron").to_owned();
    let mut desk = desk_with(opening);
    settled(&mut desk);
    let lit = output(&desk, 0, "visibility");
    let lamp = |desk: &Harness<Desk>| match desk.state().viewer.light().unwrap().1 {
        skiagraph_scene::LightKind::Spot(lamp) => lamp,
        other => panic!("{other:?}"),
    };
    let before = lamp(&desk);
    let cone = desk.get_by_role_and_label(Role::Slider, "cone");
    cone.focus();
    desk.step();
    (0..8).for_each(|_| desk.key_press(egui::Key::ArrowLeft));
    settled(&mut desk);
    let narrow = lamp(&desk);
    assert!(
        narrow.cone_degrees < before.cone_degrees - 1.0,
        "{narrow:?}"
    );
    let moved = [narrow.position, narrow.direction];
    assert_eq!(moved, [before.position, before.direction]);
    assert_ne!(output(&desk, 0, "visibility"), lit);
    // The counts of each pass stand beside its time, where the adapter counts.
    if shown(&desk, 0)
        .passes
        .iter()
        .any(|pass| pass.statistics.is_some())
    {
        desk.get_all_by_label_contains(" fragments").next().unwrap();
    }
}

#[test]
fn dragging_turns_the_camera_and_the_light() {
    let mut desk = desk(&["nsm"]);
    settled(&mut desk);
    let view = desk.state().viewer.desired.view.clone().unwrap();
    let lit = output(&desk, 0, "visibility");
    let [from, to] = [egui::pos2(800.0, 300.0), egui::pos2(860.0, 310.0)];
    desk.hover_at(from);
    desk.drag_at(from);
    desk.step();
    desk.hover_at(to);
    desk.drop_at(to);
    settled(&mut desk);
    let looked = desk.state().viewer.desired.view.clone().unwrap();
    assert_ne!(looked.direction, view.direction);
    assert_eq!(looked.eye, view.eye);
    desk.state_mut().viewer.look_from(view.clone());
    desk.state_mut().viewer.dragged(Drag::Light, [0.6, 0.2]);
    settled(&mut desk);
    let turned = desk.state().viewer.desired.view.clone().unwrap();
    assert!(turned.light.is_some());
    assert_ne!(output(&desk, 0, "visibility"), lit);
    desk.key_down_modifiers(Modifiers::NONE, egui::Key::W);
    desk.run_steps(3);
    desk.key_up_modifiers(Modifiers::NONE, egui::Key::W);
    settled(&mut desk);
    assert_ne!(
        desk.state().viewer.desired.view.as_ref().unwrap().eye,
        view.eye
    );
}

#[test]
fn passes_are_stepped_through_and_materials_read() {
    let mut desk = desk(&["nsm"]);
    settled(&mut desk);
    let steps = desk.state().viewer.steps(0);
    assert!(steps.len() > 2, "{steps:?}");
    for step in &steps {
        desk.get_by_label(">").click();
        settled(&mut desk);
        let viewer = &desk.state().viewer;
        assert_eq!(viewer.panes[0].show, Show::Material(step.clone()));
        let drawn = &viewer.panes[0].drawn;
        assert!(
            drawn.image.is_some() || drawn.table.is_some(),
            "{step:?}: {}",
            drawn.legend
        );
    }
    let map = steps
        .iter()
        .find(|step| step.material.ends_with("shadow_maps"))
        .unwrap();
    desk.state_mut().viewer.show(0, Show::Material(map.clone()));
    settled(&mut desk);
    desk.get_by_label("heat map").click();
    desk.run_steps(3);
    let drawn = &desk.state().viewer.panes[0].drawn;
    assert!(drawn.heat.is_some());
    let histogram = drawn.histogram.clone().unwrap();
    assert_eq!(histogram.bins.iter().sum::<u64>(), histogram.finite);
    desk.hover_at(egui::pos2(800.0, 300.0));
    desk.run_steps(2);
    keep(&mut desk, "material.png");
}

#[test]
fn the_layers_of_a_group_are_stepped_through_as_they_are_drawn() {
    let mut desk = desk(&["pssm"]);
    settled(&mut desk);
    let steps = desk.state().viewer.steps(0).into_iter();
    let maps = steps.filter(|step| step.material.ends_with("shadow_maps"));
    let maps: Vec<_> = maps.collect();
    assert_eq!(maps.len(), 4, "{maps:?}");
    let parts = ["layer 0", "layers 0 to 1", "layers 0 to 2"];
    let parts = parts.map(|part| format!("{part} of 4, "));
    for (step, part) in maps.iter().zip(parts.iter().chain([&String::new()])) {
        let show = Show::Material(step.clone());
        desk.state_mut().viewer.show(0, show);
        settled(&mut desk);
        assert_eq!(shown(&desk, 0).error, None, "{step:?}");
        let drawn = &desk.state().viewer.panes[0].drawn;
        assert!(drawn.image.is_some(), "{step:?}: {}", drawn.legend);
        let is_part = drawn.legend.contains(" of 4, ");
        assert!(
            drawn.legend.starts_with(part) && is_part != part.is_empty(),
            "{}",
            drawn.legend
        );
    }
}

#[test]
fn the_reference_becomes_finer_and_tells_what_is_wrong() {
    let mut desk = desk(&["rt", "nsm"]);
    desk.state_mut().viewer.show(0, Show::Difference);
    desk.state_mut().viewer.show(1, Show::Difference);
    until(&mut desk, "the reference of all pixels", |viewer| {
        viewer
            .answer
            .as_ref()
            .is_some_and(|answer| answer.stride == 1)
    });
    let legend =
        |desk: &Harness<Desk>, index: usize| desk.state().viewer.panes[index].drawn.legend.clone();
    assert!(
        legend(&desk, 0).contains("; 0 wrong outside the band"),
        "{}",
        legend(&desk, 0)
    );
    assert!(
        !legend(&desk, 1).contains("; 0 wrong outside the band"),
        "{}",
        legend(&desk, 1)
    );
    assert!(
        legend(&desk, 1).ends_with("of all pixels"),
        "{}",
        legend(&desk, 1)
    );
    keep(&mut desk, "difference.png");
    desk.state_mut().viewer.dragged(Drag::Look, [0.3, 0.0]);
    desk.step();
    until(&mut desk, "a frame from elsewhere", |viewer| {
        viewer.is_current()
            && viewer
                .answer
                .as_ref()
                .is_some_and(|answer| answer.stride == 1)
    });
}

const METHOD: &str = r#"(format: 3, params: [F32(name: "share", default: 1, min: 0, max: 1)],
    materials: [Texture(name: "visibility", format: R32Float)],
    passes: [Include(graph: "shared/gbuffer.ron"), Fullscreen(name: "all", color: ["visibility"])],
    outputs: ["visibility"])"#;
const SHADER: &str = "#import \"part.wgsl\"
struct Params { share: f32 }
var<uniform> params: Params;
@fragment
fn fragment() -> @location(0) f32 { return params.share * part(); }";
const PART: &str = "fn part() -> f32 { return 1.0; }";

#[test]
fn changed_files_are_read_again_and_a_mistake_keeps_the_last_graph() {
    let folder = tempfile::tempdir().unwrap();
    let file = |name: &str| folder.path().join(name);
    std::fs::write(file("mine.ron"), METHOD).unwrap();
    std::fs::write(file("all.wgsl"), SHADER).unwrap();
    std::fs::write(file("part.wgsl"), PART).unwrap();
    let path = file("mine.ron");
    let mut opening = opening(&[path.to_str().unwrap()]);
    opening.map_size = None;
    let mut desk = desk_with(opening);
    settled(&mut desk);
    let first = |desk: &Harness<Desk>| {
        let bytes = output(desk, 0, "visibility");
        f32::from_le_bytes([bytes[0], bytes[1], bytes[2], bytes[3]])
    };
    assert_eq!(shown(&desk, 0).error, None);
    assert_eq!(first(&desk), 1.0);
    // A shader that is only imported.
    std::fs::write(file("part.wgsl"), PART.replace("1.0", "0.5")).unwrap();
    until(&mut desk, "the changed import", |viewer| {
        viewer.method(0).is_some_and(|method| method.reads == 2)
    });
    assert_eq!(first(&desk), 0.5);
    let is_faulty = |viewer: &Viewer| viewer.method(0).is_some_and(|it| it.error.is_some());
    std::fs::write(file("part.wgsl"), PART.replace("return", "retrun")).unwrap();
    until(&mut desk, "the mistake in the shader", is_faulty);
    let error = shown(&desk, 0).error.unwrap();
    assert!(error.contains("part.wgsl"), "{error}");
    assert_eq!(first(&desk), 0.5, "the last good graph runs on");
    desk.state_mut()
        .viewer
        .set_param(0, "share", ParamValue::F32(0.5));
    settled(&mut desk);
    assert_eq!(first(&desk), 0.25, "and takes params");
    std::fs::write(file("part.wgsl"), PART).unwrap();
    until(&mut desk, "the mistake mended", |viewer| !is_faulty(viewer));
    assert_eq!(first(&desk), 0.5);
    std::fs::write(file("mine.ron"), METHOD.replace("R32Float", "R33Float")).unwrap();
    until(&mut desk, "the mistake in the document", is_faulty);
    assert_eq!(first(&desk), 0.5);
}

#[test]
fn another_scene_and_a_scene_that_is_not_there() {
    let mut desk = desk(&["nsm"]);
    settled(&mut desk);
    desk.state_mut().viewer.choose_scene("nowhere");
    until(&mut desk, "the complaint", |viewer| {
        let is_told = |(text, is_error): &(String, bool)| *is_error && text.contains("nowhere");
        viewer.notice.as_ref().is_some_and(is_told)
    });
    desk.state_mut().viewer.choose_scene("forest:10000");
    settled(&mut desk);
    assert_eq!(desk.state().viewer.notice, None);
    let scene = desk
        .state()
        .viewer
        .snapshot
        .as_ref()
        .unwrap()
        .question
        .scene
        .clone();
    assert_eq!(scene.name, "forest");
}

/// `SKIAGRAPH_SCREENSHOTS=docs/images` writes those of docs/view.md.
#[test]
#[ignore = "takes larger pictures than a test needs"]
fn pictures_for_the_documents() {
    let large = |viewer: &mut Viewer| viewer.desired.size = [720, 480];
    let map = |viewer: &mut Viewer, index: usize| {
        viewer.set_param(index, "map_size", ParamValue::U32(1024));
    };
    let mut one = desk(&["nsm"]);
    large(&mut one.state_mut().viewer);
    map(&mut one.state_mut().viewer, 0);
    settled(&mut one);
    keep(&mut one, "view-params.png");
    let steps = one.state().viewer.steps(0);
    let is_map = |step: &&skiagraph_graph::Capture| step.material.ends_with("shadow_maps");
    let step = steps.iter().rfind(is_map).unwrap().clone();
    let viewer = &mut one.state_mut().viewer;
    viewer.show(0, Show::Material(step));
    let hot = super::drawn::Reading {
        part: 0,
        heat: Some(0),
        channel: 0,
    };
    viewer.read(0, hot);
    settled(&mut one);
    one.hover_at(egui::pos2(560.0, 300.0));
    one.run_steps(3);
    keep(&mut one, "view-material.png");
    let mut two = desk(&["nsm", "light_buffer"]);
    large(&mut two.state_mut().viewer);
    for index in 0..2 {
        map(&mut two.state_mut().viewer, index);
        two.state_mut().viewer.show(index, Show::Difference);
    }
    until(&mut two, "the reference of all pixels", |viewer| {
        viewer.is_current()
            && viewer
                .answer
                .as_ref()
                .is_some_and(|answer| answer.stride == 1)
    });
    keep(&mut two, "view-difference.png");
}
