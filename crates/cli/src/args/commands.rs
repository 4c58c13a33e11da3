//! Arguments of each command.

use crate::args::{
    shared::{MethodArgs, SceneArgs},
    values::{bytes, frames, gate, milliseconds, percent, texels},
};
use clap::{ArgAction, Args, ValueEnum};
use skiagraph_compare::graphs::argument::Assignment;
use skiagraph_compare::measuring::ground_truth::REFERENCE_SAMPLES;
use skiagraph_compare::pictures::{data::DataFormat, save::Save};
use skiagraph_compare::records::published_row::PublishedFile;
use skiagraph_compare::size::Size;
use skiagraph_reference::OracleMode;
use skiagraph_report::gate::Gate;
use std::path::PathBuf;

/// `skiagraph compare`.
#[derive(Args, Debug)]
#[command(mut_arg("scenes", |scenes| scenes.action(ArgAction::Append).help(
    "Built-in scene, scene file (.ron), name in scenes/, or a mesh (.obj, .gltf, .glb). Given \
     several times, each scene is compared by itself into DIR/SCENE, with an overview"
)))]
pub struct CompareArgs {
    /// Presets by name, or graphs (.ron) with the output `visibility`, and perhaps `status`.
    /// With settings of its own a method stands beside itself: `crsm@n=1,depth=plane`. Without any:
    /// the eight that one would ship (rt, light_buffer, nsm, pcf, pssm, vsm, hybrid_pcf, crsm) and
    /// one's own in ./pipelines.
    #[arg(value_name = "PRESET|FILE.ron[@NAME=VALUE,…]")]
    pub presets: Vec<String>,
    /// Compare all presets, those in ./pipelines and the built-in ones.
    #[arg(long, conflicts_with = "presets")]
    pub all: bool,
    /// The scene and the place that it is seen from.
    #[command(flatten)]
    pub scene: SceneArgs,
    /// A camera path of the scene, or `all`: every frame is judged, and shimmer is counted, with
    /// what a method keeps from frame to frame, and timed, also with every pass run (but with
    /// --cached-frames 0). --frames is of still views.
    #[arg(long, value_name = "NAME", conflicts_with = "view")]
    pub path: Option<String>,
    /// Move the camera by a part of a pixel in each frame, in turns of so many places (Halton's
    /// sequence), as for temporal antialiasing: `camera.jitter` of the shaders.
    #[arg(long, value_name = "N", requires = "path",
          value_parser = clap::value_parser!(u32).range(1..=1024))]
    pub jitter: Option<u32>,
    /// Viewport sizes in pixels, separated by commas.
    #[arg(
        long,
        value_name = "WxH,…",
        value_delimiter = ',',
        default_value = "1024x1024"
    )]
    pub size: Vec<Size>,
    /// Shadow map sizes in texels, separated by commas: the param `map_size` of the graphs that
    /// have it.
    #[arg(long, value_name = "N,…", value_delimiter = ',',
          value_parser = texels(), allow_negative_numbers = true)]
    pub map_size: Vec<u32>,
    /// A param of the graphs that have it. Of a list (radius=1,2,4; vectors between semicolons) or
    /// a range (bias=0..0.01/5: five values) every value is a row. May be repeated.
    #[arg(long = "set", value_name = "NAME=VALUE,…", allow_hyphen_values = true)]
    pub params: Vec<Assignment>,
    /// Timed frames per run. The frame that is judged and pictured is one more behind them, as its
    /// readback would be timed, too.
    #[arg(long, default_value_t = 10, value_name = "N",
          value_parser = frames(1), allow_negative_numbers = true)]
    pub frames: u32,
    /// Frames before the timed ones.
    #[arg(long, default_value_t = 2, value_name = "N",
          value_parser = frames(0), allow_negative_numbers = true)]
    pub warmup: u32,
    /// Timed frames in which only the camera moves, so that passes may be skipped: as many as
    /// --frames, 0 for none.
    #[arg(long, value_name = "N",
          value_parser = frames(0), allow_negative_numbers = true)]
    pub cached_frames: Option<u32>,
    /// The answer that counts as right: `exact` (own primitive excluded, no offset) or
    /// `offset:LENGTH` (ray origin moved towards the light).
    #[arg(long, default_value = "exact", value_name = "MODE")]
    pub oracle: OracleMode,
    /// Shadow rays per pixel to a light that has an extent, of which the reference is made.
    #[arg(long, value_name = "N", default_value_t = REFERENCE_SAMPLES,
          value_parser = clap::value_parser!(u32).range(4..=1_048_576))]
    pub reference_samples: u32,
    /// Take no method whose frame takes longer with every pass run: `3ms`, `800us`.
    #[arg(long, value_name = "TIME", value_parser = milliseconds)]
    pub under: Option<f64>,
    /// Take no method that is wrong on so many of the pixels that face the light, or more: `1%`.
    /// The fastest one that is right enough is taken, not the fastest exact one.
    #[arg(long, value_name = "SHARE", value_parser = percent)]
    pub below: Option<f64>,
    /// Take no method that needs more memory, with what it reads of the scene: `64MiB`.
    #[arg(long, value_name = "SIZE", value_parser = bytes)]
    pub memory: Option<u64>,
    /// Search the params that documents mark with `tune`, and measure each method with its best
    /// setting, too. Settings are chosen on every second view and judged on the others.
    #[arg(long, conflicts_with = "path")]
    pub tune: bool,
    /// End with exit code 4 if a figure of a method is greater: `nsm: wrong > 0.1%`, `rmse > 0.05`,
    /// `flip > 0.02`, `frame > 3ms`, `memory > 64MiB`. May be repeated.
    #[arg(long, value_name = "METHOD: FIGURE > VALUE", value_parser = gate)]
    pub fail_if: Vec<Gate>,
    /// Compare with older results, cell by cell: a results.json or its folder. End with exit code 5
    /// if a method has become more wrong or slower.
    #[arg(long, value_name = "RESULTS.json|DIR")]
    pub baseline: Option<PathBuf>,
    /// Folder for report.html, results.json, results.csv and the pictures; of several scenes for
    /// report.html and a folder for each.
    #[arg(long, default_value = "compare", value_name = "DIR")]
    pub out: PathBuf,
    /// Keep the runs in DIR/results.json whose graph, shaders, params, scene and view are still the
    /// same, and go on with the others.
    #[arg(long)]
    pub resume: bool,
    /// Forget what DIR/results.json holds. Without it, runs of other methods, views and sizes stay
    /// in it.
    #[arg(long, conflicts_with = "resume")]
    pub replace: bool,
    /// Published figures to stand beside ours in results.json and in --format markdown, there as
    /// (LABEL VALUE): a CSV with the columns scene, view, viewport, map_size, preset, quantity,
    /// value, source, note. May be repeated.
    #[arg(long = "beside", value_name = "LABEL:FILE.csv")]
    pub published: Vec<PublishedFile>,
    /// Which pictures are written.
    #[arg(long, value_enum, default_value_t = Images::All)]
    pub images: Images,
    /// Write the answers and the reference as arrays, too: NumPy's or OpenEXR's.
    #[arg(long, value_name = "npy|exr")]
    pub data: Option<DataFormat>,
    /// Format of the results on standard output.
    #[arg(long, value_enum, default_value_t = Format::Table)]
    pub format: Format,
    /// Print the time of each pass, too: a table per method, a column per viewport and map.
    #[arg(long)]
    pub passes: bool,
    /// Print all figures of each view and viewport by itself, too.
    #[arg(long)]
    pub details: bool,
}

/// Which pictures are written.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum Images {
    /// Those of every run, and of the reference of every view and viewport.
    All,
    /// None.
    None,
}

/// How results are printed.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum Format {
    /// For a terminal.
    Table,
    /// For a document: the command, the conditions, and a table per view and viewport with the
    /// times of steps.
    Markdown,
    /// The contents of results.json; of several scenes a list of them.
    Json,
}

/// `skiagraph chart`.
#[derive(Args, Debug)]
pub struct ChartArgs {
    /// Folders that `compare --out` wrote, each with its results.json.
    #[arg(value_name = "DIR", required = true)]
    pub folders: Vec<PathBuf>,
    /// Kind of chart to draw.
    #[arg(long, value_enum, default_value_t = ChartKind::Front)]
    pub kind: ChartKind,
    /// Only runs of this viewport size. Without it: all, each in a panel of its own.
    #[arg(long, value_name = "WxH")]
    pub size: Option<Size>,
    /// Draws published figures beside ours instead, theirs left and ours right on the same axes: by
    /// map size and by viewport a chart for each quantity that both have, times as shares of those
    /// of the method that draws no map. --out is a folder for them.
    #[arg(
        long,
        value_name = "LABEL:FILE.csv",
        conflicts_with = "kind",
        requires = "out"
    )]
    pub beside: Option<PublishedFile>,
    /// File to write, or with --beside the folder. Without it: standard output, as SVG.
    #[arg(long, value_name = "FILE.svg|FILE.png|DIR")]
    pub out: Option<PathBuf>,
}

/// Kinds of charts.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum ChartKind {
    /// GPU time of a frame less its G-buffer against the share of wrong pixels outside the band:
    /// a panel per folder and viewport, a mark per method and map size, the mean where there are
    /// several views.
    Front,
    /// Time and memory against the number of triangles: two panels per scene, view and viewport, a
    /// line per method and map size; give a folder for each size of a scene.
    Growth,
    /// Errors over the frames of camera paths: a panel per folder, path and viewport, a line per
    /// method and map size.
    Frames,
}

/// `skiagraph report`.
#[derive(Args, Debug)]
pub struct ReportArgs {
    /// Folders that `compare --out` wrote, each with its results.json, and those that `stress
    /// --out` wrote. What was measured alike becomes one; of a run that is there twice the newer
    /// one counts.
    #[arg(value_name = "DIR", required = true)]
    pub folders: Vec<PathBuf>,
    /// The page. Without it: report.html in the first folder.
    #[arg(long, value_name = "FILE.html")]
    pub out: Option<PathBuf>,
}

/// `skiagraph merge`.
#[derive(Args, Debug)]
pub struct MergeArgs {
    /// Folders that `compare --out` or `merge --out` wrote, or their results.json.
    #[arg(value_name = "DIR|FILE.json", required = true)]
    pub places: Vec<PathBuf>,
    /// Folder for results.json, results.csv and report.html.
    #[arg(long, value_name = "DIR")]
    pub out: PathBuf,
}

/// `skiagraph completions`.
#[derive(Args, Debug)]
pub struct CompletionsArgs {
    /// The shell.
    pub shell: clap_complete::Shell,
}

/// `skiagraph new`.
#[derive(Args, Debug)]
pub struct NewArgs {
    /// Name of the method: NAME.ron and NAME.wgsl are written.
    pub name: String,
    /// Write a variant of this preset instead, with its params to choose from.
    #[arg(long, value_name = "PRESET")]
    pub from: Option<String>,
}

/// `skiagraph show`.
#[derive(Args, Debug)]
pub struct ShowArgs {
    /// A preset, or a document or shader by its path, also below pipelines/ or shaders/; or a
    /// scene.
    #[arg(value_name = "NAME|FILE")]
    pub file: String,
    /// Write out what a document extends, each line with the file and line that it comes from.
    #[arg(long)]
    pub flat: bool,
}

/// `skiagraph schema`.
#[derive(Args, Debug)]
pub struct SchemaArgs {
    /// Files that are described.
    #[arg(value_enum, default_value_t = SchemaOf::Documents)]
    pub of: SchemaOf,
    /// Format of the description.
    #[arg(long, value_enum, default_value_t = SchemaFormat::Json)]
    pub format: SchemaFormat,
}

/// Files that have a schema.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum SchemaOf {
    /// Graphs, `(format: 3, passes: …)`.
    Documents,
    /// Scene files, `(format: 1, mesh: …)`.
    Scenes,
}

/// How the language is described.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum SchemaFormat {
    /// A JSON Schema (draft 2020-12).
    Json,
    /// Tables for a reader.
    Markdown,
}

/// `skiagraph run`.
#[derive(Args, Debug)]
pub struct RunArgs {
    /// The method to run.
    #[command(flatten)]
    pub method: MethodArgs,
    /// The scene to run it on.
    #[command(flatten)]
    pub scene: SceneArgs,
    /// Save an output, a material or a view of one, after a pass or at the end: .png a picture,
    /// .npy or .exr values, .bin raw bytes, .csv the words of a buffer. After a pass it is as much
    /// as has been written by then. May be repeated.
    #[arg(long, value_name = "MATERIAL[@PASS]=FILE")]
    pub save: Vec<Save>,
    /// Render so many frames one after the other and save each: `--save visibility=v.png` writes
    /// v.0000.png, v.0001.png … Along a path: not all of it, but so many frames.
    #[arg(long, value_name = "N", requires = "save",
          value_parser = frames(1), allow_negative_numbers = true)]
    pub frames: Option<u32>,
    /// A camera path of the scene, each frame of which is saved.
    #[arg(long, value_name = "NAME", conflicts_with = "view", requires = "save")]
    pub path: Option<String>,
    /// Move the camera by a part of a pixel in each frame, in turns of so many places (Halton's
    /// sequence), as for temporal antialiasing: `camera.jitter` of the shaders.
    #[arg(long, value_name = "N", requires = "save",
          value_parser = clap::value_parser!(u32).range(1..=1024))]
    pub jitter: Option<u32>,
    /// Fill all memory that a frame has not written with two patterns, one after the other, and
    /// fail if an output differs: the graph then reads what no pass has written. An output that
    /// differs in the same memory, too, depends on the order of threads and is not judged.
    #[arg(long)]
    pub poison: bool,
}

/// `skiagraph profile`.
#[derive(Args, Debug)]
pub struct ProfileArgs {
    /// Presets by name, or graphs (.ron). With settings of its own a method stands beside itself:
    /// `crsm@n=1,depth=plane`.
    #[arg(value_name = "PRESET|FILE.ron[@NAME=VALUE,…]", required = true)]
    pub presets: Vec<String>,
    /// Viewport sizes in pixels, separated by commas.
    #[arg(
        long,
        value_name = "WxH,…",
        value_delimiter = ',',
        default_value = "1024x1024"
    )]
    pub size: Vec<Size>,
    /// Shadow map sizes in texels, separated by commas: the param `map_size` of the graphs that
    /// have it.
    #[arg(long, value_name = "N,…", value_delimiter = ',',
          value_parser = texels(), allow_negative_numbers = true)]
    pub map_size: Vec<u32>,
    /// A param of the graphs that have it. Of a list (radius=1,2,4; vectors between semicolons) or
    /// a range (bias=0..0.01/5: five values) every value is timed. May be repeated.
    #[arg(long = "set", value_name = "NAME=VALUE,…", allow_hyphen_values = true)]
    pub params: Vec<Assignment>,
    /// The scene to run the methods on.
    #[command(flatten)]
    pub scene: SceneArgs,
    /// Timed frames.
    #[arg(long, default_value_t = 30, value_name = "N",
          value_parser = frames(1), allow_negative_numbers = true)]
    pub frames: u32,
    /// Frames before the timed ones.
    #[arg(long, default_value_t = 3, value_name = "N",
          value_parser = frames(0), allow_negative_numbers = true)]
    pub warmup: u32,
    /// Write a line per pass and one for the frame.
    #[arg(long, value_name = "FILE")]
    pub csv: Option<PathBuf>,
    /// Write every timed frame in the Trace Event Format, for ui.perfetto.dev or chrome://tracing;
    /// of one profile.
    #[arg(long, value_name = "FILE")]
    pub trace: Option<PathBuf>,
    /// Write everything, samples included: what --baseline reads; of one profile.
    #[arg(long, value_name = "FILE")]
    pub json: Option<PathBuf>,
    /// Compare with what an earlier --json wrote; one profile.
    #[arg(long, value_name = "OLD.json")]
    pub baseline: Option<PathBuf>,
}

/// `skiagraph stress`.
#[derive(Args, Debug)]
pub struct StressArgs {
    /// Presets by name, or graphs (.ron) with the output `visibility`, and perhaps `status`.
    /// With settings of its own a method stands beside itself: `crsm@n=1,depth=plane`. Without any:
    /// all presets, those in ./pipelines and the built-in ones.
    #[arg(value_name = "PRESET|FILE.ron[@NAME=VALUE,…]")]
    pub presets: Vec<String>,
    /// List the cases instead: names, casters, reasons. Needs no GPU.
    #[arg(long, exclusive = true)]
    pub list: bool,
    /// A case by name. May be repeated. Without any: all cases.
    #[arg(long = "case", value_name = "NAME")]
    pub cases: Vec<String>,
    /// Viewport size in pixels.
    #[arg(long, value_name = "WxH", default_value = "128x128")]
    pub size: Size,
    /// Shadow map sizes in texels, separated by commas: the param `map_size` of the graphs that
    /// have it.
    #[arg(long, value_name = "N,…", value_delimiter = ',', default_value = "128",
          value_parser = texels(), allow_negative_numbers = true)]
    pub map_size: Vec<u32>,
    /// A param of the graphs that have it. Of a list (radius=1,2,4; vectors between semicolons) or
    /// a range (bias=0..0.01/5: five values) every value is a row. May be repeated.
    #[arg(long = "set", value_name = "NAME=VALUE,…", allow_hyphen_values = true)]
    pub params: Vec<Assignment>,
    /// Judge this method as an exact one, too: no pixel outside the band may be wrong. May be
    /// repeated.
    #[arg(long, value_name = "PRESET|FILE.ron")]
    pub exact: Vec<String>,
    /// Folder for the pictures of every cell: shaded, visibility, error, uncertain.
    #[arg(long, value_name = "DIR")]
    pub save: Option<PathBuf>,
    /// Folder for stress.json, written anew after every case.
    #[arg(long, value_name = "DIR")]
    pub out: Option<PathBuf>,
    /// Format of the matrix on standard output.
    #[arg(long, value_enum, default_value_t = StressFormat::Table)]
    pub format: StressFormat,
}

/// How the matrix is printed.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum StressFormat {
    /// For a terminal.
    Table,
    /// The contents of stress.json.
    Json,
}

/// `skiagraph check`.
#[derive(Args, Debug)]
pub struct CheckArgs {
    /// Graphs (.ron), or presets by name.
    #[arg(value_name = "FILE.ron", required = true)]
    pub graphs: Vec<String>,
    /// How diagnostics are printed: text on standard error, or json on standard output.
    #[arg(long, value_enum, default_value_t = CheckFormat::Text)]
    pub format: CheckFormat,
    /// Check again whenever a document, shader or picture beside the graphs or in ./pipelines or
    /// ./shaders changes, until Ctrl-C.
    #[arg(long)]
    pub watch: bool,
}

/// How diagnostics are printed.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum CheckFormat {
    /// For people: source lines with the mistakes underlined, on standard error.
    Text,
    /// For programs: one JSON object on standard output.
    Json,
}

/// `skiagraph presets`.
#[derive(Args, Debug)]
pub struct PresetsArgs {
    /// How they are listed.
    #[arg(long, value_enum, default_value_t = PresetsFormat::Text)]
    pub format: PresetsFormat,
}

/// How presets are listed.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum PresetsFormat {
    /// Each with its params.
    Text,
    /// As the table of docs/presets.md.
    Markdown,
}

/// `skiagraph graph`.
#[derive(Args, Debug)]
pub struct GraphArgs {
    /// The method to plan.
    #[command(flatten)]
    pub method: MethodArgs,
    /// Format of the drawing. Without it: what the ending of --out names, else svg.
    #[arg(long, value_enum, value_name = "FORMAT")]
    pub format: Option<DrawingFormat>,
    /// File to write. Without it: standard output.
    #[arg(long, value_name = "FILE")]
    pub out: Option<PathBuf>,
    /// Outputs that are wanted, separated by commas; what only others need is culled. Without it:
    /// all.
    #[arg(long, value_name = "NAME,…", value_delimiter = ',')]
    pub outputs: Vec<String>,
}

/// How a graph is drawn.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum DrawingFormat {
    /// A chart of lifetimes, for a browser.
    Svg,
    /// Nodes and links, for Graphviz.
    Dot,
    /// The plan as data, for scripts.
    Json,
}

/// `skiagraph view`.
#[derive(Args, Debug)]
pub struct ViewArgs {
    /// One or two presets by name, or graphs (.ron), each perhaps in a setting of its own.
    #[arg(value_name = "PRESET|FILE.ron[@NAME=VALUE,…]", num_args = 0..=2, default_value = "nsm")]
    pub methods: Vec<String>,
    /// The scene and the place that it is seen from.
    #[command(flatten)]
    pub scene: SceneArgs,
    /// Pixels that the methods run in; the window shows them larger or smaller.
    #[arg(long, value_name = "WxH", default_value = "512x512")]
    pub size: Size,
    /// Shadow map size in texels: the param `map_size`.
    #[arg(long, value_name = "N", value_parser = texels(), allow_negative_numbers = true)]
    pub map_size: Option<u32>,
    /// A param of the graphs that have it. May be repeated.
    #[arg(long = "set", value_name = "NAME=VALUE", allow_hyphen_values = true)]
    pub params: Vec<Assignment>,
}
