//! Generated graphs of any number of passes, every one of which the output needs: what the
//! benchmarks plan and encode.

pub mod chain;

use skiagraph_gpu::device::{self, Gpu, Wanted};
use skiagraph_graph::{Graph, Plan, PlanRequest, Registry, Sources};
use std::{collections::BTreeMap, sync::Arc};

/// Width and height of the generated graphs' textures: planning and encoding do not depend on it.
pub const VIEWPORT: [u32; 2] = [16, 16];

/// Opens an adapter and prints its name, with the text of `unit` behind; without one, prints that
/// nothing was measured.
pub fn open(wanted: &Wanted, unit: &str) -> Option<Gpu> {
    let gpu = open_quietly(wanted)?;
    let info = gpu.adapter.get_info();
    println!(
        "adapter: {} ({:?}, {} {}){unit}",
        info.name, info.backend, info.driver, info.driver_info
    );
    Some(gpu)
}

/// Opens an adapter; without one, prints that nothing was measured.
pub fn open_quietly(wanted: &Wanted) -> Option<Gpu> {
    let opened = device::open_with(wanted);
    let opened = opened.inspect_err(|error| println!("NOTHING WAS MEASURED: {error}"));
    opened.ok()
}

/// Returns the plan of a document.
///
/// # Panics
/// If the document has mistakes, or cannot be planned.
pub fn planned(
    path: &str,
    (registry, sources): (&Registry, &dyn Sources),
    request: &PlanRequest<'_>,
) -> Plan {
    Graph::load(path, registry, sources)
        .and_then(|graph| graph.plan(request))
        .unwrap_or_else(|faults| panic!("{faults}"))
}

/// Returns the value in the middle of some.
pub fn median(values: impl Iterator<Item = f64>) -> f64 {
    let mut values: Vec<f64> = values.collect();
    values.sort_by(f64::total_cmp);
    values[values.len() / 2]
}

/// How many shaders a generated graph has.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Shaders {
    /// One of each sort, used by all passes of the sort.
    #[default]
    Few,
    /// Every pass that has a shader has a file of its own.
    OnePerPass,
}

/// A document `graph.ron` with its shaders, in memory.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Generated {
    files: BTreeMap<String, String>,
    /// Number of passes by kind.
    pub kinds: BTreeMap<&'static str, usize>,
}

impl Sources for Generated {
    fn read(&self, path: &str) -> Result<Option<Arc<str>>, String> {
        Ok(self.files.get(path).map(|text| text.as_str().into()))
    }

    fn list(&self, _: &str) -> Vec<String> {
        self.files.keys().cloned().collect()
    }
}

const FILL: &str = include_str!("shaders/fill.wgsl");

const ONE: &str = include_str!("shaders/one.wgsl");

const TWO: &str = include_str!("shaders/two.wgsl");

const DRAW: &str = include_str!("shaders/draw.wgsl");

const STORE: &str = include_str!("shaders/store.wgsl");

/// A graph of exactly `passes` passes (1 at least), the same for the same `seed`.
///
/// The passes are chosen at random among
/// ```text
/// source   Fullscreen         ─▶ new          fan-out  Fullscreen any ─▶ new
/// chain    Fullscreen | Compute | Raster with depth | Copy: open ─▶ new
/// join     Fullscreen open, open ─▶ new
/// over     Clear new, then Raster open ─▶ new, what was cleared is kept
/// turns    Fullscreen ping ─▶ pong ─▶ ping …; Copy ─▶ new     (written again and again)
/// mips     Fullscreen open ─▶ mip 0 ─▶ mip 1 ─▶ mip 2; Fullscreen all mips ─▶ new
/// ```
/// where `open` is a texture that no pass has read yet. The chain's full-screen passes have a
/// param, `strength`. Materials left open in the end are joined, so that no pass is culled.
pub fn graph(passes: usize, shaders: Shaders, seed: u64) -> Generated {
    let mut writer = Writer {
        shaders,
        ..Writer::default()
    };
    let mut random = Random(seed);
    let mut open = vec![writer.source()];
    let mut every = open.clone();
    while writer.passes < passes {
        let left = passes - writer.passes;
        // Each open texture but one takes a join in the end.
        let joins = open.len() - 1;
        if left <= joins {
            let (b, a) = (open.pop(), open.pop());
            open.extend(a.zip(b).map(|(a, b)| writer.join(&a, &b)));
            continue;
        }
        let spare = left - joins;
        let taken = |open: &mut Vec<String>, random: &mut Random| {
            let index = random.below(open.len());
            open.swap_remove(index)
        };
        let made = match random.below(12) {
            0 if spare >= 2 => writer.source(),
            1 | 2 if spare >= 2 => writer.fullscreen(&every[random.below(every.len())]),
            3 if open.len() > 1 => {
                let a = taken(&mut open, &mut random);
                let b = taken(&mut open, &mut random);
                writer.join(&a, &b)
            }
            4 if spare >= 2 => writer.over(&taken(&mut open, &mut random)),
            5 if spare >= 5 => {
                let turns = 2 + random.below(3);
                writer.turns(&taken(&mut open, &mut random), turns)
            }
            6 if spare >= 4 => writer.mips(&taken(&mut open, &mut random)),
            7 => writer.raster(&taken(&mut open, &mut random)),
            8 => writer.copy(&taken(&mut open, &mut random)),
            9 | 10 => writer.compute(&taken(&mut open, &mut random)),
            _ => writer.fullscreen(&taken(&mut open, &mut random)),
        };
        every.push(made.clone());
        open.push(made);
    }
    writer.document(&open)
}

/// `splitmix64` (Steele, Lea, Flood: Fast splittable pseudorandom number generators, 2014): a
/// sequence that stays the same whatever happens to libraries. Its seed.
pub struct Random(pub u64);

impl Random {
    /// A number below `end`, which is not 0.
    pub fn below(&mut self, end: usize) -> usize {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut bits = self.0;
        bits = (bits ^ (bits >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        bits = (bits ^ (bits >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        ((bits ^ (bits >> 31)) % end as u64) as usize
    }
}

/// Writes the document pass by pass. Methods that make something return its name.
#[derive(Default)]
struct Writer {
    shaders: Shaders,
    generated: Generated,
    materials: String,
    body: String,
    passes: usize,
    has_turns: bool,
    has_param: bool,
}

impl Writer {
    fn material(&mut self, name: &str, format: &str) {
        self.materials += &format!("        Texture(name: \"{name}\", format: {format}),\n");
    }

    /// The name of a texture that the next pass writes.
    fn new_texture(&mut self) -> String {
        let name = format!("texture_{}", self.passes);
        self.material(&name, "Rgba16Float");
        name
    }

    fn pass(&mut self, kind: &'static str, fields: &str) {
        *self.generated.kinds.entry(kind).or_default() += 1;
        let number = self.passes;
        self.body += &format!("        {kind}(name: \"pass_{number}\", {fields}),\n");
        self.passes += 1;
    }

    /// The field `shader` of the next pass.
    fn shader(&mut self, name: &str, text: &str) -> String {
        let name = match self.shaders {
            Shaders::Few => name.to_owned(),
            Shaders::OnePerPass => format!("{name}_{}", self.passes),
        };
        let file = format!("{name}.wgsl");
        self.generated.files.insert(file, text.to_owned());
        format!("shader: \"{name}\"")
    }

    fn source(&mut self) -> String {
        let made = self.new_texture();
        let shader = self.shader("fill", FILL);
        self.pass("Fullscreen", &format!("{shader}, {}", color(&made)));
        made
    }

    fn fullscreen(&mut self, from: &str) -> String {
        let made = self.new_texture();
        self.fullscreen_onto(from, &made);
        made
    }

    fn fullscreen_onto(&mut self, from: &str, to: &str) {
        self.has_param = true;
        let shader = self.shader("one", ONE);
        let fields = format!("{shader}, bind: {{\"a\": \"{from}\"}}, {}", color(to));
        self.pass("Fullscreen", &fields);
    }

    fn join(&mut self, a: &str, b: &str) -> String {
        let made = self.new_texture();
        let shader = self.shader("two", TWO);
        let bind = format!("bind: {{\"a\": \"{a}\", \"b\": \"{b}\"}}");
        self.pass("Fullscreen", &format!("{shader}, {bind}, {}", color(&made)));
        made
    }

    fn raster(&mut self, from: &str) -> String {
        let made = self.new_texture();
        let depth = format!("depth_{}", self.passes);
        self.material(&depth, "Depth32Float");
        let shader = self.shader("draw", DRAW);
        let fields = format!(
            "{shader}, draw: 3, bind: {{\"a\": \"{from}\"}}, {}, depth: (target: \"{depth}\", \
             load: Clear(1.0), compare: Less)",
            color(&made)
        );
        self.pass("Raster", &fields);
        made
    }

    fn compute(&mut self, from: &str) -> String {
        let made = self.new_texture();
        let shader = self.shader("store", STORE);
        let fields = format!(
            "{shader}, dispatch: Over(\"{made}.size\"), bind: {{\"a\": \"{from}\", \"made\": \
             \"{made}\"}}, overwrites: [\"{made}\"]"
        );
        self.pass("Compute", &fields);
        made
    }

    fn copy(&mut self, from: &str) -> String {
        let made = self.new_texture();
        self.pass("Copy", &format!("from: \"{from}\", to: \"{made}\""));
        made
    }

    fn over(&mut self, from: &str) -> String {
        let made = self.new_texture();
        self.pass("Clear", &format!("target: \"{made}\""));
        let shader = self.shader("draw", DRAW);
        let fields = format!(
            "{shader}, draw: 3, bind: {{\"a\": \"{from}\"}}, color: [(target: \"{made}\", load: \
             Load)]"
        );
        self.pass("Raster", &fields);
        made
    }

    fn turns(&mut self, from: &str, turns: usize) -> String {
        if !std::mem::replace(&mut self.has_turns, true) {
            self.material("ping", "Rgba16Float");
            self.material("pong", "Rgba16Float");
        }
        let mut last = from;
        for turn in 0..turns {
            let next = ["ping", "pong"][turn % 2];
            self.fullscreen_onto(last, next);
            last = next;
        }
        self.copy(last)
    }

    fn mips(&mut self, from: &str) -> String {
        let chain = format!("chain_{}", self.passes);
        let level = |mip: usize| format!("{chain}.mip[{mip}]");
        self.material(&chain, "Rgba16Float, mips: 3");
        self.fullscreen_onto(from, &level(0));
        self.fullscreen_onto(&level(0), &level(1));
        self.fullscreen_onto(&level(1), &level(2));
        self.fullscreen(&chain)
    }

    fn document(mut self, open: &[String]) -> Generated {
        let output = |(index, name)| format!("(name: \"output_{index}\", material: \"{name}\")");
        let outputs: Vec<String> = open.iter().enumerate().map(output).collect();
        let param = "F32(name: \"strength\", default: 0.5)";
        let params = if self.has_param { param } else { "" };
        let text = format!(
            "(\n    format: 3,\n    params: [{params}],\n    \
             materials: [\n{}    ],\n    passes: [\n{}    ],\n    outputs: [{}],\n)\n",
            self.materials,
            self.body,
            outputs.join(", ")
        );
        self.generated.files.insert("graph.ron".to_owned(), text);
        self.generated
    }
}

fn color(target: &str) -> String {
    format!("color: [\"{target}\"]")
}
