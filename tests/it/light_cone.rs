//! The planes of `shaders/shared/light_cone.wgsl` on the GPU: a sample of a light that they call
//! hidden, or not hidden, is so in f64 and for the tracer's own test of its ray; and the boxes of
//! `shaders/shared/caster_box.wgsl`: a sample that a caster hides for either is in its box. Bounds:
//! docs/light_buffer_area.md.

use crate::{
    compiled_apart::altered_files,
    support::{
        graphs::{Extended, run_files},
        meshes,
        random::Random,
    },
};
use glam::{DMat3, DVec3, Vec3};
use skiagraph_graph::Sources;
use skiagraph_passes::{
    EmbeddedSources, SceneProvider,
    uniforms::{LightAreaUniform, LightUniform},
};
use skiagraph_scene::{DirectionalLight, LIGHT_GAP, LightKind, Mesh, PointLight, Scene, SpotLight};
use skiagraph_tests::cpu_reference::predicates::HALF_ULP;
use std::{array::from_fn, sync::Arc};

/// Samples of a question.
const SAMPLES: usize = 8;

/// A triangle and a receiver; the triangle's number is the question's. Laid out as the shader's
/// below.
#[repr(C)]
#[derive(Clone, Copy, Debug, bytemuck::Pod, bytemuck::Zeroable)]
struct Question {
    receiver: [f32; 3],
    t_min: f32,
    points: [[f32; 2]; SAMPLES],
}

/// Samples by bits. Laid out as the shader's below.
#[repr(C)]
#[derive(Clone, Copy, Debug, bytemuck::Pod, bytemuck::Zeroable)]
struct Answer {
    hidden: u32,
    seen: u32,
    traced: u32,
    boxed: u32,
    error: f32,
}

/// Before it stand the function of `test_samples.wgsl` that asks the tracer, and that of
/// `box_casters.wgsl`.
const SHADER: &str = r#"
struct Question {
    receiver: vec3<f32>,
    t_min: f32,
    points: array<vec2<f32>, 8>,
}

struct Answer {
    hidden: u32,
    seen: u32,
    traced: u32,
    boxed: u32,
    error: f32,
}

var<storage, read> test_questions: array<Question>;
var<storage, read_write> answers: array<Answer>;

@compute @workgroup_size(64)
fn main(@builtin(global_invocation_id) thread: vec3<u32>) {
    let primitive = thread.x;
    if primitive >= arrayLength(&answers) {
        return;
    }
    let asked = test_questions[primitive];
    let sight = sight_of(asked.receiver, asked.t_min);
    let cone = cone_of(sight, primitive);
    var points = asked.points;
    var traced = 0u;
    var boxed = 0u;
    var sides = vec2(0u);
    let own = unpacked_box(packed_box(box_of(primitive)));
    let box = coarse_box(own, place_along_light(asked.receiver));
    for (var i = 0u; i < 8u; i++) {
        let point = seen_point(sight, points[i]);
        sides |= (sides_of(cone, vec4(point.x), vec4(point.y)) & vec2(1u)) << vec2(i);
        traced |= u32(hides(asked.receiver, asked.t_min, primitive, points[i])) << i;
        // In pairs, as `samples_under` has them.
        let other = seen_point(sight, points[i ^ 1u]);
        boxed |= (bits_between(coarse_word(point, other), box) >> 15u & 1u) << i;
    }
    if light_kind != LIGHT_DIRECTIONAL {
        boxed = 0xffffffffu;
    } else if box.is_behind {
        boxed = 0u;
    }
    // As `lit_samples` has it.
    let certain = select(0u, sides.x, cone.is_clear);
    let unsure = ~certain & sides.y;
    answers[primitive] = Answer(
        select(certain, 0u, cone.is_beside),
        select(~certain & ~unsure, 0xffffffffu, cone.is_beside),
        traced,
        boxed,
        cone.error,
    );
}
"#;

const DOCUMENT: &str = r#"(
    format: 3,
    description: "triangles and receivers in, answers out",
    materials: [Buffer(name: "answers", count: "test.questions.count")],
    passes: [Compute(name: "judge", dispatch: Over("test.questions.count"))],
    outputs: ["answers"],
    lights: [directional, spot, point],
)"#;

/// A function of an embedded shader, as it stands there.
fn function(path: &str, name: &str) -> String {
    let text = EmbeddedSources.read(path).unwrap().unwrap();
    let begin = text.find(&format!("\nfn {name}("));
    let begin = begin.unwrap_or_else(|| panic!("{path} has no function {name}"));
    let length = text[begin..].find("\n}\n").unwrap();
    text[begin..begin + length + 3].to_owned()
}

fn shader() -> String {
    let modules = [
        "ids",
        "aimed_ray",
        "caster_box",
        "light_cone",
        "ray_triangle",
    ];
    let mut text: String = modules
        .map(|module| format!("#import \"shared/{module}.wgsl\"\n"))
        .concat();
    text += &function("shaders/test_samples.wgsl", "hides");
    text += &function("shaders/box_casters.wgsl", "box_of");
    text + SHADER
}

/// A light with its numbers as shaders have them.
struct Emitter {
    kind: LightKind,
    uniform: LightUniform,
    area: LightAreaUniform,
}

/// The light as a receiver sees it, in f64.
struct Sight {
    /// To the light's centre; of a directional light, of length 1.
    centre: DVec3,
    /// From there to the rim.
    across: [DVec3; 2],
    is_place: bool,
    max_distance: f64,
}

impl Emitter {
    fn new(kind: LightKind, mesh: &Mesh) -> Self {
        Self {
            kind,
            uniform: LightUniform::new(kind, mesh),
            area: LightAreaUniform::from(&kind),
        }
    }

    fn seen_from(&self, receiver: Vec3) -> Sight {
        let (light, area) = (&self.uniform, &self.area);
        let rim = [area.right, area.up].map(Vec3::as_dvec3);
        let place = light.position.as_dvec3() + light.position_low.as_dvec3();
        let way = place - receiver.as_dvec3();
        let (centre, across) = match (self.kind.position(), self.kind.direction()) {
            (None, _) => (light.to_light.as_dvec3(), rim),
            (_, Some(_)) => (way, rim),
            (_, None) => {
                let to_light = way.normalize();
                let helper = if to_light.x.abs() > 0.5 {
                    DVec3::Y
                } else {
                    DVec3::X
                };
                let x = to_light.cross(helper).normalize();
                let radius = f64::from(area.radius);
                (way, [x * radius, x.cross(to_light) * radius])
            }
        };
        Sight {
            centre,
            across,
            is_place: self.kind.position().is_some(),
            max_distance: f64::from(light.max_distance),
        }
    }
}

impl Sight {
    fn towards(&self, [x, y]: [f64; 2]) -> DVec3 {
        self.centre + self.across[0] * x + self.across[1] * y
    }

    /// The point of the disk in the direction of a place relative to the receiver.
    fn point_before(&self, place: DVec3) -> Option<[f64; 2]> {
        let matrix = DMat3::from_cols(place, -self.across[0], -self.across[1]);
        let hit = matrix.inverse() * self.centre;
        let is_on_disk = hit.x > 0.0 && hit.y.hypot(hit.z) <= 1.0;
        is_on_disk.then_some([hit.y, hit.z])
    }

    /// Traces the ray to a point of the disk through a triangle whose corners are relative to the
    /// receiver. Products hold a difference of corners, or f64 would not tell a small triangle far
    /// away.
    fn exact(&self, corners: [DVec3; 3], point: [f64; 2], t_min: f64) -> Exact {
        let way = self.towards(point);
        let [a, b, c] = corners;
        let edges = [(a, b), (b, c), (c, a)].map(|(p, q)| way.dot(p.cross(q - p)));
        let inside = edges.iter().all(|&e| e > 0.0) || edges.iter().all(|&e| e < 0.0);
        let normal = (b - a).cross(c - a);
        let (length, t) = (way.length(), a.dot(normal) / way.dot(normal));
        let (t, t_max) = if self.is_place {
            (t * length, length * (1.0 - LIGHT_GAP))
        } else {
            (t, self.max_distance)
        };
        let to_light = self.centre.normalize();
        let depths = corners.map(|corner| corner.dot(to_light));
        let beside = corners.map(|corner| corner.reject_from(to_light).length());
        let size = corners.map(DVec3::length).into_iter().fold(0.0, f64::max);
        let radius = self.across[0].length() / self.centre.length();
        // Distances of hits err by less.
        let room = 3.0 * (beside.into_iter().fold(0.0, f64::max) + radius * size);
        let is_between = depths
            .iter()
            .all(|depth| depth - room > t_min && depth + room < t_max);
        let nearest = edges.iter().map(|e| e.abs()).fold(f64::INFINITY, f64::min);
        Exact {
            hit: inside && t > t_min && t <= t_max,
            is_between,
            nearest: nearest / way.dot(to_light),
        }
    }
}

/// The answer of a ray in f64.
struct Exact {
    hit: bool,
    /// True if all of the triangle is between receiver and light, so that edges alone decide.
    is_between: bool,
    /// Edge function of the nearest edge, in the plane across the way to the light's centre.
    nearest: f64,
}

/// Numbers that are drawn.
struct Dice(Random);

impl Dice {
    /// All powers of ten between two alike.
    fn power(&mut self, low: f64, high: f64) -> f64 {
        10f64.powf(low + (high - low) * f64::from(self.0.unit()))
    }

    fn signed(&mut self) -> f64 {
        f64::from(self.0.signed())
    }

    fn vector(&mut self) -> DVec3 {
        self.0.vector().as_dvec3()
    }

    fn receiver(&mut self, emitter: &Emitter) -> Vec3 {
        let Some(place) = emitter.kind.position() else {
            return (self.vector() * self.power(-1.0, 2.0)).as_vec3();
        };
        // Within twice the radius of a lamp receivers ask rays.
        let distance = f64::from(emitter.area.radius) / self.power(-4.0, -0.31);
        let mut from_light = self.vector().normalize();
        if let LightKind::Spot(spot) = emitter.kind {
            let axis = spot.direction.normalize();
            let ahead = from_light.dot(axis);
            from_light += axis * (ahead.abs().max(0.05) - ahead);
        }
        (place + from_light.normalize() * distance).as_vec3()
    }

    /// Corners around a place that is seen before the light, or about so: of all shapes, behind the
    /// receiver, around it, and as near to it as hits begin to count.
    fn corners(&mut self, sight: &Sight, receiver: Vec3, t_min: f64, shape: u32) -> [Vec3; 3] {
        let length = sight.centre.length();
        let aim = sight.towards([self.signed() * 1.2, self.signed() * 1.2]) / length;
        let far = if sight.is_place { 0.2 } else { 2.0 };
        let mut away = length * self.power(-2.5, far);
        if shape == 5 {
            away = t_min * self.power(-1.0, 3.0);
        }
        let radius = sight.across[0].length() / length;
        let seen = if self.0.unit() < 0.5 { radius } else { 1.0 };
        let mut size = away * seen * self.power(-2.5, 0.7);
        if shape >= 4 {
            size = away * self.power(-1.0, 1.5);
        }
        if shape == 4 {
            away *= self.signed();
        }
        let middle = receiver.as_dvec3() + aim * away;
        let mut corners = [(); 3].map(|()| self.vector());
        let thin = self.power(-7.0, -2.0);
        if shape == 2 {
            corners[2] = corners[0].lerp(corners[1], self.signed()) + corners[2] * thin;
        }
        if shape == 3 {
            // All but edge-on.
            let beside = self.vector();
            let within = [(); 3].map(|()| aim * self.signed() + beside * self.signed());
            corners = from_fn(|i| within[i] + corners[i] * thin);
        }
        corners.map(|corner| (middle + corner * size).as_vec3())
    }

    /// Points of the disk: anywhere, at an edge, and a little beside one.
    fn points(&mut self, sight: &Sight, corners: [DVec3; 3]) -> [[f32; 2]; SAMPLES] {
        from_fn(|number| {
            let (i, along) = (number % 3, f64::from(self.0.unit()) * 1.4 - 0.2);
            let at_edge = sight.point_before(corners[i].lerp(corners[(i + 1) % 3], along));
            let off = self.power(-9.0, -1.0);
            let beside = at_edge.map(|[x, y]| [x + off * self.signed(), y + off * self.signed()]);
            let point = beside.filter(|[x, y]| number < 6 && x.hypot(*y) <= 1.0);
            point
                .unwrap_or_else(|| {
                    let (turn, away) = (self.signed() * 3.2, f64::from(self.0.unit()).sqrt());
                    [turn.cos() * away, turn.sin() * away]
                })
                .map(|c| c as f32)
        })
    }
}

/// Samples that were judged.
#[derive(Debug, Default)]
struct Judged {
    hidden: usize,
    seen: usize,
    asked: usize,
    /// Sure ones of which f64, or the tracer, says the other.
    wrong: usize,
    refuted: usize,
    /// Samples that boxes leave out, and those of them that the caster hides in f64 or for the
    /// tracer.
    outside: usize,
    lost: usize,
    /// Greatest edge function at which the tracer errs, as a share of the bound.
    farthest: f64,
    first: Option<String>,
}

/// Judges the samples of random triangles under a light, in a box that reaches so far; `files`
/// stand before the embedded ones.
fn judge(
    kind: LightKind,
    (count, reach): (u32, f32),
    files: &[(String, String)],
    judged: &mut Judged,
) {
    let mut dice = Dice(Random(count.into()));
    let ends = [Vec3::splat(-reach), Vec3::splat(reach)];
    let box_around = meshes::mesh(
        vec![ends[0], ends[1], Vec3::new(reach, -reach, 0.0)],
        vec![[0, 1, 2]],
    );
    let emitter = Emitter::new(kind, &box_around);
    let (mut positions, mut questions) = (box_around.positions, Vec::new());
    for number in 0..count {
        let receiver = dice.receiver(&emitter);
        let sight = emitter.seen_from(receiver);
        let t_min = HALF_ULP * (receiver.length() + 2.0 * dice.power(0.0, 2.0) as f32);
        let drawn = dice.corners(&sight, receiver, t_min.into(), number % 6);
        let corners = drawn.map(|corner| corner.clamp(ends[0], ends[1]));
        let relative = corners.map(|corner| corner.as_dvec3() - receiver.as_dvec3());
        // The first triangle is the box around all.
        positions.extend(corners.iter().filter(|_| number > 0));
        questions.push(Question {
            receiver: receiver.to_array(),
            t_min,
            points: dice.points(&sight, relative),
        });
    }
    let triangles = (0..count).map(|i| [3 * i, 3 * i + 1, 3 * i + 2]);
    let mesh = meshes::mesh(positions, triangles.collect());
    // The bound is stated for wider suns than a scene may have.
    let lights = vec![match kind {
        LightKind::Directional(sun) => DirectionalLight::new(sun.direction).into(),
        lamp => lamp.into(),
    }];
    let scene = Arc::new(Scene {
        name: "test".into(),
        mesh,
        views: vec![],
        lights,
    });
    let mut provider = Extended::new(SceneProvider::new(scene.clone()));
    provider.add("light_area", &[emitter.area]);
    provider.add("test.questions", &questions);
    let shader = shader();
    let mut sources = vec![("test.ron", DOCUMENT), ("shaders/judge.wgsl", &*shader)];
    sources.extend(files.iter().map(|(path, text)| (&**path, &**text)));
    let answers: Vec<Answer> =
        bytemuck::pod_collect_to_vec(&run_files(&sources, &mut provider, "answers"));
    assert_eq!(answers.len(), questions.len());
    let emitter = Emitter::new(kind, &scene.mesh);
    for (number, (asked, answer)) in questions.iter().zip(&answers).enumerate().skip(1) {
        let sight = emitter.seen_from(asked.receiver.into());
        let origin = Vec3::from(asked.receiver).as_dvec3();
        let corners = scene
            .mesh
            .corners(number as u32)
            .map(|corner| corner - origin);
        for (sample, point) in asked.points.iter().enumerate() {
            let bit = |bits: u32| bits >> sample & 1 == 1;
            let (hidden, seen, traced) = (bit(answer.hidden), bit(answer.seen), bit(answer.traced));
            let t_min = asked.t_min.into();
            let exact = sight.exact(corners, point.map(f64::from), t_min);
            let hit = exact.hit;
            assert!(!(hidden && seen), "{asked:?} {answer:?}");
            judged.hidden += usize::from(hidden);
            judged.seen += usize::from(seen);
            judged.asked += usize::from(!hidden && !seen);
            let is_wrong = (hidden && !hit) || (seen && hit);
            let is_refuted = (hidden && !traced) || (seen && traced);
            judged.wrong += usize::from(is_wrong);
            judged.refuted += usize::from(is_refuted);
            judged.outside += usize::from(!bit(answer.boxed));
            let is_lost = !bit(answer.boxed) && (hit || traced);
            judged.lost += usize::from(is_lost);
            if (is_wrong || is_refuted || is_lost) && judged.first.is_none() {
                judged.first = Some(format!(
                    "{kind:?}: sample {sample} of {asked:?}, corners {corners:?}: {answer:?}, f64 \
                     says {hit}"
                ));
            }
            if hit != traced && exact.is_between {
                judged.farthest = judged.farthest.max(exact.nearest / f64::from(answer.error));
            }
        }
    }
}

/// Suns with a ρ from 1e-4 to 2, spot and point lights of which receivers see as much as 0.49.
fn lights() -> Vec<LightKind> {
    let mut random = Random(3);
    let mut lights = Vec::new();
    for radius in [1e-4, 1e-3, 0.0046, 0.04, 0.3, 1.0, 2.0f64] {
        let angle_degrees = 2.0 * radius.atan().to_degrees();
        let direction = random.vector().as_dvec3();
        lights.push(LightKind::Directional(DirectionalLight {
            direction,
            angle_degrees,
        }));
    }
    for radius in [0.01, 0.3, 5.0] {
        let position = random.vector().as_dvec3() * 30.0;
        let direction = random.vector().as_dvec3();
        lights.push(LightKind::Point(PointLight { position, radius }));
        lights.push(LightKind::Spot(SpotLight {
            position,
            direction,
            cone_degrees: 170.0,
            radius,
        }));
    }
    lights
}

/// Reaches of the box around all: no farther than needed, so that what grows with it is small, and
/// far.
const NEAR: f32 = 300.0;
const FAR: f32 = 1e5;

fn judged(count: u32, reach: f32, files: &[(String, String)]) -> Judged {
    let mut total = Judged::default();
    for light in lights() {
        judge(light, (count, reach), files, &mut total);
    }
    println!("{total:?}");
    total
}

/// A module with that share of its bound, which follows the words `bound`.
fn with_bound(path: &str, bound: &str, share: f64) -> Vec<(String, String)> {
    let text = EmbeddedSources.read(path).unwrap().unwrap();
    assert_eq!(text.matches(bound).count(), 1, "the bound of {path}");
    vec![(
        path.to_owned(),
        text.replace(bound, &format!("{bound}{share:?} * ")),
    )]
}

#[test]
fn what_the_planes_are_sure_of_f64_and_the_tracer_find_too() {
    let outcome = judged(20_000, FAR, &[]);
    assert_eq!(
        (outcome.wrong, outcome.refuted),
        (0, 0),
        "{:?}",
        outcome.first
    );
    let least = outcome.hidden.min(outcome.seen).min(outcome.asked);
    assert!(least > 50_000, "{outcome:?}");
    // A thousandth would be too little, and less than a thousandth no measure.
    assert!((1e-3..1.0).contains(&outcome.farthest), "{outcome:?}");
}

#[test]
fn a_tracer_that_rounds_in_another_way_finds_it_too() {
    for reach in [NEAR, FAR] {
        let outcome = judged(5_000, reach, &altered_files(1));
        let faults = (outcome.wrong, outcome.refuted, outcome.lost);
        assert_eq!(faults, (0, 0, 0), "{:?}", outcome.first);
    }
}

#[test]
fn a_sample_that_a_caster_hides_is_in_its_box() {
    let outcome = judged(20_000, NEAR, &[]);
    assert_eq!((outcome.lost, outcome.wrong), (0, 0), "{:?}", outcome.first);
    assert!(outcome.outside > 50_000, "{outcome:?}");
}

#[test]
fn without_the_bound_boxes_lose_samples() {
    let path = "shaders/shared/caster_box.wgsl";
    let outcome = judged(20_000, NEAR, &with_bound(path, "return 32.0 * ", 0.0));
    assert!(outcome.lost > 0, "{outcome:?}");
}

#[test]
fn a_thousandth_of_the_bound_is_refuted() {
    let path = "shaders/shared/light_cone.wgsl";
    let outcome = judged(20_000, FAR, &with_bound(path, "let error = ", 1e-3));
    assert!(outcome.wrong > 0 && outcome.refuted > 0, "{outcome:?}");
}
