//! The command line as clap reads it. Exit codes: 0 fine, 1 the input is wrong, 2 usage, 3 no usable GPU, or it was lost or hangs.

use crate::parse::{self, Assignment, Beside, Save, Size};
use clap::{Args, Parser, Subcommand, ValueEnum};
use glam::DVec3;
use skiagraph_reference::OracleMode;
use std::path::PathBuf;

/// Runs, times and judges shadow methods that are written as RON graphs and WGSL shaders.
#[derive(Debug, Parser)]
#[command(
    name = "skiagraph",
    version,
    propagate_version = true,
    after_help = "Example:\n  skiagraph compare rt nsm --scene park --size 512x512\n\n\
        Exit codes: 0 fine, 1 the input is wrong, 2 wrong usage, 3 no usable GPU, or it was lost or hangs, 130 stopped by Ctrl-C."
)]
pub struct Cli {
    /// What to do.
    #[command(subcommand)]
    pub command: Command,
    /// Where it is done.
    #[command(flatten)]
    pub gpu: GpuArgs,
}

/// The GPU, and how much of it and of our time a graph may take.
#[derive(Args, Clone, Debug)]
#[command(next_help_heading = "GPU")]
pub struct GpuArgs {
    /// GPU to use: part of its name, in any case. Without it: $WGPU_ADAPTER_NAME, else the best one found.
    #[arg(long, global = true, value_name = "NAME")]
    pub adapter: Option<String>,
    /// Memory for the textures and buffers of a graph: 512MiB, 2GiB, or bytes. A graph that needs more is refused with a table of
    /// what takes the most. Without it: on a software adapter what the machine has free, else what the driver gives.
    #[arg(long, global = true, value_name = "SIZE", value_parser = parse::bytes)]
    pub memory_limit: Option<u64>,
    /// Give a frame up that takes longer than this, and with it the device: its shader may never end. 0 waits for ever.
    #[arg(long, global = true, value_name = "SECONDS", default_value_t = 300, value_parser = clap::value_parser!(u64).range(..=MOST_SECONDS))]
    pub timeout: u64,
}

/// A day: far above any frame, and far below what a clock can add.
const MOST_SECONDS: u64 = 86_400;

/// The samples of all frames are kept for the percentiles, and nobody waits for more.
const MOST_FRAMES: i64 = 100_000;

/// The commands.
#[derive(Debug, Subcommand)]
pub enum Command {
    /// Render a scene with several shadow methods: GPU time per pass and wrong pixels, side by side.
    #[command(after_help = "Examples:\n  skiagraph compare\n  \
        skiagraph compare rt nsm --scene park --view all --size 512x512,1024x1024 --map-size 1024,2048\n  \
        skiagraph compare nsm --scene house.obj --eye 0,2,8 --look 0,0,-1 --light 0.3,-1,-0.2\n  \
        skiagraph compare rt my_method.ron --oracle offset:0.03 --format markdown\n  \
        skiagraph compare --view all --map-size 512,1024,2048 --out park --resume   # after Ctrl-C: only what is missing")]
    Compare(CompareArgs),
    /// Render one frame with one graph and save any of its materials.
    #[command(
        after_help = "Examples:\n  skiagraph run nsm --save visibility=shadow.png\n  \
        skiagraph run nsm --save shadow_map@create_shadow_map=map.png --set map_size=512\n  \
        skiagraph run my_method.ron --scene sponza --save status=status.bin\n  \
        skiagraph run my_method.ron --poison"
    )]
    Run(RunArgs),
    /// Time every pass of one graph over many frames, and list what its materials take.
    #[command(
        after_help = "Examples:\n  skiagraph profile nsm --scene park --frames 100\n  \
        skiagraph profile nsm --json before.json\n  \
        skiagraph profile nsm --set map_size=512 --baseline before.json\n  \
        skiagraph profile my_method.ron --csv passes.csv --trace frames.json   # open frames.json in ui.perfetto.dev\n\n\
        docs/profiling.md says how to read the tables and the trace."
    )]
    Profile(ProfileArgs),
    /// Run the hard cases with every method: which pixels does each get wrong, and are the exact ones wrong nowhere?
    #[command(
        after_help = "Examples:\n  skiagraph stress\n  skiagraph stress --list\n  \
        skiagraph stress rt crsm --case box_on_floor --save pictures\n  \
        skiagraph stress crsm --set cull=none --map-size 32,128,512 --out stress\n  \
        skiagraph stress my_method.ron --exact my_method.ron\n\n\
        A cell counts pixels outside the band, wrongly lit + wrongly in shadow. Methods that are called exact must show 0, and no\n\
        band may be above its case's cap; else the exit code is 1. What casts shadows by its back faces alone (param `cull`) is\n\
        judged on open casters with cull=none."
    )]
    Stress(StressArgs),
    /// Check graphs and their shaders. Needs no GPU.
    #[command(
        after_help = "Examples:\n  skiagraph check my_method.ron pipelines/*.ron\n  \
        skiagraph check my_method.ron --format json\n\n\
        The JSON is {\"schema\": 1, \"files\": [{\"file\", \"passes\", \"diagnostics\": [{\"code\", \"severity\", \"message\", \"labels\",\n\
        \"help\"}]}]}; `passes` is null where there are errors. A label is {\"file\", \"line\", \"column\", \"end_line\", \"end_column\",\n\
        \"text\"}, counted from 1 in lines and characters; the end is the first place behind. The first label is the mistake's own\n\
        place. Exit codes are those of --format text."
    )]
    Check(CheckArgs),
    /// Draw a graph: passes in order, materials and their lifetimes, what depends on what, what is culled and why. Needs no GPU.
    #[command(after_help = "Examples:\n  skiagraph graph nsm --out nsm.svg\n  \
        skiagraph graph my_method.ron --outputs visibility --size 1920x1080 --out my_method.svg\n  \
        skiagraph graph rt --format dot | dot -Tpng -o rt.png\n  \
        skiagraph graph rt --format json")]
    Graph(GraphArgs),
    /// List the built-in shadow methods and their params.
    #[command(
        after_help = "Examples:\n  skiagraph presets\n  skiagraph presets --show nsm\n  \
        skiagraph presets --show shared/light.wgsl"
    )]
    Presets(PresetsArgs),
    /// List the scenes and their views.
    #[command(after_help = "Example:\n  skiagraph scenes")]
    Scenes,
    /// Show the GPUs, what they can do, and where meshes are searched.
    #[command(after_help = "Example:\n  skiagraph doctor --adapter llvmpipe")]
    Doctor,
}

/// What is drawn, and from where.
#[derive(Args, Clone, Debug)]
#[command(next_help_heading = "Scene")]
pub struct SceneArgs {
    /// Built-in scene, scene file (.ron), name in scenes/, or a mesh (.obj) with --eye, --look and --light.
    #[arg(long, default_value = "park", value_name = "SCENE")]
    pub scene: String,
    /// A view of the scene, or `all`. Without it: the scene's first view.
    #[arg(long, value_name = "NAME")]
    pub view: Option<String>,
    /// Eye position, for an .obj.
    #[arg(long, value_name = "X,Y,Z", value_parser = parse::vector, allow_hyphen_values = true)]
    pub eye: Option<DVec3>,
    /// Direction in which the eye looks, for an .obj.
    #[arg(long, value_name = "X,Y,Z", value_parser = parse::direction, allow_hyphen_values = true)]
    pub look: Option<DVec3>,
    /// Direction in which the light travels, for an .obj.
    #[arg(long, value_name = "X,Y,Z", value_parser = parse::direction, allow_hyphen_values = true)]
    pub light: Option<DVec3>,
    /// Up direction, for an .obj. Without it: 0,1,0.
    #[arg(long, value_name = "X,Y,Z", value_parser = parse::direction, allow_hyphen_values = true)]
    pub up: Option<DVec3>,
    /// Vertical field of view in degrees, for an .obj. Without it: 60.
    #[arg(long, value_name = "DEGREES", value_parser = parse::degrees)]
    pub fov: Option<f64>,
    /// Near plane distance, for an .obj. Without it: a ten-thousandth of --far.
    #[arg(long, value_name = "LENGTH", value_parser = parse::positive)]
    pub near: Option<f64>,
    /// Far plane distance, for an .obj. Without it: just behind the whole mesh.
    #[arg(long, value_name = "LENGTH", value_parser = parse::positive)]
    pub far: Option<f64>,
}

/// `skiagraph compare`.
#[derive(Args, Debug)]
pub struct CompareArgs {
    /// Presets by name, or graphs (.ron) with the outputs `visibility` and `status`. Without any: all presets.
    #[arg(value_name = "PRESET|FILE.ron")]
    pub presets: Vec<String>,
    /// What is drawn.
    #[command(flatten)]
    pub scene: SceneArgs,
    /// Viewport sizes in pixels, separated by commas.
    #[arg(
        long,
        value_name = "WxH,…",
        value_delimiter = ',',
        default_value = "1024x1024"
    )]
    pub size: Vec<Size>,
    /// Shadow map sizes in texels, separated by commas: the param `map_size` of the graphs that have it.
    #[arg(long, value_name = "N,…", value_delimiter = ',', value_parser = clap::value_parser!(u32).range(1..), allow_negative_numbers = true)]
    pub map_size: Vec<u32>,
    /// A param of the graphs that have it. May be repeated.
    #[arg(long = "set", value_name = "NAME=VALUE", allow_hyphen_values = true)]
    pub params: Vec<Assignment>,
    /// Timed frames per run. The frame that is judged and pictured is one more behind them, as its readback would be timed, too.
    #[arg(long, default_value_t = 10, value_name = "N", value_parser = clap::value_parser!(u32).range(1..=MOST_FRAMES), allow_negative_numbers = true)]
    pub frames: u32,
    /// Frames before the timed ones.
    #[arg(long, default_value_t = 2, value_name = "N", value_parser = clap::value_parser!(u32).range(..=MOST_FRAMES), allow_negative_numbers = true)]
    pub warmup: u32,
    /// Timed frames in which only the camera moves, so that passes may be skipped: as many as --frames, 0 for none.
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(..=MOST_FRAMES), allow_negative_numbers = true)]
    pub cached_frames: Option<u32>,
    /// What is right: `exact` (own primitive excluded, no offset) or `offset:LENGTH` (ray origin moved towards the light).
    #[arg(long, default_value = "exact", value_name = "MODE")]
    pub oracle: OracleMode,
    /// Folder for results.json, results.csv and the pictures.
    #[arg(long, default_value = "compare", value_name = "DIR")]
    pub out: PathBuf,
    /// Keep the runs in DIR/results.json whose graph, shaders, params, scene and view are still the same, and go on with the others.
    #[arg(long)]
    pub resume: bool,
    /// Published figures to stand beside ours in results.json and in --format markdown, there as (LABEL VALUE): a CSV with the columns
    /// scene, view, viewport, map_size, preset, quantity, value, source, note. May be repeated.
    #[arg(long, value_name = "LABEL:FILE.csv")]
    pub beside: Vec<Beside>,
    /// Which pictures are written.
    #[arg(long, value_enum, default_value_t = Images::All)]
    pub images: Images,
    /// What is printed on standard output.
    #[arg(long, value_enum, default_value_t = Format::Table)]
    pub format: Format,
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
    /// For a document: the command, the conditions, and a table per view and viewport with the times of steps.
    Markdown,
    /// The contents of results.json.
    Json,
}

/// One graph, its viewport and its params.
#[derive(Args, Debug)]
pub struct MethodArgs {
    /// Preset by name, or a graph (.ron).
    #[arg(value_name = "PRESET|FILE.ron")]
    pub preset: String,
    /// Viewport size in pixels.
    #[arg(long, value_name = "WxH", default_value = "1024x1024")]
    pub size: Size,
    /// Shadow map size in texels: the param `map_size`.
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..), allow_negative_numbers = true)]
    pub map_size: Option<u32>,
    /// A param of the graph. May be repeated.
    #[arg(long = "set", value_name = "NAME=VALUE", allow_hyphen_values = true)]
    pub params: Vec<Assignment>,
}

/// `skiagraph presets`.
#[derive(Args, Debug)]
pub struct PresetsArgs {
    /// Print a built-in file instead: a preset, or a document or shader by its path below pipelines/ or shaders/.
    #[arg(long, value_name = "NAME|PATH")]
    pub show: Option<String>,
}

/// `skiagraph run`.
#[derive(Args, Debug)]
pub struct RunArgs {
    /// What is run.
    #[command(flatten)]
    pub method: MethodArgs,
    /// What it is run on.
    #[command(flatten)]
    pub scene: SceneArgs,
    /// Save an output, a material or a view of one, after a pass or at the end: .png a picture, .bin raw bytes, .csv the words of
    /// a buffer. May be repeated.
    #[arg(long, value_name = "MATERIAL[@PASS]=FILE")]
    pub save: Vec<Save>,
    /// Fill all memory that a frame has not written with two patterns, one after the other, and fail if an output differs: the graph
    /// then reads what no pass has written.
    #[arg(long)]
    pub poison: bool,
}

/// `skiagraph profile`.
#[derive(Args, Debug)]
pub struct ProfileArgs {
    /// What is timed.
    #[command(flatten)]
    pub method: MethodArgs,
    /// What it is run on.
    #[command(flatten)]
    pub scene: SceneArgs,
    /// Timed frames.
    #[arg(long, default_value_t = 30, value_name = "N", value_parser = clap::value_parser!(u32).range(1..=MOST_FRAMES), allow_negative_numbers = true)]
    pub frames: u32,
    /// Frames before the timed ones.
    #[arg(long, default_value_t = 3, value_name = "N", value_parser = clap::value_parser!(u32).range(..=MOST_FRAMES), allow_negative_numbers = true)]
    pub warmup: u32,
    /// Write a line per pass and one for the frame.
    #[arg(long, value_name = "FILE")]
    pub csv: Option<PathBuf>,
    /// Write every timed frame in the Trace Event Format, for ui.perfetto.dev or chrome://tracing.
    #[arg(long, value_name = "FILE")]
    pub trace: Option<PathBuf>,
    /// Write everything, samples included: what --baseline reads.
    #[arg(long, value_name = "FILE")]
    pub json: Option<PathBuf>,
    /// Compare with what an earlier --json wrote.
    #[arg(long, value_name = "OLD.json")]
    pub baseline: Option<PathBuf>,
}

/// `skiagraph stress`.
#[derive(Args, Debug)]
pub struct StressArgs {
    /// Presets by name, or graphs (.ron) with the outputs `visibility` and `status`. Without any: all presets.
    #[arg(value_name = "PRESET|FILE.ron")]
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
    /// Shadow map sizes in texels, separated by commas: the param `map_size` of the graphs that have it.
    #[arg(long, value_name = "N,…", value_delimiter = ',', default_value = "128", value_parser = clap::value_parser!(u32).range(1..), allow_negative_numbers = true)]
    pub map_size: Vec<u32>,
    /// A param of the graphs that have it. May be repeated.
    #[arg(long = "set", value_name = "NAME=VALUE", allow_hyphen_values = true)]
    pub params: Vec<Assignment>,
    /// Judge this method as an exact one, too: no pixel outside the band may be wrong. May be repeated.
    #[arg(long, value_name = "PRESET|FILE.ron")]
    pub exact: Vec<String>,
    /// Folder for the pictures of every cell: shaded, visibility, error, uncertain.
    #[arg(long, value_name = "DIR")]
    pub save: Option<PathBuf>,
    /// Folder for stress.json, written anew after every case.
    #[arg(long, value_name = "DIR")]
    pub out: Option<PathBuf>,
    /// What is printed on standard output.
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
}

/// How diagnostics are printed.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum CheckFormat {
    /// For people: source lines with the mistakes underlined, on standard error.
    Text,
    /// For programs: one JSON object on standard output.
    Json,
}

/// `skiagraph graph`.
#[derive(Args, Debug)]
pub struct GraphArgs {
    /// What is planned.
    #[command(flatten)]
    pub method: MethodArgs,
    /// What is drawn. Without it: what the ending of --out names, else svg.
    #[arg(long, value_enum, value_name = "FORMAT")]
    pub format: Option<Drawn>,
    /// File to write. Without it: standard output.
    #[arg(long, value_name = "FILE")]
    pub out: Option<PathBuf>,
    /// Outputs that are wanted, separated by commas; what only others need is culled. Without it: all.
    #[arg(long, value_name = "NAME,…", value_delimiter = ',')]
    pub outputs: Vec<String>,
}

/// How a graph is drawn.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum Drawn {
    /// A chart of lifetimes, for a browser.
    Svg,
    /// Nodes and links, for Graphviz.
    Dot,
    /// The plan as data, for scripts.
    Json,
}

#[cfg(test)]
mod tests {
    use super::*;
    use clap::CommandFactory;

    fn parse(line: &str) -> Result<Cli, clap::Error> {
        Cli::try_parse_from(line.split_whitespace())
    }

    #[test]
    fn clap_finds_no_fault_in_the_definitions() {
        Cli::command().debug_assert();
    }

    #[test]
    fn every_command_shows_an_example() {
        for command in Cli::command().get_subcommands() {
            let help = command
                .get_after_help()
                .map(ToString::to_string)
                .unwrap_or_default();
            assert!(
                help.contains(&format!("skiagraph {}", command.get_name())),
                "{}",
                command.get_name()
            );
        }
    }

    #[test]
    fn lists_and_negative_vectors_are_read() {
        let cli = parse(
            "skiagraph compare rt a.ron --size 8x4,16x9 --map-size 512,1024 --eye -1,2,-3 --light -0.5,-1,0 --set bias=-2",
        )
        .unwrap();
        let Command::Compare(args) = cli.command else {
            panic!("not compare")
        };
        assert_eq!(args.presets, ["rt", "a.ron"]);
        assert_eq!(args.size, [Size([8, 4]), Size([16, 9])]);
        assert_eq!(args.map_size, [512, 1024]);
        assert_eq!(args.scene.eye, Some(DVec3::new(-1.0, 2.0, -3.0)));
        assert_eq!(args.scene.light, Some(DVec3::new(-0.5, -1.0, 0.0)));
        assert_eq!(
            args.params,
            [Assignment {
                name: "bias".into(),
                value: "-2".into()
            }]
        );
        assert_eq!(
            (args.frames, args.warmup, args.oracle),
            (10, 2, OracleMode::Exact)
        );
    }

    #[test]
    fn the_adapter_may_stand_on_either_side_of_the_command() {
        for line in [
            "skiagraph --adapter x doctor",
            "skiagraph doctor --adapter x",
        ] {
            assert_eq!(parse(line).unwrap().gpu.adapter.as_deref(), Some("x"));
        }
    }

    #[test]
    fn a_number_out_of_range_is_told_its_range() {
        for (line, range) in [
            ("skiagraph compare --map-size 512,-5", "-5 is not in 1.."),
            ("skiagraph run nsm --map-size -5", "-5 is not in 1.."),
            ("skiagraph compare --warmup -1", "-1 is not in 0..=100000"),
            (
                "skiagraph compare --frames 100001",
                "100001 is not in 1..=100000",
            ),
        ] {
            let message = parse(line).unwrap_err().to_string();
            assert!(message.contains(range), "{line}: {message}");
        }
    }

    #[test]
    fn usage_errors_have_exit_code_2() {
        for line in [
            "skiagraph",
            "skiagraph check",
            "skiagraph compare --size 10",
            "skiagraph compare --frames 0",
            "skiagraph compare --frames 100001",
            "skiagraph compare --warmup 4294967295 --frames 1",
            "skiagraph run",
            "skiagraph run rt --save visibility=a.gif",
            "skiagraph compare --look 0,0,0",
            "skiagraph compare --oracle offset:-1",
            "skiagraph compare --oracle embree",
            "skiagraph profile",
            "skiagraph profile rt nsm",
            "skiagraph profile nsm --frames 0",
            "skiagraph check a.ron --format yaml",
            "skiagraph doctor --memory-limit lots",
            "skiagraph doctor --timeout -1",
            "skiagraph doctor --timeout 86401",
        ] {
            assert_eq!(parse(line).unwrap_err().exit_code(), 2, "{line}");
        }
    }
}
