//! The presets with their passes in another order: the frame is the same, to the bit.

use crate::support::graphs::{layered, open, provider, run};
use crate::support::meshes::box_over_floor;
use glam::{DVec3, Vec3};
use skiagraph_gpu::Content;
use skiagraph_graph::{Access, Graph, Origin, Plan, PlanRequest, Sources};
use skiagraph_passes::{EmbeddedSources, SceneProvider, presets, registry};
use skiagraph_scene::{DirectionalLight, Scene, View};
use std::{collections::BTreeSet, sync::Arc};

const VIEWPORT: [u32; 2] = [32, 24];

fn scene() -> Arc<Scene> {
    let view = View {
        eye: DVec3::new(0.5, 5.0, 7.0),
        direction: DVec3::new(0.0, -0.7, -1.0),
        ..View::default()
    };
    Arc::new(Scene {
        name: "box".into(),
        mesh: box_over_floor(4.0, Vec3::new(1.0, 0.4, 1.0)),
        views: vec![view],
        lights: vec![DirectionalLight::new(DVec3::new(-0.4, -1.0, 0.3)).into()],
    })
}

/// An entry of `passes` in a flat document: its text up to the entries within it, these, and the
/// rest.
struct Entry {
    head: String,
    within: Vec<Entry>,
    tail: String,
}

impl Entry {
    /// Reads the entries at the start of `lines`, each of which begins in this column.
    fn read<'l>(lines: &mut std::iter::Peekable<impl Iterator<Item = &'l str>>) -> Vec<Self> {
        let column = |line: &str| line.len() - line.trim_start().len();
        let mut entries: Vec<Self> = Vec::new();
        let first = lines.peek().map_or(0, |line| column(line));
        while let Some(line) = lines.next_if(|line| column(line) >= first) {
            if column(line) == first && !line.trim_start().starts_with(')') {
                let [head, tail] = [line.to_owned() + "\n", String::new()];
                let within = Vec::new();
                entries.push(Self { head, within, tail });
                continue;
            }
            let entry = entries.last_mut().expect("the first line begins an entry");
            let is_text = if entry.within.is_empty() {
                &mut entry.head
            } else {
                &mut entry.tail
            };
            *is_text += &(line.to_owned() + "\n");
            if line.trim() == "passes: [" {
                entry.within = Self::read(lines);
            }
        }
        entries
    }

    /// Returns the name that the entry gives to its passes.
    fn name(&self) -> &str {
        let behind = |word: &str| Some(self.head.split_once(word)?.1.split('"').next().unwrap());
        let first = self.head.lines().next().unwrap();
        if first.contains("name: \"") {
            return behind("name: \"").unwrap();
        }
        let path = behind("graph: \"").expect("an entry has a name or a graph");
        let file = path.rsplit('/').next().unwrap();
        file.strip_suffix(".ron").unwrap()
    }

    /// True if the entry may give names to entries below: it is, or holds, an include.
    fn gives_names(&self) -> bool {
        self.text().contains("Include(")
    }

    /// True if the entry's own passes hang on names of includes above.
    fn takes_names(&self) -> bool {
        let text = self.text();
        let words = ["Include(", "repeat: ", "if: "];
        words.iter().any(|word| text.contains(word))
    }

    fn text(&self) -> String {
        let within: String = self.within.iter().map(Self::text).collect();
        self.head.clone() + &within + &self.tail
    }
}

/// Pairs of passes, by their names without indices, that keep the order of the file.
fn tied(plan: &Plan) -> BTreeSet<[String; 2]> {
    let meet = |a: &Access, b: &Access| {
        let (a, b) = (&a.part, &b.part);
        let meet =
            |a: &std::ops::Range<u32>, b: &std::ops::Range<u32>| a.start < b.end && b.start < a.end;
        meet(&a.mips, &b.mips) && meet(&a.layers, &b.layers)
    };
    let mut tied = BTreeSet::new();
    for (id, resource) in plan.resources().iter().enumerate() {
        let uses = plan.all_passes().iter().enumerate().flat_map(|(at, pass)| {
            let accesses = pass.accesses.iter();
            let accesses = accesses.filter(|access| access.resource.index() == id);
            accesses.map(move |access| (at, access))
        });
        let uses: Vec<(usize, &Access)> = uses.collect();
        let writes: Vec<_> = uses.iter().filter(|(_, access)| access.writes).collect();
        let has_content = resource.keep || resource.origin != Origin::Own;
        let several = writes.iter().any(|(at, access)| {
            let mut writes = writes.iter();
            has_content || writes.any(|(other, write)| at != other && meet(access, write))
        });
        if several {
            let name = |at: &usize| without_indices(&plan.all_passes()[*at].name);
            for (one, _) in &uses {
                tied.extend(uses.iter().map(|(other, _)| [name(one), name(other)]));
            }
        }
    }
    tied
}

fn without_indices(name: &str) -> String {
    let parts = name
        .split('[')
        .map(|part| part.split_once(']').map_or(part, |it| it.1));
    parts.collect()
}

/// Puts the entries into another order in which passes that are tied keep theirs, and an entry
/// stays below the includes whose names it may need.
fn shuffle(entries: &mut Vec<Entry>, prefix: &str, tied: &BTreeSet<[String; 2]>, seed: &mut u64) {
    let mut open: Vec<Entry> = std::mem::take(entries);
    for entry in &mut open {
        let prefix = format!("{prefix}{}.", entry.name());
        shuffle(&mut entry.within, &prefix, tied, seed);
    }
    let is_of = |entry: &Entry, pass: &str| {
        let name = format!("{prefix}{}", entry.name());
        let behind = pass.strip_prefix(&name);
        behind.is_some_and(|behind| behind.is_empty() || behind.starts_with('.'))
    };
    while !open.is_empty() {
        let is_ready = |at: &usize| {
            let keeps = |above: &Entry| {
                let takes = above.gives_names() && open[*at].takes_names();
                let mut pairs = tied.iter();
                takes || pairs.any(|[one, other]| is_of(above, one) && is_of(&open[*at], other))
            };
            !open[..*at].iter().any(keeps)
        };
        let ready: Vec<usize> = (0..open.len()).filter(is_ready).collect();
        // SplitMix64.
        *seed = seed.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mixed = (*seed ^ (*seed >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        let mixed = (mixed ^ (mixed >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        let next = ready[((mixed ^ (mixed >> 31)) % ready.len() as u64) as usize];
        entries.push(open.remove(next));
    }
}

type Outputs = Vec<(String, Content)>;

fn outputs(plan: Plan, provider: &mut SceneProvider) -> Outputs {
    let readable = plan.readable().iter();
    let names = readable.map(|(name, _)| name.clone());
    // Casters that are behind what covers a texel are listed or not, as threads come.
    let names: Vec<String> = names.filter(|name| name != "entry_count").collect();
    let names: Vec<&str> = names.iter().map(String::as_str).collect();
    let readbacks = run(plan, provider, &names).readbacks.into_iter();
    readbacks.map(|it| (it.name, it.content)).collect()
}

/// Names of the live passes in the order in which they run.
fn order(plan: &Plan) -> Vec<String> {
    plan.passes().into_iter().map(|pass| pass.name).collect()
}

/// Holds orders of a preset's passes, one for each seed, against the order of the file. Returns how
/// many ran in another order than the file's.
fn holds(preset: &str, seeds: std::ops::Range<u64>) -> usize {
    let scene = scene();
    let provider = provider(&scene, &scene.views[0], VIEWPORT);
    let path = format!("pipelines/{preset}.ron");
    let needed = match preset {
        "crsm_hw" => wgpu::Features::CONSERVATIVE_RASTERIZATION,
        _ => wgpu::Features::empty(),
    };
    let planned = |sources: &dyn Sources| {
        let graph =
            Graph::load(&path, &registry(), sources).unwrap_or_else(|error| panic!("{error}"));
        let mut request = PlanRequest::new(VIEWPORT, &provider);
        request.features = open().device.features() | needed;
        graph
            .plan(&request)
            .unwrap_or_else(|error| panic!("{error}"))
    };
    let file = planned(&EmbeddedSources);
    let (in_file, tied) = (order(&file), tied(&file));
    // Where the device cannot run it, the plans alone are compared.
    let may_run = open().device.features().contains(needed);
    let run = |plan: Plan| may_run.then(|| outputs(plan, &mut provider.clone()));
    let expected = run(file);
    let flat = Graph::flat(&path, &registry(), &EmbeddedSources).unwrap();
    let (before, rest) = flat.split_once("    passes: [\n").unwrap();
    let mut moved = 0;
    for seed in seeds {
        let mut lines = rest.lines().peekable();
        let mut entries = Entry::read(&mut lines);
        shuffle(&mut entries, "", &tied, &mut seed.clone());
        let passes: String = entries.iter().map(Entry::text).collect();
        let after: Vec<&str> = lines.collect();
        let text = format!("{before}    passes: [\n{passes}{}\n", after.join("\n"));
        let sources = layered(&[(&path, &text)]);
        let shuffled = planned(&sources);
        let in_order = order(&shuffled);
        println!("{preset}, seed {seed}: {in_order:?}");
        let sorted = |names: &[String]| names.iter().cloned().collect::<BTreeSet<String>>();
        assert_eq!(
            sorted(&in_order),
            sorted(&in_file),
            "{preset}, seed {seed}\n{text}"
        );
        moved += usize::from(in_order != in_file || text != flat);
        let outputs = run(shuffled);
        let pairs = outputs.iter().flatten().zip(expected.iter().flatten());
        let differing: Vec<&str> = pairs
            .filter(|(one, other)| one != other)
            .map(|(one, _)| one.0.as_str())
            .collect();
        assert!(
            differing.is_empty(),
            "{preset}, seed {seed}: another {} by\n{text}",
            differing.join(", ")
        );
    }
    moved
}

#[test]
fn presets_in_another_order() {
    for preset in ["crsm", "light_buffer", "pssm"] {
        assert!(holds(preset, 0..2) > 0, "{preset} has one order alone");
    }
}

#[test]
#[ignore = "takes a minute"]
fn every_preset_in_ten_orders() {
    let moved = |preset: &skiagraph_passes::Preset| holds(&preset.name, 0..10) > 0;
    let moved = presets().iter().filter(|preset| moved(preset)).count();
    // In the rest every entry needs the one above it.
    assert!(moved >= 20, "only {moved} presets have another order");
}
