//! Params that only uniforms hold get another value without another plan.

use crate::support::{Files, plan, right};
use skiagraph_graph::{ParamValue, Plan};

/// One param of each kind of use; the document `blur` is included twice.
fn uses() -> Files {
    Files::graph(
        r#"
    params: [
        F32(name: "gain", default: 1, max: 100),
        F32(name: "width", default: 3),
        F32(name: "handed_on", default: 5),
        F32(name: "computed_with", default: 7),
        F32(name: "asked_by_a_default", default: 9),
        F32(name: "defaulted", default: "asked_by_a_default * 2"),
        U32(name: "items", default: 4, min: 1),
        U32(name: "constant", default: 1),
        Bool(name: "more", default: true),
        Choice(name: "kind", words: [one, other], default: one),
    ],
    materials: [Buffer(name: "list", count: "items"), Buffer(name: "sum")],
    passes: [
        Compute(name: "fill", dispatch: Over("list.count")),
        Include(
            name: "first", graph: "blur.ron",
            set: {"radius": "handed_on"}, bind: {"into": "list"},
        ),
        Include(
            name: "again", graph: "blur.ron",
            set: {"radius": "computed_with * 2"}, bind: {"into": "list"},
        ),
        Compute(name: "add", run: When("more"), dispatch: Groups(1, 1, 1)),
    ],
    outputs: ["list", "sum"],
"#,
    )
    .with(
        "fill.wgsl",
        "struct Params { gain: f32, width: f32, kind: u32, defaulted: f32, asked_by_a_default: f32 }
         var<uniform> params: Params;
         var<storage, read_write> list: array<u32>;
         override constant: u32;
         @compute @workgroup_size(64) fn main(@builtin(global_invocation_id) id: vec3<u32>) {
             list[id.x] = constant + u32(params.gain + params.width) + params.kind;
         }",
    )
    .with(
        "add.wgsl",
        "struct Params { gain: f32 }
         var<uniform> params: Params;
         var<storage, read> list: array<u32>;
         var<storage, read_write> sum: u32;
         @compute @workgroup_size(1) fn main() { sum = u32(params.gain) + list[0]; }",
    )
    .with(
        "blur.ron",
        r#"(format: 3, params: [F32(name: "radius")], inputs: [Buffer(name: "into")],
            passes: [Compute(name: "blur", dispatch: Groups(1, 1, 1))], outputs: ["into"])"#,
    )
    .with(
        "blur.wgsl",
        "struct Params { radius: f32 }
         var<uniform> params: Params;
         var<storage, read_write> into: array<u32>;
         @compute @workgroup_size(1) fn main() { into[0] = into[0] + u32(params.radius); }",
    )
}

/// The uniforms of the live passes, pass by pass.
fn uniforms(plan: &Plan) -> Vec<Vec<Option<&[u8]>>> {
    plan.live().map(|pass| pass.params().collect()).collect()
}

#[test]
fn a_value_that_only_uniforms_hold_is_written_into_them() {
    let cases: [(&str, ParamValue, Option<&[&str]>); 10] = [
        ("gain", ParamValue::F32(2.0), Some(&["fill", "add"])),
        ("width", ParamValue::F32(2.0), Some(&["fill"])),
        ("handed_on", ParamValue::F32(2.0), Some(&["first.blur"])),
        ("computed_with", ParamValue::F32(2.0), None),
        ("asked_by_a_default", ParamValue::F32(2.0), None),
        ("defaulted", ParamValue::F32(2.0), Some(&["fill"])),
        ("items", ParamValue::U32(9), None),
        ("constant", ParamValue::U32(9), None),
        ("more", ParamValue::Bool(false), None),
        ("kind", ParamValue::Choice("other".into()), None),
    ];
    for (name, value, passes) in cases {
        let mut set = right(plan(&uses()));
        let anew = right(set.with_param(name, value.clone()));
        assert_eq!(set.is_in_uniforms(name, &value), passes.is_some(), "{name}");
        let changed = set.set_in_uniforms(name, value.clone());
        let live: Vec<&str> = set.live().map(|pass| pass.name.as_str()).collect();
        let changed: Vec<&str> = changed.into_iter().map(|at| live[at]).collect();
        assert_eq!(changed, passes.unwrap_or_default(), "{name}");
        if passes.is_some() {
            assert_eq!(uniforms(&set), uniforms(&anew), "{name}");
            assert_eq!(set.param(name), Some(&value), "{name}");
            // The next plan starts from the new value.
            let wide = right(set.with_viewport([9, 9]));
            assert_eq!(wide.param(name), Some(&value), "{name}");
            assert!(set.set_in_uniforms(name, value).is_empty(), "{name}: twice");
        }
    }
}

#[test]
fn a_value_that_the_param_cannot_have_is_not_written() {
    let plan = right(plan(&uses()));
    for value in [ParamValue::F32(101.0), ParamValue::U32(1)] {
        assert!(!plan.is_in_uniforms("gain", &value), "{value}");
    }
    assert!(!plan.is_in_uniforms("none", &ParamValue::F32(1.0)));
}
