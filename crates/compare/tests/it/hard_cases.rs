//! The hard cases, and whether methods keep what they guarantee.

use crate::support::{LIT, TEMPORAL, gpu, sources};
use serde_json::Value;
use skiagraph_cases::{Casters, HardCase, case, cases};
use skiagraph_compare::{
    graphs::shadow_method::load_methods,
    measuring::ground_truth::PrimaryVisibility,
    measuring::hard_case::{HardCaseContext, MethodRun},
    sink::{Session, Silent},
};
use skiagraph_passes::EmbeddedSources;
use std::{fs, path::Path};

/// Judges methods of a folder on a case, those of `exact` as exact ones, with viewport and maps of
/// that side; as `stress.json` has it.
fn judged_in(folder: &Path, names: &[&str], exact: &[String], name: &str, side: u32) -> Value {
    let methods = load_methods(names, &[], &[side], &sources(folder)).unwrap();
    let features = gpu().device.features();
    let methods = methods.into_iter().map(|method| {
        let settled = method.at([side; 2]).settled(features);
        MethodRun::new(settled, exact).unwrap()
    });
    let methods: Vec<MethodRun> = methods.collect();
    let context = HardCaseContext {
        session: Session::new(gpu(), &Silent),
        primary: &PrimaryVisibility::load(&EmbeddedSources).unwrap(),
        methods: &methods,
        viewport: [side; 2],
        pictures: None,
    };
    let case = context.run(&case(name).unwrap());
    serde_json::to_value(case.unwrap_or_else(|error| panic!("{error}"))).unwrap()
}

/// The same with the method that remembers.
fn judged(names: &[&str], exact: &[String], name: &str, side: u32) -> Value {
    judged_in(TEMPORAL.as_ref(), names, exact, name, side)
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
    let methods = ["odd.ron", "rt"];
    let case = judged_in(folder.path(), &methods, &[], "box_on_floor", 16);
    let cells = case["cells"].as_array().unwrap();
    let verdicts: Vec<_> = cells.iter().map(|cell| &cell["verdict"]).collect();
    assert_eq!(verdicts, ["fail", "pass"]);
    let failed = cells[0]["failed"].as_str().unwrap();
    assert!(failed.contains("status is 7"), "{failed}");
}
