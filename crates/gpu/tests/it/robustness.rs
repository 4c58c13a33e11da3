//! Odd plans that must also run, or be refused with an error.

use crate::everything::files;
use crate::support::{Files, Triangle, load};
use crate::tiny::{GPU, encoder};
use proptest::{
    prelude::*,
    test_runner::{RngAlgorithm, TestRng, TestRunner},
};
use skiagraph_gpu::{Executor, Frame};
use skiagraph_graph::{Plan, PlanRequest};
use std::cell::Cell;

/// Replacements for parts of the document or its shaders that often still plan.
const OTHERS: &[(&str, &[&str])] = &[
    (
        "R32Float",
        &[
            "R16Float",
            "Rgba32Float",
            "R8Unorm",
            "Rg32Float",
            "Rgba8UnormSrgb",
            "Rg11b10Ufloat",
        ],
    ),
    ("Depth32Float", &["Depth16Unorm", "Depth24Plus"]),
    (
        "size: \"edge\"",
        &[
            "size: (1, 1)",
            "size: (8192, 1)",
            "size: \"small.size\"",
            "size: (5, 300)",
        ],
    ),
    (
        "max(viewport.size / 2, 1)",
        &[
            "viewport.size * 2",
            "ceil(viewport.size * 0.0001)",
            "1",
            "viewport.size",
        ],
    ),
    (
        "2 * small.count",
        &[
            "1",
            "65",
            "viewport.count",
            "scene.indices.count",
            "64 * 2048",
        ],
    ),
    (
        "Groups(1, 2, 3)",
        &[
            "Groups(0, 1, 1)",
            "Over(\"small.size\")",
            "Over(\"kept.count\")",
            "Indirect(\"items\")",
            "Over(\"scene.positions.count\")",
        ],
    ),
    (
        "compare: Less",
        &[
            "compare: Always, write: false",
            "compare: Never",
            "compare: GreaterEqual",
        ],
    ),
    (
        "load: Clear(1.0)",
        &["load: Clear(0)", "load: Clear(\"bias\")"],
    ),
    (
        "load: Clear(0, 0, 0, 0)",
        &[
            "load: Clear(0.5, 1e30, -1, 0)",
            "load: Load, blend: Additive",
            "load: Load, blend: Alpha",
            "load: Load, blend: Min",
        ],
    ),
    ("mips: 2", &["mips: 1", "mips: 5"]),
    ("layers: 1", &["layers: 2"]),
    (
        "bias: (constant: 1)",
        &[
            "bias: (slope_scale: 1e30, clamp: -1)",
            "bias: (constant: -2147483648)",
        ],
    ),
    ("default: 16", &["default: 1", "default: 64"]),
    ("default: -0.5", &["default: 1e30", "default: 0"]),
    ("default: front", &["default: none", "default: back"]),
    ("filter: Nearest", &["filter: Linear", "compare: Less"]),
    (
        "draw: \"scene.indices.count\"",
        &[
            "draw: 0",
            "draw: 7",
            "draw: 3, instances: 0",
            "draw: 3, topology: LineList",
            "draw: 3, topology: PointList",
            "draw: 3, topology: TriangleStrip",
            "draw: Indirect(\"items\")",
        ],
    ),
    (
        "@workgroup_size(64)",
        &[
            "@workgroup_size(1)",
            "@workgroup_size(16, 16)",
            "@workgroup_size(1, 1, 64)",
            "@workgroup_size(256)",
        ],
    ),
    (
        "Over(\"items.count\")",
        &[
            "Over(\"kept.count\")",
            "Over(\"depth.size\")",
            "Over(\"scene.indices.count\")",
            "Groups(65535, 1, 1)",
        ],
    ),
    (
        "items[id.x] = id.x;",
        &[
            "items[id.x] = items[id.x / 0u];",
            "items[9999999u] = 1u;",
            "var x: f16 = 1.0h;",
            "workgroupBarrier();",
        ],
    ),
    (
        "var<uniform> params",
        &[
            "@group(3) @binding(9) var<uniform> params",
            "@group(1) @binding(999) var<uniform> params",
        ],
    ),
    (
        "from: \"small\", to: \"same\"",
        &[
            "from: \"same\", to: \"small\"",
            "from: \"image.mip[0]\", to: \"same\"",
        ],
    ),
    ("twice ? 2 : 1", &["0", "3", "edge / 8"]),
    (
        "area: (0, 0, 1, 1)",
        &[
            "area: (0, 0, 0, 1)",
            "area: (0, 0, 9, 9)",
            "area: (40, 0, 1, 1)",
        ],
    ),
    ("edge > 0", &["edge > 100", "cull == back"]),
    ("run: OnChange", &["run: Once", "run: When(\"twice\")"]),
    ("image.mip[0]", &["image.mip[1]", "image"]),
];

/// The files with some things replaced by others of their kind.
fn varied(choices: &[(usize, usize)]) -> Files {
    let mut files = files();
    for (which, other) in choices {
        let (from, to) = OTHERS[which % OTHERS.len()];
        for text in files.texts.values_mut() {
            *text = text.replace(from, to[other % to.len()]);
        }
    }
    files
}

/// Runs two frames, so that what is read of the frame before is there; false where the device
/// refuses the plan.
fn runs(plan: Plan) -> Result<bool, TestCaseError> {
    let outputs = plan.outputs();
    let read: Vec<&str> = outputs.iter().map(|output| output.name.as_str()).collect();
    let mut executor = match Executor::new(&GPU.device, &GPU.queue, plan, &mut Triangle) {
        Ok(executor) => executor,
        Err(error) => {
            prop_assert!(!error.to_string().is_empty());
            return Ok(false);
        }
    };
    let failed = |error: skiagraph_gpu::ExecuteError| TestCaseError::fail(error.to_string());
    for _ in 0..2 {
        let mut encoder = encoder();
        let frame = Frame::new().with_timing(true).with_read(&read);
        executor.encode(&mut encoder, &frame).map_err(failed)?;
        GPU.queue.submit([encoder.finish()]);
        let report = executor.finish().map_err(failed)?;
        prop_assert_eq!(report.readbacks.len(), read.len());
    }
    Ok(true)
}

/// wgpu's own answer to an uncaught error is a panic.
#[test]
fn what_plans_runs_or_is_refused() {
    let ran = Cell::new(0);
    let mut runner = TestRunner::new_with_rng(
        ProptestConfig {
            cases: 300,
            failure_persistence: None,
            ..ProptestConfig::default()
        },
        TestRng::deterministic_rng(RngAlgorithm::ChaCha),
    );
    let choices = prop::collection::vec(any::<(usize, usize)>(), 1..3);
    let outcome = runner.run(&choices, |choices| {
        let Ok(graph) = load(&varied(&choices)) else {
            return Ok(());
        };
        let mut request = PlanRequest::new([33, 17], &Triangle);
        request.limits = GPU.device.limits();
        request.features = GPU.device.features();
        if let Ok(plan) = graph.plan(&request) {
            ran.set(ran.get() + u32::from(runs(plan)?));
        }
        Ok(())
    });
    outcome.unwrap_or_else(|failure| panic!("{failure}"));
    let ran = ran.get();
    assert!(
        ran > 50,
        "only {ran} of the changed documents ran: the test says little"
    );
}
