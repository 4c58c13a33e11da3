//! Refusals by a device or a provider: an error with names, before anything is encoded.

use crate::support::{Files, load, right};
use crate::tiny::{GPU, encoder, executor, image, made, request};
use skiagraph_gpu::{ExecuteError, Executor, Frame, Provider, ProviderError};
use skiagraph_graph::{Describe, NoProvider, Provided, ProvidedBinding};

#[test]
fn an_output_that_the_plan_does_not_have() {
    let mut executor = made(&image());
    let wanted = Frame::new().with_read(&["imgae"]);
    let error = executor
        .encode(&mut encoder(), &wanted)
        .expect_err("there is none");
    assert_eq!(
        error.to_string(),
        "the plan has no output `imgae`; it has image"
    );
}

/// Right as WGSL, but this device was not opened with what it needs: an error that names the pass,
/// and no panic.
#[test]
fn a_shader_that_the_device_refuses() {
    let files = Files::graph(
        r#"
    materials: [Buffer(name: "total")],
    passes: [Compute(name: "precise", dispatch: Groups(1, 1, 1))],
    outputs: ["total"],
"#,
    )
    .with(
        "precise.wgsl",
        "var<storage, read_write> total: f32;
         @compute @workgroup_size(1) fn main() {
             var sum: f64 = 1.0lf;
             sum = sum * 0.1lf;
             total = f32(sum);
         }",
    );
    match executor(&files, &[]).expect_err("f64 was not asked for") {
        ExecuteError::Gpu {
            pass,
            place,
            message,
        } => {
            assert_eq!(pass, "precise");
            assert!(place.starts_with("graph.ron:3:"), "{place}");
            assert!(!message.is_empty());
        }
        other => panic!("{other}"),
    }
}

/// Gives four items in a buffer without the usage that binding needs.
struct Broken;

impl Describe for Broken {
    fn names(&self) -> Vec<String> {
        vec!["items".to_owned()]
    }

    fn describe(&self, name: &str) -> Option<Provided> {
        (name == "items").then_some(Provided::new(ProvidedBinding::Storage, Some(4), 4))
    }
}

impl Provider for Broken {
    fn build(
        &mut self,
        _: &str,
        device: &wgpu::Device,
        _: &wgpu::Queue,
    ) -> Result<wgpu::Buffer, ProviderError> {
        Ok(device.create_buffer(&wgpu::BufferDescriptor {
            label: Some("items"),
            size: 16,
            usage: wgpu::BufferUsages::COPY_DST,
            mapped_at_creation: false,
        }))
    }
}

/// A provider's resource is checked when it is bound; the provider's refusal is told in its words.
#[test]
fn a_provider_that_fails() {
    let files = Files::graph(
        r#"
    materials: [Buffer(name: "total")],
    passes: [Compute(name: "sum", dispatch: Groups(1, 1, 1))],
    outputs: ["total"],
"#,
    )
    .with(
        "sum.wgsl",
        "var<storage, read> items: array<u32>;
         var<storage, read_write> total: u32;
         @compute @workgroup_size(1) fn main() { total = items[0]; }",
    );
    let plan = || right(right(load(&files)).plan(&request(&Broken)));
    match Executor::new(&GPU.device, &GPU.queue, plan(), &mut Broken)
        .expect_err("it cannot be bound")
    {
        ExecuteError::Gpu { pass, .. } => assert_eq!(pass, "sum"),
        other => panic!("{other}"),
    }
    let error = Executor::new(&GPU.device, &GPU.queue, plan(), &mut NoProvider)
        .expect_err("nothing is provided");
    assert!(
        matches!(&error, ExecuteError::Provider { name, .. } if name == "items"),
        "{error}"
    );
}

/// Panics as it builds, as wgpu does on some shaders.
struct Panicking;

impl Describe for Panicking {
    fn names(&self) -> Vec<String> {
        Broken.names()
    }

    fn describe(&self, name: &str) -> Option<Provided> {
        Broken.describe(name)
    }
}

impl Provider for Panicking {
    fn build(
        &mut self,
        name: &str,
        _: &wgpu::Device,
        _: &wgpu::Queue,
    ) -> Result<wgpu::Buffer, ProviderError> {
        panic!("no {name} today")
    }
}

/// A panic while something is made on the device is an error that names it, on this thread and on
/// others, and the device goes on as before.
#[test]
fn a_panic_while_something_is_made() {
    let files = Files::graph(
        r#"
    materials: [Buffer(name: "total")],
    passes: [Compute(name: "sum", dispatch: Groups(1, 1, 1))],
    outputs: ["total"],
"#,
    )
    .with(
        "sum.wgsl",
        "var<storage, read> items: array<u32>;
         var<storage, read_write> total: u32;
         @compute @workgroup_size(1) fn main() { total = items[0]; }",
    );
    let plan = || right(right(load(&files)).plan(&request(&Broken)));
    let made = || Executor::new(&GPU.device, &GPU.queue, plan(), &mut Panicking).err();
    let on_another = std::thread::scope(|scope| scope.spawn(made).join());
    for error in [made(), on_another.expect("no thread dies of it")] {
        match error.expect("nothing was made") {
            ExecuteError::Panicked { name, panicked } => {
                assert_eq!(name, "`items`");
                assert_eq!(panicked.message, "no items today");
                assert!(panicked.place.contains("refusals.rs:"), "{panicked}");
            }
            other => panic!("{other}"),
        }
    }
    made_again();
}

/// A graph that is right runs on the device.
fn made_again() {
    let mut executor = made(&image());
    executor
        .encode(&mut encoder(), &Frame::default())
        .expect("the error scopes are as they were");
}

/// naga cannot write this shader, which is valid: refused with its place before the device is
/// asked.
#[test]
fn a_shader_that_the_library_panics_on() {
    let files = Files::graph(
        r#"
    materials: [Buffer(name: "total")],
    passes: [Compute(name: "nested", dispatch: Groups(1, 1, 1))],
    outputs: ["total"],
"#,
    )
    .with(
        "nested.wgsl",
        "var<storage, read_write> total: i32;
fn inner(p: ptr<function, i32>) -> i32 { return *p + 1; }
fn pick(v: ptr<function, array<array<i32, 4>, 4>>, i: u32) -> i32 {
    let unused = i + 1u;
    return inner(&(*v)[i][0]);
}
@compute @workgroup_size(1) fn main() {
    var a: array<array<i32, 4>, 4>;
    total = pick(&a, 1u);
}",
    );
    let error = right(load(&files))
        .plan(&request(&NoProvider))
        .expect_err("it cannot be written");
    let message = error.to_string();
    assert!(
        message.contains("library-panic") && message.contains("nested.wgsl:5:"),
        "{message}"
    );
    made_again();
}

/// Terabytes: an error that names the texture, with the planner's table of what takes the most.
#[test]
fn more_memory_than_there_is() {
    let limits = GPU.device.limits();
    let (edge, layers) = (
        limits.max_texture_dimension_2d,
        limits.max_texture_array_layers,
    );
    let files = Files::graph(&format!(
        r#"
    materials: [
        Texture(name: "image", format: Rgba32Float, size: {edge}, layers: {layers}),
    ],
    passes: [Clear(name: "reset", target: "image")],
    outputs: ["image"],
"#
    ));
    match executor(&files, &[]).expect_err("no device has as much") {
        ExecuteError::OutOfMemory { name, table } => {
            assert_eq!(name, "image");
            let words = |line: &str| line.split_whitespace().collect::<Vec<_>>().join(" ");
            let gib = (u64::from(edge).pow(2) * u64::from(layers) * 16) >> 30;
            let size = format!("{edge}×{edge}, {layers} layers");
            let rows = [
                format!("image {size} Rgba32Float {gib}.00 GiB outlives the frame"),
                format!("all together {gib}.00 GiB"),
            ];
            assert_eq!(table.lines().map(words).collect::<Vec<_>>(), rows);
        }
        other => panic!("{other}"),
    }
}

/// A provider that wants terabytes in its second version.
struct Vast(u64);

impl Describe for Vast {
    fn names(&self) -> Vec<String> {
        vec!["items".to_owned()]
    }

    fn describe(&self, name: &str) -> Option<Provided> {
        (name == "items").then_some(Provided::new(ProvidedBinding::Storage, Some(1), 4))
    }
}

impl Provider for Vast {
    fn version(&self, _: &str) -> u64 {
        self.0
    }

    fn build(
        &mut self,
        _: &str,
        device: &wgpu::Device,
        _: &wgpu::Queue,
    ) -> Result<wgpu::Buffer, ProviderError> {
        let limits = device.limits();
        let edge = limits.max_texture_dimension_2d;
        let vast = wgpu::TextureDescriptor {
            label: None,
            size: wgpu::Extent3d {
                width: edge,
                height: edge,
                depth_or_array_layers: limits.max_texture_array_layers,
            },
            mip_level_count: 1,
            sample_count: 1,
            dimension: wgpu::TextureDimension::D2,
            format: wgpu::TextureFormat::Rgba32Float,
            usage: wgpu::TextureUsages::TEXTURE_BINDING,
            view_formats: &[],
        };
        if self.0 > 1 {
            drop(device.create_texture(&vast));
        }
        Ok(device.create_buffer(&wgpu::BufferDescriptor {
            label: None,
            size: 4,
            usage: wgpu::BufferUsages::STORAGE,
            mapped_at_creation: false,
        }))
    }
}

/// Wherever memory is refused, the error has the table: when executors are made, and later.
#[test]
fn more_memory_than_there_is_for_a_provider() {
    let files = Files::graph(
        r#"
    materials: [Buffer(name: "out", count: 1)],
    passes: [Compute(name: "take", dispatch: Groups(1, 1, 1))],
    outputs: ["out"],
"#,
    )
    .with(
        "take.wgsl",
        "var<storage, read_write> out: array<u32>;
         var<storage, read> items: array<u32>;
         @compute @workgroup_size(1) fn main() { out[0] = items[0]; }",
    )
    .edited(
        "graph.ron",
        "dispatch: Groups(1, 1, 1)",
        r#"dispatch: Groups(1, 1, 1), bind: {"items": "items"}"#,
    );
    let plan = |provider: &Vast| right(right(load(&files)).plan(&request(provider)));
    let has_table = |refused: Result<(), ExecuteError>| match refused {
        Err(ExecuteError::OutOfMemory { name, table }) => {
            assert_eq!(name, "items");
            assert!(table.contains("all together"), "{table}");
        }
        other => panic!("{other:?}"),
    };
    let mut provider = Vast(2);
    let made = Executor::new(&GPU.device, &GPU.queue, plan(&provider), &mut provider);
    has_table(made.map(drop));
    provider.0 = 1;
    let made = Executor::new(&GPU.device, &GPU.queue, plan(&provider), &mut provider);
    let mut executor = made.unwrap();
    provider.0 = 3;
    has_table(executor.refresh(&mut provider));
    let resized = executor.resize([3, 3], &mut provider);
    has_table(resized.map(drop));
}
