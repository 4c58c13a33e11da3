//! `rt`, its engines and `light_buffer` where compilers differ: receivers, their places in the grid
//! and the tracer's test of a triangle are rounded in one pipeline in another way than in the
//! other. No answer need be the same to the bit; each must be right but where the oracle calls it
//! indeterminate.

use crate::{
    light_buffer::{mixed, moved},
    support::{
        bench::{Answers, Bench},
        graphs::{Extended, layered, run_files},
        random::Random,
        scenes::load,
    },
};
use glam::DVec3;
use skiagraph_graph::{LayeredSources, ParamValue, Sources};
use skiagraph_passes::{EmbeddedSources, SceneProvider};
use skiagraph_scene::{DirectionalLight, LightKind, Mesh, Scene};
use skiagraph_tests::cpu_reference::arithmetic::{Arithmetic, Rounding};
use std::sync::Arc;

/// Each result one of the two f32 around the exact one, drawn from a seed and the operands, or of a
/// division within two of the nearest, as WGSL allows. A nearest result's error is found as
/// Knuth's TwoSum and Dekker's product have it.
const EITHER: &str = r"
fn either_mixed(a: f32, b: f32) -> u32 {
    var x = (bitcast<u32>(a) ^ SEEDu) * 0x9E3779B9u;
    x = (x ^ (x >> 16u)) * 0x85EBCA6Bu;
    x = (x ^ (x >> 13u) ^ bitcast<u32>(b)) * 0xC2B2AE35u;
    return x ^ (x >> 16u);
}

// The same number, of which a compiler does not know it: it must not take sums apart.
fn either_kept(x: f32, mixed: u32) -> f32 {
    return bitcast<f32>(bitcast<u32>(x) ^ ((mixed * (mixed + 1u)) & 1u));
}

fn either_of(nearest: f32, error: f32, mixed: u32) -> f32 {
    let bits = bitcast<u32>(nearest);
    let outwards = (error > 0.0) == (nearest > 0.0);
    let other = bitcast<f32>(select(bits - 1u, bits + 1u, outwards));
    return select(nearest, other, error != 0.0 && nearest != 0.0 && (mixed & 2u) == 2u);
}

fn either_plus(a: f32, b: f32) -> f32 {
    let mixed = either_mixed(a, b);
    let sum = either_kept(a + b, mixed);
    let part = either_kept(sum - a, mixed);
    let rest = either_kept(sum - part, mixed);
    return either_of(sum, (a - rest) + (b - part), mixed);
}

fn either_plus_of(p: vec3<f32>, q: vec3<f32>) -> vec3<f32> {
    return vec3(either_plus(p.x, q.x), either_plus(p.y, q.y), either_plus(p.z, q.z));
}

fn either_split(a: f32, mixed: u32) -> vec2<f32> {
    let large = either_kept(4097.0 * a, mixed);
    let high = either_kept(large - either_kept(large - a, mixed), mixed);
    return vec2(high, a - high);
}

fn either_times(a: f32, b: f32) -> f32 {
    let mixed = either_mixed(a, b);
    let product = either_kept(a * b, mixed);
    let x = either_split(a, mixed);
    let y = either_split(b, mixed);
    let error = ((x.x * y.x - product) + x.x * y.y + x.y * y.x) + x.y * y.y;
    return either_of(product, error, mixed);
}

fn either_over(a: f32, b: f32) -> f32 {
    let mixed = either_mixed(a, b);
    let quotient = a / b;
    let other = bitcast<f32>(bitcast<u32>(quotient) + (mixed >> 8u) % 5u - 2u);
    return select(quotient, other, quotient != 0.0);
}
";

/// Replacements in each of the shaders. Sums of three are in another order, too.
const ALTERED: [(&str, &[(&str, &str)]); 4] = [
    (
        "shaders/shared/predicates.wgsl",
        &[
            (
                "let product = lesser.x * greater.y;",
                "let product = either_times(lesser.x, greater.y);",
            ),
            (
                "let area = product - lesser.y * greater.x;",
                "let area = either_plus(product, -either_times(lesser.y, greater.x));",
            ),
        ],
    ),
    (
        "shaders/shared/ray_corners.wgsl",
        &[
            (
                "vec3(d.xy, 1.0) / d.z",
                "vec3(either_over(d.x, d.z), either_over(d.y, d.z), either_over(1.0, d.z))",
            ),
            (
                "let p = permute(corner - ray.origin, ray.longest);",
                "let p = permute(either_plus_of(corner, -ray.origin), ray.longest);",
            ),
            (
                "vec3(p.xy - ray.shear.xy * p.z, ray.shear.z * p.z)",
                "vec3(
                    either_plus(p.x, -either_times(ray.shear.x, p.z)),
                    either_plus(p.y, -either_times(ray.shear.y, p.z)),
                    either_times(ray.shear.z, p.z),
                )",
            ),
            (
                "let sum = weights.x + weights.y + weights.z;",
                "let sum = either_plus(weights.x, either_plus(weights.y, weights.z));",
            ),
            (
                "let barycentric = weights / sum;",
                "let barycentric = vec3(
                    either_over(weights.x, sum),
                    either_over(weights.y, sum),
                    either_over(weights.z, sum),
                );",
            ),
            (
                "let t = dot(barycentric, vec3(a.z, b.z, c.z));",
                "let t = either_plus(
                    either_times(barycentric.x, a.z),
                    either_plus(
                        either_times(barycentric.y, b.z),
                        either_times(barycentric.z, c.z),
                    ),
                );",
            ),
        ],
    ),
    // Receivers themselves.
    (
        "shaders/shared/drawn_receiver.wgsl",
        &[
            (
                "var place = world + (weights.y * (b - a) + weights.z * (c - a));",
                "var place = either_plus_of(world, weights.y * (b - a) + weights.z * (c - a));",
            ),
            (
                "corner_position(3u * id + 1u) + (weights.z * (c - b) + weights.x * (a - b));",
                "either_plus_of(
                    corner_position(3u * id + 1u),
                    weights.z * (c - b) + weights.x * (a - b),
                );",
            ),
            (
                "corner_position(3u * id + 2u) + (weights.x * (a - c) + weights.y * (b - c));",
                "either_plus_of(
                    corner_position(3u * id + 2u),
                    weights.x * (a - c) + weights.y * (b - c),
                );",
            ),
        ],
    ),
    // Where a receiver asks: marked by one arithmetic, sought by another. 1 - 2^-24 times a number
    // lies between it and its neighbour.
    (
        "shaders/shared/asked_list.wgsl",
        &[(
            "let place = place_of(receiver, light_clip_summands_of_scene());",
            "let place = place_of(
                vec3(
                    either_times(receiver.x, 0.99999994),
                    either_times(receiver.y, 0.99999994),
                    either_times(receiver.z, 0.99999994),
                ),
                light_clip_summands_of_scene(),
            );",
        )],
    ),
];

fn either(seed: u32) -> String {
    EITHER.replace("SEED", &seed.to_string())
}

/// Paths and texts of the files in which results are rounded in another way.
pub fn altered_files(seed: u32) -> Vec<(String, String)> {
    let mut files = vec![("shaders/shared/either.wgsl".to_owned(), either(seed))];
    for (path, replaced) in ALTERED {
        let text = EmbeddedSources.read(path).unwrap().unwrap();
        let mut text = format!("#import \"shared/either.wgsl\"\n{text}");
        for (from, to) in replaced {
            assert_eq!(text.matches(from).count(), 1, "{path}: {from}");
            text = text.replace(from, to);
        }
        files.push((path.to_owned(), text));
    }
    files
}

/// The embedded files, but for what is rounded in another way.
fn altered(seed: u32) -> LayeredSources {
    let files = altered_files(seed);
    let files: Vec<(&str, &str)> = files
        .iter()
        .map(|(path, text)| (path.as_str(), text.as_str()))
        .collect();
    layered(&files)
}

/// Pixels of a scene.
#[derive(Default)]
struct Pixels {
    judged: usize,
    /// With two answers that differ.
    differing: usize,
    indeterminate: usize,
    /// That the lists answer, of all pipelines.
    listed: usize,
}

/// Runs the methods as they are and twice altered, and holds each against the oracle.
fn judged(scene: &Arc<Scene>, viewport: [u32; 2], pixels: &mut Pixels) {
    let mut bench = Bench::new(scene, viewport);
    let mut answers = Vec::new();
    let mut methods = vec![("rt", "hierarchy"), ("light_buffer", "hierarchy")];
    if matches!(scene.light(), LightKind::Directional(_)) {
        methods.push(("rt", "light_space"));
    }
    for (method, engine) in methods {
        let params = [("engine", ParamValue::Choice(engine.to_owned()))];
        for seed in [0, 1, 2] {
            let answer = match seed {
                0 => bench.answers(method, &params),
                seed => bench.answers_with(&altered(seed), method, &params),
            };
            let wrong = &answer.counts.wrong;
            assert_eq!(
                wrong.total - wrong.in_band,
                0,
                "{} {method} {engine}, altered by {seed}: {:?}",
                scene.name,
                answer.counts
            );
            answers.push(answer);
        }
    }
    let truth = &answers[0].truth;
    let seen = |pixel: &usize| {
        let first = answers[0].visibility[*pixel];
        answers
            .iter()
            .any(|other| other.visibility[*pixel] != first)
    };
    let differing: Vec<usize> = (0..answers[0].visibility.len()).filter(seen).collect();
    let outside = differing.iter().find(|&&p| !truth.indeterminate[p]);
    assert_eq!(outside, None, "{}: a determinate pixel differs", scene.name);
    pixels.judged += truth.indeterminate.len();
    pixels.differing += differing.len();
    pixels.indeterminate += truth.indeterminate.iter().filter(|it| **it).count();
    pixels.listed += answers[3..6].iter().map(Answers::certain).sum::<usize>();
}

#[test]
fn pipelines_that_round_apart_are_right_but_where_it_is_indeterminate() {
    let mut pixels = Pixels::default();
    judged(&mixed(1), [96, 64], &mut pixels);
    // Where f32 cannot tell of a tenth of the pixels.
    judged(&moved(&mixed(4), 3e4), [96, 64], &mut pixels);
    for name in [
        "stack_gap_one_ulp",
        "light_nearly_along_a_wall",
        "receivers_on_texel_corners",
    ] {
        let case = skiagraph_cases::case(name).unwrap();
        judged(&Arc::new(case.scene()), [64, 64], &mut pixels);
    }
    let Pixels {
        judged,
        differing,
        indeterminate,
        listed,
    } = pixels;
    println!("{differing} of {judged} pixels differ, {indeterminate} are indeterminate");
    assert!(listed > 10_000, "{listed}");
    assert!(differing > 0, "the altered arithmetic altered nothing");
}

#[test]
#[ignore = "a suite: `./test.sh --all` runs it"]
fn pipelines_that_round_apart_are_right_in_every_case_and_view() {
    let mut pixels = Pixels::default();
    for case in skiagraph_cases::cases() {
        judged(&Arc::new(case.scene()), [64, 64], &mut pixels);
    }
    let park = load("park");
    for view in &park.views {
        let scene = Scene {
            views: vec![view.clone()],
            ..(*park).clone()
        };
        judged(&Arc::new(scene), [128, 96], &mut pixels);
    }
    let Pixels {
        judged,
        differing,
        indeterminate,
        listed,
    } = pixels;
    println!("{differing} of {judged} pixels differ, {indeterminate} are indeterminate");
    assert!(listed > 100_000, "{listed}");
}

/// Laid out as the shader's below.
#[repr(C)]
#[derive(Clone, Copy, Debug, bytemuck::Pod, bytemuck::Zeroable)]
struct Results {
    sum: f32,
    product: f32,
    quotient: f32,
    padding: f32,
}

const SHADER: &str = r#"
#import "shared/either.wgsl"

var<storage, read> test_operands: array<vec2<f32>>;
var<storage, read_write> results: array<vec4<f32>>;

@compute @workgroup_size(64)
fn main(@builtin(global_invocation_id) thread: vec3<u32>) {
    if thread.x >= arrayLength(&results) {
        return;
    }
    let asked = test_operands[thread.x];
    results[thread.x] = vec4(
        either_plus(asked.x, asked.y),
        either_times(asked.x, asked.y),
        either_over(asked.x, asked.y),
        0.0,
    );
}
"#;

const DOCUMENT: &str = r#"(
    format: 3,
    description: "operands in, results out",
    materials: [Buffer(name: "results", count: "test.operands.count")],
    passes: [Compute(name: "evaluate", dispatch: Over("test.operands.count"))],
    outputs: ["results"],
)"#;

/// The other arithmetic is one that WGSL allows, and not the adapter's own.
#[test]
fn altered_results_are_either_neighbour() {
    let mut random = Random(5);
    let operands: Vec<[f32; 2]> = (0..20_000)
        .map(|i| {
            let size = [1.0, 1e-3, 1e4][i % 3];
            [random.signed(), size * random.signed()]
        })
        .collect();
    let mut provider = Extended::new(SceneProvider::new(Arc::new(Scene {
        name: "test".into(),
        mesh: Mesh::default(),
        views: vec![],
        lights: vec![DirectionalLight::new(DVec3::NEG_Y).into()],
    })));
    provider.add("test.operands", &operands);
    let either = either(1);
    let files = [
        ("test.ron", DOCUMENT),
        ("shaders/evaluate.wgsl", SHADER),
        ("shaders/shared/either.wgsl", &either),
    ];
    let results: Vec<Results> =
        bytemuck::pod_collect_to_vec(&run_files(&files, &mut provider, "results"));
    let [down, up] = [Rounding::Down, Rounding::Up].map(|rounding| Arithmetic {
        rounding,
        ..Arithmetic::PLAIN
    });
    let mut other = [0; 3];
    for (&[a, b], result) in operands.iter().zip(&results) {
        let case = format!("{a} {b}: {result:?}");
        assert!(
            [down, up].iter().any(|by| by.add(a, b) == result.sum),
            "{case}"
        );
        assert!(
            [down, up].iter().any(|by| by.mul(a, b) == result.product),
            "{case}"
        );
        let near = i64::from((a / b).to_bits()) - i64::from(result.quotient.to_bits());
        assert!(a == 0.0 || b == 0.0 || near.abs() <= 3, "{case}");
        other[0] += usize::from(result.sum != a + b);
        other[1] += usize::from(result.product != a * b);
        other[2] += usize::from(result.quotient != a / b);
    }
    // About half of those that f32 does not hold.
    assert!(other.iter().all(|&count| count > 4_000), "{other:?}");
}
