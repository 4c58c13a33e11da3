//! docs/dissertation.md.

use super::{
    Document, Figure, MAPS, Pages, Row, faster::Faster, least_and_most, median, of_h200, published,
    read, table,
};

/// Milliseconds for a ray of a hybrid as multiples of those for a ray of `rt` in the same viewport.
fn ray_costs<'a>(
    document: &'a Document,
    method: &'a str,
) -> impl Iterator<Item = f64> + Clone + 'a {
    document.of(method).map(|row| {
        let [own, rt] = [row, document.rt(row)].map(|row| row.ours("trace ms") / row.ours("rays"));
        own / rt
    })
}

/// Time as a line over rays: milliseconds without any, nanoseconds for one more, and the share of
/// the variance that the line leaves.
fn fit(points: &[(f64, f64)]) -> [f64; 3] {
    let count = points.len() as f64;
    let mean = |value: &dyn Fn(&(f64, f64)) -> f64| points.iter().map(value).sum::<f64>() / count;
    let (x, y) = (mean(&|p| p.0), mean(&|p| p.1));
    let slope = mean(&|p| (p.0 - x) * (p.1 - y)) / mean(&|p| (p.0 - x).powi(2));
    let start = y - slope * x;
    let left = mean(&|p| (p.1 - start - slope * p.0).powi(2)) / mean(&|p| (p.1 - y).powi(2));
    [start, 1e6 * slope, left]
}

#[test]
fn the_dissertations_conclusions_are_held_against_the_tables() {
    let mut pages = Pages::default();
    let page = "docs/dissertation.md";
    let [sponza_d, bench_d, sponza, sizes] =
        ["sponza-d", "bench-d", "sponza", "sizes"].map(Document::read);
    let h200 = read("docs/results/h200.md");
    let beside = |figure: Figure| format!("{:.2} (D {:.2})", figure.ours, figure.theirs.unwrap());
    let joined = |cells: &[String]| cells.join(", ");

    let viewports = ["512×512", "1024×1024", "1920×1080"];
    let by_viewport = viewports.map(|v| {
        beside(
            sponza_d
                .row("main", v, "nsm_d", 1024)
                .figure("wrong %")
                .unwrap(),
        )
    });
    let by_map = |method: &str, head: &str| {
        let cells = MAPS.map(|map| {
            sponza_d
                .row("main", "1024×1024", method, map)
                .figure(head)
                .unwrap()
        });
        joined(&cells.map(beside))
    };
    let map_steps = |theirs: bool| {
        let rows = sponza_d.of("crsma_d");
        let ratio = rows.map(|row| {
            let crsm = sponza_d.row("main", &row.viewport, "crsm_d", row.map);
            let [one, other] = [row, crsm].map(|row| row.figure("map ms").unwrap());
            if theirs {
                one.theirs.unwrap() / other.theirs.unwrap()
            } else {
                one.ours / other.ours
            }
        });
        median(ratio)
    };
    let [on_sponza, on_bench] = [
        Faster::than_rt(&sponza_d, "_d"),
        Faster::than_rt(&bench_d, "_d"),
    ];
    let theirs = Faster::of_theirs(|_| true, &["hybrid_pcf", "crsm", "crsma"], "rt");
    // Rays that adjacency saves, in percent of crsm's.
    let saved = |document: &Document, view: &str, end: &str| {
        let [crsm, crsma] = ["crsm", "crsma"].map(|method| {
            let row = document.row(view, "1024×1024", &format!("{method}{end}"), 1024);
            row.figure("rays").unwrap()
        });
        let share = |one: f64, other: f64| 100.0 * (1.0 - other / one);
        let ours = share(crsm.ours, crsma.ours);
        format!(
            "{ours:.0} % (D {:.0})",
            share(crsm.theirs.unwrap(), crsma.theirs.unwrap())
        )
    };
    let saved_by_ours = {
        let [crsm, crsma] = ["crsm", "crsma"]
            .map(|method| sponza.row("main", "1024×1024", method, 1024).ours("rays"));
        100.0 * (1.0 - crsma / crsm)
    };
    let times = of_h200("| `sponza`, 1024², map of `nsm` 1024²");
    for figure in [
        "`hybrid_pcf` 1.73 ms",
        "`crsm` 4.72",
        "`crsma_full`\n12.9",
        "8,290, all of open parts",
    ] {
        assert!(h200.contains(figure), "h200.md does not say {figure}");
    }
    let [wide, wider] = ["| `sponza`, 1920×1080", "| `sponza`, 3840×2160"].map(|start| {
        let row = h200.lines().find(|line| {
            line.starts_with(start) && line.contains("ms")
                || line.starts_with(start) && line.contains(" %)")
        });
        row.unwrap()
            .split('(')
            .nth(1)
            .unwrap()
            .split(' ')
            .next()
            .unwrap()
            .to_owned()
    });

    let row = |what: &str, verdict: &str, cpu: String, gpu: String| {
        vec![what.to_owned(), verdict.to_owned(), cpu, gpu]
    };
    let lines = [
        row(
            "*Viewport*: the share of wrong pixels hardly depends on it (5.3.2)",
            "holds; a wider picture shows other surfaces",
            format!(
                "`nsm_d`, map 1024²: {} % at 512², 1024², 1920×1080",
                joined(&by_viewport)
            ),
            format!("`nsm`, map 2048²: {wide} % at 1920×1080, {wider} % at 3840×2160"),
        ),
        row(
            "*Map size*: a finer map leaves fewer wrong pixels to `nsm`, fewer rays to hybrids, \
             and more certain wrong pixels to `crsm` (5.3.3, 5.4.2)",
            "holds; the last are [open casters](methods.md#open-casters), all with \
             `depth=conservative`",
            format!(
                "maps 512² … 4096²: `nsm_d` wrong {} %; `crsm_d` certain wrong {} %",
                by_map("nsm_d", "wrong %"),
                by_map("crsm_d", "certain wrong %"),
            ),
            "map 1024²: 8,290 wrong pixels of `crsm`, all of open parts".to_owned(),
        ),
        row(
            "*Adjacency* does not pay: a shadow map with neighbours takes too long (6.2, 6.9)",
            "no longer: [half planes](methods.md#crsma-shrink-only-where-the-surface-ends) \
             instead of up to four triangles each",
            format!(
                "the map takes {:.2} times as long as `crsm_d`'s (D {:.1} times), median of 12 \
                 cells",
                map_steps(false),
                map_steps(true),
            ),
            "`crsma`'s times were not kept".to_owned(),
        ),
        row(
            "*Feasibility*: hybrids seldom beat a ray for every pixel (6.8, 6.9)",
            "holds where rays are cheap; on a CPU hybrids win",
            format!(
                "faster frames than `rt` in {} of {} cells on Sponza and {} of {} on `bench` (D {} \
                 of {} in all)",
                on_sponza.by_frames,
                on_sponza.cells,
                on_bench.by_frames,
                on_bench.cells,
                theirs.by_frames,
                theirs.cells,
            ),
            format!(
                "Sponza, 1024²: `rt` {} ms, `hybrid_pcf` 1.73, `crsm` 4.72, `crsma_full` 12.9",
                times[0]
            ),
        ),
        row(
            "*Memory*: tracing costs a duplicate of the scene (7)",
            "no: shaders trace the triangles that maps are drawn of",
            "the hierarchy adds [half the mesh to 0.9 of it](results.md#memory-what-tracing-adds)"
                .to_owned(),
            "the same bytes".to_owned(),
        ),
        row(
            "*Tessellation*: adjacency helps less where triangles are small (7)",
            "not in D's own tables: its Flowers have the smallest triangles. Sponza gains least",
            format!(
                "rays saved, 1024² pixels and map: flowers_with {}, trees_against {}, Sponza {}; \
                 by `crsma` as it is {saved_by_ours:.0} % on Sponza",
                saved(&bench_d, "flowers_with", "_d"),
                saved(&bench_d, "trees_against", "_d"),
                saved(&sponza_d, "main", "_d"),
            ),
            "not measured".to_owned(),
        ),
        row(
            "*Errors*: `crsm` and `crsma` are almost free of them (5.5, 7)",
            "`crsm` and `crsma_full` are free of them on closed casters, [proven](precision.md); \
             `crsma` is [no proof](methods.md#crsma-why-it-is-no-proof)",
            "none in the hard cases that they claim".to_owned(),
            "none in the hard cases and in `park`'s nine views".to_owned(),
        ),
    ];
    let heads = ["D's conclusion (chapter)", "today", "llvmpipe", "H200"];
    pages.hold(page, "conclusions", &table(&heads, lines));

    let rows: Vec<&Row> = sizes.of("rt").collect();
    assert_eq!(rows.len(), 17);
    let points = |theirs: bool| -> Vec<(f64, f64)> {
        let point = |row: &&Row| {
            let (width, height) = row.viewport.split_once('×').unwrap();
            let sum = row.figure("sum of steps ms").unwrap();
            let time = if theirs {
                sum.theirs.unwrap()
            } else {
                sum.ours
            };
            (
                width.parse::<f64>().unwrap() * height.parse::<f64>().unwrap(),
                time,
            )
        };
        rows.iter().map(point).collect()
    };
    let [ours, theirs] = [fit(&points(false)), fit(&points(true))];
    let per_ray = |document: &Document| {
        ["hybrid_pcf_d", "crsm_d", "crsma_d"].map(|method| {
            let costs = ray_costs(document, method);
            let [least, most] = least_and_most(costs.clone());
            format!("`{method}` {:.1} ({least:.1} to {most:.1})", median(costs))
        })
    };
    let figures = published();
    let their_costs = ["hybrid_pcf", "crsm", "crsma"].map(|method| {
        let rays = figures
            .iter()
            .filter(|([view, _, preset, _, quantity], _)| {
                view == "main" && preset == method && quantity == "rays"
            });
        let costs = rays.map(|([view, viewport, preset, map, _], rays)| {
            let get = |preset: &str, map: &str, quantity: &str| {
                figures[&[view, viewport, preset, map, quantity].map(str::to_owned)]
            };
            let (width, height) = viewport.split_once('x').unwrap();
            let pixels = width.parse::<f64>().unwrap() * height.parse::<f64>().unwrap();
            get(preset, map, "ms.trace_rays") / rays / (get("rt", "", "ms.steps") / pixels)
        });
        let costs: Vec<f64> = costs.collect();
        let [least, most] = least_and_most(costs.iter().copied());
        format!("{:.1} ({least:.1} to {most:.1})", median(costs.into_iter()))
    });
    let text = format!(
        "Sponza in D's 17 screen sizes (table 19), a ray for each pixel, as a line over the rays: \
         D {:.1} ms and {:.1} ns a ray, which leaves {:.1} % of the variance; ours \
         ([sizes](results/sizes.md)) {:.0} ms and {:.0} ns, {:.1} %. But a ray of a hybrid costs \
         more than one of `rt`, since those at contours and in shadows are the long and scattered \
         ones: on Sponza {}, median and range of 12 cells as multiples of `rt`'s in the same \
         viewport. D's own tables 22, 23 and 25 show it, too: {}, though with few rays that is \
         mostly what a call takes without any. So hybrids save less time than rays.",
        theirs[0],
        theirs[1],
        100.0 * theirs[2],
        ours[0],
        ours[1],
        100.0 * ours[2],
        joined(&per_ray(&sponza_d)),
        joined(&their_costs),
    );
    pages.say(page, "rays", &text);
    pages.end();
}
