//! The rows: the questions that an adapter is asked.
//!
//! ```
//! use skiagraph_compare::adapters::rows::rows;
//!
//! for row in rows(true) {
//!     println!("{}: skiagraph {} ({} s)", row.name, row.command.join(" "), row.seconds);
//! }
//! ```

use crate::records::abilities::Ability;

/// A question, and the command that answers it.
#[derive(Clone, Debug)]
pub struct Row {
    /// Name of the row, and of its folder.
    pub name: &'static str,
    /// The question, as a line of text.
    pub asks: &'static str,
    /// Longest time in seconds. It is generous, as a machine may have other work; the limits of all
    /// rows together exceed the default of
    /// [`AdapterRequest::limit`](crate::adapters::running::AdapterRequest::limit), which ends all
    /// rows.
    pub seconds: u64,
    /// Words of the command, without the program and without `--out`.
    pub command: Vec<String>,
    /// Ability without which the row is not run but recorded as
    /// [`Outcome::Lacking`](crate::records::adapter::Outcome::Lacking); `None` if it needs none.
    pub needs: Option<Ability>,
    /// Backends (vulkan, metal, dx12, gl) on which the row is not run either, as its methods are
    /// not known to be right there.
    pub unproven_on: &'static [&'static str],
    /// Groups of names of methods whose answers must be the same bits; the first of a group is
    /// compared with each other one.
    pub alike: &'static [&'static [&'static str]],
}

/// A row as the table below has it: the command of the full row, then that of the small one.
struct Line {
    name: &'static str,
    asks: &'static str,
    seconds: u64,
    full: &'static str,
    small: &'static str,
    needs: Option<Ability>,
    unproven_on: &'static [&'static str],
    alike: &'static [&'static [&'static str]],
}

const LINE: Line = Line {
    name: "",
    asks: "",
    seconds: 60,
    full: "",
    small: "",
    needs: None,
    unproven_on: &[],
    alike: &[],
};

/// Hard answers of one scene that are the same bits, whichever way they are found.
const HARD_ALIKE: &[&[&str]] = &[&["rt", "light_buffer", "light_buffer@stage=fragment"]];

const LINES: &[Line] = &[
    Line {
        name: "hard",
        asks: "is every method right on the hard cases, as guaranteed?",
        seconds: 150,
        full: "stress rt light_buffer light_buffer@stage=fragment crsm crsma_full nsm --size \
               128x128 --map-size 128",
        small: "stress rt light_buffer light_buffer@stage=fragment --size 32x32 --map-size 32 \
                --case grid_of_holes --case torus",
        ..LINE
    },
    Line {
        name: "hard_area",
        asks: "the same under lights with an extent",
        seconds: 60,
        full: "stress rt_area light_buffer_area --size 64x64 --map-size 64 --set samples=4",
        small: "stress rt_area light_buffer_area --size 24x24 --map-size 24 --set samples=4 \
                --case torus",
        unproven_on: &["gl"],
        ..LINE
    },
    Line {
        name: "hard_ray_query",
        asks: "the same by the driver's ray queries",
        seconds: 90,
        full: "stress rt rt_area --size 64x64 --map-size 64 --set engine=ray_query --set samples=4",
        small: "stress rt --size 32x32 --map-size 32 --set engine=ray_query --case torus",
        needs: Some(Ability::RayQuery),
        ..LINE
    },
    Line {
        name: "park",
        asks: "are three ways to hard shadows the same bits, in nine views of closed meshes?",
        seconds: 90,
        full: "compare rt light_buffer light_buffer@stage=fragment crsm crsma_full nsm --scene \
               park --view all --size 256x256 --map-size 512 --data npy --frames 3",
        small: "compare rt light_buffer light_buffer@stage=fragment nsm --scene park --size 48x48 \
                --map-size 64 --data npy --frames 1",
        alike: HARD_ALIKE,
        ..LINE
    },
    Line {
        name: "lamps",
        asks: "the same under a spot, a point and a directional light",
        seconds: 60,
        full: "compare rt light_buffer light_buffer@stage=fragment nsm --scene lamps --view all \
               --light all --size 256x256 --map-size 512 --data npy --frames 3",
        small: "compare rt light_buffer --scene lamps --light all --size 32x32 --data npy \
                --frames 1",
        alike: HARD_ALIKE,
        ..LINE
    },
    Line {
        name: "area",
        asks: "do lists and rays give the same shares of an extended light, to the bit?",
        seconds: 150,
        full: "compare rt_area light_buffer_area --scene park_soft --size 128x128,256x256 \
               --reference-samples 64 --data npy --frames 3",
        small: "compare rt_area light_buffer_area --scene park_soft --size 32x32 \
                --reference-samples 16 --set samples=4 --data npy --frames 1",
        unproven_on: &["gl"],
        alike: &[&["rt_area", "light_buffer_area"]],
        ..LINE
    },
    Line {
        name: "sizes",
        asks: "what does a frame cost by its size, and when are lists asked faster in fragments, \
               when in compute?",
        seconds: 240,
        full: "compare rt light_buffer light_buffer@stage=fragment nsm crsm --scene sponza --size \
               256x256,512x512,1024x1024,1920x1080 --map-size 1024 --frames 5",
        small: "compare rt light_buffer light_buffer@stage=fragment nsm --scene park --size \
                40x40,64x64 --map-size 64 --frames 2",
        ..LINE
    },
    Line {
        name: "sizes_ray_query",
        asks: "the same by ray queries",
        seconds: 90,
        full: "compare rt rt@engine=ray_query --scene sponza --size 256x256,1024x1024 --frames 5",
        small: "compare rt rt@engine=ray_query --scene park --size 40x40 --frames 1",
        needs: Some(Ability::RayQuery),
        ..LINE
    },
    Line {
        name: "city_10000",
        asks: "what does a frame cost by the number of triangles?",
        seconds: 60,
        full: "compare rt light_buffer light_buffer@stage=fragment nsm crsm --scene city:10000 \
               --view overview --size 1024x576 --map-size 1024 --frames 5",
        small: "compare rt light_buffer nsm --scene city:10000 --view overview --size 48x27 \
                --map-size 64 --frames 1",
        ..LINE
    },
    Line {
        name: "city_100000",
        asks: "the same, ten times as many",
        seconds: 60,
        full: "compare rt light_buffer light_buffer@stage=fragment nsm crsm --scene city:100000 \
               --view overview --size 1024x576 --map-size 1024 --frames 5",
        small: "",
        ..LINE
    },
    Line {
        name: "city_1000000",
        asks: "the same, a hundred times as many",
        seconds: 120,
        full: "compare rt light_buffer light_buffer@stage=fragment nsm crsm --scene city:1000000 \
               --view overview --size 1024x576 --map-size 1024 --frames 5",
        small: "",
        ..LINE
    },
];

/// Words behind each comparison: no pictures, only the time of whole frames, and what a killed
/// process has measured is kept.
const COMPARED: &str = "--warmup 1 --cached-frames 0 --images none --resume";

/// Returns the rows in the order in which they run. If `is_small` is true, they are fewer and
/// measure little, to try in short time that all works.
pub fn rows(is_small: bool) -> Vec<Row> {
    let row = |line: &Line| {
        let words = if is_small { line.small } else { line.full };
        let more = if words.starts_with("compare") {
            COMPARED
        } else {
            ""
        };
        let command: Vec<String> = words
            .split_whitespace()
            .chain(more.split_whitespace())
            .map(str::to_owned)
            .collect();
        Row {
            name: line.name,
            asks: line.asks,
            seconds: line.seconds,
            command,
            needs: line.needs,
            unproven_on: line.unproven_on,
            alike: line.alike,
        }
    };
    let all = LINES.iter().map(row);
    all.filter(|row| !row.command.is_empty()).collect()
}
