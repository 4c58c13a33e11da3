//! The hard cases, and whether methods keep what they guarantee.

use crate::support::{LIT, NOWHERE, TEMPORAL, count, gpu, sources};
use serde_json::Value;
use skiagraph_cases::{Casters, HardCase, case, cases};
use skiagraph_compare::{
    graphs::shadow_method::load_methods,
    measuring::ground_truth::PrimaryVisibility,
    measuring::hard_case::{HardCaseContext, MethodRun},
    records::stress::Guarantee,
    sink::{Session, Silent},
};
use skiagraph_gpu::block_on;
use skiagraph_passes::EmbeddedSources;
use std::{fs, path::Path};

/// Methods of a folder, those of `exact` as exact ones, with viewport and maps of that side.
fn method_runs(folder: &Path, names: &[&str], exact: &[String], side: u32) -> Vec<MethodRun> {
    let methods = load_methods(names, &[], &[side], &sources(folder)).unwrap();
    let features = gpu().device.features();
    let methods = methods.into_iter().map(|method| {
        let settled = method.at([side; 2]).settled(features);
        MethodRun::new(settled, exact)
    });
    methods.collect()
}

/// Judges methods on a case, with its pictures in a folder if one is named; as `stress.json` has
/// it.
fn judge(methods: &[MethodRun], name: &str, side: u32, pictures: Option<&Path>) -> Value {
    let context = HardCaseContext {
        session: Session::new(gpu(), &Silent),
        primary: &PrimaryVisibility::load(&EmbeddedSources).unwrap(),
        methods,
        viewport: [side; 2],
        pictures,
    };
    let case = block_on(context.run(&case(name).unwrap()));
    serde_json::to_value(case.unwrap_or_else(|error| panic!("{error}"))).unwrap()
}

/// The same of built-in methods and of the one that remembers.
fn judged(names: &[&str], exact: &[String], name: &str, side: u32) -> Value {
    judge(
        &method_runs(TEMPORAL.as_ref(), names, exact, side),
        name,
        side,
        None,
    )
}

#[test]
fn what_is_guaranteed_is_judged_and_pictured() {
    let folder = tempfile::tempdir().unwrap();
    let side = 32;
    let methods = method_runs(NOWHERE.as_ref(), &["rt", "nsm"], &[], side);
    let promises = methods.iter().map(|run| run.column.guarantee);
    assert_eq!(promises.collect::<Vec<_>>(), [Some(Guarantee::Exact), None]);
    let case = judge(&methods, "box_on_floor", side, Some(folder.path()));
    assert_eq!(
        (&case["name"], &case["casters"], &case["verdict"]),
        (&"box_on_floor".into(), &"closed".into(), &"pass".into())
    );
    assert!(count(&case["pixels"]["shadow"]) > 0);
    let [rt, nsm] = [0, 1].map(|index| &case["cells"][index]);
    assert_eq!(
        (&rt["preset"], &rt["verdict"]),
        (&"rt".into(), &"pass".into())
    );
    assert_eq!(rt["rays"], case["pixels"]["facing_light"]);
    assert_eq!(nsm["verdict"], "unjudged");
    assert_eq!(nsm["map_size"], side);
    let outside = &nsm["outside_band"];
    assert!(
        count(&outside["lit"]) + count(&outside["shadow"]) > 0,
        "{nsm}"
    );
    for cell in [rt, nsm] {
        for kind in ["shaded", "visibility", "error"] {
            let name = cell["images"][kind].as_str().unwrap();
            let picture = image::open(folder.path().join(name)).unwrap();
            assert_eq!((picture.width(), picture.height()), (side, side));
        }
    }
}

#[test]
fn open_casters_are_judged_without_culling() {
    let is_open = |case: &HardCase| case.casters == Casters::Open;
    let open = cases().into_iter().find(is_open);
    let name = open.expect("the catalogue has open cases").name;
    let report = judged(&["crsm", "nsm"], &[], name, 32);
    let cells = report["cells"].as_array().unwrap();
    let verdicts: Vec<_> = cells
        .iter()
        .map(|cell| [&cell["preset"], &cell["set"], &cell["verdict"]].map(Value::as_str))
        .collect();
    let expected = [
        [Some("crsm"), None, Some("open")],
        [Some("crsm"), Some("cull=none"), Some("pass")],
        [Some("nsm"), None, Some("unjudged")],
    ];
    assert_eq!(verdicts, expected);
}

#[test]
fn a_method_that_remembers_is_judged_in_its_steady_state() {
    let exact = ["temporal.ron".to_owned()];
    let case = judged(&["temporal.ron"], &exact, "box_on_floor", 48);
    assert_eq!(case["verdict"], "pass");
    let cells = case["cells"].as_array().unwrap();
    let verdicts: Vec<_> = cells.iter().map(|cell| &cell["verdict"]).collect();
    assert_eq!(verdicts, ["pass"]);
}

#[test]
fn outputs_that_break_the_contract_fail_their_cell_and_no_other() {
    let folder = tempfile::tempdir().unwrap();
    let odd = LIT.replace("value: 2", "value: 7");
    fs::write(folder.path().join("odd.ron"), odd).unwrap();
    let methods = method_runs(folder.path(), &["odd.ron", "rt"], &[], 16);
    let case = judge(&methods, "box_on_floor", 16, None);
    let cells = case["cells"].as_array().unwrap();
    let verdicts: Vec<_> = cells.iter().map(|cell| &cell["verdict"]).collect();
    assert_eq!(verdicts, ["fail", "pass"]);
    let failed = cells[0]["failed"].as_str().unwrap();
    assert!(failed.contains("status is 7"), "{failed}");
}
