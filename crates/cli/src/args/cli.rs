//! The program, its commands and their examples. Exit codes: 0 fine, 1 wrong input, 2 wrong usage,
//! 3 no usable GPU, or it was lost or hangs, 4 a condition of `--fail-if` does not hold, 5 worse
//! than `--baseline`, 130 stopped by Ctrl-C.

use crate::args::commands::{
    ChartArgs, CheckArgs, CompareArgs, CompletionsArgs, DoctorArgs, GraphArgs, JudgeArgs,
    MergeArgs, NewArgs, PresetsArgs, ProfileArgs, ReportArgs, RunArgs, SchemaArgs, ShowArgs,
    StressArgs, TruthArgs, ViewArgs,
};
use crate::args::shared::GpuArgs;
use clap::{Parser, Subcommand};

/// Runs, times and judges shadow methods that are written as RON graphs and WGSL shaders.
#[derive(Debug, Parser)]
#[command(
    name = "skiagraph",
    version,
    propagate_version = true,
    after_help = "Example:\n  skiagraph compare rt nsm --scene park --size 512x512\n\n\
        Progress goes to standard error: a bar on a terminal, a line every five seconds in a \
        pipe, or with SKIAGRAPH_PROGRESS=lines one at the begin and the end of each step.\n\n\
        Compiled shaders are kept for the next start in the user's cache folder, or in the \
        folder of SKIAGRAPH_SHADER_CACHE; an empty one keeps none.\n\n\
        Exit codes: 0 fine, 1 the input is wrong, 2 wrong usage, 3 no usable GPU, \
        or it was lost or hangs, 4 a condition of --fail-if does not hold, 5 worse than \
        --baseline, 130 stopped by Ctrl-C."
)]
pub struct Cli {
    /// Command to run.
    #[command(subcommand)]
    pub command: Command,
    /// GPU on which the command runs, with limits on memory and time.
    #[command(flatten)]
    pub gpu: GpuArgs,
}

/// Commands of the program, each with its arguments.
#[derive(Debug, Subcommand)]
pub enum Command {
    /// Render a scene with several shadow methods: GPU time per pass and wrong pixels, side by
    /// side.
    #[command(after_help = "Examples:\n  skiagraph compare\n  \
        skiagraph compare rt nsm --scene park --view all --size 512x512,1024x1024 \
            --map-size 1024,2048\n  \
        skiagraph compare nsm --scene house.obj --eye 0,2,8 --look 0,0,-1 --light 0.3,-1,-0.2\n  \
        skiagraph compare rt my_method.ron --oracle offset:0.03 --format markdown\n  \
        skiagraph compare --view all --map-size 512,1024,2048 --out park --resume   \
            # after Ctrl-C: only what is missing\n  \
        skiagraph compare nsm --baseline before/results.json\n  \
        skiagraph compare --all --view all --plan cells.jsonl\n  \
        skiagraph compare --cells cells.jsonl --shard 3/10 --out measured   \
            # docs/many_machines.md")]
    Compare(CompareArgs),
    /// Draw a chart of results of compare: time against error with its Pareto front, growth with
    /// the number of triangles, or errors along camera paths. Needs no GPU.
    #[command(after_help = "Examples:\n  \
        skiagraph compare --scene park --map-size 512,1024,2048 --frames 11 --out park\n  \
        skiagraph chart park --out front.svg\n  \
        skiagraph chart sponza park --size 1024x1024 --out fronts.svg\n  \
        skiagraph chart city-1e4 city-1e5 city-1e6 --kind growth --out growth.svg")]
    Chart(ChartArgs),
    /// Write one HTML page of the results of compare and stress in some folders: verdict, charts,
    /// table, pictures. Needs no GPU, and the page no network.
    #[command(after_help = "Examples:\n  skiagraph report compare\n  \
        skiagraph report desk/park laptop/park --out park.html   \
            # two machines in one page\n\n\
        `compare` writes the page into its folder by itself.")]
    Report(ReportArgs),
    /// Join the results of several folders and machines to one results.json, results.csv and page.
    /// Needs no GPU.
    #[command(
        after_help = "Example:\n  skiagraph merge desk/park laptop/park.json --out all\n\n\
        Of a cell that was measured twice on one machine the newer run counts. Other machines, \
            adapters, scenes and protocols\nare kept apart. Results that --out holds already stay. \
            Pictures stay where they are; the page shows them."
    )]
    Merge(MergeArgs),
    /// Render one frame with one graph and save any of its materials (textures and buffers). Those
    /// whose size depends on the frame's content get room for all of it: frames that are rendered
    /// before, and counted in the output, find out how much that is.
    #[command(
        after_help = "Examples:\n  skiagraph run nsm --save visibility=shadow.png\n  \
        skiagraph run nsm --save shadow_map@create_shadow_map.draw[0]=map.png --map-size 512\n  \
        skiagraph run my_method.ron --scene sponza --save status=status.bin\n  \
        skiagraph run my_method.ron --poison"
    )]
    Run(RunArgs),
    /// Time every pass of a graph over many frames, and list the memory of its textures and
    /// buffers; of several graphs, views or sizes, print a table of passes and sizes per graph.
    #[command(
        after_help = "Examples:\n  skiagraph profile nsm --scene park --frames 100\n  \
        skiagraph profile nsm --json before.json\n  \
        skiagraph profile nsm --set map_size=512 --baseline before.json\n  \
        skiagraph profile nsm crsm --view all --size 512x512,1024x1024 --csv all.csv\n  \
        skiagraph profile my_method.ron --csv passes.csv --trace frames.json   \
            # open frames.json in ui.perfetto.dev\n\n\
        docs/profiling.md says how to read the tables and the trace."
    )]
    Profile(ProfileArgs),
    /// Run every method on a catalogue of hard scenes, count the pixels that it gets wrong, and
    /// fail if it breaks the guarantee of its document.
    #[command(
        after_help = "Examples:\n  skiagraph stress\n  skiagraph stress --list\n  \
        skiagraph stress rt crsm --case box_on_floor --save pictures\n  \
        skiagraph stress crsm --set cull=none --map-size 32,128,512 --out stress\n  \
        skiagraph stress my_method.ron --exact my_method.ron\n\n\
        A cell counts pixels outside the band, wrongly lit + wrongly in shadow. Methods \
            that are called exact must show 0, and no\n\
        band may be above its case's cap; else the exit code is 1. What casts \
            shadows by its back faces alone (param `cull`) is\n\
        judged on open casters with cull=none."
    )]
    Stress(StressArgs),
    /// Judge pictures that another renderer made of a known scene and camera as methods are judged:
    /// wrong pixels, soft errors, distance from edges.
    #[command(
        after_help = "Examples:\n  skiagraph judge factor.exr --scene park --view bench_side\n  \
        skiagraph judge shadowed.exr --unshadowed unshadowed.exr --depth depth.exr --out judged\n\n\
        docs/judge.md says how to bring an engine's picture."
    )]
    Judge(JudgeArgs),
    /// Write the truth of a view as arrays, for other programs that judge: shares of light, ids,
    /// depths, blockers, and the camera's matrices in the conventions of engines.
    #[command(after_help = "Example:\n  \
        skiagraph truth --scene park --view bench_side --size 640x480 --out truth")]
    Truth(TruthArgs),
    /// Check graphs and their shaders. Needs no GPU: needs beyond WebGPU's default limits and
    /// features are warnings. With --adapter or --backend the graphs must run on that GPU, and
    /// needs that it does not meet are errors.
    #[command(
        after_help = "Examples:\n  skiagraph check my_method.ron pipelines/*.ron\n  \
        skiagraph check my_method.ron --adapter llvmpipe\n  \
        skiagraph check my_method.ron --format json\n  \
        skiagraph check my_method.ron --watch   \
            # beside an editor: again after each change\n\n\
        The JSON is {\"schema\": 1, \"files\": [{\"file\", \"passes\", \"diagnostics\": \
            [{\"code\", \"severity\", \"message\", \"labels\",\n\
        \"help\"}]}]}; `passes` is null where there are errors. A label is {\"file\", \"line\", \
            \"column\", \"end_line\", \"end_column\",\n\
        \"text\"}, counted from 1 in lines and characters; the end is the first place behind. The \
            first label is the mistake's own\n\
        place. Exit codes are those of --format text."
    )]
    Check(CheckArgs),
    /// Draw a graph: passes in order, materials with their lifetimes, dependences, and culled
    /// passes with the reasons. Needs no GPU.
    #[command(after_help = "Examples:\n  skiagraph graph nsm --out nsm.svg\n  \
        skiagraph graph my_method.ron --outputs visibility --size 1920x1080 --out my_method.svg\n  \
        skiagraph graph rt --format dot | dot -Tpng -o rt.png\n  \
        skiagraph graph rt --format json")]
    Graph(GraphArgs),
    /// List the presets, those in ./pipelines and the built-in ones, and their params.
    #[command(after_help = "Examples:\n  skiagraph presets\n  \
        skiagraph presets --format markdown")]
    Presets(PresetsArgs),
    /// Write a small working method to start from into the current folder: a document and a
    /// shader, or a variant of a preset. Overwrites nothing.
    #[command(after_help = "Examples:\n  skiagraph new my_method\n  \
        skiagraph new my_crsm --from crsm")]
    New(NewArgs),
    /// Print a graph document, shader or scene file, of the working directory or built in; behind a
    /// document the materials that its passes read and write.
    #[command(after_help = "Examples:\n  skiagraph show nsm\n  \
        skiagraph show shared/light.wgsl\n  skiagraph show crsma_full --flat\n  \
        skiagraph show lamps")]
    Show(ShowArgs),
    /// Print the format of graph documents or scene files: a JSON Schema for editors and programs
    /// that write them, or the reference of the language.
    #[command(
        after_help = "Examples:\n  skiagraph schema > skiagraph.schema.json\n  \
        skiagraph schema --format markdown\n  skiagraph schema scenes\n\n\
        In the schema `Kind(field: value)` is {\"Kind\": {\"field\": value}}, a bare word is a \
        text, a tuple is a list."
    )]
    Schema(SchemaArgs),
    /// Print a script that completes commands and options in a shell.
    #[command(after_help = "Examples:\n  \
        skiagraph completions bash > ~/.local/share/bash-completion/completions/skiagraph\n  \
        skiagraph completions fish > ~/.config/fish/completions/skiagraph.fish")]
    Completions(CompletionsArgs),
    /// List the scenes and their views.
    #[command(after_help = "Example:\n  skiagraph scenes")]
    Scenes,
    /// Show the GPUs with their limits and features, and the folders that are searched for meshes.
    #[command(after_help = "Example:\n  skiagraph doctor --adapter llvmpipe")]
    Doctor(DoctorArgs),
    /// Show methods in a window: fly through the scene, turn the light, move params, look at any
    /// material, see where a method is wrong. Changed files are read again while it runs.
    #[command(after_help = "Examples:\n  skiagraph view\n  \
        skiagraph view my_method.ron rt --scene sponza\n  \
        skiagraph view crsm@n=1 --scene my_model.glb --size 1024x1024\n\n\
        docs/view.md says what there is to see and to press.")]
    View(ViewArgs),
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::args::values::LightArgument;
    use clap::CommandFactory;
    use glam::DVec3;
    use skiagraph_compare::{graphs::argument::Assignment, size::Size};
    use skiagraph_reference::OracleMode;

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

    /// An argument group flattened into a command brings its flags, and not its own description.
    #[test]
    fn each_command_is_described_by_itself() {
        let program = Cli::command();
        let about = |command: &clap::Command| {
            let about = command.get_about().map(ToString::to_string);
            about.unwrap_or_else(|| panic!("{} says nothing", command.get_name()))
        };
        let mut abouts: Vec<String> = program.get_subcommands().map(about).collect();
        abouts.push(about(&program));
        for shared in ["The GPU,", "The scene to draw,"] {
            assert!(
                !abouts.iter().any(|about| about.starts_with(shared)),
                "{abouts:?}"
            );
        }
        let count = abouts.len();
        abouts.sort();
        abouts.dedup();
        assert_eq!(abouts.len(), count, "two commands say the same: {abouts:?}");
    }

    #[test]
    fn lists_and_negative_vectors_are_read() {
        let cli = parse(
            "skiagraph compare rt a.ron --size 8x4,16x9 --map-size 512,1024 --eye -1,2,-3 --light \
             -0.5,-1,0 --set bias=-2",
        )
        .unwrap();
        let Command::Compare(args) = cli.command else {
            panic!("not compare")
        };
        assert_eq!(args.presets, ["rt", "a.ron"]);
        assert_eq!(args.timing.size, [Size([8, 4]), Size([16, 9])]);
        assert_eq!(args.timing.sweep.map_size, [512, 1024]);
        assert_eq!(args.scene.eye, Some(DVec3::new(-1.0, 2.0, -3.0)));
        let light = LightArgument::Direction(DVec3::new(-0.5, -1.0, 0.0));
        assert_eq!(args.scene.light, Some(light));
        assert_eq!(
            args.timing.sweep.params,
            [Assignment {
                name: "bias".into(),
                value: "-2".into()
            }]
        );
        assert_eq!(
            (
                args.timing.frames,
                args.timing.warmup,
                args.reference.oracle
            ),
            (10, 2, OracleMode::Exact)
        );
    }

    #[test]
    fn shared_options_have_the_defaults_of_their_command() {
        let Command::Profile(args) = parse("skiagraph profile rt").unwrap().command else {
            panic!("not profile")
        };
        assert_eq!((args.timing.frames, args.timing.warmup), (30, 3));
        let Command::Stress(args) = parse("skiagraph stress").unwrap().command else {
            panic!("not stress")
        };
        assert_eq!(args.sweep.map_size, [128]);
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
}
