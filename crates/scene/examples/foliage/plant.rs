//! A plant of masked, double-sided leaves over a floor, as a binary glTF file.

use std::io::Cursor;

/// Leaves in each of its rings.
const LEAVES: u32 = 12;
const RINGS: u32 = 6;

#[derive(Default)]
struct Vertices {
    positions: Vec<[f32; 3]>,
    uvs: Vec<[f32; 2]>,
    indices: Vec<u32>,
}

impl Vertices {
    fn quad(&mut self, corners: [[f32; 3]; 4], repeat: f32) {
        let first = self.positions.len() as u32;
        self.positions.extend(corners);
        let uvs = [[0., 1.], [1., 1.], [1., 0.], [0., 0f32]];
        self.uvs.extend(uvs.map(|uv| uv.map(|at| at * repeat)));
        self.indices
            .extend([0, 1, 2, 0, 2, 3].map(|corner| first + corner));
    }

    fn bytes(&self) -> Vec<u8> {
        let positions = self.positions.as_flattened().iter();
        let floats = positions.chain(self.uvs.as_flattened());
        let mut bytes: Vec<u8> = floats.flat_map(|value| value.to_le_bytes()).collect();
        bytes.extend(self.indices.iter().flat_map(|index| index.to_le_bytes()));
        bytes
    }
}

fn leaves() -> Vertices {
    let mut leaves = Vertices::default();
    for ring in 0..RINGS {
        let height = 0.3 + 0.35 * ring as f32;
        let length = 1.2 - 0.15 * ring as f32;
        for leaf in 0..LEAVES {
            let turn = (leaf as f32 + 0.5 * (ring % 2) as f32) / LEAVES as f32;
            let (sin, cos) = (turn * std::f32::consts::TAU).sin_cos();
            let at = |out: f32, aside: f32, up: f32| {
                [
                    cos * out - sin * aside,
                    height + up,
                    sin * out + cos * aside,
                ]
            };
            let (half, tip) = (0.3 * length, 0.4 * length);
            let corners = [
                at(0.05, -half, 0.0),
                at(length, -half, tip),
                at(length, half, tip),
                at(0.05, half, 0.0),
            ];
            leaves.quad(corners, 1.0);
        }
    }
    leaves
}

fn floor() -> Vertices {
    let mut floor = Vertices::default();
    let corners = [(-3., 3.), (3., 3.), (3., -3.), (-3., -3.)];
    floor.quad(corners.map(|(x, z)| [x, 0.0, z]), 4.0);
    floor
}

/// A leaf with a jagged rim, as a PNG with alpha.
fn leaf_picture() -> Vec<u8> {
    let picture = image::RgbaImage::from_fn(96, 64, |x, y| {
        let (u, v) = ((x as f32 + 0.5) / 96.0, (y as f32 + 0.5) / 64.0);
        let width = 2.0 * (u * (1.0 - u)) + 0.03 * f32::from(x / 6 % 2 == 0);
        let rib = (v - 0.5).abs() < 0.03;
        let alpha = rib || ((v - 0.5).abs() < width && (x / 4 + y / 4) % 5 != 0);
        let green = 90 + (80.0 * u) as u8;
        image::Rgba([40, green, 30, if alpha { 255 } else { 40 }])
    });
    let mut bytes = Cursor::new(Vec::new());
    picture
        .write_to(&mut bytes, image::ImageFormat::Png)
        .expect("a picture in memory can be written");
    bytes.into_inner()
}

/// The file's bytes.
pub fn plant() -> Vec<u8> {
    let (leaves, floor, picture) = (leaves(), floor(), leaf_picture());
    let mut blob = Vec::new();
    let mut views = Vec::new();
    for part in [leaves.bytes(), floor.bytes(), picture] {
        let (offset, length) = (blob.len(), part.len());
        views.push(format!(
            r#"{{"buffer":0,"byteOffset":{offset},"byteLength":{length}}}"#
        ));
        blob.extend(part);
        blob.resize(blob.len().next_multiple_of(4), 0);
    }
    let mut accessors = Vec::new();
    for (view, mesh) in [&leaves, &floor].into_iter().enumerate() {
        let (count, indices) = (mesh.positions.len(), mesh.indices.len());
        let bound = |extreme: fn(f32, f32) -> f32, start: f32| -> String {
            let axis = |axis: usize| mesh.positions.iter().map(|p| p[axis]).fold(start, extreme);
            format!("[{:?},{:?},{:?}]", axis(0), axis(1), axis(2))
        };
        let (low, high) = (bound(f32::min, f32::MAX), bound(f32::max, f32::MIN));
        accessors.push(format!(
            r#"{{"bufferView":{view},"componentType":5126,"count":{count},
"type":"VEC3","min":{low},"max":{high}}},
{{"bufferView":{view},"byteOffset":{},"componentType":5126,"count":{count},"type":"VEC2"}},
{{"bufferView":{view},"byteOffset":{},"componentType":5125,"count":{indices},"type":"SCALAR"}}"#,
            12 * count,
            20 * count,
        ));
    }
    let json = format!(
        r#"{{"asset":{{"version":"2.0","generator":"skiagraph, example foliage"}},"scene":0,
"scenes":[{{"nodes":[0,1]}}],
"nodes":[{{"name":"leaves","mesh":0}},{{"name":"floor","mesh":1}}],
"meshes":[
{{"primitives":[{{"attributes":{{"POSITION":0,"TEXCOORD_0":1}},"indices":2,"material":0}}]}},
{{"primitives":[{{"attributes":{{"POSITION":3,"TEXCOORD_0":4}},"indices":5,"material":1}}]}}],
"materials":[
{{"name":"leaf","doubleSided":true,"alphaMode":"MASK",
"pbrMetallicRoughness":{{"baseColorTexture":{{"index":0}}}}}},
{{"name":"floor","pbrMetallicRoughness":{{"baseColorFactor":[0.6,0.5,0.4,1.0]}}}}],
"textures":[{{"source":0}}],
"images":[{{"bufferView":2,"mimeType":"image/png"}}],
"accessors":[{}],"bufferViews":[{}],"buffers":[{{"byteLength":{}}}]}}"#,
        accessors.join(",\n"),
        views.join(","),
        blob.len(),
    );
    let mut json = json.into_bytes();
    json.resize(json.len().next_multiple_of(4), b' ');
    let word = |number: usize| (number as u32).to_le_bytes();
    let total = 12 + 8 + json.len() + 8 + blob.len();
    let header = [b"glTF".as_slice(), &word(2), &word(total)].concat();
    let chunk = |kind: &[u8], bytes: &[u8]| [&word(bytes.len()), kind, bytes].concat();
    [header, chunk(b"JSON", &json), chunk(b"BIN\0", &blob)].concat()
}
