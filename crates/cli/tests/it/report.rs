//! `report.html` in a browser: what it shows, and what happens on clicks, keys and wheel. Needs an
//! adapter and Chromium (`chromium`, or what `CHROMIUM` names).

use crate::support::{results, skiagraph};
use serde_json::Value;
use std::{
    fs,
    path::{Path, PathBuf},
    process::Command,
    sync::OnceLock,
};

/// Runs in the page, ahead of its own scripts.
const BEFORE: &str = "<script>window.faults = []; \
     addEventListener('error', (event) => faults.push(event.message)); \
     addEventListener('unhandledrejection', (event) => faults.push(String(event.reason))); \
     console.error = (...words) => faults.push(words.join(' ')); \
     window.shifts = []; const nameOf = ({ node }) => (node?.outerHTML ?? '').slice(0, 60); \
     new PerformanceObserver((list) => list.getEntries().forEach((entry) => { \
     if (!entry.hadRecentInput) shifts.push(`${entry.value} ${entry.sources.map(nameOf)}`); })) \
     .observe({ type: 'layout-shift', buffered: true });</script>";

/// Folder of `package.json`, which pins axe-core.
const AXE: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/tests/axe");
/// Set where the test of accessibility must not be left out, as by `.ci/run`.
const AXE_REQUIRED: &str = "SKIAGRAPH_AXE";

/// Returns what `script` finds on the page in a frame so wide; the script ends by calling `done`.
fn browsed(folder: &Path, page: &str, width: u32, is_dark: bool, script: &str) -> Value {
    let html = fs::read_to_string(folder.join(page)).unwrap();
    let own = tempfile::tempdir_in(folder).unwrap();
    let folder = own.path();
    let html = html.replacen("<head>", &format!("<head>{BEFORE}"), 1);
    let helpers = include_str!("report/helpers.js");
    let html = html.replacen(
        "</body>",
        &format!("<script type=\"module\">{helpers}{script}</script></body>"),
        1,
    );
    fs::write(folder.join("tried.html"), html).unwrap();
    // A window has a least width, a frame has none; the outcome comes back as a message.
    let frame = folder.join("frame.html");
    let around = include_str!("report/frame.html").replace("WIDTH", &width.to_string());
    fs::write(&frame, around).unwrap();
    let program = std::env::var("CHROMIUM").unwrap_or_else(|_| "chromium".into());
    let output = Command::new(&program)
        .args(["--headless", "--no-sandbox", "--disable-gpu", "--dump-dom"])
        .arg(format!(
            "--user-data-dir={}",
            folder.join("browser").display()
        ))
        .arg("--window-size=1400,1000")
        .arg(format!(
            "--blink-settings=preferredColorScheme={}",
            if is_dark { 0 } else { 1 }
        ))
        .arg("--virtual-time-budget=60000")
        .arg(format!("file://{}", frame.display()))
        .output()
        .unwrap_or_else(|error| panic!("{program} cannot be started ({error}): install it"));
    let dom = String::from_utf8_lossy(&output.stdout);
    let (begin, end) = ("<pre id=\"outcome\">", "</pre>");
    let at = dom.find(begin).unwrap_or_else(|| {
        let stderr = String::from_utf8_lossy(&output.stderr);
        panic!("the page came to no end: {stderr}")
    });
    let text = &dom[at + begin.len()..];
    let text = text[..text.find(end).unwrap()]
        .replace("&lt;", "<")
        .replace("&gt;", ">");
    serde_json::from_str(&text.replace("&amp;", "&")).unwrap()
}

/// A folder with a page of two sizes and maps (`out/report.html`), one of two machines with the
/// hard cases (`all.html`) and one of several lights (`lights/report.html`).
fn pages() -> &'static Path {
    static FOLDER: OnceLock<PathBuf> = OnceLock::new();
    FOLDER.get_or_init(|| {
        let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join("pages");
        if folder.exists() {
            fs::remove_dir_all(&folder).unwrap();
        }
        fs::create_dir_all(&folder).unwrap();
        write_pages(&folder);
        folder
    })
}

fn write_pages(folder: &Path) {
    let line = "compare rt nsm light_buffer pcf --scene park --size 64x64,96x64 --map-size 64,128 \
                --frames 2 --warmup 1 --out out";
    let (runs, _) = results(folder, line);
    assert_eq!(runs.len(), 14, "four methods, one without a map, two sizes");
    let output = skiagraph(
        folder,
        "stress rt nsm --case box_on_floor --size 48x48 --out hard",
    );
    assert!(output.status.success());
    let scene = concat!(env!("CARGO_MANIFEST_DIR"), "/../../scenes/lamps.ron");
    let line = format!(
        "compare rt nsm --scene {scene} --light all --size 48x48 --map-size 64 --frames 1 \
         --out lights"
    );
    let output = skiagraph(folder, &line);
    let stderr = String::from_utf8_lossy(&output.stderr);
    assert!(output.status.success(), "{stderr}");
    // Times that a busy machine does not change: what is on the front follows from them.
    let text = fs::read_to_string(folder.join("out/results.json")).unwrap();
    let mut far: Value = serde_json::from_str(&text).unwrap();
    far["runs"]
        .as_array_mut()
        .unwrap()
        .iter_mut()
        .for_each(set_times);
    fs::write(folder.join("out/results.json"), far.to_string()).unwrap();
    assert!(skiagraph(folder, "report out").status.success());
    // Another machine's results.
    fs::create_dir(folder.join("far")).unwrap();
    far["adapter"]["name"] = "Far GPU".into();
    for run in far["runs"].as_array_mut().unwrap() {
        run["band"] = 100.into();
    }
    fs::write(folder.join("far/results.json"), far.to_string()).unwrap();
    // Another scene's, each with its own times.
    fs::create_dir(folder.join("level")).unwrap();
    far["scene"]["name"] = "level".into();
    fs::write(folder.join("level/results.json"), far.to_string()).unwrap();
    assert!(
        skiagraph(folder, "report out level --out scenes.html")
            .status
            .success()
    );
    // A matrix in which a band is too large and a method could not run.
    let text = fs::read_to_string(folder.join("hard/stress.json")).unwrap();
    let mut matrix: Value = serde_json::from_str(&text).unwrap();
    matrix["cases"][0]["verdict"] = "fail".into();
    matrix["cases"][0]["band"] = 1_000.into();
    matrix["methods"][1]["unavailable"] = "needs what is not there".into();
    fs::create_dir(folder.join("bad")).unwrap();
    fs::write(folder.join("bad/stress.json"), matrix.to_string()).unwrap();
    let output = skiagraph(folder, "report out far hard bad --out all.html");
    let stderr = String::from_utf8_lossy(&output.stderr);
    assert!(
        output.status.success() && stderr.contains("all.html"),
        "{stderr}"
    );
}

/// Gives a run the times of its method, viewport and map: a shadow map is the fastest, rays the
/// slowest.
fn set_times(run: &mut Value) {
    let preset = run["preset"].as_str().unwrap();
    let methods = ["nsm", "pcf", "light_buffer", "rt"];
    let method = methods.iter().position(|name| *name == preset).unwrap();
    let width = run["viewport"][0].as_f64().unwrap();
    let map = run["map_size"].as_f64().unwrap_or(0.0);
    let ms = (method + 1) as f64 * width / 64.0 + map / 1e3;
    let regimes = [
        ("/regimes/0/frame", 0.25),
        ("/regimes/1/frame", 0.5),
        ("/regimes/2/frame", 1.0),
        ("/regimes/3/frame", 1.5),
        ("/regimes/4/frame", 2.0),
    ];
    for (frame, share) in [("/frame", 1.0)].into_iter().chain(regimes) {
        for clock in ["gpu_frames", "wall_frames"] {
            if let Some(times) = run.pointer_mut(&format!("{frame}/{clock}")) {
                *times = vec![share * ms; 8].into(); // as many as tell times apart
            }
        }
        for clock in ["gpu_ms", "wall_ms"] {
            for (figure, by) in [("median", 1.0), ("q1", 0.9), ("q3", 1.2)] {
                if let Some(time) = run.pointer_mut(&format!("{frame}/{clock}/{figure}")) {
                    *time = (by * share * ms).into();
                }
            }
        }
    }
}

#[test]
#[ignore = "a suite: `./test.sh --all` runs it"]
fn the_page_works_in_a_browser() {
    let folder = pages();
    for (width, is_dark) in [
        (1280, false),
        (1280, true),
        (700, false),
        (390, false),
        (390, true),
    ] {
        let script = include_str!("report/page.js");
        let outcome = browsed(folder, "out/report.html", width, is_dark, script);
        assert_eq!(outcome["faults"], Value::Array(Vec::new()), "{width}");
        assert_eq!(outcome["failed"], Value::Array(Vec::new()), "{width}");
        let theme = if is_dark { "dark" } else { "light" };
        assert_eq!(outcome["theme"], theme);
        assert_eq!(outcome["width"], width);
    }
    for (page, script) in [
        ("all.html", include_str!("report/merged.js")),
        ("scenes.html", include_str!("report/scenes.js")),
    ] {
        let outcome = browsed(folder, page, 1280, false, script);
        assert_eq!(outcome["faults"], Value::Array(Vec::new()), "{page}");
        assert_eq!(outcome["failed"], Value::Array(Vec::new()), "{page}");
    }
    // A4 is 210 mm wide, less 24 mm of margins.
    for page in ["out/report.html", "all.html", "scenes.html"] {
        let outcome = browsed(folder, page, 703, true, include_str!("report/print.js"));
        assert_eq!(outcome["failed"], Value::Array(Vec::new()), "{page}");
    }
}

/// Returns the script of axe-core; `None`, with a message, where it is not installed and may be
/// missing.
fn axe() -> Option<PathBuf> {
    let script = Path::new(AXE).join("node_modules/axe-core/axe.min.js");
    if script.is_file() {
        return Some(script);
    }
    let text = "axe-core is not installed: npm ci --prefix crates/cli/tests/axe";
    assert!(std::env::var_os(AXE_REQUIRED).is_none(), "{text}");
    eprintln!("left out, no page is tried for accessibility: {text}");
    None
}

#[test]
#[ignore = "a suite: `./test.sh --all` runs it"]
fn axe_core_finds_nothing_serious_on_the_pages() {
    let Some(axe) = axe() else {
        return;
    };
    let folder = pages();
    let axe = fs::read_to_string(axe).unwrap();
    fs::write(folder.join("axe.min.js"), axe).unwrap();
    let script = include_str!("report/axe.js");
    let mut violations = Vec::new();
    let layouts = [(1280, false), (390, true), (1280, true), (390, false)];
    let pages = [
        ("out/report.html", &layouts[..]),
        ("all.html", &layouts[..2]),
        ("lights/report.html", &layouts[..2]),
    ];
    for (page, windows) in pages {
        for &(width, is_dark) in windows {
            let outcome = browsed(folder, page, width, is_dark, script);
            assert_eq!(outcome["faults"], Value::Array(Vec::new()), "{page}");
            assert!(outcome["passed"].as_u64() > Some(10), "{page}: {outcome}");
            let findings = outcome["failed"].as_array().unwrap().iter();
            let theme = if is_dark { "dark" } else { "light" };
            violations.extend(
                findings.map(|finding| format!("{page}, {width} pixels, {theme}: {finding}")),
            );
        }
    }
    assert!(violations.is_empty(), "{}", violations.join("\n"));
}

#[test]
fn a_page_of_nothing_says_what_is_missing() {
    let folder = tempfile::tempdir().unwrap();
    fs::create_dir(folder.path().join("empty")).unwrap();
    let output = skiagraph(folder.path(), "report empty");
    assert_eq!(output.status.code(), Some(1));
    let stderr = String::from_utf8_lossy(&output.stderr);
    assert!(
        stderr.contains("there is no results.json in empty"),
        "{stderr}"
    );
    assert!(!folder.path().join("empty/report.html").exists());
}
