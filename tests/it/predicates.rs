//! The predicates on the GPU against their CPU reference: every answer is one that some arithmetic
//! yields which WGSL allows, so neither can change alone.

use crate::support::{
    graphs::{Extended, run_files},
    random::Random,
};
use glam::DVec3;
use skiagraph_passes::SceneProvider;
use skiagraph_scene::{DirectionalLight, Mesh, Scene};
use skiagraph_tests::cpu_reference::{
    arithmetic::Rounding,
    predicates::{Arithmetic, HALF_ULP, bbox_contains},
};
use std::sync::Arc;

/// Laid out as the shader's below.
#[repr(C)]
#[derive(Clone, Copy, Debug, bytemuck::Pod, bytemuck::Zeroable)]
struct Question {
    edge: [[f32; 2]; 2],
    point: [f32; 2],
    numbers: [u32; 2],
}

/// Laid out as the shader's below.
#[repr(C)]
#[derive(Clone, Copy, Debug, bytemuck::Pod, bytemuck::Zeroable)]
struct Answer {
    edge_area: f32,
    inward_distance: f32,
    side: f32,
    receiver_error_bound: f32,
    overlaps: u32,
    left: u32,
    contains: u32,
    padding: u32,
}

const SHADER: &str = r#"
#import "shared/predicates.wgsl"

struct Question {
    p: vec2<f32>,
    q: vec2<f32>,
    point: vec2<f32>,
    numbers: vec2<u32>,
}

struct Answer {
    edge_area: f32,
    inward_distance: f32,
    side: f32,
    receiver_error_bound: f32,
    overlaps: u32,
    left: u32,
    contains: u32,
    padding: u32,
}

var<storage, read> test_questions: array<Question>;
var<storage, read_write> answers: array<Answer>;

@compute @workgroup_size(64)
fn main(@builtin(global_invocation_id) thread: vec3<u32>) {
    if thread.x >= arrayLength(&answers) {
        return;
    }
    let asked = test_questions[thread.x];
    let p = asked.p;
    let q = asked.q;
    answers[thread.x] = Answer(
        edge_area(p, q),
        inward_distance(p, q, asked.point, f32(asked.numbers.x) - f32(asked.numbers.y)),
        side_of_edge(p, q, asked.point),
        receiver_error_bound(vec3(p, q.x), vec3(asked.point, q.y)),
        u32(edge_overlaps_texel(p, q, asked.point)),
        u32(left_of(asked.numbers.x, asked.numbers.y, p, q, asked.point)),
        u32(bbox_contains(p - asked.point, q - asked.point, q - p)),
        0u,
    );
}
"#;

const DOCUMENT: &str = r#"(
    format: 3,
    description: "questions in, answers out",
    materials: [Buffer(name: "answers", count: "test.questions.count")],
    passes: [Compute(name: "judge", dispatch: Over("test.questions.count"))],
    outputs: ["answers"],
)"#;

fn asked(questions: &[Question]) -> Vec<Answer> {
    let mut provider = Extended::new(SceneProvider::new(Arc::new(Scene {
        name: "test".into(),
        mesh: Mesh::default(),
        views: vec![],
        lights: vec![DirectionalLight::new(DVec3::NEG_Y).into()],
    })));
    provider.add("test.questions", questions);
    let files = [("test.ron", DOCUMENT), ("shaders/judge.wgsl", SHADER)];
    bytemuck::pod_collect_to_vec(&run_files(&files, &mut provider, "answers"))
}

/// Edges with a point on the line, on a texel's border, a hair off either, or anywhere.
fn questions(count: u32) -> Vec<Question> {
    let mut random = Random(7);
    let mut place = |size: f32, step: f32| {
        [random.unit(), random.unit()].map(|c| (c * size / step).floor() * step)
    };
    (0..count)
        .map(|i| {
            let step = [0.5, 1.0, 1.0 / 256.0, 1.0 / 4096.0][i as usize % 4];
            let size = [8.0, 64.0, 4096.0][i as usize / 4 % 3];
            let (p, mut q) = (place(size, step), place(size, step));
            if i % 7 == 0 {
                // All but in line with the origin.
                q = p.map(|c| c * 1.3);
            }
            if q == p {
                q[0] += 1.0;
            }
            let [share, aside] = place(1.0, 1.0 / 16.0);
            // 0, or at most four times what a point must be clear of an edge by.
            let aside = (aside - 0.5) * if i % 2 == 0 { 0.0 } else { 0.032 };
            let edge = [q[0] - p[0], q[1] - p[1]];
            let length = edge[0].hypot(edge[1]);
            let point = if i % 5 == 0 {
                place(size, step)
            } else {
                [
                    p[0] + edge[0] * share - edge[1] / length * aside,
                    p[1] + edge[1] * share + edge[0] / length * aside,
                ]
            };
            Question {
                edge: [p, q],
                point,
                numbers: [[1, 2], [2, 1]][i as usize / 2 % 2],
            }
        })
        .collect()
}

#[test]
fn the_gpu_answers_as_some_allowed_arithmetic_does() {
    let questions = questions(60_000);
    let answers = asked(&questions);
    assert_eq!(answers.len(), questions.len());
    let (mut sides, mut lefts, mut met) = ([0; 3], [0; 2], [0; 2]);
    // Nothing else that WGSL allows can be enumerated.
    let allowed = [
        Rounding::Nearest,
        Rounding::ToZero,
        Rounding::Down,
        Rounding::Up,
    ];
    let allowed = allowed.map(Arithmetic::rounding);
    for (question, answer) in questions.iter().zip(&answers) {
        let &Question {
            edge: [p, q],
            point,
            numbers,
        } = question;
        let some = |holds: &dyn Fn(Arithmetic) -> bool| {
            allowed
                .iter()
                .flatten()
                .any(|&arithmetic| holds(arithmetic))
        };
        let case = format!("{question:?}: {answer:?}");
        assert!(some(&|a| a.edge_area(p, q) == answer.edge_area), "{case}");
        assert!(
            some(&|a| a.edge_overlaps_texel(p, q, point) == (answer.overlaps == 1)),
            "{case}"
        );
        assert!(
            some(&|a| a.left_of(numbers, [p, q], point) == (answer.left == 1)),
            "{case}"
        );
        assert!(
            some(&|a| a.side_of_edge([p, q], point) == answer.side),
            "{case}"
        );
        let area = numbers[0] as f32 - numbers[1] as f32;
        // Error bound of either, as the shader says.
        let away = (point[0] - p[0]).hypot(point[1] - p[1]);
        let near = |a: Arithmetic| {
            let expected = a.inward_distance([p, q], point, area, 0);
            let bound = 2.0 * HALF_ULP * (3.0 * away + 8.0 * expected.abs());
            (expected - answer.inward_distance).abs() <= bound
        };
        assert!(some(&near), "{case}");
        let eye = [point[0], point[1], q[1]];
        let own = Arithmetic::PLAIN.receiver_error_bound([p[0], p[1], q[0]], eye);
        assert!(
            (own - answer.receiver_error_bound).abs() <= 1e-5 * own,
            "{case}"
        );
        let around = [
            [p[0] - point[0], p[1] - point[1]],
            [q[0] - point[0], q[1] - point[1]],
            [q[0] - p[0], q[1] - p[1]],
        ];
        assert_eq!(bbox_contains(around), answer.contains == 1, "{case}");
        sides[(answer.side + 1.0) as usize] += 1;
        lefts[answer.left as usize] += 1;
        met[answer.overlaps as usize] += 1;
    }
    let least = sides.iter().chain(&lefts).chain(&met).min();
    assert!(least > Some(&3000), "{sides:?} {lefts:?} {met:?}");
}
