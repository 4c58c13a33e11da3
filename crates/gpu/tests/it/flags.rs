//! The flags of the uniform `frame`: in which frames the scene or its lights count as changed.

use crate::buffers::{INPUT, OLD, OUT, compute, document, shader, writes};
use crate::host::{GPU, executor, frame, planned, request, set, words};
use crate::support::Files;
use skiagraph_gpu::{Executor, Provider, ProviderError};
use skiagraph_graph::{Describe, NoProvider, ParamValue, Provided, ProvidedBinding};
use std::collections::BTreeMap;

const FRAME: &str = "#import \"frame.wgsl\"\n";
/// Writes both flags.
const FLAGS: &str = "out[0] = frame.changed_scene; out[1] = frame.changed_light;";

/// Lists names of a scene, each with a version; builds `scene.positions`.
struct Versions(BTreeMap<&'static str, u64>);

impl Versions {
    fn new() -> Self {
        let names = [
            "camera",
            "light",
            "light_area",
            "lights.1",
            "scene.light_space_nodes",
            "scene.positions",
            "scene.tlas",
        ];
        Self(names.map(|name| (name, 1)).into())
    }
}

impl Describe for Versions {
    fn names(&self) -> Vec<String> {
        self.0.keys().map(|name| (*name).to_owned()).collect()
    }

    fn describe(&self, name: &str) -> Option<Provided> {
        self.0
            .contains_key(name)
            .then_some(Provided::new(ProvidedBinding::Storage, Some(1), 4))
    }
}

impl Provider for Versions {
    fn version(&self, name: &str) -> u64 {
        self.0.get(name).copied().unwrap_or_default()
    }

    fn build(
        &mut self,
        name: &str,
        device: &wgpu::Device,
        _: &wgpu::Queue,
    ) -> Result<wgpu::Buffer, ProviderError> {
        if self.version(name) == u64::MAX {
            return Err(ProviderError::new("it cannot be built".to_owned()));
        }
        Ok(device.create_buffer(&wgpu::BufferDescriptor {
            label: None,
            size: 4,
            usage: wgpu::BufferUsages::STORAGE,
            mapped_at_creation: false,
        }))
    }
}

/// ```text
/// frame's flags ─▶ tell ─▶ told ;  scene.positions ─▶ look ─▶ seen
/// total.previous ─▶ count ─▶ total, with as many items as the viewport is wide
/// ```
fn files() -> Files {
    let wide = r#"Buffer(name: "told", count: 2), Buffer(name: "total", count: "viewport.width"),"#;
    let passes = [
        compute("tell", "", r#""out": "told""#),
        compute("look", "", r#""input": "scene.positions", "out": "seen""#),
        compute("count", "", r#""old": "total.previous", "out": "total""#),
    ];
    document(
        r#"U32(name: "gain", default: 1)"#,
        &["seen"],
        &passes,
        &["told", "seen", "total"],
    )
    .edited("graph.ron", "materials: [", &format!("materials: [{wide}"))
    .with(
        "frame.wgsl",
        include_str!("../../../../shaders/shared/frame.wgsl"),
    )
    .with("tell.wgsl", shader(&format!("{FRAME}{OUT}"), FLAGS))
    .with("look.wgsl", writes(INPUT, "input[0]"))
    .with(
        "count.wgsl",
        writes(
            &format!("struct Params {{ gain: u32 }} var<uniform> params: Params; {OLD}"),
            "old[0] + params.gain",
        ),
    )
}

fn start(provider: &mut Versions) -> Executor {
    let plan = planned(&files(), &request(provider));
    Executor::new(&GPU.device, &GPU.queue, plan, provider).unwrap_or_else(|error| panic!("{error}"))
}

/// The flags of scene and light in the next frame.
#[track_caller]
fn expect(executor: &mut Executor, flags: [u32; 2], when: &str) {
    assert_eq!(words(&frame(executor, &["told"]), 0), flags, "{when}");
}

#[test]
fn every_name_that_is_listed_counts_for_one_frame() {
    let mut provider = Versions::new();
    let mut executor = start(&mut provider);
    expect(&mut executor, [1, 1], "the first frame");
    let (none, scene, light) = ([0, 0], [1, 0], [0, 1]);
    let names = [
        ("camera", none),
        ("light", light),
        ("light_area", light),
        ("lights.1", light),
        ("scene.light_space_nodes", light),
        ("scene.positions", scene),
        ("scene.tlas", scene),
    ];
    for (name, flags) in names {
        *provider.0.get_mut(name).expect("it is listed") += 1;
        executor.refresh(&mut provider).unwrap();
        // A second look does not take it back.
        executor.refresh(&mut provider).unwrap();
        expect(&mut executor, flags, name);
        expect(&mut executor, none, name);
        executor.touch(name).unwrap();
        expect(&mut executor, flags, name);
        expect(&mut executor, none, name);
    }
    provider.0.remove("lights.1");
    executor.refresh(&mut provider).unwrap();
    expect(&mut executor, light, "a light less");
}

#[test]
fn other_plans_keep_what_is_known_and_new_memory_counts_as_both() {
    let mut provider = Versions::new();
    let mut executor = start(&mut provider);
    expect(&mut executor, [1, 1], "the first frame");
    for gain in [2, 3] {
        let plan = executor.plan().with_param("gain", ParamValue::U32(gain));
        executor
            .replace_graph(plan.unwrap(), &mut provider)
            .unwrap();
        expect(&mut executor, [0, 0], "the same memory");
        let plan = executor
            .plan()
            .with_param("gain", ParamValue::U32(gain + 1));
        *provider.0.get_mut("scene.tlas").expect("it is listed") += 1;
        executor
            .replace_graph(plan.unwrap(), &mut provider)
            .unwrap();
        expect(&mut executor, [1, 0], "changed before another plan");
    }
    executor.resize([16, 8], &mut provider).unwrap();
    expect(&mut executor, [1, 1], "`total` is in new memory");
    expect(&mut executor, [0, 0], "nothing any more");
}

#[test]
fn a_refresh_that_fails_counts_as_both() {
    let mut provider = Versions::new();
    let mut executor = start(&mut provider);
    expect(&mut executor, [1, 1], "the first frame");
    provider.0.insert("scene.positions", u64::MAX);
    assert!(executor.refresh(&mut provider).is_err());
    expect(&mut executor, [1, 1], "it failed");
    expect(&mut executor, [0, 0], "the executor is as it was");
    provider.0.insert("scene.positions", 2);
    executor.refresh(&mut provider).unwrap();
    expect(&mut executor, [1, 0], "it can be had again");
}

/// Number and time are others in every frame, the flags are no reason to run.
#[test]
fn a_pass_that_reads_flags_alone_is_not_run_for_them() {
    let files = |body: &str| {
        let pass = compute("tell", "run: OnChange,", r#""out": "told""#);
        document("U32(name: \"seed\", default: 1)", &[], &[pass], &["told"])
            .edited(
                "graph.ron",
                "materials: [",
                r#"materials: [Buffer(name: "told", count: 2)"#,
            )
            .with(
                "frame.wgsl",
                include_str!("../../../../shaders/shared/frame.wgsl"),
            )
            .with(
                "tell.wgsl",
                shader(
                    &format!(
                        "{FRAME}struct Params {{ seed: u32 }} var<uniform> params: Params; {OUT}
                         fn number() -> u32 {{ return frame.index; }}
                         fn all() -> Frame {{ return frame; }}"
                    ),
                    &format!("out[0] = params.seed; {body}"),
                ),
            )
    };
    for (body, runs) in [
        (FLAGS, false),
        ("out[1] = number();", true),
        ("out[1] = all().changed_light;", true),
    ] {
        let mut executor = executor(&files(body), &request(&NoProvider));
        assert!(frame(&mut executor, &[]).skipped.is_empty());
        assert_eq!(frame(&mut executor, &[]).skipped.is_empty(), runs, "{body}");
    }
    // When it runs for another reason, they are those of the frame.
    let mut executor = executor(
        &files("out[1] = frame.changed_light;"),
        &request(&NoProvider),
    );
    assert_eq!(words(&frame(&mut executor, &["told"]), 0), [1, 1]);
    set(&mut executor, "seed", ParamValue::U32(7));
    assert_eq!(words(&frame(&mut executor, &["told"]), 0), [7, 0]);
}
