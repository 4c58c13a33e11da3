//! Answers and reference as arrays.

use crate::support::{keep, park_comparison};
use exr::prelude::{FlatSamples, ReadChannels, ReadLayers};
use skiagraph_compare::measuring::resume::Kept;
use skiagraph_compare::pictures::data::DataFormat;
use std::{fs, path::Path};

const SIDE: usize = 24;

/// The bytes of an array of the viewport's size and of this type.
fn npy(file: &Path, kind: &str) -> Vec<u8> {
    let bytes = fs::read(file).unwrap();
    let begin = 10 + usize::from(u16::from_le_bytes([bytes[8], bytes[9]]));
    let header = std::str::from_utf8(&bytes[10..begin]).unwrap();
    let expected = format!("'descr': '{kind}', 'fortran_order': False, 'shape': ({SIDE}, {SIDE})");
    assert!(header.contains(&expected), "{header}");
    bytes[begin..].to_vec()
}

fn shares(bytes: &[u8]) -> Vec<f32> {
    let each = bytes.as_chunks::<4>().0.iter();
    each.map(|bytes| f32::from_le_bytes(*bytes)).collect()
}

/// Counts in the arrays are those of the results.
#[test]
fn the_arrays_of_a_run_hold_its_counts() {
    let folder = tempfile::tempdir().unwrap();
    let out = folder.path().join("out");
    let mut comparison = park_comparison(&["nsm"], folder.path(), SIDE as u32);
    comparison.protocol.data = Some(DataFormat::Npy);
    comparison.protocol.pictures = true;
    let (_, results) = keep(&comparison, &out, Kept::Others).unwrap();
    let run = &results["runs"][0];
    let array_path = |name: &str| out.join(format!("{name}.npy"));
    let (own, reference) = (
        format!("nsm-bench_side-{SIDE}x{SIDE}-map128"),
        format!("reference-bench_side-{SIDE}x{SIDE}"),
    );
    let visibility = shares(&npy(&array_path(&format!("{own}-visibility")), "<f4"));
    let status = npy(&array_path(&format!("{own}-status")), "|u1");
    let truth = shares(&npy(&array_path(&format!("{reference}-visibility")), "<f4"));
    let truth_status = npy(&array_path(&format!("{reference}-status")), "|u1");
    let band = npy(&array_path(&format!("{reference}-indeterminate")), "|b1");
    let count = |is: &dyn Fn(usize) -> bool| (0..SIDE * SIDE).filter(|at| is(*at)).count() as u64;
    let faces = |at: usize| truth_status[at] >= 2;
    assert_eq!(run["pixels"]["facing_light"], count(&faces));
    assert_eq!(
        run["pixels"]["lit"],
        count(&|at| faces(at) && truth[at] == 1.0)
    );
    assert_eq!(run["band"], count(&|at| band[at] == 1));
    let is_wrong = |at: usize| faces(at) && visibility[at] != truth[at];
    assert_eq!(run["wrong"]["total"], count(&is_wrong));
    assert_eq!(
        run["certain"]["shadow"],
        count(&|at| faces(at) && status[at] == 3)
    );
    // Row by row from the top, as in the picture.
    let picture = image::open(out.join(format!("{own}-visibility.png"))).unwrap();
    let is_white: Vec<bool> = picture.to_rgb8().pixels().map(|it| it.0[0] > 127).collect();
    let differs = |at: usize| faces(at) && is_white[at] != (visibility[at] == 1.0);
    assert_eq!(count(&differs), 0);
    let flipped = |at: usize| (SIDE - 1 - at / SIDE) * SIDE + at % SIDE;
    assert_ne!(
        count(&|at| faces(at) && is_white[flipped(at)] != (visibility[at] == 1.0)),
        0
    );
}

#[test]
fn pictures_of_openexr_hold_the_same_values() {
    let folder = tempfile::tempdir().unwrap();
    let written = |format: DataFormat| {
        let out = folder.path().join(format.extension());
        let mut comparison = park_comparison(&["pcf"], folder.path(), SIDE as u32);
        comparison.protocol.data = Some(format);
        let (_, results) = keep(&comparison, &out, Kept::Others).unwrap();
        assert!(results["runs"][0].get("images").is_none(), "no pictures");
        let name = format!("pcf-bench_side-{SIDE}x{SIDE}-map128-visibility");
        out.join(format!("{name}.{}", format.extension()))
    };
    let layers = exr::prelude::read()
        .no_deep_data()
        .largest_resolution_level();
    let picture = layers.all_channels().first_valid_layer().all_attributes();
    let picture = picture.from_file(written(DataFormat::Exr)).unwrap();
    let [channel] = &picture.layer_data.channel_data.list[..] else {
        panic!("one channel")
    };
    let array = shares(&npy(&written(DataFormat::Npy), "<f4"));
    assert!(
        array.iter().any(|share| *share > 0.0 && *share < 1.0),
        "shades"
    );
    assert_eq!(channel.sample_data, FlatSamples::F32(array));
}
