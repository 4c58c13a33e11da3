//! The hard cases, and whether methods keep what they guarantee.

use crate::support::gpu;
use serde_json::Value;
use skiagraph_cases::{Casters, HardCase, case, cases};
use skiagraph_compare::{
    graphs::shadow_method::load_methods,
    measuring::ground_truth::PrimaryVisibility,
    measuring::hard_case::{HardCaseContext, MethodRun},
    sink::{Session, Silent},
};
use skiagraph_passes::EmbeddedSources;

/// Judges methods on a case, with viewport and maps of that side; as `stress.json` has it.
fn judged(names: &[&str], name: &str, side: u32) -> Value {
    let methods = load_methods(names, &[], &[side], &EmbeddedSources).unwrap();
    let features = gpu().device.features();
    let methods = methods.into_iter().map(|method| {
        let settled = method.at([side; 2]).settled(features);
        MethodRun::new(settled, &[]).unwrap()
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

#[test]
fn open_casters_are_judged_without_culling() {
    let folder = tempfile::tempdir().unwrap();
    let is_open = |case: &HardCase| case.casters == Casters::Open;
    let open = cases().into_iter().find(is_open);
    let name = open.expect("the catalogue has open cases").name;
    let report = judged(&["crsm", "nsm"], name, 32);
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
