//! Work of the CPU in the middle of a frame: what it is given, what the passes behind it see, and
//! who may run it.

use crate::buffers::{compute, shader, writes};
use crate::host::{GPU, encoder, request, words};
use crate::support::{Files, right};
use serde::Deserialize;
use skiagraph_gpu::{CpuWork, ExecuteError, Executor, Frame, Provider, ProviderError};
use skiagraph_graph::{
    Describe, Graph, Lowering, NoProvider, PassKind, Plan, PlanRequest, Provided, Reference,
    Registry,
    step::{CpuCall, CpuItems, Step},
};
use std::{cell::Cell, sync::Arc};

/// Has the host's `host.adder` add `add` to each of `count` numbers of `from`, into `to`.
#[derive(Debug, Deserialize)]
struct Add {
    from: Reference,
    to: Reference,
    count: Reference,
    work: String,
    #[serde(default = "four")]
    bytes: u64,
}

fn four() -> u64 {
    4
}

impl PassKind for Add {
    fn lower(&self, pass: &mut Lowering<'_>) {
        let items = |buffer: &Reference| CpuItems {
            buffer: buffer.into(),
            bytes: self.bytes,
        };
        pass.step(Step::Cpu(CpuCall {
            work: pass.named(&self.work),
            entry: "add".to_owned(),
            count: (&self.count).into(),
            reads: vec![items(&self.from)],
            writes: items(&self.to),
        }));
    }
}

/// Gives an adder, another one for another number.
struct Given(u32);

impl Describe for Given {
    fn names(&self) -> Vec<String> {
        vec!["host.adder".to_owned()]
    }

    fn describe(&self, name: &str) -> Option<Provided> {
        (name == "host.adder").then_some(Provided::CPU_WORK)
    }
}

impl Provider for Given {
    fn version(&self, _: &str) -> u64 {
        u64::from(self.0)
    }

    fn has_versions(&self) -> bool {
        true
    }

    fn build(
        &mut self,
        name: &str,
        _: &wgpu::Device,
        _: &wgpu::Queue,
    ) -> Result<wgpu::Buffer, ProviderError> {
        Err(ProviderError::new(format!("`{name}` is not a buffer")))
    }

    fn build_cpu_work(&mut self, _: &str) -> Result<Arc<dyn CpuWork>, ProviderError> {
        Ok(Arc::new(Adder(self.0)))
    }
}

thread_local! {
    /// True while all work fails.
    static FAILS: Cell<bool> = const { Cell::new(false) };
}

#[derive(Debug)]
struct Adder(u32);

impl CpuWork for Adder {
    fn run(&self, entry: &str, reads: &[&[u8]], writes: &mut [u8]) -> Result<(), ProviderError> {
        assert_eq!((entry, reads.len()), ("add", 1));
        assert_eq!(reads[0].len(), writes.len());
        if self.0 == 0 || FAILS.get() {
            return Err(ProviderError::new("adds nothing".to_owned()));
        }
        for (from, to) in reads[0].chunks(4).zip(writes.chunks_mut(4)) {
            let number = u32::from_ne_bytes(from.try_into().unwrap());
            to.copy_from_slice(&(number + self.0).to_ne_bytes());
        }
        Ok(())
    }
}

/// Fills four numbers, adds to the first three on the CPU, and doubles all four on the GPU.
fn files(add: &str) -> Files {
    let fill = compute("fill", "", "");
    let double = compute("double", "", "");
    let add = format!("Add(name: \"add\", from: \"numbers\", to: \"sums\", {add}),");
    Files::graph(&format!(
        "materials: [Buffer(name: \"numbers\", count: 4), Buffer(name: \"sums\", count: 4),
            Buffer(name: \"number\"), Buffer(name: \"doubled\", count: 4)],
        passes: [{fill} {add} {double}], outputs: [\"doubled\", \"sums\"]"
    ))
    .with(
        "fill.wgsl",
        shader(
            "var<storage, read_write> numbers: array<u32>;
            var<storage, read_write> sums: array<u32>;
            var<storage, read_write> number: u32;",
            "number = 3u; for (var i = 0u; i < 4u; i++) { numbers[i] = 10u * i; sums[i] = 9u; }",
        ),
    )
    .with(
        "double.wgsl",
        shader(
            "var<storage, read> sums: array<u32>; var<storage, read_write> doubled: array<u32>;",
            "for (var i = 0u; i < 4u; i++) { doubled[i] = 2u * sums[i]; }",
        ),
    )
}

const ADD: &str = "count: \"number\", work: \"host.adder\"";

fn graph(files: &Files) -> Arc<Graph> {
    let mut registry = Registry::standard();
    registry.register::<Add>("Add");
    Arc::new(right(Graph::load("graph.ron", &registry, files)))
}

fn executor(provider: &mut Given) -> Executor {
    let plan = right(graph(&files(ADD)).plan(&request(provider)));
    Executor::new(&GPU.device, &GPU.queue, plan, provider).unwrap_or_else(|error| panic!("{error}"))
}

fn doubled(executor: &mut Executor) -> Vec<u32> {
    let frame = Frame::new().with_read(&["doubled"]).with_timing(true);
    let submitted = executor.submit(&frame, &|| false);
    submitted.unwrap_or_else(|error| panic!("{error}"));
    let report = executor.finish().unwrap();
    let passes = report.timing.unwrap().passes;
    let names: Vec<&str> = passes.iter().map(|pass| &*pass.name).collect();
    assert_eq!(names, ["fill", "add", "double"]);
    report.readbacks[0].content.as_u32().unwrap()
}

#[test]
fn the_cpu_works_between_two_passes_of_the_gpu() {
    let mut provider = Given(7);
    let mut executor = executor(&mut provider);
    // The number beyond the count stays as it was.
    for _ in 0..2 {
        assert_eq!(doubled(&mut executor), [14, 34, 54, 18]);
    }
    provider.0 = 8;
    executor.refresh(&mut provider).unwrap();
    assert_eq!(doubled(&mut executor), [16, 36, 56, 18]);
}

#[test]
fn a_frame_that_does_not_wait_is_refused_and_says_what_does() {
    let mut executor = executor(&mut Given(1));
    let refused = executor.encode(&mut encoder(), &Frame::default());
    let Err(error @ ExecuteError::OnCpu { .. }) = refused else {
        panic!("{refused:?}");
    };
    let text = error.to_string();
    assert!(text.contains("pass `add` works on the CPU"), "{text}");
    assert!(text.contains("`Executor::submit`"), "{text}");
}

#[test]
fn work_that_fails_ends_its_frame_alone() {
    let mut provider = Given(0);
    let mut executor = executor(&mut provider);
    let failed = executor.submit(&Frame::default(), &|| false);
    let message = failed.unwrap_err().to_string();
    assert_eq!(
        message,
        "the work `host.adder` on the CPU failed: adds nothing"
    );
    provider.0 = 2;
    executor.refresh(&mut provider).unwrap();
    assert_eq!(doubled(&mut executor), [4, 24, 44, 18]);
}

/// It has overwritten what the frames before it left.
#[test]
fn no_frame_rests_on_one_whose_work_failed() {
    for run in ["", "run: OnChange,"] {
        rests_on_no_failed_frame(run);
    }
}

fn rests_on_no_failed_frame(run: &str) {
    let mut provider = Given(2);
    let add = format!("{ADD}, {run}");
    let files = ["fill", "double"].iter().fold(files(&add), |files, pass| {
        let name = format!("name: \"{pass}\",");
        files.edited("graph.ron", &name, &format!("{name} {run}"))
    });
    let plan = right(graph(&files).plan(&request(&provider)));
    let mut executor = Executor::new(&GPU.device, &GPU.queue, plan, &mut provider).unwrap();
    let sums = |executor: &mut Executor| {
        let frame = Frame::new().with_read(&["sums"]);
        executor.submit(&frame, &|| false).unwrap();
        let report = executor.finish().unwrap();
        (words(&report, 0), report.skipped.len())
    };
    assert_eq!(sums(&mut executor), (vec![2, 12, 22, 9], 0));
    assert_eq!(sums(&mut executor), (vec![2, 12, 22, 9], 3));
    FAILS.set(true);
    let failed = executor.submit(&Frame::new().with_all(true), &|| false);
    FAILS.set(false);
    assert!(matches!(failed, Err(ExecuteError::CpuWork { .. })));
    assert_eq!(sums(&mut executor), (vec![2, 12, 22, 9], 0));
    assert_eq!(sums(&mut executor), (vec![2, 12, 22, 9], 3));
}

/// Commands in front of the work that wgpu refuses are an error; the CPU gets nothing stale.
#[test]
fn commands_before_the_work_that_are_refused_are_an_error() {
    let mut provider = Given(2);
    let plan = right(graph(&files(ADD)).plan(&request(&provider)));
    let mut executor = Executor::new(&GPU.device, &GPU.queue, plan, &mut provider).unwrap();
    let frame = Frame::new();
    assert_eq!(executor.submit(&frame, &|| false).unwrap(), 0);
    executor.output_buffer("sums").unwrap().destroy();
    // Else it may rest: nothing has changed.
    let refused = executor.submit(&frame.with_all(true), &|| false);
    assert!(
        matches!(refused, Err(ExecuteError::Refused { frame: 1, .. })),
        "{refused:?}"
    );
}

#[test]
fn a_frame_without_such_work_is_submitted_as_well() {
    let files = Files::graph(
        "materials: [Buffer(name: \"out\", count: 1)],
        passes: [Compute(name: \"one\", dispatch: Groups(1, 1, 1))], outputs: [\"out\"]",
    )
    .with("one.wgsl", writes("", "1u"));
    let plan: Plan = right(graph(&files).plan(&request(&NoProvider)));
    let mut executor = Executor::new(&GPU.device, &GPU.queue, plan, &mut NoProvider).unwrap();
    let asked = Cell::new(0);
    let frame = Frame::new().with_read(&["out"]);
    let index = executor.submit(&frame, &|| {
        asked.set(asked.get() + 1);
        true
    });
    assert_eq!(index.unwrap(), 0);
    let report = executor.finish().unwrap();
    assert_eq!(report.readbacks[0].content.as_u32().unwrap(), [1]);
    assert_eq!(asked.get(), 0, "nothing was waited for");
}

#[test]
fn what_does_not_fit_the_work_is_told() {
    let provider = Given(1);
    let wrong = |add: &str, provider: &dyn Describe| {
        let request: PlanRequest<'_> = request(provider);
        graph(&files(add)).plan(&request).unwrap_err().to_string()
    };
    let text = wrong(&format!("{ADD}, bytes: 8"), &provider);
    assert!(text.contains("have 4 bytes, the CPU's 8"), "{text}");
    let text = wrong("count: \"host.adder\", work: \"host.adder\"", &provider);
    assert!(
        text.contains("`host.adder` has no items for the CPU"),
        "{text}"
    );
    let text = wrong(ADD, &NoProvider);
    assert!(
        text.contains("`host.adder` does no work on the CPU"),
        "{text}"
    );
}
