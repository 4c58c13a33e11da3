//! README.md.

use super::{Document, Pages, ms, of_h200, read, share, table, wrap};

#[test]
fn the_readme_says_what_the_tables_say() {
    let mut pages = Pages::default();
    let sponza = Document::read("sponza");
    let frame = |viewport: &str, method: &str| {
        let map = if method == "rt" { 0 } else { 1024 };
        sponza.row("main", viewport, method, map)
    };
    let ratio = |viewport: &str| {
        let [own, rt] = ["light_buffer", "rt"].map(|method| frame(viewport, method).less_gbuffer());
        100.0 * own / rt
    };
    let text = format!(
        "**Hard shadows without a wrong pixel: `rt` where rays are cheap, \
         [`light_buffer`](docs/light_buffer.md) where they are expensive.** On the one GPU \
         measured, a compute card, `rt` is the fastest method of all where every pass runs and no \
         mesh moves; on a CPU `light_buffer` takes {:.0} % of its time at 512² pixels, {:.0} % at \
         1024² and {:.0} % at 1920×1080. With wrong pixels, but without anything to trace: \
         `nsm@fit=receivers`. Soft ones: `rt_area`, `pcss`, or filtered maps ([all \
         methods](docs/presets.md)). Measure on your own scene and machine first:",
        ratio("512×512"),
        ratio("1024×1024"),
        ratio("1920×1080"),
    );
    pages.say("README.md", "choice", &text);
    // Every row of times on the H200 has `rt` first, and no mesh moves there.
    let times = read("docs/results/h200.md");
    let times = times
        .split("## Times\n")
        .nth(1)
        .unwrap()
        .split("The other methods")
        .next()
        .unwrap();
    let rows: Vec<Vec<f64>> = times
        .lines()
        .filter(|line| line.starts_with("| `"))
        .map(|line| of_h200(line.split(" | ").next().unwrap()))
        .collect();
    assert!(rows.len() >= 5, "{rows:?}");
    for row in rows {
        let methods = &row[1..row.len() - 1];
        assert!(
            methods.iter().all(|other| row[0] < *other),
            "rt is not the fastest: {row:?}"
        );
    }

    let gbuffer = 0.63;
    let h200 = read("docs/results/h200.md");
    assert!(h200.contains(&format!("{gbuffer} ms of each is the G-buffer")));
    let times = of_h200("| `sponza`, 1024², map of `nsm` 1024²");
    let beside = h200
        .split("The other methods on `sponza`, 1024²: ")
        .nth(1)
        .unwrap();
    let own_ms = |method: &str| {
        let time = beside.split(&format!("`{method}` ")).nth(1).unwrap();
        let end = time
            .find(|c: char| !c.is_ascii_digit() && c != '.')
            .unwrap();
        time[..end].parse::<f64>().unwrap() - gbuffer
    };
    let lines = [
        (
            "nsm",
            times[1] - gbuffer,
            "all",
            format!(
                "a shadow map; with `fit=receivers` {} %, {} ms on the H200",
                of_h200_share(&h200),
                ms(times[2] - gbuffer),
            ),
        ),
        (
            "light_buffer",
            times[4] - gbuffer,
            "all",
            "lists of casters per texel of a grid".to_owned(),
        ),
        (
            "hybrid_pcf",
            own_ms("hybrid_pcf"),
            "sun, spot",
            "rays at the map's contours".to_owned(),
        ),
        (
            "crsm",
            own_ms("crsm"),
            "sun, spot",
            "rays where the map proves nothing; wrong where open meshes cast".to_owned(),
        ),
        (
            "rt",
            times[0] - gbuffer,
            "all",
            "a ray per pixel".to_owned(),
        ),
    ]
    .map(|(method, on_h200, lights, what)| {
        let row = frame("1024×1024", method);
        let [on_cpu, on_h200] = [row.less_gbuffer(), on_h200].map(ms);
        vec![
            format!("`{method}`"),
            on_cpu,
            on_h200,
            share(row.ours("wrong %")),
            lights.to_owned(),
            what,
        ]
    });
    let heads = ["method", "llvmpipe", "H200", "wrong %", "lights", ""];
    let frames = sponza
        .head("times")
        .split("medians of ")
        .nth(1)
        .unwrap()
        .split(" frame")
        .next()
        .unwrap();
    let note = format!(
        "(Medians of {frames} and 51 frames: llvmpipe, Mesa 22.3.6, two shared cores, {}; NVIDIA \
         H200, no ray queries, 2026-11-26, which [draws slowly](docs/results/h200.md). \
         [More](docs/results.md).)",
        sponza.head("date"),
    );
    assert!(sponza.head("adapter").contains("llvmpipe Mesa 22.3.6"));
    pages.hold(
        "README.md",
        "methods",
        &format!("{}\n\n{}", table(&heads, lines), wrap(&note)),
    );
    pages.end();
}

/// Wrong share of `nsm@fit=receivers` on Sponza at 1024².
fn of_h200_share(text: &str) -> String {
    let row = text
        .lines()
        .find(|line| line.starts_with("| `sponza`, 1024²"))
        .unwrap();
    row.split('|')
        .nth(4)
        .unwrap()
        .split(['(', '%'])
        .nth(1)
        .unwrap()
        .trim()
        .to_owned()
}
