//! Provided resources: changed between frames that are submitted together, not set yet, or no
//! longer as planned.

use crate::buffers::{INPUT, compute, document, writes};
use crate::host::{GPU, encoder, frame, numbers, planned, request};
use crate::support::Files;
use skiagraph_gpu::{ExecuteError, Executor, Frame, Provider, ProviderError};
use skiagraph_graph::{Describe, ParamValue, Provided, ProvidedBinding, ProvidedKind};

/// Gives `host.value`, another buffer for another value.
struct Given {
    /// None that was not set yet.
    value: Option<u32>,
    items: u64,
    kind: u32,
}

const KIND: [&str; 2] = ["round", "square"];

impl Describe for Given {
    fn names(&self) -> Vec<String> {
        vec!["host.value".to_owned()]
    }

    fn describe(&self, name: &str) -> Option<Provided> {
        (name == "host.value").then_some(
            Provided::new(ProvidedBinding::Storage, Some(self.items), 4).with_kind(ProvidedKind {
                words: &KIND,
                number: self.kind,
            }),
        )
    }
}

impl Provider for Given {
    fn version(&self, _: &str) -> u64 {
        self.value.map_or(0, |value| 1 + u64::from(value))
    }

    fn missing(&self, _: &str) -> Option<String> {
        self.value.is_none().then(|| "set a value".to_owned())
    }

    fn build(
        &mut self,
        _: &str,
        device: &wgpu::Device,
        queue: &wgpu::Queue,
    ) -> Result<wgpu::Buffer, ProviderError> {
        let value = self.value.ok_or_else(|| "there is none".to_owned())?;
        let usage = wgpu::BufferUsages::STORAGE
            | wgpu::BufferUsages::COPY_DST
            | wgpu::BufferUsages::COPY_SRC;
        let buffer = device.create_buffer(&wgpu::BufferDescriptor {
            label: None,
            size: 4 * self.items,
            usage,
            mapped_at_creation: false,
        });
        queue.write_buffer(&buffer, 0, &value.to_ne_bytes());
        Ok(buffer)
    }
}

/// A value that was set.
fn one() -> Given {
    Given {
        value: Some(1),
        items: 1,
        kind: 0,
    }
}

/// Takes the value of this frame, and that of the one before.
fn takes() -> Files {
    let take = compute("take", "", r#""input": "host.value", "out": "seen""#);
    let before = compute(
        "before",
        "",
        r#""input": "host.value.previous", "out": "seen_before""#,
    );
    document(
        r#"U32(name: "factor", default: 1)"#,
        &["seen", "seen_before"],
        &[take, before],
        &["seen", "seen_before"],
    )
    .with("take.wgsl", FACTOR)
    .with("before.wgsl", writes(INPUT, "input[0]"))
}

const FACTOR: &str = "
    struct Params { factor: u32 }
    var<uniform> params: Params;
    var<storage, read> input: array<u32>;
    var<storage, read_write> out: array<u32>;
    @compute @workgroup_size(1) fn main() { out[0] = input[0] * params.factor; }";

fn start(provider: &mut Given) -> Executor {
    let plan = planned(&takes(), &request(provider));
    Executor::new(&GPU.device, &GPU.queue, plan, provider).unwrap_or_else(|error| panic!("{error}"))
}

const READ: Frame<'_> = Frame::new().with_read(&["seen", "seen_before"]);

/// The two numbers of the oldest frame.
fn seen(executor: &mut Executor) -> [u32; 2] {
    let report = executor.finish().unwrap_or_else(|error| panic!("{error}"));
    [0, 1].map(|index| crate::host::words(&report, index)[0])
}

#[test]
fn frames_of_one_submission_see_what_was_set_for_each() {
    let mut provider = one();
    let mut executors = [start(&mut provider), start(&mut provider)];
    let mut encoder = encoder();
    for round in 0..3 {
        for (number, executor) in executors.iter_mut().enumerate() {
            provider.value = Some(10 * (number as u32 + 1) + round);
            executor.refresh(&mut provider).unwrap();
            executor.encode(&mut encoder, &READ).unwrap();
        }
    }
    GPU.queue.submit([encoder.finish()]);
    for round in 0..3 {
        for (number, executor) in executors.iter_mut().enumerate() {
            let now = 10 * (number as u32 + 1) + round;
            let before = if round == 0 { now } else { now - 1 };
            assert_eq!(seen(executor), [now, before], "executor {number}");
        }
    }
}

/// Params that only uniforms hold, and those for which the graph is planned anew.
#[test]
fn frames_of_one_submission_have_the_params_that_were_set_for_each() {
    let mut provider = one();
    let mut executor = start(&mut provider);
    let mut encoder = encoder();
    let factors = [1, 2, 3, 2];
    for (index, factor) in factors.into_iter().enumerate() {
        let value = ParamValue::U32(factor);
        if index % 2 == 0 {
            executor.set_param("factor", value, &mut provider).unwrap();
        } else {
            let plan = executor.plan().with_param("factor", value).unwrap();
            executor.replace_graph(plan, &mut provider).unwrap();
        }
        executor.encode(&mut encoder, &READ).unwrap();
    }
    GPU.queue.submit([encoder.finish()]);
    for factor in factors {
        assert_eq!(seen(&mut executor)[0], factor);
    }
}

#[test]
fn what_is_not_set_yet_is_asked_for_again() {
    let mut provider = Given {
        value: None,
        ..one()
    };
    let mut executor = start(&mut provider);
    for _ in 0..2 {
        let error = executor.encode(&mut encoder(), &READ).unwrap_err();
        let ExecuteError::NotProvided { name, why, .. } = &error else {
            panic!("{error}");
        };
        assert_eq!([name, why], ["host.value", "set a value"]);
        executor.refresh(&mut provider).unwrap();
    }
    // A change of the plan has nothing to show either.
    executor.resize([9, 9], &mut provider).unwrap();
    assert!(executor.encode(&mut encoder(), &READ).is_err());
    provider.value = Some(5);
    executor.refresh(&mut provider).unwrap();
    frame(&mut executor, &[]);
    assert_eq!(numbers(&mut executor, "seen"), [5]);
    assert_eq!(numbers(&mut executor, "seen_before"), [5]);
    // A resource that is taken back is not shown as it was.
    provider.value = None;
    executor.refresh(&mut provider).unwrap();
    assert!(executor.encode(&mut encoder(), &READ).is_err());
}

#[test]
fn what_is_no_longer_as_planned_is_an_error_of_its_own() {
    let mut provider = one();
    let mut executor = start(&mut provider);
    let mut error = |provider: &mut Given| {
        provider.value = provider.value.map(|value| value + 1);
        let error = executor.refresh(provider).unwrap_err();
        assert!(
            matches!(error, ExecuteError::OtherThanPlanned { .. }),
            "{error}"
        );
        error.to_string()
    };
    let kind = error(&mut Given { kind: 1, ..one() });
    let expected =
        "`host.value` is square now, but the graph was planned for round: plan the graph";
    assert!(kind.starts_with(expected), "{kind}");
    let count = error(&mut Given { items: 3, ..one() });
    let expected = "`host.value` has 3 items of 4 bytes now, but the graph was planned for 1 items";
    assert!(count.starts_with(expected), "{count}");
}
