//! Provided resources: changed between frames that are submitted together, not set yet, or no
//! longer as planned.

use crate::buffers::{INPUT, compute, document, writes};
use crate::host::{GPU, encoder, frame, numbers, planned, request};
use crate::support::{Files, right};
use serde::Deserialize;
use skiagraph_gpu::{ExecuteError, Executor, Frame, Provider, ProviderError};
use skiagraph_graph::{
    Describe, Graph, Lowering, ParamValue, PassKind, Provided, ProvidedBinding, ProvidedKind,
    Reference, Registry, ResourceKind, step::Step,
};

/// Gives `host.value`, another buffer for another value.
struct Given {
    /// None that was not set yet.
    value: Option<u32>,
    items: u64,
    kind: u32,
    /// Items of `host.extra`, which no pass binds; it is not described if there are none.
    extra: u64,
}

const KIND: [&str; 2] = ["round", "square"];

impl Describe for Given {
    fn names(&self) -> Vec<String> {
        let names = ["host.value", "host.extra"].map(str::to_owned);
        let described = names
            .into_iter()
            .filter(|name| self.describe(name).is_some());
        described.collect()
    }

    fn describe(&self, name: &str) -> Option<Provided> {
        let items = match name {
            "host.value" => self.items,
            "host.extra" => self.extra,
            _ => 0,
        };
        let kind = ProvidedKind {
            words: &KIND,
            number: self.kind,
        };
        let described = Provided::new(ProvidedBinding::Storage, Some(items), 4).with_kind(kind);
        (items > 0).then_some(described)
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
        extra: 0,
    }
}

/// Takes the value of this frame, and that of the one before; `more` are fields of the first pass.
fn takes(more: &str) -> Files {
    let take = compute("take", more, r#""input": "host.value", "out": "seen""#);
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
    start_on(&takes(""), provider)
}

fn start_on(files: &Files, provider: &mut Given) -> Executor {
    let plan = planned(files, &request(provider));
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
    // No pass asks for the kind.
    let mut executor = start(&mut provider);
    let value = Some(7);
    let mut square = Given {
        kind: 1,
        value,
        ..one()
    };
    executor.refresh(&mut square).unwrap();
    frame(&mut executor, &[]);
    assert_eq!(numbers(&mut executor, "seen"), [7]);
    let any_kind = r#"if: "host.value.kind == round || host.value.kind == square","#;
    let mut executor = start_on(&takes(any_kind), &mut provider);
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
}

#[test]
fn other_numbers_of_items_are_planned_for_by_a_refresh() {
    let mut provider = one();
    let mut executor = start(&mut provider);
    frame(&mut executor, &[]);
    for items in [3, 2] {
        provider = Given {
            items,
            value: provider.value.map(|value| value + 1),
            ..provider
        };
        executor.refresh(&mut provider).unwrap();
        let id = executor
            .plan()
            .used()
            .find(|used| used.name == "host.value");
        let kind = &id.unwrap().kind;
        let ResourceKind::Provided(planned) = kind else {
            panic!("{kind:?}");
        };
        assert_eq!(planned.items, Some(items));
        frame(&mut executor, &[]);
        assert_eq!(numbers(&mut executor, "seen"), [provider.value.unwrap()]);
    }
}

/// A plan may be for another number of items than a provider has, also if the version is the same.
#[test]
fn a_plan_for_another_provider_is_refused() {
    let mut provider = one();
    let mut executor = start(&mut provider);
    let other = Given { items: 3, ..one() };
    let plan = executor.plan().with(|request| request.provider = &other);
    let refused = executor.replace_graph(plan.unwrap(), &mut provider);
    let error = refused.unwrap_err().to_string();
    let expected = "`host.value` has 1 items of 4 bytes now, but the graph was planned for 3 items";
    assert!(error.starts_with(expected), "{error}");
    frame(&mut executor, &[]);
    assert_eq!(numbers(&mut executor, "seen"), [1]);
}

/// Clears a texture to the number of items of `host.extra`.
#[derive(Debug, Deserialize)]
struct CountExtra {
    target: Reference,
}

impl PassKind for CountExtra {
    fn lower(&self, pass: &mut Lowering<'_>) {
        let items = pass.provided_items("host.extra") as f64;
        pass.step(Step::Clear {
            target: (&self.target).into(),
            value: [items, 0.0, 0.0, 0.0],
        });
    }
}

/// A kind may ask for a resource that the provider does not have yet.
#[test]
fn a_resource_that_comes_later_needs_another_plan() {
    let mut registry = Registry::standard();
    registry.register::<CountExtra>("CountExtra");
    let files = Files::graph(
        r#"materials: [Texture(name: "seen", format: R32Float, size: (1, 1))],
        passes: [CountExtra(name: "count", target: "seen")], outputs: ["seen"]"#,
    );
    let graph = right(Graph::load("graph.ron", &registry, &files));
    let mut provider = one();
    let plan = right(graph.plan(&request(&provider)));
    let mut executor = Executor::new(&GPU.device, &GPU.queue, plan, &mut provider).unwrap();
    let shown = |executor: &mut Executor| {
        let report = frame(executor, &["seen"]);
        report.readbacks[0]
            .content
            .as_f32()
            .expect("it holds numbers")
    };
    assert_eq!(shown(&mut executor), [0.0]);
    executor.refresh(&mut provider).unwrap();
    provider.extra = 2;
    let error = executor.refresh(&mut provider).unwrap_err().to_string();
    let expected = "the provider has `host.extra` now, but the graph was planned without it: plan";
    assert!(error.starts_with(expected), "{error}");
    let plan = executor.plan().with(|request| request.provider = &provider);
    executor
        .replace_graph(plan.unwrap(), &mut provider)
        .unwrap();
    assert_eq!(shown(&mut executor), [2.0]);
    provider.extra = 0;
    let error = executor.refresh(&mut provider).unwrap_err().to_string();
    let expected = "the provider no longer has `host.extra`, with which the graph was planned: ";
    assert!(error.starts_with(expected), "{error}");
}
