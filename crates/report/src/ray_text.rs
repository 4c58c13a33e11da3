//! Speed and answers of ray engines, as tables for a terminal and as a report for a driver's maker.

use crate::table::terminal;
use itertools::Itertools;
use skiagraph_compare::records::rays::{AnyHits, Conformance, RayTest, WrongRay, per_billion};
use skiagraph_compare::records::table::Table;
use skiagraph_compare::wording::{ms, plural, thousands};

/// Returns the speed of the engines as text for a terminal.
pub fn any_hits(of: &AnyHits) -> String {
    let heads = [
        "rays",
        "engine",
        "count",
        "built, ms",
        "ms",
        "Mrays/s",
        "blocked",
        "unlike",
        "no answer",
    ];
    let rows = of.sets.iter().flat_map(|set| {
        set.engines.iter().map(|engine| {
            vec![
                set.name.clone(),
                engine.engine.clone(),
                thousands(set.rays),
                ms(engine.built_ms),
                ms(engine.ms),
                format!("{:.2}", engine.mrays_per_s),
                thousands(engine.blocked),
                thousands(engine.unlike_first),
                thousands(engine.unanswered),
            ]
        })
    });
    format!(
        "{}\nmillions of any hits per second, median of {}; unlike: rays that `Hierarchy` answers \
         otherwise\n{}\n",
        of.adapter,
        plural(of.turns as usize, "turn"),
        terminal(&Table::new(heads, 2, rows))
    )
}

/// Returns the answers of the engines as text for a terminal.
pub fn conformance(of: &Conformance) -> String {
    let mut text = format!(
        "{}\nrays whose right answer is known; wrong: blocked ones let through + others blocked + \
         without an answer\n{}\n",
        of.adapter,
        terminal(&table(of))
    );
    for (engine, why) in &of.unavailable {
        text += &format!("{engine} is unavailable: {why}\n");
    }
    for engine in of.engines() {
        text += &sum(of, engine);
        text.push('\n');
    }
    text
}

fn table(of: &Conformance) -> Table {
    let engines = of.engines();
    let heads = ["solid", "aimed", "rays", "not judged"].into_iter();
    let heads = heads.chain(engines.iter().copied());
    let row = |test: &RayTest| {
        let judged = [
            test.solid.clone(),
            test.aim.clone(),
            thousands(test.rays),
            thousands(test.indeterminate),
        ];
        let engines = test.engines.iter().map(|it| match it.wrong() {
            0 => "0".into(),
            _ => format!("{} + {} + {}", it.through, it.blocked, it.unanswered),
        });
        judged.into_iter().chain(engines).collect()
    };
    Table::new(heads, 2, of.tests.iter().map(row))
}

/// An engine in one sentence.
fn sum(of: &Conformance, engine: &str) -> String {
    let (leaks, at) = of.sum(engine, Some(true));
    let (wrong, all) = of.sum(engine, None);
    format!(
        "{engine}: {} of {} rays at closed surfaces leak, {} of all {} are wrong: {} of 10^9",
        thousands(leaks),
        thousands(at),
        thousands(wrong),
        thousands(all),
        rate(wrong, all)
    )
}

/// Returns wrong rays per 10⁹ with their [upper bound](per_billion) of 95 % certainty:
/// `12.5 (95 %: at most 17)`.
pub fn rate(wrong: u64, rays: u64) -> String {
    let (rate, most) = per_billion(wrong, rays);
    format!("{} (95 %: at most {})", figure(rate), figure(most))
}

/// Three digits, or all of a larger number.
fn figure(value: f64) -> String {
    if value >= 100.0 {
        thousands(value.round() as u64)
    } else {
        format!("{value:.1}").trim_end_matches(".0").to_owned()
    }
}

/// Returns a report in Markdown that tells a driver's maker what was traced, how, and which answers
/// are wrong; enough to repeat the tests without this program. The report lists the wrong rays of
/// `RayQuery`, or of `Hierarchy` if `RayQuery` did not run.
pub fn vendor_report(of: &Conformance) -> String {
    let queries = of.engines().contains(&"RayQuery");
    let engine = if queries { "RayQuery" } else { "Hierarchy" };
    let mut text = format!(
        "# Ray queries: {}\n\n\
         {} · {} · {}. {}.\n\n\
         {}\n\n",
        of.adapter.name,
        of.adapter.driver,
        of.adapter.backend,
        of.began,
        of.program,
        summary(of, queries)
    );
    text += &format!("{}\n", METHOD.trim());
    text += "\n## Answers\n\n";
    text += &table(of).markdown();
    text += "\nWrong: blocked rays let through + others blocked + rays without an answer.\n";
    let wrong = of.tests.iter().filter_map(|test| {
        let own = test.engines.iter().find(|it| it.engine == engine)?;
        (!own.examples.is_empty()).then_some((test, &own.examples))
    });
    for (test, examples) in wrong {
        text += &format!(
            "\n## Wrong rays: {}, {}\n\n{}; {} triangles. Right answer: {}.\n\n",
            test.solid,
            test.aim,
            test.reason,
            thousands(test.triangles),
            match test.is_blocked {
                Some(true) => "every ray is blocked",
                Some(false) => "no ray is blocked",
                None => "by f64 with error bounds",
            }
        );
        text += &example_table(examples).markdown();
    }
    text
}

fn summary(of: &Conformance, queries: bool) -> String {
    let mut lines: Vec<String> = of.engines().into_iter().map(|it| sum(of, it)).collect();
    lines.iter_mut().for_each(|line| line.push('.'));
    if !queries {
        let why = of.unavailable.iter().map(|(_, why)| why).join("; ");
        lines.push(format!(
            "There are no ray queries ({why}): `Hierarchy`, a compute shader, is what was tested."
        ));
    }
    lines.join("\n")
}

const METHOD: &str = "
## What was traced

Every solid is a closed surface around a centre: a latitude-longitude ball whose corners were moved
along their rays from the centre, in f32, with shared corners of equal bits. A ray that begins at
the centre and ends outside, or the other way round, crosses the surface, whichever way coordinates
round; one that ends before the nearest corner does not. `crowd` is random triangles, and its
answers are those of an f64 tracer with error bounds: rays whose answer a rounding of the corners
could flip are not judged.

- One bottom-level structure of one geometry: `R32G32B32_SFLOAT` positions, 16 bytes apart, 32-bit
  indices, no transform, not opaque, built for fast trace. One instance, identity, mask 0xff.
- A compute shader of 64 threads a group; a ray a thread. `rayQueryInitializeEXT` with the flag
  `TerminateOnFirstHit`, t_min 0 and the t_max of the table; each candidate triangle is confirmed.
- Candidates come as the driver finds them: a ray is let through if no candidate came.
- Directions are not of unit length, and t_max is in lengths of the direction.

Vulkan's specification (*Ray Traversal*, *Watertightness*) says that an implementation should not
miss where a ray meets a shared edge or the shared corner of a closed fan, and that this is expected
and tested, though it is no \"must\".
";

fn example_table(examples: &[WrongRay]) -> Table {
    let heads = [
        "origin",
        "direction",
        "t_max",
        "found",
        "a compute shader finds",
        "corners",
    ];
    let id = |of: Option<u32>| of.map_or("none".into(), |it| it.to_string());
    let vector = |of: [f32; 3]| of.map(bits).join(" ");
    let row = |ray: &WrongRay| {
        vec![
            vector(ray.origin),
            vector(ray.direction),
            bits(ray.t_max),
            id(ray.primitive),
            id(ray.expected),
            ray.corners
                .map_or("–".into(), |corners| corners.map(vector).join("; ")),
        ]
    };
    Table::new(heads, 6, examples.iter().map(row))
}

/// A float with its bits, which say exactly which one it is.
fn bits(value: f32) -> String {
    format!("{value} (0x{:08x})", value.to_bits())
}
