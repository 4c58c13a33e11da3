//! Random documents, and an interpreter that runs them from top to bottom.

use crate::{
    buffers::{OUT, SEED, SEED_PARAM, compute},
    host::{LOSSES, Loss},
    support::Files,
};
use proptest::prelude::*;
use std::fmt::Write as _;

/// How a pass of a random document reads a material.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Read {
    Now(usize),
    Before(usize),
    Host,
}

#[derive(Clone, Debug)]
pub struct Pass {
    reads: Vec<Read>,
    /// Written: which material, all of it or its first half.
    target: usize,
    whole: bool,
    /// Run condition, if the material is kept: its writers need not have the same.
    run: usize,
    /// True if it adds to the content, if the material is kept.
    adds: bool,
    /// It is there only while the param `extra` is true.
    optional: bool,
}

/// A shader with an invocation for each of so many items of `out`.
fn each(globals: &str, items: usize, value: &str) -> String {
    format!(
        "{globals}
         @compute @workgroup_size({items}) fn main(@builtin(local_invocation_index) i: u32) {{
             out[i] = {value};
         }}"
    )
}

impl Pass {
    /// How many items it writes.
    fn items(&self) -> usize {
        if self.whole { ITEMS } else { ITEMS / 2 }
    }

    /// The entry of the document and the shader: a sum of what is read, times a large number.
    fn texts(&self, index: usize, run: &str, is_kept: bool) -> (String, String) {
        let target = self.target;
        let adds = is_kept && self.adds;
        let mut bind = format!("\"out\": \"m{target}\"");
        let mut globals = format!("{SEED} {OUT}\n");
        let mut sum = format!("{}u + params.seed", index + 1);
        for (number, read) in self.reads.iter().enumerate() {
            let source = match read {
                Read::Now(material) => format!("m{material}"),
                Read::Before(material) => format!("m{material}.previous"),
                Read::Host => "host".to_owned(),
            };
            let _ = write!(bind, ", \"r{number}\": \"{source}\"");
            let _ = writeln!(globals, "var<storage, read> r{number}: array<u32>;");
            let _ = write!(sum, " + {}u * r{number}[i]", 2 * number + 3);
        }
        if adds {
            sum.push_str(" + 13u * out[i]");
        }
        // A shader sees its own part of the memory alone.
        let _ = write!(sum, " + arrayLength(&out) - {}u", count(target));
        let overwrites = if self.whole && !adds {
            format!("overwrites: [\"m{target}\"],")
        } else {
            String::new()
        };
        let condition = if self.optional { "if: \"extra\"," } else { "" };
        let more = format!("run: {run}, {overwrites} {condition}");
        let pass = compute(&format!("p{index}"), &more, &bind);
        let value = format!("({sum}) * 2654435761u");
        (pass, each(&globals, self.items(), &value))
    }
}

/// Changes before a frame.
#[derive(Clone, Copy, Debug)]
pub enum Event {
    Nothing,
    Seed(u32),
    Flag(bool),
    Extra(bool),
    Host(u32),
    Resize(u32),
}

#[derive(Clone, Debug)]
pub struct Program {
    /// Run condition of each material's writer.
    runs: Vec<usize>,
    /// True for each material that has `keep: true`.
    kept: Vec<bool>,
    passes: Vec<Pass>,
    pub outputs: Vec<usize>,
    pub events: Vec<Event>,
    /// How the frame after each event is lost.
    pub losses: Vec<Option<Loss>>,
    pub poison: Option<u8>,
}

const MATERIALS: usize = 6;
/// Items of a material that passes write and read.
pub const ITEMS: usize = 4;

/// Number of items of a material: each has another size, so that several lie side by side in the
/// memory of one.
fn count(material: usize) -> usize {
    ITEMS + 70 * material
}

const RUNS: [&str; 4] = ["Always", "OnChange", "Once", "When(\"flag\")"];
/// Those of passes that write what is kept: that `OnChange` saves work is seen there, since what a
/// pass adds to is no reason to run it.
const RUNS_OF_KEPT: [usize; 3] = [0, 2, 3];

pub type Value = [u32; ITEMS];

impl Program {
    /// Run condition of a pass.
    fn run(&self, pass: &Pass) -> usize {
        if self.kept[pass.target] {
            pass.run
        } else {
            self.runs[pass.target]
        }
    }

    /// True if a pass reads the host's buffer. Only then does the document have it as an input, as
    /// with one each pass runs in every frame.
    pub fn reads_host(&self) -> bool {
        let mut passes = self.passes.iter();
        passes.any(|pass| pass.reads.contains(&Read::Host))
    }

    /// The document: every material that is not kept is set to zero before it is first used, so
    /// that lifetimes are short and memory is shared.
    pub fn files(&self) -> Files {
        let mut passes = String::new();
        let mut fresh: Vec<usize> = (0..MATERIALS).filter(|it| !self.kept[*it]).collect();
        let mut zero = |passes: &mut String, used: &dyn Fn(usize) -> bool| {
            for material in fresh.extract_if(.., |material| used(*material)) {
                passes.push_str(&self.zero(material));
            }
        };
        let mut files = Files::default().with("zero.wgsl", each(OUT, ITEMS, "0u"));
        for (index, pass) in self.passes.iter().enumerate() {
            zero(&mut passes, &|material| {
                material == pass.target || pass.reads.contains(&Read::Now(material))
            });
            let (pass, shader) = pass.texts(index, RUNS[self.run(pass)], self.kept[pass.target]);
            passes.push_str(&pass);
            files = files.with(&format!("p{index}.wgsl"), shader);
        }
        zero(&mut passes, &|_| true);
        let materials: String = (0..MATERIALS)
            .map(|material| {
                let keep = self.kept[material];
                let count = count(material);
                format!("Buffer(name: \"m{material}\", count: {count}, keep: {keep}), ")
            })
            .collect();
        let outputs: Vec<String> = self.outputs.iter().map(|at| format!("m{at}")).collect();
        let input = match self.reads_host() {
            true => "Buffer(name: \"host\")",
            false => "",
        };
        files.document(
            "graph.ron",
            &format!(
                "\n    params: [{SEED_PARAM} Bool(name: \"flag\", default: true), \
                 Bool(name: \"extra\", default: true)],\n    \
                 inputs: [{input}],\n    materials: [{materials}],\n    \
                 passes: [\n{passes}    ],\n    outputs: {outputs:?},\n"
            ),
        )
    }

    /// The pass that sets a material to zero: half of them are shaders, half clears, which may run
    /// ahead of other passes.
    fn zero(&self, material: usize) -> String {
        let run = RUNS[self.runs[material]];
        // The size of a buffer comes from the shaders that see it.
        let is_seen = self.passes.iter().any(|pass| {
            let sees = pass.target == material || pass.reads.contains(&Read::Now(material));
            sees && !pass.optional
        });
        if material % 2 == 1 && is_seen {
            return format!(
                "        Clear(name: \"zero{material}\", run: {run}, target: \"m{material}\"),\n"
            );
        }
        let more = format!("shader: \"zero\", run: {run}, overwrites: [\"m{material}\"],");
        let bind = format!("\"out\": \"m{material}\"");
        compute(&format!("zero{material}"), &more, &bind)
    }

    /// The outputs after each frame when every pass is run in file order, those that run `Once` in
    /// the first frame only and those that run by the flag when it is set. That `OnChange` saves
    /// work must not be seen. A frame that is lost is none.
    pub fn interpret(&self) -> Vec<Vec<Value>> {
        let mut now = [[0u32; ITEMS]; MATERIALS];
        let mut before = now;
        let (mut seed, mut flag, mut extra, mut host) = (5u32, true, true, 9u32);
        let mut frames = Vec::new();
        let mut number = 0;
        for (event, loss) in self.events.iter().zip(&self.losses) {
            match *event {
                Event::Seed(value) => seed = value,
                Event::Flag(value) => flag = value,
                Event::Extra(value) => extra = value,
                Event::Host(value) => host = value,
                Event::Nothing | Event::Resize(_) => {}
            }
            if loss.is_some() {
                frames.push(Vec::new());
                continue;
            }
            let runs = |run: usize| match run {
                2 => number == 0,
                3 => flag,
                _ => true,
            };
            for (material, value) in now.iter_mut().enumerate() {
                if !self.kept[material] && runs(self.runs[material]) {
                    *value = [0; ITEMS];
                }
            }
            for (index, pass) in self
                .passes
                .iter()
                .enumerate()
                .filter(|(_, pass)| runs(self.run(pass)) && (extra || !pass.optional))
            {
                let values: Vec<Value> = pass
                    .reads
                    .iter()
                    .map(|read| match read {
                        Read::Now(material) => now[*material],
                        Read::Before(material) => before[*material],
                        Read::Host => [host; ITEMS],
                    })
                    .collect();
                let adds = self.kept[pass.target] && pass.adds;
                for item in 0..pass.items() {
                    let before = if adds { now[pass.target][item] } else { 0 };
                    let sum = values.iter().enumerate().fold(
                        (index as u32 + 1)
                            .wrapping_add(seed)
                            .wrapping_add(before.wrapping_mul(13)),
                        |sum, (number, value)| {
                            sum.wrapping_add((2 * number as u32 + 3).wrapping_mul(value[item]))
                        },
                    );
                    now[pass.target][item] = sum.wrapping_mul(2_654_435_761);
                }
            }
            frames.push(self.outputs.iter().map(|material| now[*material]).collect());
            before = now;
            number += 1;
        }
        frames
    }
}

fn any_pass() -> impl Strategy<Value = Pass> {
    let read = prop_oneof![
        3 => (0..MATERIALS).prop_map(Read::Now),
        2 => (0..MATERIALS).prop_map(Read::Before),
        1 => Just(Read::Host),
    ];
    (
        prop::collection::vec(read, 0..3),
        0..MATERIALS,
        prop::bool::weighted(0.7),
        prop::bool::weighted(0.2),
        prop::sample::select(RUNS_OF_KEPT.to_vec()),
        any::<bool>(),
    )
        .prop_map(|(mut reads, target, whole, optional, run, adds)| {
            // A history begins with the first plan that reads it: so a pass that comes and goes
            // reads none, and does not decide which others are needed.
            let whole = whole && !optional;
            let keeps = |read: &Read| !(optional && matches!(read, Read::Before(_)));
            reads.retain(keeps);
            // A pass cannot bind what it writes a second time.
            reads.retain(|read| *read != Read::Now(target));
            Pass {
                reads,
                target,
                whole,
                run,
                adds,
                optional,
            }
        })
}

fn any_event() -> impl Strategy<Value = Event> {
    prop_oneof![
        3 => Just(Event::Nothing),
        2 => any::<u32>().prop_map(Event::Seed),
        1 => any::<bool>().prop_map(Event::Flag),
        2 => any::<bool>().prop_map(Event::Extra),
        2 => any::<u32>().prop_map(Event::Host),
        1 => (1..9u32).prop_map(Event::Resize),
    ]
}

fn any_loss() -> impl Strategy<Value = Option<Loss>> {
    prop_oneof![3 => Just(None), 1 => prop::sample::select(LOSSES.to_vec()).prop_map(Some)]
}

pub fn any_program() -> impl Strategy<Value = Program> {
    (
        prop::collection::vec(
            prop_oneof![3 => Just(0usize), 3 => Just(1), 1 => Just(2), 1 => Just(3)],
            MATERIALS,
        ),
        prop::collection::vec(prop::bool::weighted(0.3), MATERIALS),
        (prop::collection::vec(any_pass(), 1..12), any::<bool>()),
        prop::collection::btree_set(0..MATERIALS, 1..3),
        prop::collection::vec((any_event(), any_loss()), 3..9),
        prop_oneof![Just(None), Just(Some(0xa5))],
    )
        .prop_map(
            |(mut runs, mut kept, (mut passes, is_plain), mut outputs, events, poison)| {
                if is_plain {
                    // Nothing outlives the frame but the output: most of the memory is shared.
                    (runs, kept) = (vec![0; MATERIALS], vec![false; MATERIALS]);
                    outputs = passes.last().map(|pass| pass.target).into_iter().collect();
                    for pass in &mut passes {
                        pass.optional = false;
                        for read in &mut pass.reads {
                            if let Read::Before(material) = *read {
                                *read = Read::Now(material);
                            }
                        }
                    }
                }
                // A material that is read must be written, whichever passes are there.
                for (material, kept) in kept.iter_mut().enumerate() {
                    let writes = |pass: &Pass| pass.target == material && !pass.optional;
                    *kept &= passes.iter().any(writes);
                }
                for pass in &mut passes {
                    // A kept material has no version of the frame before but itself.
                    for read in &mut pass.reads {
                        if let Read::Before(material) = *read
                            && kept[material]
                        {
                            *read = Read::Now(material);
                        }
                    }
                    let target = pass.target;
                    pass.reads.retain(|read| *read != Read::Now(target));
                    // The result of a pass that ran once stays as it is only while the same passes
                    // make it.
                    let run = if kept[target] { pass.run } else { runs[target] };
                    pass.optional &= RUNS[run] != "Once";
                }
                // Without a pass that reads it a material may not be cleared first, and is made
                // anew without that usage: what a pass that ran once has read of it is then gone.
                if passes.iter().any(|pass| pass.optional) {
                    let run = |pass: &Pass| match kept[pass.target] {
                        true => pass.run,
                        false => runs[pass.target],
                    };
                    for pass in passes.iter_mut().filter(|pass| RUNS[run(pass)] == "Once") {
                        pass.reads.retain(|read| !matches!(read, Read::Now(_)));
                    }
                }
                // A pass that comes may make others needed: a history that one of those reads would
                // begin with that plan.
                if passes.iter().any(|pass| {
                    pass.reads
                        .iter()
                        .any(|read| matches!(read, Read::Before(_)))
                }) {
                    for pass in passes.iter_mut().filter(|pass| pass.optional) {
                        pass.reads.retain(|read| !matches!(read, Read::Now(_)));
                    }
                }
                // A material that only a removed pass reads would be lost with it.
                if passes.iter().any(|pass| pass.optional) {
                    outputs.extend(0..MATERIALS);
                }
                let (events, losses) = events.into_iter().unzip();
                Program {
                    runs,
                    kept,
                    passes,
                    outputs: outputs.into_iter().collect(),
                    events,
                    losses,
                    poison,
                }
            },
        )
}
