//! Props, towns and interiors as foreign files have them: solids, shells, bodies of several parts,
//! in several units, off the origin, with y or z up.

use glam::DVec3;
use std::f64::consts::TAU;
use std::fmt::Write;
use std::path::Path;

/// Polygons of a body, y up, in metres, wound counter-clockwise seen from where they are seen.
#[derive(Clone, Default)]
pub struct Shape(pub Vec<Vec<DVec3>>);

impl Shape {
    pub fn and(mut self, other: Shape) -> Self {
        self.0.extend(other.0);
        self
    }

    pub fn moved(mut self, by: [f64; 3]) -> Self {
        let by = DVec3::from(by);
        self.map(|place| place + by);
        self
    }

    fn map(&mut self, to: impl Fn(DVec3) -> DVec3) {
        self.0
            .iter_mut()
            .flatten()
            .for_each(|place| *place = to(*place));
    }

    /// With the other side of its polygons seen.
    pub fn inward(mut self) -> Self {
        self.0.iter_mut().for_each(|polygon| polygon.reverse());
        self
    }

    /// Both sides, as two polygons each.
    pub fn two_sided(self) -> Self {
        self.clone().and(self.inward())
    }

    /// Without polygons whose middle fulfils a condition.
    pub fn without(mut self, is_out: impl Fn(DVec3) -> bool) -> Self {
        self.0
            .retain(|polygon| !is_out(polygon.iter().sum::<DVec3>() / polygon.len() as f64));
        self
    }

    /// In another unit, off the origin, and with z up if asked for.
    pub fn in_unit(mut self, unit: f64, off: DVec3, is_z_up: bool) -> Self {
        self.map(|it| it * unit);
        if is_z_up {
            self.map(|it| DVec3::new(it.x, -it.z, it.y));
        }
        self.map(|it| it + off);
        self
    }

    pub fn write_obj(&self, path: &Path) {
        let (mut text, mut count) = (String::new(), 0);
        for polygon in &self.0 {
            for place in polygon {
                writeln!(text, "v {} {} {}", place.x, place.y, place.z).unwrap();
            }
            let corners = (1..=polygon.len()).map(|at| format!(" {}", count + at));
            writeln!(text, "f{}", corners.collect::<String>()).unwrap();
            count += polygon.len();
        }
        std::fs::write(path, text).unwrap();
    }

    /// A .gltf with a .bin beside it, double-sided if asked for.
    pub fn write_gltf(&self, path: &Path, is_double_sided: bool) {
        let fan = |polygon: &Vec<DVec3>| {
            let polygon = polygon.clone();
            let triangles = 1..polygon.len() - 1;
            triangles.flat_map(move |at| [polygon[0], polygon[at], polygon[at + 1]])
        };
        let places: Vec<[f32; 3]> = self
            .0
            .iter()
            .flat_map(fan)
            .map(|it| it.as_vec3().to_array())
            .collect();
        let bin = path.with_extension("bin");
        std::fs::write(&bin, bytemuck::cast_slice::<_, u8>(&places)).unwrap();
        let ends = |pick: fn(f32, f32) -> f32| {
            places
                .iter()
                .copied()
                .reduce(|a, b| [0, 1, 2].map(|at| pick(a[at], b[at])))
                .unwrap()
        };
        let (count, bytes) = (places.len(), 12 * places.len());
        let text = serde_json::json!({
            "asset": {"version": "2.0"},
            "scenes": [{"nodes": [0]}], "scene": 0,
            "nodes": [{"mesh": 0}],
            "materials": [{"doubleSided": is_double_sided}],
            "meshes": [{"primitives": [{"attributes": {"POSITION": 0}, "material": 0}]}],
            "buffers": [{"uri": bin.file_name().unwrap().to_str().unwrap(), "byteLength": bytes}],
            "bufferViews": [{"buffer": 0, "byteLength": bytes}],
            "accessors": [{"bufferView": 0, "componentType": 5126, "count": count, "type": "VEC3",
                "min": ends(f32::min), "max": ends(f32::max)}],
        });
        std::fs::write(path, text.to_string()).unwrap();
    }
}

/// A closed box.
pub fn block(low: [f64; 3], high: [f64; 3]) -> Shape {
    let corner = |at: usize| {
        let pick = |axis: usize| {
            if at >> axis & 1 == 0 {
                low[axis]
            } else {
                high[axis]
            }
        };
        DVec3::new(pick(0), pick(1), pick(2))
    };
    let faces = [
        [0, 2, 3, 1],
        [4, 5, 7, 6],
        [0, 1, 5, 4],
        [2, 6, 7, 3],
        [0, 4, 6, 2],
        [1, 3, 7, 5],
    ];
    Shape(faces.iter().map(|face| face.map(corner).to_vec()).collect())
}

/// A surface turned about y: radii and heights from below, seen from outside.
pub fn lathe(profile: &[[f64; 2]]) -> Shape {
    const SIDES: usize = 24;
    let place = |[radius, height]: [f64; 2], side: usize| {
        let (sin, cos) = (TAU * (side % SIDES) as f64 / SIDES as f64).sin_cos();
        DVec3::new(radius * cos, height, -radius * sin)
    };
    let mut shape = Shape::default();
    for pair in profile.windows(2) {
        for side in 0..SIDES {
            let mut corners = vec![
                place(pair[0], side),
                place(pair[0], side + 1),
                place(pair[1], side + 1),
                place(pair[1], side),
            ];
            corners.dedup();
            if corners.first() == corners.last() {
                corners.pop();
            }
            if corners.len() > 2 {
                shape.0.push(corners);
            }
        }
    }
    shape
}

/// A closed ball with radii of its own along each axis.
pub fn ball(middle: [f64; 3], radii: [f64; 3]) -> Shape {
    let at = |step: i32| {
        let angle = TAU * 0.25 * (f64::from(step) / 6.0 - 1.0);
        [if step % 12 == 0 { 0.0 } else { angle.cos() }, angle.sin()]
    };
    let mut ball = lathe(&(0..=12).map(at).collect::<Vec<_>>());
    ball.map(|it| it * DVec3::from(radii));
    ball.moved(middle)
}

fn pole(radius: f64, low: f64, high: f64) -> Shape {
    lathe(&[[0.0, low], [radius, low], [radius, high], [0.0, high]])
}

/// Names of all props; tests give each a unit, a place and a kind of file by its number.
const NAMES: [&str; 21] = [
    "ball",
    "teapot",
    "cup",
    "hollow",
    "deer",
    "mirrored_deer",
    "table",
    "chair",
    "tree",
    "lamp",
    "statue",
    "torus",
    "bottle",
    "car",
    "stairs",
    "crate",
    "arch",
    "bowl",
    "shelf",
    "barrel",
    "vase",
];

/// Props by name. All are to be seen from outside.
pub fn props() -> Vec<(&'static str, Shape)> {
    NAMES.map(|name| (name, prop(name))).into()
}

/// The prop of a name.
pub fn prop(name: &str) -> Shape {
    let shapes = [vessels(), bodies(), furniture(), buildings()].concat();
    let named = shapes.into_iter().find(|(other, _)| *other == name);
    named.unwrap().1
}

/// Four legs at a distance from the middle.
fn legs(x: f64, z: f64, width: f64, height: f64) -> Shape {
    let corners = [[-x, -z], [x, -z], [-x, z], [x, z]];
    let leg = |[x, z]: [f64; 2]| block([x - width, 0.0, z - width], [x + width, height, z + width]);
    corners.map(leg).into_iter().reduce(Shape::and).unwrap()
}

/// Circle whose turn about y is a ring that lies on the floor.
fn ring() -> Vec<[f64; 2]> {
    let torus = (0..=16).map(|step| {
        let (sin, cos) = (TAU * f64::from(step % 16) / 16.0).sin_cos();
        [1.0 + 0.35 * cos, 0.35 + 0.35 * sin]
    });
    torus.collect()
}

/// Bodies of revolution, hollow or not.
fn vessels() -> Vec<(&'static str, Shape)> {
    let cup = [
        [0.0, 0.0],
        [0.04, 0.0],
        [0.045, 0.1],
        [0.04, 0.1],
        [0.035, 0.01],
        [0.0, 0.01],
    ];
    let bottle = [
        [0.0, 0.0],
        [0.04, 0.0],
        [0.04, 0.2],
        [0.015, 0.24],
        [0.015, 0.3],
        [0.012, 0.3],
        [0.012, 0.24],
        [0.037, 0.197],
        [0.037, 0.005],
        [0.0, 0.005],
    ];
    let pot = [
        [0.0, 0.0],
        [0.5, 0.0],
        [0.8, 0.3],
        [0.85, 0.5],
        [0.75, 0.8],
        [0.4, 1.0],
        [0.1, 1.05],
    ];
    let bowl = [
        [0.0, 0.0],
        [0.1, 0.0],
        [0.25, 0.1],
        [0.3, 0.2],
        [0.28, 0.2],
        [0.23, 0.11],
        [0.09, 0.02],
        [0.0, 0.02],
    ];
    let barrel = [[0.0, 0.0], [0.3, 0.0], [0.4, 0.45], [0.3, 0.9], [0.0, 0.9]];
    let vase = [
        [0.0, 0.0],
        [0.1, 0.0],
        [0.18, 0.2],
        [0.07, 0.35],
        [0.1, 0.4],
    ];
    vec![
        ("ball", ball([0.0, 1.0, 0.0], [1.0; 3])),
        ("teapot", lathe(&pot).and(ball([0.0, 1.1, 0.0], [0.12; 3]))),
        ("cup", lathe(&cup)),
        ("torus", lathe(&ring())),
        ("bottle", lathe(&bottle)),
        ("bowl", lathe(&bowl)),
        ("barrel", lathe(&barrel)),
        ("vase", lathe(&vase).two_sided()),
    ]
}

/// Bodies of several parts.
fn bodies() -> Vec<(&'static str, Shape)> {
    let tire = |x: f64, z: f64| {
        let mut wheel = lathe(&ring()).moved([0.0, -0.35, 0.0]);
        wheel.map(|it| DVec3::new(it.x, it.z, -it.y) * 0.25);
        wheel.moved([x, 0.34, z])
    };
    let wheels = [[-1.3, -0.8], [1.3, -0.8], [-1.3, 0.8], [1.3, 0.8]].map(|[x, z]| tire(x, z));
    let wheels = wheels.into_iter().reduce(Shape::and).unwrap();
    // A body without an underside, its wheel wells open.
    let body = block([-2.2, 0.3, -0.9], [2.2, 0.9, 0.9])
        .and(block([-1.2, 0.9, -0.8], [1.0, 1.5, 0.8]))
        .without(|middle| middle.y < 0.31 || (middle.y - 0.9).abs() < 1e-9);
    let deer = ball([0.0, 1.0, 0.0], [0.7, 0.35, 0.3])
        .and(ball([0.75, 1.5, 0.0], [0.15, 0.45, 0.14]))
        .and(ball([0.95, 1.9, 0.0], [0.25, 0.14, 0.12]))
        .and(legs(0.45, 0.15, 0.06, 0.9));
    let tree = pole(0.15, 0.0, 2.2)
        .and(ball([0.0, 3.2, 0.0], [1.3, 1.2, 1.3]))
        .and(ball([0.6, 2.6, 0.5], [0.8, 0.6, 0.8]));
    let statue = block([-0.5, 0.0, -0.5], [0.5, 0.8, 0.5])
        .and(ball([0.0, 1.3, 0.0], [0.25, 0.55, 0.2]))
        .and(ball([0.0, 2.0, 0.0], [0.15, 0.2, 0.15]));
    let left = deer.clone().without(|it| it.z > 0.31);
    let mirrored = ball([0.0, 1.0, 0.5], [0.6, 0.3, 0.2]).inward();
    vec![
        ("car", body.two_sided().and(wheels)),
        ("deer", deer),
        ("mirrored_deer", left.and(mirrored)),
        ("tree", tree),
        ("statue", statue),
    ]
}

fn furniture() -> Vec<(&'static str, Shape)> {
    let chair = legs(0.2, 0.2, 0.025, 0.45)
        .and(block([-0.25, 0.45, -0.25], [0.25, 0.5, 0.25]))
        .and(block([-0.25, 0.5, -0.25], [0.25, 1.0, -0.2]));
    let table = block([-0.8, 0.7, -0.4], [0.8, 0.75, 0.4]).and(legs(0.7, 0.3, 0.03, 0.7));
    let lamp = pole(0.25, 0.0, 0.05)
        .and(pole(0.04, 0.05, 3.0))
        .and(lathe(&[[0.3, 2.8], [0.12, 3.2], [0.0, 3.2]]).two_sided());
    let crate_ = block([-0.5, 0.0, -0.4], [0.5, 0.05, 0.4])
        .and(block([-0.5, 0.05, -0.4], [-0.45, 0.5, 0.4]))
        .and(block([0.45, 0.05, -0.4], [0.5, 0.5, 0.4]))
        .and(block([-0.45, 0.05, -0.4], [0.45, 0.5, -0.35]))
        .and(block([-0.45, 0.05, 0.35], [0.45, 0.5, 0.4]));
    let shelf = block([-0.5, 0.0, -0.2], [-0.45, 2.0, 0.2])
        .and(block([0.45, 0.0, -0.2], [0.5, 2.0, 0.2]))
        .and(
            (0..5)
                .map(|at| {
                    let low = 0.48 * f64::from(at);
                    block([-0.45, low, -0.2], [0.45, low + 0.03, 0.2])
                })
                .reduce(Shape::and)
                .unwrap(),
        )
        .and(block([-0.5, 0.0, -0.22], [0.5, 2.0, -0.2]));
    vec![
        ("table", table),
        ("chair", chair),
        ("lamp", lamp),
        ("crate", crate_),
        ("shelf", shelf),
    ]
}

fn buildings() -> Vec<(&'static str, Shape)> {
    let hollow = block([-1.0, 0.0, -1.0], [1.0, 1.5, 1.0])
        .and(block([-0.9, 0.1, -0.9], [0.9, 1.4, 0.9]).inward());
    let stairs = (0..6).map(|step| {
        let (low, high) = (0.3 * f64::from(step), 0.2 * f64::from(step + 1));
        block([low, 0.0, -0.6], [low + 0.3, high, 0.6])
    });
    let arch = block([-1.5, 0.0, -0.3], [-1.0, 2.0, 0.3])
        .and(block([1.0, 0.0, -0.3], [1.5, 2.0, 0.3]))
        .and(block([-1.6, 2.0, -0.35], [1.6, 2.5, 0.35]));
    vec![
        ("hollow", hollow),
        ("stairs", stairs.reduce(Shape::and).unwrap()),
        ("arch", arch),
    ]
}

/// A house with a saddle roof, closed.
fn house(x: f64, z: f64, [width, height, depth]: [f64; 3], base: f64) -> Shape {
    let place = |x: f64, y: f64, z: f64| DVec3::new(x, y, z);
    let (x2, z2, eaves) = (x + width, z + depth, base + height);
    let (middle, ridge) = (x + width * 0.5, base + height * 1.4);
    let [a, b, c, d] = [
        place(x, base, z),
        place(x2, base, z),
        place(x2, base, z2),
        place(x, base, z2),
    ];
    let up = |it: DVec3| place(it.x, eaves, it.z);
    let (front, back) = (place(middle, ridge, z2), place(middle, ridge, z));
    Shape(vec![
        vec![a, b, c, d],
        vec![d, c, up(c), front, up(d)],
        vec![b, a, up(a), back, up(b)],
        vec![c, b, up(b), up(c)],
        vec![a, d, up(d), up(a)],
        vec![up(a), up(d), front, back],
        vec![up(c), up(b), back, front],
    ])
}

/// Rows of houses at a pitch, of sizes that differ, on a floor of some height.
fn houses(rows: u32, pitch: [f64; 2], size: [f64; 3], floor: impl Fn(f64, f64) -> f64) -> Shape {
    let mut town = Shape::default();
    for (row, column) in (0..rows).flat_map(|row| (0..rows).map(move |column| (row, column))) {
        let (x, z) = (f64::from(column) * pitch[0], f64::from(row) * pitch[1]);
        let vary = f64::from((row * 7 + column * 5) % 11) / 11.0;
        let size = [
            size[0] * (0.8 + 0.2 * vary),
            size[1] * (0.7 + 0.8 * vary),
            size[2],
        ];
        town = town.and(house(x, z, size, floor(x, z)));
    }
    town
}

/// A sheet of squares at some height.
fn terrain(size: [f64; 2], floor: impl Fn(f64, f64) -> f64) -> Shape {
    const SQUARES: usize = 40;
    let at = |x: usize, z: usize| {
        let share = |number: usize| number as f64 / SQUARES as f64 * 1.2 - 0.1;
        let (x, z) = (share(x) * size[0], share(z) * size[1]);
        DVec3::new(x, floor(x, z), z)
    };
    let squares = (0..SQUARES).flat_map(|x| (0..SQUARES).map(move |z| (x, z)));
    let squares = squares.flat_map(|(x, z)| {
        let [a, b, c, d] = [at(x, z), at(x, z + 1), at(x + 1, z + 1), at(x + 1, z)];
        [vec![a, b, c], vec![a, c, d]]
    });
    Shape(squares.collect())
}

/// Towns by name, and whether they have a floor.
pub fn towns() -> Vec<(&'static str, Shape, bool)> {
    let flat = |_: f64, _: f64| 0.0;
    let hilly = |x: f64, z: f64| 4.0 * (x / 40.0).sin() + 3.0 * (z / 55.0).cos();
    let village = houses(7, [19.0, 22.0], [10.0, 5.0, 12.0], flat);
    let blocks = houses(10, [30.0, 34.0], [18.0, 12.0, 22.0], flat);
    let slab = block([-15.0, -2.0, -15.0], [145.0, 0.0, 165.0]);
    vec![
        ("village_on_slab", village.clone().and(slab), true),
        ("village", village, false),
        (
            "blocks_on_sheet",
            blocks.clone().and(terrain([300.0, 340.0], |_, _| -0.01)),
            true,
        ),
        (
            "village_on_hills",
            houses(8, [20.0, 21.0], [10.0, 6.0, 11.0], |x, z| hilly(x, z) - 1.0)
                .and(terrain([165.0, 170.0], hilly)),
            true,
        ),
        (
            "small_town",
            houses(4, [18.0, 18.0], [9.0, 5.0, 9.0], flat)
                .and(block([-10.0, -0.5, -10.0], [75.0, 0.0, 75.0])),
            true,
        ),
    ]
}

/// The walls of a room in squares of about half a metre, seen from inside, without those in holes.
fn walls(low: [f64; 3], high: [f64; 3], is_hole: impl Fn(DVec3) -> bool) -> Shape {
    let cut = |from: DVec3, along: DVec3, count: usize| {
        (0..=count)
            .map(move |at| from + along * (at as f64 / count as f64))
            .collect::<Vec<_>>()
    };
    let squares = block(low, high).inward().0.into_iter().flat_map(|face| {
        let counts = [face[1] - face[0], face[3] - face[0]].map(|it| (it.length() * 2.0).ceil());
        let [wide, deep] = counts.map(|it| it as usize);
        let rows = cut(face[0], face[3] - face[0], deep);
        let rows: Vec<_> = rows
            .into_iter()
            .map(|from| cut(from, face[1] - face[0], wide))
            .collect();
        let squares = (0..deep).flat_map(|z| (0..wide).map(move |x| (x, z)));
        let squares = squares.map(|(x, z)| {
            vec![
                rows[z][x],
                rows[z][x + 1],
                rows[z + 1][x + 1],
                rows[z + 1][x],
            ]
        });
        squares.collect::<Vec<_>>()
    });
    Shape(squares.collect()).without(is_hole)
}

/// Interiors by name, with the height of their floor and that of their ceiling.
pub fn interiors() -> Vec<(&'static str, Shape, [f64; 2])> {
    let furniture = || {
        let table = prop("table");
        let chair = prop("chair");
        table
            .and(chair.clone().moved([1.2, 0.0, 0.3]))
            .and(chair.moved([-1.3, 0.0, -0.2]))
    };
    let window = |it: DVec3| it.x > 3.9 && it.y > 0.9 && it.y < 2.2 && it.z.abs() < 1.2;
    let door = |it: DVec3| it.z > 2.9 && it.y < 2.1 && it.x.abs() < 0.6;
    let room = walls([-4.0, 0.0, -3.0], [4.0, 3.0, 3.0], |it| {
        window(it) || door(it)
    });
    let corridor = walls([-10.0, 0.0, -1.2], [10.0, 2.8, 1.2], |it| {
        it.x > 9.9 || window(it) || (it.z > 1.1 && (it.x + 4.0).abs() < 1.0 && it.y > 0.8)
    })
    .and(block([2.0, 0.0, 0.5], [2.6, 1.0, 1.1]))
    .and(block([-6.0, 0.0, -1.1], [-5.2, 1.6, -0.6]));
    let columns = (0..12).map(|at| {
        let (x, z) = (
            f64::from(at % 6) * 3.6 - 9.0,
            if at < 6 { -2.5 } else { 2.5 },
        );
        pole(0.4, 0.0, 6.0).moved([x, 0.0, z])
    });
    let hall = walls([-12.0, 0.0, -6.0], [12.0, 6.0, 6.0], |it| {
        it.z > 5.9 && it.y > 1.0 && it.y < 5.0 && (it.x / 2.0).rem_euclid(2.0) < 1.0
    });
    // Walls of some thickness, with a door and two windows.
    let thick = [
        block([-4.3, -0.3, -3.3], [4.3, 0.0, 3.3]),
        block([-4.3, 3.0, -3.3], [4.3, 3.3, 3.3]),
        block([-4.3, 0.0, -3.3], [4.3, 3.0, -3.0]),
        block([-4.3, 0.0, -3.0], [-4.0, 3.0, 3.0]),
        block([4.0, 0.0, -3.0], [4.3, 0.9, 3.0]),
        block([4.0, 2.3, -3.0], [4.3, 3.0, 3.0]),
        block([4.0, 0.9, -3.0], [4.3, 2.3, -1.2]),
        block([4.0, 0.9, 1.2], [4.3, 2.3, 3.0]),
        block([-4.3, 0.0, 3.0], [-0.5, 3.0, 3.3]),
        block([0.5, 0.0, 3.0], [4.3, 3.0, 3.3]),
        block([-0.5, 2.1, 3.0], [0.5, 3.0, 3.3]),
    ];
    let thick = thick.into_iter().reduce(Shape::and).unwrap();
    // A tube with a mouth, seen from inside, its lower part flattened.
    let cave = (0..=14).map(|at| {
        let x = f64::from(at) * 1.5;
        let radius = 3.2 + 0.5 * (x * 0.9).sin();
        [if at == 14 { 0.0 } else { radius }, x]
    });
    // Turned over, it is seen from inside.
    let mut cave = lathe(&cave.collect::<Vec<_>>());
    cave.map(|it| DVec3::new(it.y, it.x.max(-1.2 + 0.1 * (it.y * 1.7).sin()), it.z));
    let cave = cave
        .and(ball([9.0, -1.0, 1.0], [0.7, 0.8, 0.6]))
        .and(ball([4.0, -1.0, -1.0], [0.8, 1.0, 0.7]))
        .and(ball([13.0, -1.0, -0.6], [0.6, 0.9, 0.7]));
    vec![
        ("room", room.and(furniture()), [0.0, 3.0]),
        ("thick_room", thick.and(furniture()), [0.0, 3.0]),
        ("corridor", corridor, [0.0, 2.8]),
        (
            "hall",
            hall.and(columns.reduce(Shape::and).unwrap()),
            [0.0, 6.0],
        ),
        ("cave", cave, [-1.4, 3.7]),
    ]
}
