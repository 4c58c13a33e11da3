//! Arguments of each command.

use crate::args::shared::{MethodArgs, ReferenceArgs, SceneArgs, SweepArgs, TimingArgs};
use crate::args::values::{self, LightArgument, frames, texels};
use clap::builder::PossibleValuesParser;
use clap::{ArgAction, Args, ValueEnum};
use skiagraph_compare::foreign::factor::Reading;
use skiagraph_compare::graphs::argument::Assignment;
use skiagraph_compare::pictures::{data::DataFormat, save::Save};
use skiagraph_compare::quantities::{bytes, milliseconds, percent};
use skiagraph_compare::records::figures::drawn;
use skiagraph_compare::records::{published_row::PublishedFile, shard::Shard};
use skiagraph_compare::size::Size;
use skiagraph_report::gate::{self, Gate};
use std::path::PathBuf;

/// Arguments of `skiagraph compare`.
#[derive(Args, Debug)]
#[command(mut_args(|arg| match arg.get_id().as_str() {
    "out" | "cells" | "shard" => arg,
    _ => arg.conflicts_with("cells"),
}))]
#[command(mut_arg("scenes", |scenes| scenes.action(ArgAction::Append).help(
    "Built-in scene, scene file (.ron), name in scenes/, or a mesh (.obj, .gltf, .glb). Given \
     several times, each scene is compared by itself into DIR/SCENE, with an overview"
)))]
pub struct CompareArgs {
    /// Presets by name, or graphs (.ron) with the output `visibility`, and perhaps `status`.
    /// `crsm@n=1,depth=plane` is a method with params of its own. Without any: the eight that are
    /// fit for use (rt, light_buffer, nsm, pcf, pssm, vsm, hybrid_pcf, crsm) and your own in
    /// ./pipelines.
    #[arg(value_name = "PRESET|FILE.ron[@NAME=VALUE,…]")]
    pub presets: Vec<String>,
    /// Compare all presets, those in ./pipelines and the built-in ones.
    #[arg(long, conflicts_with = "presets")]
    pub all: bool,
    /// The scene and the place that it is seen from.
    #[command(flatten)]
    pub scene: SceneArgs,
    /// A camera path of the scene, or `all`. Every frame is judged and timed, and shimmer counted.
    /// Unchanged passes are skipped. --frames has no effect.
    #[arg(long, value_name = "NAME", conflicts_with = "view")]
    pub path: Option<String>,
    /// Move the camera by a part of a pixel in each frame, through N places in turn (Halton's
    /// sequence), as for temporal antialiasing. Shaders read it as `camera.jitter`.
    #[arg(long, value_name = "N", requires = "path",
          value_parser = clap::value_parser!(u32).range(1..=1024))]
    pub jitter: Option<u32>,
    /// Viewports, params, and frames to time.
    #[command(flatten)]
    pub timing: TimingArgs,
    /// Compare each method that has a shadow map with maps of 256, 512, 1024, 2048 and 4096 texels,
    /// and tell its error at the cost of the fastest exact method.
    #[arg(long, conflicts_with = "map_size")]
    pub map_curve: bool,
    /// Timed frames before each of which the same has moved: nothing, the camera, the light, meshes
    /// (on a path that moves parts). 0 for none. Without it: as many as --frames.
    #[arg(long, value_name = "N", alias = "cached-frames",
          value_parser = frames(0), allow_negative_numbers = true)]
    pub regime_frames: Option<u32>,
    /// How the reference traces.
    #[command(flatten)]
    pub reference: ReferenceArgs,
    /// Recommend no method whose frame takes longer, GPU and CPU together, on any view or in any
    /// frame of a path; for each kind of movement by itself: `3ms`, `800us`.
    #[arg(long, value_name = "TIME", value_parser = milliseconds)]
    pub under: Option<f64>,
    /// Recommend no method that is wrong on so large a share of the pixels that face the light, or
    /// more: `1%`. The fastest below it is recommended, not the fastest exact one.
    #[arg(long, value_name = "SHARE", value_parser = percent)]
    pub below: Option<f64>,
    /// Recommend no method that needs more memory, with the scene data it reads: `64MiB`.
    #[arg(long, value_name = "SIZE", value_parser = bytes)]
    pub memory: Option<u64>,
    /// Search the values of params that documents mark with `tune`, and measure each method with
    /// the best ones, too. They are chosen on every second view and judged on the others.
    #[arg(long, conflicts_with = "path")]
    pub tune: bool,
    #[arg(long, value_name = "METHOD: FIGURE > VALUE", help = format!(
        "End with exit code 4 if a figure of a method is greater on any view or in any frame of a \
         path: `nsm: wrong > 0.1%`. Figures: {}. May be repeated", gate::help(false)
    ))]
    pub fail_if: Vec<Gate>,
    /// Compare each method on each view with older results: a results.json or its folder. End with
    /// exit code 5 if a method has become more wrong or slower.
    #[arg(long, value_name = "RESULTS.json|DIR")]
    pub baseline: Option<PathBuf>,
    /// Folder for report.html, results.json, results.csv and the pictures; with several scenes, for
    /// report.html and a folder for each scene.
    #[arg(long, default_value = "compare", value_name = "DIR")]
    pub out: PathBuf,
    /// Keep the runs in the results.json of --out whose graph, shaders, params, scene and view are
    /// still the same, and measure only the others.
    #[arg(long)]
    pub resume: bool,
    /// Drop all runs in the results.json of --out. Without it, runs of other methods, views and
    /// sizes stay there.
    #[arg(long, conflicts_with = "resume")]
    pub replace: bool,
    /// Write the cells of the comparison into a file, a line for each, and measure none: many
    /// machines can then each measure a part of them.
    #[arg(long, value_name = "FILE.jsonl", conflicts_with_all = [
        "tune", "out", "resume", "replace", "baseline", "fail_if", "format", "passes", "details",
        "write_scene",
    ])]
    pub plan: Option<PathBuf>,
    /// Measure the cells that --plan wrote and --out does not hold yet, each into a file of its
    /// own; `merge` joins them.
    #[arg(long, value_name = "FILE.jsonl")]
    pub cells: Option<PathBuf>,
    /// Part of --cells to measure: 3/10 is the third of ten. Without it: all.
    #[arg(long, value_name = "NUMBER/COUNT", requires = "cells")]
    pub shard: Option<Shard>,
    /// Published figures to show beside the measured ones in results.json and --format markdown,
    /// there as (LABEL VALUE): a CSV with the columns scene, view, viewport, map_size, preset,
    /// quantity, value, source, note. May be repeated.
    #[arg(long = "beside", value_name = "LABEL:FILE.csv")]
    pub published: Vec<PublishedFile>,
    /// Pictures to write.
    #[arg(long, value_enum, default_value_t = Images::All)]
    pub images: Images,
    /// Write visibility and status of each pixel, too: as NumPy arrays or OpenEXR pictures.
    #[arg(long, value_name = "npy|exr")]
    pub data: Option<DataFormat>,
    /// Format of the results on standard output.
    #[arg(long, value_enum, default_value_t = Format::Table)]
    pub format: Format,
    /// Print the GPU time of each pass, too: a table per method, a column per viewport and map
    /// size.
    #[arg(long)]
    pub passes: bool,
    /// Print all figures of each view and viewport by itself, too.
    #[arg(long)]
    pub details: bool,
}

/// Choice of the pictures that are written.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum Images {
    /// Pictures of every run, and of the reference of every view and viewport.
    All,
    /// No pictures.
    None,
}

/// Formats of the results on standard output.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum Format {
    /// Tables as text for a terminal.
    Table,
    /// Markdown: the command, the conditions, and a table per view and viewport with the times of
    /// groups of passes.
    Markdown,
    /// The contents of results.json; with several scenes, a list of them.
    Json,
}

/// Arguments of `skiagraph chart`.
#[derive(Args, Debug)]
pub struct ChartArgs {
    /// Folders that `compare --out` wrote, each with its results.json.
    #[arg(value_name = "DIR", required = true)]
    pub folders: Vec<PathBuf>,
    /// Kind of chart to draw.
    #[arg(long, value_enum, default_value_t = ChartKind::Front)]
    pub kind: ChartKind,
    /// Error to draw. Without it: wrong pixels of all for `front`, for `frames` wrong pixels of
    /// those that face the light, or the RMSE under a light with an extent.
    #[arg(long, value_name = "FIGURE",
          value_parser = PossibleValuesParser::new(drawn().map(|figure| &*figure.name)))]
    pub error: Option<String>,
    /// Draw only runs of this viewport size. Without it: all sizes, each in a panel of its own.
    #[arg(long, value_name = "WxH")]
    pub size: Option<Size>,
    /// File to write. Without it: standard output, as SVG.
    #[arg(long, value_name = "FILE.svg|FILE.png")]
    pub out: Option<PathBuf>,
}

/// Kinds of charts.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum ChartKind {
    /// GPU time of a frame less its G-buffer against the share of wrong pixels, without those that
    /// rounding decides: a panel per folder and viewport, a mark per method and map size, the mean
    /// of the views.
    Front,
    /// Time and memory against the number of triangles: two panels per scene, view and viewport, a
    /// line per method and map size. Give a folder for each number of triangles.
    Growth,
    /// Errors (wrong pixels, or RMSE of shares) over the frames of camera paths: a panel per
    /// folder, path and viewport, a line per method and map size.
    Frames,
}

/// Arguments of `skiagraph report`.
#[derive(Args, Debug)]
pub struct ReportArgs {
    /// Folders that `compare --out` or `stress --out` wrote. Results of one scene, machine, GPU and
    /// protocol are joined; of a run that is there twice the newer one counts.
    #[arg(value_name = "DIR", required = true)]
    pub folders: Vec<PathBuf>,
    /// File of the page. Without it: report.html in the first folder.
    #[arg(long, value_name = "FILE.html")]
    pub out: Option<PathBuf>,
}

/// Arguments of `skiagraph merge`.
#[derive(Args, Debug)]
pub struct MergeArgs {
    /// Folders that `compare --out` or `merge --out` wrote, or their results.json.
    #[arg(value_name = "DIR|FILE.json", required = true)]
    pub places: Vec<PathBuf>,
    /// Folder for results.json, results.csv and report.html.
    #[arg(long, value_name = "DIR")]
    pub out: PathBuf,
}

/// Arguments of `skiagraph completions`.
#[derive(Args, Debug)]
pub struct CompletionsArgs {
    /// Shell for which the script is printed.
    pub shell: clap_complete::Shell,
}

/// Arguments of `skiagraph new`.
#[derive(Args, Debug)]
pub struct NewArgs {
    /// Name of the new method: NAME.ron and NAME.wgsl are written into the current folder.
    pub name: String,
    /// Write a variant of this preset instead, a document that lists its params to change.
    #[arg(long, value_name = "PRESET")]
    pub from: Option<String>,
}

/// Arguments of `skiagraph show`.
#[derive(Args, Debug)]
pub struct ShowArgs {
    /// Name of a preset or scene, or path of a document or shader, also relative to pipelines/ or
    /// shaders/.
    #[arg(value_name = "NAME|FILE")]
    pub file: String,
    /// Print a document together with those that it extends, each line with its file and line.
    #[arg(long)]
    pub flat: bool,
}

/// Arguments of `skiagraph schema`.
#[derive(Args, Debug)]
pub struct SchemaArgs {
    /// Kind of files whose format is described.
    #[arg(value_enum, default_value_t = SchemaOf::Documents)]
    pub of: SchemaOf,
    /// Format of the description.
    #[arg(long, value_enum, default_value_t = SchemaFormat::Json)]
    pub format: SchemaFormat,
}

/// Kinds of files that have a schema.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum SchemaOf {
    /// Graph documents, `(format: 3, passes: …)`.
    Documents,
    /// Scene files, `(format: 1, mesh: …)`.
    Scenes,
}

/// Formats of the description.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum SchemaFormat {
    /// A JSON Schema (draft 2020-12).
    Json,
    /// Tables in Markdown, for a reader.
    Markdown,
}

/// Arguments of `skiagraph run`.
#[derive(Args, Debug)]
pub struct RunArgs {
    /// The method to run.
    #[command(flatten)]
    pub method: MethodArgs,
    /// The scene to run it on.
    #[command(flatten)]
    pub scene: SceneArgs,
    /// Save an output, a material or a part of one, as it is after a pass or at the end of the
    /// frame: .png a picture, .npy or .exr values, .bin raw bytes, .csv the items of a buffer. May
    /// be repeated.
    #[arg(long, value_name = "MATERIAL[@PASS]=FILE")]
    pub save: Vec<Save>,
    /// Render N frames one after the other and save each: `--save visibility=v.png` writes
    /// v.0000.png, v.0001.png … With --path: only the first N frames of the path.
    #[arg(long, value_name = "N", requires = "save",
          value_parser = frames(1), allow_negative_numbers = true)]
    pub frames: Option<u32>,
    /// A camera path of the scene, each frame of which is saved.
    #[arg(long, value_name = "NAME", conflicts_with = "view", requires = "save")]
    pub path: Option<String>,
    /// Move the camera by a part of a pixel in each frame, through N places in turn (Halton's
    /// sequence), as for temporal antialiasing. Shaders read it as `camera.jitter`.
    #[arg(long, value_name = "N", requires = "save",
          value_parser = clap::value_parser!(u32).range(1..=1024))]
    pub jitter: Option<u32>,
    /// Render frames with two byte patterns in all memory that no pass has written, and fail if an
    /// output differs: the graph then reads such memory. An output that also differs between frames
    /// of one pattern depends on the order of threads and is not judged.
    #[arg(long)]
    pub poison: bool,
}

/// Arguments of `skiagraph profile`.
#[derive(Args, Clone, Debug)]
#[command(mut_arg("frames", |frames| frames.default_value("30")))]
#[command(mut_arg("warmup", |warmup| warmup.default_value("3")))]
pub struct ProfileArgs {
    /// Presets by name, or graphs (.ron). `crsm@n=1,depth=plane` is a method with params of its
    /// own.
    #[arg(value_name = "PRESET|FILE.ron[@NAME=VALUE,…]", required = true)]
    pub presets: Vec<String>,
    /// Viewports, params, and frames to time.
    #[command(flatten)]
    pub timing: TimingArgs,
    /// The scene to run the methods on.
    #[command(flatten)]
    pub scene: SceneArgs,
    /// CSV file to write: a line per pass and one for the frame.
    #[arg(long, value_name = "FILE")]
    pub csv: Option<PathBuf>,
    /// File to write every timed frame to, in the Trace Event Format for ui.perfetto.dev or
    /// chrome://tracing. Needs one graph, view and size.
    #[arg(long, value_name = "FILE")]
    pub trace: Option<PathBuf>,
    /// JSON file to write, with all samples, for --baseline. Needs one graph, view and size.
    #[arg(long, value_name = "FILE")]
    pub json: Option<PathBuf>,
    /// Compare with a file that an earlier --json wrote. Needs one graph, view and size.
    #[arg(long, value_name = "OLD.json")]
    pub baseline: Option<PathBuf>,
}

/// Arguments of `skiagraph stress`.
#[derive(Args, Clone, Debug)]
#[command(mut_arg("map_size", |edges| edges.default_value("128")))]
pub struct StressArgs {
    /// Presets by name, or graphs (.ron) with the output `visibility`, and perhaps `status`.
    /// `crsm@n=1,depth=plane` is a method with params of its own. Without any: all presets, those
    /// in ./pipelines and the built-in ones.
    #[arg(value_name = "PRESET|FILE.ron[@NAME=VALUE,…]")]
    pub presets: Vec<String>,
    /// List the cases instead: names, casters (closed or open), reasons. Needs no GPU.
    #[arg(long, exclusive = true)]
    pub list: bool,
    /// Case to run, by name. May be repeated. Without any: all cases.
    #[arg(long = "case", value_name = "NAME")]
    pub cases: Vec<String>,
    /// Viewport size in pixels.
    #[arg(long, value_name = "WxH", default_value = "128x128")]
    pub size: Size,
    /// Params of the graphs.
    #[command(flatten)]
    pub sweep: SweepArgs,
    /// Judge this method as an exact one: no pixel may be wrong but those that rounding decides.
    /// May be repeated.
    #[arg(long, value_name = "PRESET|FILE.ron")]
    pub exact: Vec<String>,
    /// Folder for the pictures of every method on every case: shaded, visibility, error, uncertain.
    #[arg(long, value_name = "DIR")]
    pub save: Option<PathBuf>,
    /// Folder for stress.json, written anew after every case.
    #[arg(long, value_name = "DIR")]
    pub out: Option<PathBuf>,
    /// Format of the matrix on standard output.
    #[arg(long, value_enum, default_value_t = RecordFormat::Table)]
    pub format: RecordFormat,
}

/// Formats of what was judged, on standard output.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum RecordFormat {
    /// Text for a terminal.
    Table,
    /// The content of stress.json or judge.json.
    Json,
}

/// Arguments of `skiagraph doctor`.
#[derive(Args, Debug)]
pub struct DoctorArgs {
    /// Format of the abilities on standard output.
    #[arg(long, value_enum, default_value_t = RecordFormat::Table)]
    pub format: RecordFormat,
}

/// Arguments of `skiagraph truth`.
#[derive(Args, Debug)]
pub struct TruthArgs {
    /// The scene and the place that it is seen from.
    #[command(flatten)]
    pub scene: SceneArgs,
    /// Viewport size in pixels.
    #[arg(long, value_name = "WxH", default_value = "1024x1024")]
    pub size: Size,
    /// How the reference traces.
    #[command(flatten)]
    pub reference: ReferenceArgs,
    /// Format of the arrays.
    #[arg(long, value_name = "npy|exr", default_value = "exr")]
    pub data: DataFormat,
    /// Folder for the arrays and camera.json.
    #[arg(long, value_name = "DIR")]
    pub out: PathBuf,
}

/// Arguments of `skiagraph judge`.
#[derive(Args, Debug)]
pub struct JudgeArgs {
    /// Pictures of one size (PNG, EXR or NPY) that another renderer made of the view: the light
    /// factor, 0 in shadow to 1 in light; with --unshadowed, the shaded picture.
    #[arg(value_name = "PICTURE", required = true)]
    pub pictures: Vec<PathBuf>,
    /// The scene and the place that it is seen from.
    #[command(flatten)]
    pub scene: SceneArgs,
    /// The shaded picture without shadows: the factor is the quotient of both.
    #[arg(long, value_name = "PICTURE")]
    pub unshadowed: Option<PathBuf>,
    /// Read pictures as `flipped` (the lowest row first), `srgb` (encoded), `inverted` (1 is
    /// shadow): one or several, separated by commas.
    #[arg(long, value_name = "WORD,…")]
    pub read_as: Option<Reading>,
    /// The triangle that each pixel shows, as `truth` writes it: nothing is unattributable then,
    /// and no GPU is needed.
    #[arg(long, value_name = "FILE", conflicts_with = "depth")]
    pub ids: Option<PathBuf>,
    /// The depth that each pixel shows: it tells surfaces within 1/16 of a pixel apart.
    #[arg(long, value_name = "FILE")]
    pub depth: Option<PathBuf>,
    /// How the reference traces.
    #[command(flatten)]
    pub reference: ReferenceArgs,
    #[arg(long, value_name = "PICTURE: FIGURE > VALUE", help = format!(
        "End with exit code 4 if a figure of a picture is greater, by its file name without \
         ending: `engine: wrong > 0.1%`. Figures: {}. May be repeated", gate::help(true)
    ))]
    pub fail_if: Vec<Gate>,
    /// Folder for judge.json and pictures of the errors.
    #[arg(long, value_name = "DIR")]
    pub out: Option<PathBuf>,
    /// Format of the figures on standard output.
    #[arg(long, value_enum, default_value_t = RecordFormat::Table)]
    pub format: RecordFormat,
}

/// Arguments of `skiagraph check`.
#[derive(Args, Debug)]
pub struct CheckArgs {
    /// Graphs (.ron), or presets by name.
    #[arg(value_name = "FILE.ron", required = true)]
    pub graphs: Vec<String>,
    /// Viewport size in pixels to plan for. Without it: 64x64, or 1920x1080 where a document needs
    /// more.
    #[arg(long, value_name = "WxH")]
    pub size: Option<Size>,
    /// Scene to plan for, as of `run`, seen in its first view. Without it: a triangle under 1 to 3
    /// lights.
    #[arg(long, value_name = "SCENE")]
    pub scene: Option<String>,
    /// Light to plan for: a light of the scene, or without --scene directional, spot or point.
    /// Three numbers are the direction of a sun. Without it: the scene's first light, or each kind
    /// that a graph takes.
    #[arg(long, value_name = "NAME|X,Y,Z", value_parser = values::light,
          allow_hyphen_values = true)]
    pub light: Option<LightArgument>,
    /// Format of the diagnostics: text on standard error, or json on standard output.
    #[arg(long, value_enum, default_value_t = CheckFormat::Text)]
    pub format: CheckFormat,
    /// Check again whenever a document, shader or picture beside the graphs or in ./pipelines or
    /// ./shaders changes, until Ctrl-C.
    #[arg(long)]
    pub watch: bool,
}

/// Formats of diagnostics.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum CheckFormat {
    /// For people: source lines with the mistakes underlined, on standard error.
    Text,
    /// For programs: one JSON object on standard output.
    Json,
}

/// Arguments of `skiagraph presets`.
#[derive(Args, Debug)]
pub struct PresetsArgs {
    /// Format of the list.
    #[arg(long, value_enum, default_value_t = PresetsFormat::Text)]
    pub format: PresetsFormat,
}

/// Formats of the list of presets.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum PresetsFormat {
    /// Text with the params of each preset.
    Text,
    /// The Markdown table of docs/presets.md.
    Markdown,
}

/// Arguments of `skiagraph graph`.
#[derive(Args, Debug)]
pub struct GraphArgs {
    /// The method to plan.
    #[command(flatten)]
    pub method: MethodArgs,
    /// Format of the drawing. Without it: that of the ending of --out, else svg.
    #[arg(long, value_enum, value_name = "FORMAT")]
    pub format: Option<DrawingFormat>,
    /// File to write. Without it: standard output.
    #[arg(long, value_name = "FILE")]
    pub out: Option<PathBuf>,
    /// Outputs to plan for, separated by commas; passes that only others need are culled. Without
    /// it: all.
    #[arg(long, value_name = "NAME,…", value_delimiter = ',')]
    pub outputs: Vec<String>,
}

/// Formats of the drawing of a graph.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum DrawingFormat {
    /// A chart of lifetimes, for a browser.
    Svg,
    /// Nodes and links, for Graphviz.
    Dot,
    /// The plan as data, for scripts.
    Json,
    /// The largest textures and buffers, those that share memory in one line, and for each of the
    /// others the reason why it shares none.
    Memory,
}

/// Arguments of `skiagraph view`.
#[derive(Args, Debug)]
pub struct ViewArgs {
    /// One or two presets by name, or graphs (.ron), each perhaps with params of its own.
    #[arg(value_name = "PRESET|FILE.ron[@NAME=VALUE,…]", num_args = 0..=2, default_value = "nsm")]
    pub methods: Vec<String>,
    /// The scene and the place that it is seen from.
    #[command(flatten)]
    pub scene: SceneArgs,
    /// Viewport of the methods in pixels; the window scales their pictures.
    #[arg(long, value_name = "WxH", default_value = "512x512")]
    pub size: Size,
    /// Width of the square shadow map in texels: the param `map_size`.
    #[arg(long, value_name = "N", value_parser = texels(), allow_negative_numbers = true)]
    pub map_size: Option<u32>,
    /// A param of the graphs that have it. May be repeated.
    #[arg(
        long = "set",
        visible_alias = "image",
        value_name = "NAME=VALUE",
        allow_hyphen_values = true
    )]
    pub params: Vec<Assignment>,
}
