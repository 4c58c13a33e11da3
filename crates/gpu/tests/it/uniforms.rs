//! Uniforms whose bytes the provider tells: each frame reads those of its own refresh, whatever
//! becomes of the frames around it, in a buffer that stays.

use crate::buffers::{compute, document, writes};
use crate::host::{GPU, encoder, planned, request, words};
use crate::support::Files;
use skiagraph_gpu::{ExecuteError, Executor, Frame, Provider, ProviderError};
use skiagraph_graph::{Describe, ParamValue, Provided, ProvidedBinding};

/// A provider of one uniform.
#[derive(Default)]
pub struct Teller {
    pub value: u32,
    /// True if it builds a buffer instead of telling the bytes.
    builds: bool,
    fails: bool,
    /// True if what it builds fails.
    breaks: bool,
    built: Option<wgpu::Buffer>,
}

impl Describe for Teller {
    fn names(&self) -> Vec<String> {
        vec!["host.value".to_owned()]
    }

    fn describe(&self, name: &str) -> Option<Provided> {
        let described = Provided::new(ProvidedBinding::Uniform, Some(1), 4);
        (name == "host.value").then_some(described)
    }
}

impl Provider for Teller {
    fn version(&self, _: &str) -> u64 {
        u64::from(self.value)
    }

    fn has_versions(&self) -> bool {
        true
    }

    fn write_uniform(&mut self, _: &str, content: &mut [u8]) -> Result<bool, ProviderError> {
        if self.fails {
            return Err("the value is not known".into());
        }
        if !self.builds {
            content.copy_from_slice(&self.value.to_le_bytes());
        }
        Ok(!self.builds)
    }

    fn build(
        &mut self,
        _: &str,
        device: &wgpu::Device,
        queue: &wgpu::Queue,
    ) -> Result<wgpu::Buffer, ProviderError> {
        assert!(self.builds, "its bytes are told");
        if self.breaks {
            return Err("the buffer is broken".into());
        }
        let buffer = device.create_buffer(&wgpu::BufferDescriptor {
            label: None,
            size: 4,
            usage: wgpu::BufferUsages::UNIFORM
                | wgpu::BufferUsages::COPY_DST
                | wgpu::BufferUsages::COPY_SRC,
            mapped_at_creation: false,
        });
        queue.write_buffer(&buffer, 0, &self.value.to_le_bytes());
        self.built = Some(buffer.clone());
        Ok(buffer)
    }
}

/// The value, plus 100 × that of the frame before, plus 10,000 × a param.
pub fn files() -> Files {
    let take = compute(
        "take",
        "",
        r#""input": "host.value", "before": "host.value.previous", "out": "seen""#,
    );
    let param = r#"U32(name: "other", default: 0)"#;
    let globals = "struct Params { other: u32 } var<uniform> params: Params; \
                   var<uniform> input: u32; var<uniform> before: u32;";
    let sum = "input + before * 100u + params.other * 10000u";
    document(param, &["seen"], &[take], &["seen"]).with("take.wgsl", writes(globals, sum))
}

fn executor(provider: &mut Teller) -> Executor {
    let plan = planned(&files(), &request(provider));
    Executor::new(&GPU.device, &GPU.queue, plan, provider).unwrap_or_else(|error| panic!("{error}"))
}

/// Encodes a frame with another value.
fn encoded(executor: &mut Executor, provider: &mut Teller, value: u32) -> wgpu::CommandEncoder {
    provider.value = value;
    executor.refresh(provider).unwrap();
    let mut encoder = encoder();
    let frame = Frame::new().with_read(&["seen"]);
    executor.encode(&mut encoder, &frame).unwrap();
    encoder
}

fn seen(executor: &mut Executor) -> u32 {
    words(&executor.finish().unwrap(), 0)[0]
}

fn shown(executor: &mut Executor, provider: &mut Teller, value: u32) -> u32 {
    let encoder = encoded(executor, provider, value);
    GPU.queue.submit([encoder.finish()]);
    seen(executor)
}

#[test]
fn frames_of_one_submission_read_the_values_of_their_own() {
    let mut provider = Teller::default();
    let executor = &mut executor(&mut provider);
    let encoders = [3, 5, 8].map(|value| encoded(executor, &mut provider, value));
    GPU.queue.submit(encoders.map(wgpu::CommandEncoder::finish));
    assert_eq!([0; 3].map(|_| seen(executor)), [303, 305, 508]);
}

#[test]
fn a_lost_frame_leaves_no_value_behind() {
    let mut provider = Teller::default();
    let executor = &mut executor(&mut provider);
    assert_eq!(shown(executor, &mut provider, 3), 303);
    drop(encoded(executor, &mut provider, 5));
    // As if the lost frame had never been encoded, also where the value is that which it had.
    assert_eq!(shown(executor, &mut provider, 5), 305);
    drop(encoded(executor, &mut provider, 8));
    assert_eq!(shown(executor, &mut provider, 5), 505);
}

#[test]
fn a_uniform_outlasts_another_plan_and_another_way_to_give_it() {
    let mut provider = Teller::default();
    let executor = &mut executor(&mut provider);
    assert_eq!(shown(executor, &mut provider, 3), 303);
    let before = encoded(executor, &mut provider, 4);
    // The plan is another one, and the value, while that frame waits.
    provider.value = 5;
    let param = ParamValue::U32(1);
    executor.set_param("other", param, &mut provider).unwrap();
    let after = encoded(executor, &mut provider, 5);
    GPU.queue.submit([before.finish(), after.finish()]);
    assert_eq!([0; 2].map(|_| seen(executor)), [304, 10_405]);
    // A buffer that the provider has built is never written.
    provider.builds = true;
    assert_eq!(shown(executor, &mut provider, 6), 10_506);
    provider.builds = false;
    assert_eq!(shown(executor, &mut provider, 7), 10_607);
    let built = provider.built.take().unwrap();
    assert_eq!(crate::given::content(&built, encoder()), [6]);
}

#[test]
fn a_value_that_cannot_be_told_is_an_error_and_asked_for_again() {
    let mut provider = Teller::default();
    let executor = &mut executor(&mut provider);
    assert_eq!(shown(executor, &mut provider, 3), 303);
    (provider.value, provider.fails) = (4, true);
    let error = executor.refresh(&mut provider).unwrap_err();
    assert!(matches!(&error, ExecuteError::Provider { .. }), "{error}");
    assert!(error.to_string().contains("host.value"), "{error}");
    provider.fails = false;
    assert_eq!(shown(executor, &mut provider, 4), 304);
    // Told, and then to be built, which fails: the value that was told stays.
    provider.value = 5;
    executor.refresh(&mut provider).unwrap();
    (provider.value, provider.builds, provider.breaks) = (6, true, true);
    let error = executor.refresh(&mut provider).unwrap_err();
    assert!(error.to_string().contains("host.value"), "{error}");
    let mut encoder = encoder();
    let frame = Frame::new().with_read(&["seen"]);
    executor.encode(&mut encoder, &frame).unwrap();
    GPU.queue.submit([encoder.finish()]);
    assert_eq!(seen(executor), 405);
}
