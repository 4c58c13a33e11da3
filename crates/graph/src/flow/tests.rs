//! Order, culling and schedule on bare lists of accesses: each graph is drawn above its case.

use super::{
    arrange::arrange,
    cull,
    order::{Hazard, Order, order, walk},
    schedule::sequence,
    view::GraphView,
};
use crate::{
    diagnostics::{Code, Diagnostic, Reports},
    instantiate::Run,
    link::{Access, LinkedPass, PassId, Usage},
    resource::{Buffer, Origin, Resource, ResourceId, ResourceKind, SubresourceRange, Target},
    source::{Located, SourceFile},
};
use proptest::prelude::*;
use std::collections::{BTreeMap, BTreeSet};

/// How a pass uses a resource.
#[derive(Clone, Copy, Debug, PartialEq)]
enum How {
    Read,
    /// Overwrites everything.
    Write,
    /// Overwrites some of it.
    Part,
    /// Reads and changes it: an atomic counter, a target that is loaded.
    Change,
}
use How::{Change, Part as Partly, Read, Write};

/// A use: resource, how, mips, layers.
type Use = (usize, How, std::ops::Range<u32>, std::ops::Range<u32>);

fn whole(resource: usize, how: How) -> Use {
    (resource, how, 0..1, 0..1)
}

const RESOURCES: usize = 4;

/// Resources of cases with one writer for most of them.
const MANY: usize = 8;

struct Case {
    passes: Vec<LinkedPass>,
    resources: Vec<Resource>,
    order: Order,
    diagnostics: Vec<Diagnostic>,
}

fn edges(order: &Order) -> BTreeSet<(usize, usize, Hazard)> {
    let edges = order.edges.raw_edges().iter();
    edges
        .map(|edge| (edge.source().index(), edge.target().index(), edge.weight))
        .collect()
}

/// Some buffers.
fn resources() -> Vec<Resource> {
    let buffer = |index| Resource {
        name: format!("r{index}"),
        declared: None,
        kind: ResourceKind::Buffer(Buffer::default()),
        origin: Origin::Own,
        growth: None,
        keep: false,
    };
    (0..MANY).map(buffer).collect()
}

fn part(mips: &std::ops::Range<u32>, layers: &std::ops::Range<u32>) -> SubresourceRange {
    SubresourceRange {
        mips: mips.clone(),
        layers: layers.clone(),
        aspect: wgt::TextureAspect::All,
    }
}

fn case(uses: &[Vec<Use>]) -> Case {
    let names: Vec<String> = (0..uses.len()).map(|index| format!("p{index}")).collect();
    let file = SourceFile::new("graph.ron", names.join(" "));
    let pass = |(index, uses): (usize, &Vec<Use>)| {
        let at = names[..index]
            .iter()
            .map(|name| name.len() + 1)
            .sum::<usize>();
        let span = file.span(at..at + names[index].len());
        let access = |(resource, how, mips, layers): &Use| Access {
            resource: ResourceId(*resource),
            part: part(mips, layers),
            reads: matches!(how, Read | Change),
            writes: *how != Read,
            fully_overwrites: *how == Write,
            triggers: true,
            usage: Usage::None,
            span: span.clone(),
            step: 0,
        };
        let accesses = uses.iter().map(access).collect();
        LinkedPass {
            name: Located::new(names[index].clone(), span.clone()),
            kind: "Test",
            steps: Vec::new(),
            accesses,
            run: Run::Always,
            turns: vec![true],
        }
    };
    let in_file: Vec<LinkedPass> = uses.iter().enumerate().map(pass).collect();
    let mut reports = Reports::default();
    let resources = resources();
    let view = GraphView {
        passes: &in_file,
        resources: &resources,
    };
    let sequence = arrange(view, in_file.len(), &mut reports);
    let passes: Vec<LinkedPass> = sequence.into_iter().map(|at| in_file[at].clone()).collect();
    let view = GraphView {
        passes: &passes,
        resources: &resources,
    };
    let order = order(view, passes.len(), &mut reports);
    Case {
        passes,
        resources,
        order,
        diagnostics: reports.into_list(),
    }
}

impl Case {
    fn edges(&self) -> BTreeSet<(usize, usize, Hazard)> {
        edges(&self.order)
    }

    /// Live passes for the final versions of the resources, and the order among them.
    fn live(&self, wanted: &[Use]) -> (Vec<bool>, Order) {
        let roots = wanted.iter().flat_map(|(resource, _, mips, layers)| {
            self.order.final_writers(&Target {
                id: ResourceId(*resource),
                part: part(mips, layers),
            })
        });
        let live = cull::live(&self.order, roots, |_| None);
        let view = GraphView {
            passes: &self.passes,
            resources: &self.resources,
        };
        let (order, _) = walk(view, |pass| live[pass.0]);
        (live, order)
    }

    fn schedule(&self, wanted: &[Use]) -> Vec<usize> {
        let (live, _) = self.live(wanted);
        let sequence = sequence(&live);
        sequence.into_iter().map(PassId::index).collect()
    }

    fn codes(&self) -> Vec<Code> {
        self.diagnostics
            .iter()
            .map(|diagnostic| diagnostic.code)
            .collect()
    }
}

const RAW: Hazard = Hazard::ReadAfterWrite;
const WAR: Hazard = Hazard::WriteAfterRead;
const WAW: Hazard = Hazard::WriteAfterWrite;

#[test]
#[allow(clippy::too_many_lines, reason = "a table of cases may be long")]
fn edges_of_each_hazard() {
    type Table = (&'static str, Vec<Vec<Use>>, Vec<(usize, usize, Hazard)>);
    let table: Vec<Table> = vec![
        (
            "p0 ─write─▶ r0 ─read─▶ p1",
            vec![vec![whole(0, Write)], vec![whole(0, Read)]],
            vec![(0, 1, RAW)],
        ),
        // p1 reads p0's version, so p2 has to wait for p1; p3 reads p2's version only.
        (
            "p0 ─▶ r0 ─▶ p1 ; p2 ─▶ r0 ─▶ p3",
            vec![
                vec![whole(0, Write)],
                vec![whole(0, Read)],
                vec![whole(0, Write)],
                vec![whole(0, Read)],
            ],
            vec![(0, 1, RAW), (0, 2, WAW), (1, 2, WAR), (2, 3, RAW)],
        ),
        (
            "p0 ─▶ r0 ◀─overwrites all─ p1",
            vec![vec![whole(0, Write)], vec![whole(0, Write)]],
            vec![(0, 1, WAW)],
        ),
        // p1 leaves some of p0's content in place: p1 needs p0.
        (
            "p0 ─▶ r0 ◀─overwrites some─ p1",
            vec![vec![whole(0, Write)], vec![whole(0, Partly)]],
            vec![(0, 1, RAW), (0, 1, WAW)],
        ),
        (
            "p0 ─clear─▶ r0 ◀─atomicAdd─ p1 ; p2 atomicAdd",
            vec![
                vec![whole(0, Write)],
                vec![whole(0, Change)],
                vec![whole(0, Change)],
            ],
            // p1's own read is over once it writes, but p2 overwrites what p1 reads and wrote.
            vec![
                (0, 1, RAW),
                (0, 1, WAW),
                (1, 2, RAW),
                (1, 2, WAR),
                (1, 2, WAW),
            ],
        ),
        (
            "p0 ─▶ r0 ─▶ { p1, p2 } : readers need not wait for each other",
            vec![
                vec![whole(0, Write)],
                vec![whole(0, Read)],
                vec![whole(0, Read)],
            ],
            vec![(0, 1, RAW), (0, 2, RAW)],
        ),
        (
            "p0 ─▶ r0.mip0 ; p1: r0.mip0 ─▶ r0.mip1 : a pass and its own parts make no edge",
            vec![
                vec![(0, Write, 0..1, 0..1)],
                vec![(0, Read, 0..1, 0..1), (0, Write, 1..2, 0..1)],
            ],
            vec![(0, 1, RAW)],
        ),
        (
            "p0 ─▶ r0.mip0 ; p1 ─▶ r0.mip1 ; p2 reads mip1 : mips are independent",
            vec![
                vec![(0, Write, 0..1, 0..1)],
                vec![(0, Write, 1..2, 0..1)],
                vec![(0, Read, 1..2, 0..1)],
            ],
            vec![(1, 2, RAW)],
        ),
        (
            "p0 ─▶ r0.layer0 ; p1 ─▶ r0.layer1 ; p2 reads both ; p3 overwrites layer0",
            vec![
                vec![(0, Write, 0..1, 0..1)],
                vec![(0, Write, 0..1, 1..2)],
                vec![(0, Read, 0..1, 0..2)],
                vec![(0, Write, 0..1, 0..1)],
            ],
            vec![(0, 2, RAW), (0, 3, WAW), (1, 2, RAW), (2, 3, WAR)],
        ),
    ];
    for (graph, uses, expected) in table {
        let case = case(&uses);
        assert!(
            case.diagnostics.is_empty(),
            "{graph}: {:?}",
            case.diagnostics
        );
        assert_eq!(case.edges(), expected.into_iter().collect(), "{graph}");
    }
}

#[test]
fn only_what_the_outputs_need_runs() {
    type Table = (&'static str, Vec<Vec<Use>>, Vec<Use>, Vec<usize>);
    let table: Vec<Table> = vec![
        (
            "p0 ─▶ r0 ; p1 ─▶ r1 ; out r0",
            vec![vec![whole(0, Write)], vec![whole(1, Write)]],
            vec![whole(0, Read)],
            vec![0],
        ),
        // No pass uses a covered version: p0 is not run though p1 writes after it.
        (
            "p0 ─▶ r0 ◀─covers─ p1 ; out r0",
            vec![vec![whole(0, Write)], vec![whole(0, Write)]],
            vec![whole(0, Read)],
            vec![1],
        ),
        (
            "p0 ─▶ r0 ◀─partly─ p1 ; out r0",
            vec![vec![whole(0, Write)], vec![whole(0, Partly)]],
            vec![whole(0, Read)],
            vec![0, 1],
        ),
        // p1 only reads; that a later pass overwrites what it read keeps it no more alive.
        (
            "p0 ─▶ r0 ─▶ p1 ─▶ r1 ; p2 ─▶ r0 ; out r0",
            vec![
                vec![whole(0, Write)],
                vec![whole(0, Read), whole(1, Write)],
                vec![whole(0, Write)],
            ],
            vec![whole(0, Read)],
            vec![2],
        ),
        (
            "p0 ─▶ r0 ─▶ p1 ─▶ r1 ─▶ p2 ─▶ r2 ; p3: r1 ─▶ r3 ; out r2",
            vec![
                vec![whole(0, Write)],
                vec![whole(0, Read), whole(1, Write)],
                vec![whole(1, Read), whole(2, Write)],
                vec![whole(1, Read), whole(3, Write)],
            ],
            vec![whole(2, Read)],
            vec![0, 1, 2],
        ),
        // An output that is one mip needs that mip's passes only.
        (
            "p0 ─▶ r0.mip0 ; p1 ─▶ r0.mip1 ; out r0.mip1",
            vec![vec![(0, Write, 0..1, 0..1)], vec![(0, Write, 1..2, 0..1)]],
            vec![(0, Read, 1..2, 0..1)],
            vec![1],
        ),
        (
            "no outputs, nothing runs",
            vec![vec![whole(0, Write)]],
            vec![],
            vec![],
        ),
        // Nothing orders these four; the file does.
        (
            "p0 ─▶ r3 ; p1 ─▶ r2 ; p2 ─▶ r1 ; p3 ─▶ r0 ; all out",
            (0..4).map(|index| vec![whole(3 - index, Write)]).collect(),
            (0..4).map(|index| whole(index, Read)).collect(),
            vec![0, 1, 2, 3],
        ),
    ];
    for (graph, uses, outputs, expected) in table {
        let case = case(&uses);
        assert!(
            case.diagnostics.is_empty(),
            "{graph}: {:?}",
            case.diagnostics
        );
        assert_eq!(case.schedule(&outputs), expected, "{graph}");
    }
}

/// ```text
/// p0 ─writes all─▶ r0 ◀─covers mip 0─ p1 ◀─covers mip 0─ p2 ; p3 reads r0
/// ```
/// No pass needs p1, but p0 was known to come before p2 through p1 only.
#[test]
fn order_through_a_culled_pass() {
    let case = case(&[
        vec![(0, Write, 0..2, 0..1)],
        vec![(0, Write, 0..1, 0..1)],
        vec![(0, Write, 0..1, 0..1)],
        vec![(0, Read, 0..2, 0..1), whole(1, Write)],
    ]);
    let (live, order) = case.live(&[whole(1, Read)]);
    assert_eq!(live, [true, false, true, true]);
    let expected = [(0, 2, WAW), (0, 3, RAW), (2, 3, RAW)];
    assert_eq!(edges(&order), expected.into_iter().collect());
}

#[test]
fn reads_of_nothing() {
    type Table = (&'static str, Vec<Vec<Use>>, Vec<Code>);
    let table: Vec<Table> = vec![
        (
            "r0 ─▶ p0",
            vec![vec![whole(0, Read)]],
            vec![Code::ReadBeforeWrite],
        ),
        (
            "p0 counts in r0, which was not cleared",
            vec![vec![whole(0, Change)]],
            vec![Code::ReadBeforeWrite],
        ),
        // One writer: the order is derived.
        (
            "r0 ─▶ p0 ; p1 ─▶ r0",
            vec![vec![whole(0, Read)], vec![whole(0, Write)]],
            vec![],
        ),
        (
            "r0 ─▶ p0 ; p1 ─▶ r0 ; p2 ─▶ r0",
            vec![
                vec![whole(0, Read)],
                vec![whole(0, Write)],
                vec![whole(0, Write)],
            ],
            vec![Code::ReadBeforeWrite],
        ),
        // p0 ─▶ r1 ─▶ p1 ─▶ r0 ─▶ p0
        (
            "p0: r0 ─▶ r1 ; p1: r1 ─▶ r0",
            vec![
                vec![whole(0, Read), whole(1, Write)],
                vec![whole(1, Read), whole(0, Write)],
            ],
            vec![Code::Cycle],
        ),
        // p0 needs p1, and both write r1 in the order of the file.
        (
            "p0: r0 ─▶ r1 ; p1 ─▶ r1, r0",
            vec![
                vec![whole(0, Read), whole(1, Write)],
                vec![whole(1, Write), whole(0, Write)],
            ],
            vec![Code::Cycle],
        ),
        // Neither needs the other's result: both lack a beginning.
        (
            "p0 adds to r0 ; p1 adds to r0 : it was not cleared",
            vec![vec![whole(0, Change)], vec![whole(0, Change)]],
            vec![Code::ReadBeforeWrite],
        ),
        (
            "p0 ─▶ r0.mip0 ; p1 reads r0.mip0..2",
            vec![vec![whole(0, Write)], vec![(0, Read, 0..2, 0..1)]],
            vec![Code::ReadBeforeWrite],
        ),
        // A partial write of a buffer does not read its earlier content.
        (
            "p0 ─partly─▶ r0 ─▶ p1",
            vec![vec![whole(0, Partly)], vec![whole(0, Read)]],
            vec![],
        ),
        // Within one pass the steps run in order.
        (
            "p0: clears r0, then counts in it",
            vec![vec![whole(0, Write), whole(0, Change)]],
            vec![],
        ),
        (
            "one mistake is told once per resource",
            vec![vec![(0, Read, 0..3, 0..5)]],
            vec![Code::ReadBeforeWrite],
        ),
    ];
    for (graph, uses, expected) in table {
        assert_eq!(case(&uses).codes(), expected, "{graph}");
    }
}

#[test]
fn a_cycle_is_told_with_its_path() {
    // p0: r0 ─▶ r1 ; p1: r1 ─▶ r2 ; p2: r2 ─▶ r0
    let case = case(&[
        vec![whole(0, Read), whole(1, Write)],
        vec![whole(1, Read), whole(2, Write)],
        vec![whole(2, Read), whole(0, Write)],
    ]);
    assert_eq!(case.codes(), [Code::Cycle]);
    assert!(
        case.diagnostics[0].message.ends_with("p0 → p1 → p2 → p0"),
        "{}",
        case.diagnostics[0].message
    );
    let labels = case.diagnostics[0].labels.iter();
    let labels: Vec<&str> = labels.map(|label| label.text.as_str()).collect();
    let expected = [
        "reads `r0` of `p2`",
        "reads `r1` of `p0`",
        "reads `r2` of `p1`",
    ];
    assert_eq!(labels, expected);
}

#[test]
fn a_reader_comes_behind_its_writer() {
    type Table = (&'static str, Vec<Vec<Use>>, Vec<&'static str>);
    let table: Vec<Table> = vec![
        (
            "p0: r1 ─▶ r2 ; p1: r0 ─▶ r1 ; p2 ─▶ r0",
            vec![
                vec![whole(1, Read), whole(2, Write)],
                vec![whole(0, Read), whole(1, Write)],
                vec![whole(0, Write)],
            ],
            vec!["p2", "p1", "p0"],
        ),
        (
            "p1 waits for p3; nothing orders the others, so the file does",
            vec![
                vec![whole(1, Write)],
                vec![whole(0, Read), whole(2, Write)],
                vec![whole(1, Read)],
                vec![whole(0, Write)],
            ],
            vec!["p0", "p2", "p3", "p1"],
        ),
        (
            "p0 reads the mips that p1 and p2 write, each one",
            vec![
                vec![(0, Read, 0..2, 0..1)],
                vec![(0, Write, 1..2, 0..1), (0, Read, 0..1, 0..1)],
                vec![(0, Write, 0..1, 0..1)],
            ],
            vec!["p2", "p1", "p0"],
        ),
        (
            "p1, p2 and p3 use r0, which two of them write; p0 reads what p3 makes of it",
            vec![
                vec![whole(1, Read)],
                vec![whole(0, Write)],
                vec![whole(0, Change)],
                vec![whole(0, Read), whole(1, Write)],
            ],
            vec!["p1", "p2", "p3", "p0"],
        ),
    ];
    for (graph, uses, expected) in table {
        let case = case(&uses);
        assert!(
            case.diagnostics.is_empty(),
            "{graph}: {:?}",
            case.diagnostics
        );
        let names = case.passes.iter().map(|pass| pass.name.value.as_str());
        assert_eq!(names.collect::<Vec<_>>(), expected, "{graph}");
    }
}

/// A chain as long as no document has it: neither recursion nor quadratic work.
#[test]
fn ten_thousand_passes() {
    let uses: Vec<Vec<Use>> = (0..10_000)
        .map(|index| vec![whole(0, if index == 0 { Write } else { Change })])
        .collect();
    assert_eq!(
        case(&uses).schedule(&[whole(0, Read)]),
        (0..10_000).collect::<Vec<_>>()
    );
    let mut cycle = uses;
    cycle[0] = vec![whole(1, Read), whole(0, Write)];
    cycle.push(vec![whole(0, Read), whole(1, Write)]);
    assert_eq!(case(&cycle).codes(), [Code::Cycle]);
}

type Cell = (usize, u32, u32);

/// Writer of the content that a pass sees in a cell.
type Seen = BTreeMap<(usize, Cell), Option<usize>>;

/// Runs the passes in the order of `sequence`. Returns the writers of the cells that each pass
/// reads, and the last writer of each cell.
fn interpret(passes: &[LinkedPass], sequence: &[usize]) -> (Seen, BTreeMap<Cell, usize>) {
    let mut memory: BTreeMap<Cell, usize> = BTreeMap::new();
    let mut seen = BTreeMap::new();
    for &pass in sequence {
        for access in &passes[pass].accesses {
            for mip in access.part.mips.clone() {
                for layer in access.part.layers.clone() {
                    let cell = (access.resource.0, mip, layer);
                    let before = memory.get(&cell).copied();
                    // A partial write mixes its own with what is there, so it sees it.
                    if (access.reads || !access.fully_overwrites) && before != Some(pass) {
                        seen.insert((pass, cell), before);
                    }
                    if access.writes {
                        memory.insert(cell, pass);
                    }
                }
            }
        }
    }
    (seen, memory)
}

prop_compose! {
    fn any_use()(
        resource in 0..RESOURCES,
        how in prop_oneof![Just(Read), Just(Write), Just(Partly), Just(Change)],
        mip in 0..2u32, mips in 1..3u32,
        layer in 0..2u32, layers in 1..3u32,
    ) -> Use {
        (resource, how, mip..(mip + mips).min(2), layer..(layer + layers).min(2))
    }
}

/// Some other order of these passes that every edge allows: of those that may run, the one of the
/// highest rank.
fn shuffled(order: &Order, passes: &BTreeSet<usize>, rank: &[u32]) -> Vec<usize> {
    let edges = edges(order);
    let mut open = passes.clone();
    let mut sequence = Vec::new();
    loop {
        let is_ready = |pass: &&usize| {
            !edges
                .iter()
                .any(|(from, to, _)| to == *pass && open.contains(from))
        };
        let Some(&next) = open.iter().filter(is_ready).max_by_key(|pass| rank[**pass]) else {
            return sequence;
        };
        open.remove(&next);
        sequence.push(next);
    }
}

proptest! {
    #![proptest_config(ProptestConfig { failure_persistence: None, ..ProptestConfig::default() })]

    /// Whatever passes read and write: the schedule is the live passes, each once, every edge
    /// obeyed, and each live pass sees exactly what it would see if the whole file ran from top to
    /// bottom.
    #[test]
    fn the_schedule_means_the_file(
        uses in prop::collection::vec(prop::collection::vec(any_use(), 1..4), 1..10),
        wanted in prop::collection::vec(0..RESOURCES, 0..3),
        rank in prop::collection::vec(any::<u32>(), 11),
    ) {
        // A first pass clears everything, so that no read comes before a write.
        let clears = (0..RESOURCES).map(|resource| (resource, Write, 0..2, 0..2)).collect();
        let uses: Vec<Vec<Use>> = std::iter::once(clears).chain(uses).collect();
        let case = case(&uses);
        prop_assert!(case.diagnostics.is_empty());
        let output = |&resource: &usize| (resource, Read, 0..2, 0..2);
        let outputs: Vec<Use> = wanted.iter().map(output).collect();
        let schedule = case.schedule(&outputs);

        let live: BTreeSet<usize> = schedule.iter().copied().collect();
        prop_assert_eq!(live.len(), schedule.len(), "each pass runs once");
        let places = schedule.iter().enumerate().map(|(at, &pass)| (pass, at));
        let place: BTreeMap<usize, usize> = places.collect();
        for (from, to, hazard) in case.edges() {
            prop_assert!(from < to, "edges follow the file");
            if let (Some(from), Some(to)) = (place.get(&from), place.get(&to)) {
                prop_assert!(from < to);
            } else {
                let is_needed = hazard == RAW && live.contains(&to);
                prop_assert!(!is_needed, "a live pass needs a culled one");
            }
        }
        let file: Vec<usize> = (0..uses.len()).collect();
        let (in_file, end_of_file) = interpret(&case.passes, &file);
        // The schedule keeps the file's order; the edges must allow for no order that means
        // something else.
        for sequence in [schedule, shuffled(&case.live(&outputs).1, &live, &rank)] {
            let (seen, end) = interpret(&case.passes, &sequence);
            prop_assert_eq!(sequence.len(), live.len(), "each live pass runs");
            for (read, version) in &seen {
                let expected = &in_file[read];
                prop_assert_eq!(version, expected, "{:?} differs in {:?}", read, &sequence);
            }
            for &resource in &wanted {
                for (cell, writer) in end_of_file.iter().filter(|(cell, _)| cell.0 == resource) {
                    let end = end.get(cell);
                    prop_assert_eq!(end, Some(writer), "an output ends with another version");
                }
            }
        }
    }
}

/// Some other order of the file in which passes that use a resource with several writers keep
/// theirs.
fn rearranged(uses: &[Vec<Use>], rank: &[u32]) -> Vec<usize> {
    let written = |uses: &Vec<Use>, id: usize| uses.iter().any(|it| it.0 == id && it.1 != Read);
    let several: Vec<usize> = (0..MANY)
        .filter(|id| uses.iter().filter(|uses| written(uses, *id)).count() > 1)
        .collect();
    let is_tied = |one: &Vec<Use>, other: &Vec<Use>| {
        let both = |id: &&usize| {
            [one, other]
                .iter()
                .all(|it| it.iter().any(|it| it.0 == **id))
        };
        several.iter().any(|id| both(&id))
    };
    let mut open: Vec<usize> = (0..uses.len()).collect();
    let mut sequence = Vec::new();
    while !open.is_empty() {
        let is_ready = |at: &usize| {
            !open
                .iter()
                .any(|above| above < at && is_tied(&uses[*above], &uses[*at]))
        };
        let ready = open.iter().copied().filter(is_ready);
        let Some(next) = ready.max_by_key(|at| rank[*at]) else {
            break;
        };
        open.retain(|at| *at != next);
        sequence.push(next);
    }
    sequence
}

proptest! {
    #![proptest_config(ProptestConfig { failure_persistence: None, ..ProptestConfig::default() })]

    /// Each pass sees the same content, in whichever order the file has its passes.
    #[test]
    fn the_order_of_the_file_does_not_matter(
        reads in prop::collection::vec(prop::collection::vec(0..MANY, 0..3), 12),
        again in prop::collection::vec((0..12usize, 0..MANY), 0..3),
        rank in prop::collection::vec(any::<u32>(), 12),
    ) {
        // Pass i writes resource i, and reads what passes above it write.
        let uses = reads.iter().enumerate().map(|(at, reads)| {
            let reads = reads.iter().filter(|read| **read < at).map(|read| whole(*read, Read));
            reads.chain((at < MANY).then(|| whole(at, Write))).collect()
        });
        let mut uses: Vec<Vec<Use>> = uses.collect();
        for (at, id) in again {
            if at > id {
                uses[at].push(whole(id, Write));
            }
        }
        let file = case(&uses);
        prop_assert!(file.diagnostics.is_empty());
        let in_order: Vec<usize> = (0..uses.len()).collect();
        let (seen, end) = interpret(&file.passes, &in_order);
        let sequence = rearranged(&uses, &rank);
        prop_assert_eq!(sequence.len(), uses.len());
        let other = case(&sequence.iter().map(|at| uses[*at].clone()).collect::<Vec<_>>());
        prop_assert!(other.diagnostics.is_empty(), "{:?}", other.diagnostics);
        // By the numbers that the passes have in the first file.
        let number = |pass: usize| -> usize {
            let name = &other.passes[pass].name.value;
            sequence[name[1..].parse::<usize>().unwrap()]
        };
        let (other_seen, other_end) = interpret(&other.passes, &in_order);
        let other_seen: Seen = other_seen
            .into_iter()
            .map(|((pass, cell), writer)| ((number(pass), cell), writer.map(number)))
            .collect();
        let other_end: BTreeMap<Cell, usize> =
            other_end.into_iter().map(|(cell, pass)| (cell, number(pass))).collect();
        prop_assert_eq!(seen, other_seen);
        prop_assert_eq!(end, other_end);
    }
}
