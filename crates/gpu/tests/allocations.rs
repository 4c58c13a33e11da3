//! Allocations of a frame on the host. An allocation is that of the crate whose code asked for it:
//! the innermost function on the stack that is neither of the standard library nor of a small
//! container. So what wgpu and the profiler allocate inside their calls is theirs, but what these
//! crates do inside a callback of wgpu's is ours. Counted are `encode`, `poll`, `touch`, `grow` and
//! `output_view`; the host's own submission is not.

#[path = "../../graph/tests/it/support/mod.rs"]
mod support;
#[path = "it/support/tiny.rs"]
mod tiny;

use skiagraph_gpu::{Executor, Frame};
use std::{
    alloc::{GlobalAlloc, Layout, System},
    cell::Cell,
    collections::HashMap,
    ffi::c_void,
    sync::{
        Mutex,
        atomic::{AtomicI64, Ordering},
    },
};
use support::{Files, Triangle};
use tiny::{GPU, encoder, made};

/// Return addresses, from the inside out, as many as lead to an owner.
type Stack = Vec<*mut c_void>;

const DEPTH: usize = 48;

/// Notes the stack of each allocation of a thread that asks for it, and how many bytes there are.
struct Counting;

#[global_allocator]
static ALLOCATOR: Counting = Counting;

/// Bytes that are allocated, by whomever.
static BYTES: AtomicI64 = AtomicI64::new(0);

thread_local! {
    static NOTES: Cell<Option<Vec<Stack>>> = const { Cell::new(None) };
}

impl Counting {
    fn note() {
        // Nothing is noted while one is being noted; none at all where the thread is at its end.
        let _ = NOTES.try_with(|notes| {
            if let Some(mut noted) = notes.take() {
                let mut stack = Vec::with_capacity(DEPTH);
                backtrace::trace(|frame| {
                    stack.push(frame.ip());
                    stack.len() < DEPTH
                });
                noted.push(stack);
                notes.set(Some(noted));
            }
        });
    }
}

#[expect(unsafe_code, reason = "a global allocator is unsafe by its signature")]
// SAFETY: everything is handed on to the system's allocator.
unsafe impl GlobalAlloc for Counting {
    unsafe fn alloc(&self, layout: Layout) -> *mut u8 {
        BYTES.fetch_add(layout.size() as i64, Ordering::Relaxed);
        Self::note();
        unsafe { System.alloc(layout) }
    }

    unsafe fn dealloc(&self, place: *mut u8, layout: Layout) {
        BYTES.fetch_sub(layout.size() as i64, Ordering::Relaxed);
        unsafe { System.dealloc(place, layout) }
    }
}

/// The stacks of what is allocated meanwhile on this thread.
fn stacks(what: impl FnOnce()) -> Vec<Stack> {
    NOTES.set(Some(Vec::new()));
    what();
    NOTES.take().unwrap_or_default()
}

/// Crates that own no allocation: they ask on behalf of their callers.
const ON_BEHALF: [&str; 7] = [
    "std",
    "core",
    "alloc",
    "smallvec",
    "hashbrown",
    "backtrace",
    "__rustc",
];

/// Whose code a function of a stack is: that of these crates, of the test, or of another crate.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Owner {
    Ours,
    Tests,
    Other,
}

/// Whose a function is, by its file where that is known, else by its name.
fn owner_of(name: &str, file: Option<&str>) -> Option<Owner> {
    if let Some(file) = file {
        let mut on_behalf = ON_BEHALF.iter();
        return match file {
            _ if file.starts_with("/rustc/") || file.contains("tests/allocations.rs") => None,
            _ if on_behalf.any(|name| file.contains(&format!("/{name}-"))) => None,
            _ if file.contains("/registry/") => Some(Owner::Other),
            _ if file.contains("tests/") => Some(Owner::Tests),
            _ => Some(Owner::Ours),
        };
    }
    let name = name.trim_start_matches(['<', '&', '*', '[', '(']);
    let name = name.trim_start_matches("mut ").trim_start_matches("dyn ");
    // A hash may stand behind the crate's name.
    let crate_name = name.split([':', '[', ' ']).next()?;
    match crate_name {
        _ if ON_BEHALF.contains(&crate_name) => None,
        _ if crate_name.starts_with("skiagraph") => Some(Owner::Ours),
        _ => Some(Owner::Other),
    }
}

/// Owners and functions found for return addresses.
type Known = HashMap<*mut c_void, Option<(Owner, String)>>;

/// Returns the owner of an allocation, and the function that asked for it.
fn owner(
    stack: &Stack,
    origins: &mut HashMap<*mut c_void, Option<(Owner, String)>>,
) -> (Owner, String) {
    for &place in stack {
        let origin = origins.entry(place).or_insert_with(|| {
            let mut origin = None;
            // Functions that were inlined come first.
            backtrace::resolve(place, |symbol| {
                let name = symbol.name().map_or(String::new(), |name| name.to_string());
                let file = symbol.filename().map(|file| file.display().to_string());
                let owner = owner_of(&name, file.as_deref());
                origin = origin
                    .take()
                    .or(owner.map(|owner| (owner, format!("{name} in {file:?}"))));
            });
            origin
        });
        if let Some(origin) = origin {
            return origin.clone();
        }
    }
    (Owner::Tests, String::new())
}

/// The functions among those that asked for some allocations that are these crates'.
fn ours(stacks: &[Stack]) -> Vec<String> {
    let mut origins = Known::new();
    let owners = stacks.iter().map(|stack| owner(stack, &mut origins));
    let ours = owners.filter(|(owner, _)| *owner == Owner::Ours);
    ours.map(|(_, function)| function).collect()
}

/// Some of everything that a frame may have: draws, dispatches, copies, clears, the uniform
/// `frame`, a history, passes that are skipped, a buffer that grows, a provided buffer as it was
/// before.
fn everything() -> Files {
    Files::graph(
        r#"
    materials: [
        Texture(name: "image", format: R32Float),
        Texture(name: "copy", format: R32Float),
        Texture(name: "still", format: R32Float),
        Buffer(name: "needed", count: 1),
        Buffer(name: "items", count: 4, grow: (counter: "needed", max: 64)),
        Buffer(name: "sum", count: 64),
    ],
    passes: [
        Fullscreen(name: "number", color: ["image"]),
        Fullscreen(name: "still", run: OnChange, shader: "number", color: ["still"]),
        Copy(name: "keep", from: "image", to: "copy"),
        Clear(name: "reset", target: "needed"),
        Compute(name: "fill", dispatch: Groups(1, 1, 1)),
        Compute(
            name: "add",
            dispatch: Over("sum.count"),
            bind: {"old": "sum.previous", "sum": "sum", "before": "light.previous"},
        ),
    ],
    outputs: ["copy", "still", "items", "sum"],
"#,
    )
    .with("number.wgsl", tiny::NUMBER)
    .with(
        "fill.wgsl",
        "var<storage, read_write> needed: array<u32>;
         var<storage, read_write> items: array<u32>;
         @compute @workgroup_size(1) fn main() { needed[0] = 3u; items[0] = 1u; }",
    )
    .with(
        "add.wgsl",
        "struct Frame { index: u32, seconds: f32 }
         var<uniform> frame: Frame;
         var<uniform> before: mat4x4<f32>;
         var<storage, read> old: array<u32>;
         var<storage, read_write> sum: array<u32>;
         @compute @workgroup_size(64) fn main(@builtin(global_invocation_id) id: vec3<u32>) {
             sum[id.x] = old[id.x] + frame.index + u32(before[0].x);
         }",
    )
}

/// All that a host calls in a frame, but its own submission.
fn frame(executor: &mut Executor, wanted: &Frame<'_>, count: &mut dyn FnMut(&mut dyn FnMut())) {
    let mut encoder = encoder();
    count(&mut || {
        executor
            .touch("light")
            .unwrap_or_else(|error| panic!("{error}"));
        executor
            .encode(&mut encoder, wanted)
            .unwrap_or_else(|error| panic!("{error}"));
        assert!(executor.output_view("copy").is_some());
    });
    GPU.queue.submit([encoder.finish()]);
    count(&mut || {
        let grown = executor.grow(&mut Triangle);
        assert!(grown.unwrap_or_else(|error| panic!("{error}")).is_none());
        // A report that is handed out is memory of the host.
        if wanted.read.is_empty() && !wanted.timing {
            let none = executor.poll().unwrap_or_else(|error| panic!("{error}"));
            assert!(none.is_none());
        }
    });
    let finished = executor.finish();
    finished.unwrap_or_else(|error| panic!("{error}"));
}

/// All threads' memory is counted, so the tests run one after the other.
static ALONE: Mutex<()> = Mutex::new(());

/// A frame allocates nothing once all that it needs is there, also one that is timed and read back
/// until its report is handed out.
#[test]
fn a_steady_frame_allocates_nothing_of_ours() {
    let _alone = ALONE.lock();
    let read = ["copy", "items", "sum"];
    let timed = Frame::new().with_timing(true).with_read(&read);
    let mut executor = made(&everything());
    // A self-check of the counter: a plan that is made anew allocates.
    let seen = stacks(|| {
        let resized = executor.resize([9, 9], &mut Triangle);
        resized.unwrap_or_else(|error| panic!("{error}"));
    });
    assert!(ours(&seen).len() > 50, "of {}", seen.len());
    for wanted in [Frame::default(), timed] {
        for _ in 0..8 {
            frame(&mut executor, &wanted, &mut |calls| calls());
        }
        let mut noted = Vec::new();
        for _ in 0..3 {
            frame(&mut executor, &wanted, &mut |calls| {
                noted.extend(stacks(calls))
            });
        }
        // wgpu allocates in every frame, so something was noted.
        assert!(!noted.is_empty());
        assert_eq!(ours(&noted), [""; 0], "of {} allocations", noted.len());
    }
}

/// Neither memory nor anything on the device becomes more over a thousand frames.
#[test]
fn a_thousand_frames_are_as_large_as_one() {
    let _alone = ALONE.lock();
    let wanted = Frame::new().with_timing(true).with_read(&["sum"]);
    let mut executor = made(&everything());
    let mut after = |frames: u32| {
        for _ in 0..frames {
            frame(&mut executor, &wanted, &mut |calls| calls());
        }
        BYTES.load(Ordering::Relaxed)
    };
    // The memory that wgpu and the harness keep goes up and down: the least of several times tells.
    // A word for each frame would be 4,000 bytes between them.
    let mut least = || (0..5).map(|_| after(100)).min().unwrap_or(0);
    let (first, last) = (least(), least());
    assert!(last < first + 2000, "{first} bytes became {last}");
}
