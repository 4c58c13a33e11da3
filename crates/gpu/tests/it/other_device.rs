//! Things of another device are refused by name before wgpu sees them: of the same instance, and of
//! another one, whose devices, textures and buffers have the numbers of ours.

use crate::buffers::{compute, document, writes};
use crate::given::{KIND, SAMPLED, STORAGE, sums};
use crate::support::{Files, load, right};
use crate::uniforms::{self, Teller};
use skiagraph_gpu::{
    DeviceIdentity, ExecuteError, Executor, Frame, Provider, ProviderError, device::Gpu, import,
};
use skiagraph_graph::{Describe, NoProvider, Plan, PlanRequest, Provided, ProvidedBinding};
use std::sync::{
    Arc,
    atomic::{AtomicUsize, Ordering},
};

fn open() -> Gpu {
    skiagraph_gpu::device::open(None).unwrap_or_else(|error| panic!("{error}"))
}

/// Another device of the instance.
fn beside(gpu: &Gpu) -> Gpu {
    let mut other = gpu.clone();
    let opened = pollster::block_on(gpu.adapter.request_device(&Default::default()));
    (other.device, other.queue) = opened.unwrap_or_else(|error| panic!("{error}"));
    other.pipelines = skiagraph_gpu::Pipelines::new(&other.device);
    other
}

/// A device, and others: of its instance, and of one whose first device is equal to it for wgpu.
fn devices() -> (Gpu, [Gpu; 2]) {
    let (gpu, stranger) = (open(), open());
    assert!(gpu.device == stranger.device, "they have one number");
    let other_gpus = [beside(&gpu), stranger];
    (gpu, other_gpus)
}

fn texture(device: &wgpu::Device) -> wgpu::Texture {
    device.create_texture(&wgpu::TextureDescriptor {
        label: None,
        size: wgpu::Extent3d {
            width: KIND.edge,
            height: KIND.edge,
            depth_or_array_layers: 1,
        },
        mip_level_count: 1,
        sample_count: 1,
        dimension: wgpu::TextureDimension::D2,
        format: KIND.format,
        usage: SAMPLED,
        view_formats: &[],
    })
}

/// A buffer of one number, which may be mapped still.
fn buffer(device: &wgpu::Device, number: u32, is_mapped: bool) -> wgpu::Buffer {
    let buffer = device.create_buffer(&wgpu::BufferDescriptor {
        label: None,
        size: 4,
        usage: STORAGE | wgpu::BufferUsages::COPY_SRC,
        mapped_at_creation: true,
    });
    if !is_mapped {
        fill(&buffer, number);
    }
    buffer
}

fn fill(buffer: &wgpu::Buffer, number: u32) {
    let mut mapped = buffer.get_mapped_range_mut(..).unwrap();
    mapped.copy_from_slice(&number.to_ne_bytes());
    drop(mapped);
    buffer.unmap();
}

fn plan(files: &Files, provider: &dyn Describe, gpu: &Gpu) -> Plan {
    let mut request = PlanRequest::new([8, 8], provider);
    request.imports.extend([
        ("image".to_owned(), import::texture(&texture(&gpu.device))),
        (
            "more".to_owned(),
            import::buffer(&buffer(&gpu.device, 0, false), None),
        ),
    ]);
    right(right(load(files)).plan(&request))
}

fn sums_on(gpu: &Gpu) -> Executor {
    Executor::on(gpu, plan(&sums(), &NoProvider, gpu), &mut NoProvider).unwrap()
}

/// The numbers of an output after a frame.
fn numbers(gpu: &Gpu, executor: &mut Executor, output: &str) -> Vec<u32> {
    let mut encoder = gpu.device.create_command_encoder(&Default::default());
    let read = [output];
    let frame = Frame::new().with_read(&read).with_all(true);
    executor.encode(&mut encoder, &frame).unwrap();
    gpu.queue.submit([encoder.finish()]);
    let report = executor.finish().unwrap();
    report.readbacks[0].content.as_u32().unwrap()
}

/// Fails unless a result is the error that names the thing and the way out.
fn refused<T>(result: Result<T, ExecuteError>, thing: &str, way: &str) {
    let Err(error) = result else {
        panic!("{thing} of another device was taken");
    };
    let text = error.to_string();
    let ExecuteError::OtherDevice { name, way_out } = error else {
        panic!("{text}");
    };
    assert!(name == thing && way_out.contains(way), "{text}");
    assert!(text.contains("another device"), "{text}");
}

#[test]
fn a_device_is_itself_and_no_other() {
    let (gpu, other_gpus) = devices();
    let identity = DeviceIdentity::new(&gpu.device);
    assert!(identity.is(&gpu.device.clone()));
    assert!(identity.has_buffer(&buffer(&gpu.device, 0, false)));
    assert!(identity.has_buffer(&buffer(&gpu.device, 0, true)));
    for other in &other_gpus {
        assert!(!identity.is(&other.device));
        assert!(!DeviceIdentity::new(&other.device).is(&gpu.device));
        assert!(!identity.has_buffer(&buffer(&other.device, 0, false)));
    }
    other_gpus[1].device.destroy();
    assert!(!identity.is(&other_gpus[1].device));
    assert!(identity.is(&gpu.device));
    gpu.device.destroy();
    assert!(!identity.is(&gpu.device), "a lost device tells nothing");
}

#[test]
fn a_queue_of_another_device_is_named() {
    let (gpu, other_gpus) = devices();
    for other in &other_gpus {
        let plan = || plan(&sums(), &NoProvider, &gpu);
        let made = Executor::new(&gpu.device, &other.queue, plan(), &mut NoProvider);
        refused(made, "the queue", "came with the device");
        let shared =
            Executor::with_pipelines(&gpu.pipelines, &other.queue, plan(), &mut NoProvider);
        refused(shared, "the queue", "came with the device");
        let mut mixed = gpu.clone();
        mixed.pipelines = other.pipelines.clone();
        let mixed = Executor::on(&mixed, plan(), &mut NoProvider);
        refused(mixed, "the queue", "came with the device");
    }
}

/// The host of the other device hears of it if it has asked to, and wgpu's own handler panics.
#[test]
fn imports_of_another_device_are_named() {
    for has_handler in [false, true] {
        let (gpu, other_gpus) = devices();
        for other in &other_gpus {
            if has_handler {
                other.device.on_uncaptured_error(Arc::new(|_| {}));
            }
            // As many of each as on the other device, so that their numbers are taken here.
            let own = [texture(&gpu.device), texture(&gpu.device)];
            let own_buffers = [1, 2].map(|number| buffer(&gpu.device, number, false));
            let mut executor = sums_on(&gpu);
            let theirs = (texture(&other.device), buffer(&other.device, 7, false));
            let way = "executor's device";
            for _ in 0..2 {
                let texture = executor.import_texture("image", &theirs.0);
                refused(texture, "the import `image`", way);
                let buffer = executor.import_buffer("more", &theirs.1);
                refused(buffer, "the import `more`", way);
                // Then with ones of ours, whose numbers those of the others may be.
                executor.import_texture("image", &own[0]).unwrap();
                executor.import_buffer("more", &own_buffers[1]).unwrap();
                assert_eq!(numbers(&gpu, &mut executor, "sum"), [2; 64]);
            }
        }
    }
}

/// A buffer that the host fills after it has handed it over is left alone, mapped as it is.
#[test]
fn an_import_that_is_still_mapped_is_taken() {
    let gpu = open();
    let mut executor = sums_on(&gpu);
    let (image, more) = (texture(&gpu.device), buffer(&gpu.device, 0, true));
    executor.import_texture("image", &image).unwrap();
    executor.import_buffer("more", &more).unwrap();
    let written = more.get_mapped_range_mut(..).unwrap();
    executor.import_buffer("more", &more).unwrap();
    drop(written);
    fill(&more, 5);
    executor.import_buffer("more", &more).unwrap();
    assert_eq!(numbers(&gpu, &mut executor, "sum"), [5; 64]);
}

/// A provider of one number in a buffer that it has, whatever device it is asked for.
struct Number {
    buffer: wgpu::Buffer,
    version: u64,
    device: Option<DeviceIdentity>,
}

impl Number {
    fn new(device: &wgpu::Device, number: u32) -> Self {
        Self {
            buffer: buffer(device, number, false),
            version: number.into(),
            device: None,
        }
    }
}

impl Describe for Number {
    fn names(&self) -> Vec<String> {
        vec!["host.number".to_owned()]
    }

    fn describe(&self, name: &str) -> Option<Provided> {
        (name == "host.number").then_some(Provided::new(ProvidedBinding::Storage, Some(1), 4))
    }
}

impl Provider for Number {
    fn version(&self, _: &str) -> u64 {
        self.version
    }

    fn device(&self) -> Option<&DeviceIdentity> {
        self.device.as_ref()
    }

    fn build(
        &mut self,
        _: &str,
        _: &wgpu::Device,
        _: &wgpu::Queue,
    ) -> Result<wgpu::Buffer, ProviderError> {
        Ok(self.buffer.clone())
    }
}

/// ```text
/// host.number ─▶ take ─▶ copy
/// ```
fn taker() -> Files {
    Files::graph(
        r#"
    inputs: [Texture(name: "image", format: R32Uint), Buffer(name: "more")],
    params: [F32(name: "unused", default: 0)],
    materials: [Buffer(name: "copy", count: 1)],
    passes: [Compute(name: "take", dispatch: Groups(1, 1, 1))],
    outputs: ["copy"],
"#,
    )
    .with(
        "take.wgsl",
        "var<storage, read> host_number: array<u32>; var<storage, read_write> copy: array<u32>;
         @compute @workgroup_size(1) fn main() { copy[0] = host_number[0]; }",
    )
}

#[test]
fn what_a_provider_builds_on_another_device_is_named() {
    let (gpu, other_gpus) = devices();
    let mut own = Number::new(&gpu.device, 1);
    let mut executor = Executor::on(&gpu, plan(&taker(), &own, &gpu), &mut own).unwrap();
    for other in &other_gpus {
        let mut theirs = Number::new(&other.device, 2);
        let (name, way) = ("the provided resource `host.number`", "given");
        let made = Executor::on(&gpu, plan(&taker(), &theirs, &gpu), &mut theirs);
        refused(made, name, way);
        refused(executor.refresh(&mut theirs), name, way);
        assert_eq!(numbers(&gpu, &mut executor, "copy"), [1]);
    }
}

/// Each method that takes a provider asks for its device.
#[test]
fn a_provider_of_another_device_is_named_by_each_method() {
    let (gpu, other_gpus) = devices();
    let mut own = Number::new(&gpu.device, 1);
    own.device = Some(DeviceIdentity::new(&gpu.device));
    let heard = Arc::new(AtomicUsize::new(0));
    for other in &other_gpus {
        let counter = Arc::clone(&heard);
        other.device.on_uncaptured_error(Arc::new(move |_| {
            counter.fetch_add(1, Ordering::Relaxed);
        }));
        let planned = plan(&taker(), &own, &gpu);
        let mut executor = Executor::on(&gpu, planned.clone(), &mut own).unwrap();
        // The same number, in the same version.
        let mut theirs = Number::new(&other.device, 1);
        theirs.device = Some(DeviceIdentity::new(&other.device));
        let (name, way) = ("the provider", "SceneProvider::move_to");
        let none = skiagraph_graph::ParamValue::F32(1.0);
        refused(Executor::on(&gpu, planned.clone(), &mut theirs), name, way);
        refused(executor.refresh(&mut theirs), name, way);
        refused(executor.resize([9, 9], &mut theirs), name, way);
        refused(executor.set_param("unused", none, &mut theirs), name, way);
        refused(
            executor.replace_graph(planned.clone(), &mut theirs),
            name,
            way,
        );
        let prepared = executor.preparer().prepare(planned.clone()).unwrap();
        refused(executor.replace(prepared, &mut theirs), name, way);
        executor.refresh(&mut own).unwrap();
        assert_eq!(numbers(&gpu, &mut executor, "copy"), [1]);
        // Pipelines that were prepared on one device are made anew on the other.
        let prepared = executor.preparer().prepare(planned.clone()).unwrap();
        let mut executor =
            Executor::on(other, plan(&taker(), &theirs, other), &mut theirs).unwrap();
        executor.replace(prepared, &mut theirs).unwrap();
        assert_eq!(numbers(other, &mut executor, "copy"), [1]);
    }
    assert_eq!(heard.load(Ordering::Relaxed), 0, "hosts hear nothing");
}

/// The price of looking, so that a host may hand over its texture in every frame.
#[test]
#[ignore = "a measurement: cargo test -p skiagraph-gpu --test gpu looking -- --ignored --nocapture"]
fn looking_at_a_device_takes_microseconds() {
    let gpu = open();
    let identity = DeviceIdentity::new(&gpu.device);
    let (image, more) = (texture(&gpu.device), buffer(&gpu.device, 0, false));
    let mut executor = sums_on(&gpu);
    let time = |what: &str, act: &mut dyn FnMut()| {
        let took = (0..100).map(|_| {
            let began = std::time::Instant::now();
            (0..20).for_each(|_| act());
            began.elapsed() / 20
        });
        println!("{what}: {:?}", took.min());
    };
    time("device", &mut || assert!(identity.is(&gpu.device)));
    time("buffer", &mut || assert!(identity.has_buffer(&more)));
    time("import_buffer", &mut || {
        executor.import_buffer("more", &more).unwrap();
    });
    time("import_texture", &mut || {
        executor.import_texture("image", &image).unwrap();
    });
}

/// wgpu tells no device of an encoder. It refuses one of another device of the instance when that
/// is finished, and panics where one of another instance lacks a number.
#[test]
fn an_encoder_of_another_device_is_no_panic() {
    let (gpu, other_gpus) = devices();
    let mut number = Number::new(&gpu.device, 3);
    for other in &other_gpus {
        let heard = Arc::new(AtomicUsize::new(0));
        let counter = Arc::clone(&heard);
        other.device.on_uncaptured_error(Arc::new(move |_| {
            counter.fetch_add(1, Ordering::Relaxed);
        }));
        let mut takes = Executor::on(&gpu, plan(&taker(), &number, &gpu), &mut number).unwrap();
        let mut teller = Teller::default();
        teller.value = 3;
        let told_plan = plan(&uniforms::files(), &teller, &gpu);
        let mut reader = Executor::on(&gpu, told_plan, &mut teller).unwrap();
        let mut sums = sums_on(&gpu);
        let (image, more) = (texture(&gpu.device), buffer(&gpu.device, 5, false));
        sums.import_texture("image", &image).unwrap();
        sums.import_buffer("more", &more).unwrap();
        for executor in [&mut takes, &mut reader, &mut sums] {
            let mut encoder = other.device.create_command_encoder(&Default::default());
            match executor.encode(&mut encoder, &Frame::default()) {
                Ok(_) => {
                    drop(encoder.finish());
                    assert!(heard.swap(0, Ordering::Relaxed) > 0);
                }
                error => refused(error, "the encoder", "executor's device"),
            }
        }
        assert_eq!(numbers(&gpu, &mut takes, "copy"), [3]);
        assert_eq!(numbers(&gpu, &mut reader, "seen"), [303]);
        assert_eq!(numbers(&gpu, &mut sums, "sum"), [5; 64]);
    }
}

/// The frame at rest is the first one of its kind while another waits to be asked for its report.
#[test]
fn an_encoder_of_another_device_at_rest_is_no_panic() {
    let (gpu, other_gpus) = devices();
    let make = compute("make", "run: OnChange,", r#""out": "made""#);
    let files = document("", &["made"], &[make], &["made"]).with("make.wgsl", writes("", "7u"));
    // The other instance first lacks numbers, and then has them for other things.
    let [beside, stranger] = &other_gpus;
    for (other, held) in [(beside, 0), (stranger, 0), (stranger, 256)] {
        other.device.on_uncaptured_error(Arc::new(|_| {}));
        let buffers = |gpu: &Gpu| -> Vec<_> {
            let buffers = (0..held).map(|_| buffer(&gpu.device, 0, false));
            buffers.collect()
        };
        let _held = buffers(other);
        drop(buffers(&gpu));
        let plan = right(load(&files)).plan(&PlanRequest::new([8, 8], &NoProvider));
        let mut executor = Executor::on(&gpu, right(plan), &mut NoProvider).unwrap();
        let read = Frame::new().with_read(&["made"]);
        let mut encoder = gpu.device.create_command_encoder(&Default::default());
        executor.encode(&mut encoder, &read).unwrap();
        gpu.queue.submit([encoder.finish()]);
        let wait = wgpu::PollType::wait_indefinitely();
        gpu.device.poll(wait).unwrap();
        let mut encoder = other.device.create_command_encoder(&Default::default());
        match executor.encode(&mut encoder, &read) {
            Ok(_) => drop(encoder.finish()),
            error => refused(error, "the encoder", "executor's device"),
        }
        let report = executor.finish().unwrap();
        assert_eq!(report.readbacks[0].content.as_u32().unwrap(), [7]);
        let mut encoder = gpu.device.create_command_encoder(&Default::default());
        executor.encode(&mut encoder, &read).unwrap();
        gpu.queue.submit([encoder.finish()]);
        let report = executor.finish().unwrap();
        assert_eq!(report.readbacks[0].content.as_u32().unwrap(), [7]);
    }
}
