//! Pictures of other renderers: methods' own, judged back as foreign ones, and pictures with
//! mistakes.

use crate::support::{NOWHERE, comparison, gpu, park, scene};
use image::{GrayImage, ImageBuffer, ImageFormat, Luma, RgbImage, Rgba, RgbaImage};
use skiagraph_compare::{
    foreign::{
        judging::{Judging, Surfaces, judge},
        raster,
        truth::{TruthRequest, write_truth},
    },
    graphs::preset::SHIPPED,
    measuring::{device::GpuRequest, resume::Kept, series::Series},
    pictures::data::{Array, DataFormat, Values},
    records::{
        judged_pictures::JudgedPictures,
        results::{Answer, Measured},
    },
    sink::{Session, Silent},
};
use skiagraph_gpu::block_on;
use skiagraph_reference::{WrongCounts, flip::linear};
use skiagraph_scene::Scene;
use std::{fs, path::PathBuf, sync::Arc};
use tempfile::TempDir;

const SIZE: [u32; 2] = [80, 64];

/// Rays per pixel to a light with an extent.
const SAMPLES: u32 = 16;

/// A method's measurements, and the shares that it shows.
struct Shown {
    name: String,
    measured: Measured,
    shares: Vec<f32>,
}

/// Methods on the first view of a scene, with maps of this side.
fn shown(scene: &Arc<Scene>, methods: &[&str], map: u32) -> Vec<Shown> {
    let folder = tempfile::tempdir().unwrap();
    let mut compared = comparison(scene.clone(), methods, NOWHERE.as_ref(), &[map]);
    compared.viewports = vec![SIZE];
    compared.protocol.reference_samples = SAMPLES;
    compared.protocol.data = Some(DataFormat::Npy);
    let session = Session::new(gpu(), &Silent);
    let kept = Some((folder.path(), Kept::Nothing));
    let mut series = block_on(Series::new(&compared, session, kept)).unwrap();
    block_on(series.measure(0, 0)).unwrap();
    let files: Vec<PathBuf> = fs::read_dir(folder.path())
        .unwrap()
        .map(|file| file.unwrap().path())
        .collect();
    let runs = series.results.runs.iter().map(|run| {
        let is_own = |file: &&PathBuf| {
            let name = file.file_name().unwrap().to_str().unwrap();
            let preset = run.preset.split('@').next().unwrap();
            name.starts_with(&format!("{preset}-")) && name.ends_with("-visibility.npy")
        };
        let values = raster::read(files.iter().find(is_own).unwrap())
            .unwrap()
            .values;
        Shown {
            name: run.preset.clone(),
            measured: run.measured.clone().unwrap(),
            shares: values.iter().map(|value| *value as f32).collect(),
        }
    });
    runs.collect()
}

/// Writes shares in the format of the name: PNG of 8 bits, NPY or EXR.
fn write(folder: &TempDir, name: &str, shares: &[f32]) -> PathBuf {
    let file = folder.path().join(name);
    match file
        .extension()
        .unwrap()
        .to_str()
        .unwrap()
        .parse::<DataFormat>()
    {
        Ok(format) => {
            let array = Array::of_pixels(SIZE, Values::F32(shares.to_vec()));
            fs::write(&file, array.encode(format).unwrap()).unwrap();
        }
        Err(_) => {
            let bytes = shares.iter().map(|share| (share * 255.0).round() as u8);
            let grey = GrayImage::from_raw(SIZE[0], SIZE[1], bytes.collect()).unwrap();
            grey.save_with_format(&file, ImageFormat::Png).unwrap();
        }
    }
    file
}

fn judging(pictures: Vec<PathBuf>) -> Judging {
    Judging {
        pictures,
        reference_samples: SAMPLES,
        ..Judging::default()
    }
}

/// Judges pictures of the first view of a scene.
fn judged(scene: &Arc<Scene>, judging: &Judging) -> Result<JudgedPictures, String> {
    let (scene, view) = ((**scene).clone(), scene.views[0].clone());
    let judged = block_on(judge(
        judging,
        scene,
        &view,
        &GpuRequest::default(),
        &Silent,
    ));
    judged
        .map(|judged| judged.record)
        .map_err(|error| error.to_string())
}

/// Holds the figures of pictures against the methods' own measurements.
fn check_judged_back(scene: &Arc<Scene>, methods: &[Shown]) {
    let folder = tempfile::tempdir().unwrap();
    for extension in ["png", "npy", "exr"] {
        let file = |own: &Shown| write(&folder, &format!("{}.{extension}", own.name), &own.shares);
        let files = methods.iter().map(file).collect();
        let record = judged(scene, &judging(files)).unwrap();
        for (picture, own) in record.pictures.iter().zip(methods) {
            let (name, measured) = (format!("{}.{extension}", own.name), &own.measured);
            assert_eq!(picture.warnings, Vec::<String>::new(), "{name}");
            let outside = |total: u64, in_band: u64| total - in_band;
            let wrong = outside(picture.wrong.total, picture.wrong.in_band);
            let is_hard = picture.answer == Answer::Hard;
            if is_hard || extension != "png" {
                assert_eq!(wrong, measured.wrong_outside_band(), "{name}");
                assert_eq!(picture.graded.rmse, measured.graded.rmse, "{name}");
                assert_eq!(picture.graded.off, measured.graded.off, "{name}");
                assert_eq!(picture.graded.flip, measured.graded.flip, "{name}");
            }
            let off = (picture.graded.rmse - measured.graded.rmse).abs();
            assert!(off <= 1.0 / 255.0, "{name}: {off}");
            assert!(picture.wrong_unattributable <= wrong, "{name}");
            assert_eq!(
                picture.wrong_attributable(),
                wrong - picture.wrong_unattributable
            );
        }
        assert!(record.unattributable > 0, "silhouettes");
    }
}

#[test]
fn the_default_presets_are_judged_back_to_the_pixel() {
    let scene = park();
    let methods = shown(&scene, &SHIPPED, 512);
    assert_eq!(methods.len(), SHIPPED.len());
    let graded = methods
        .iter()
        .filter(|method| method.measured.answer == Answer::Graded);
    assert!(graded.count() >= 2, "pcf and vsm");
    check_judged_back(&scene, &methods);
}

#[test]
fn soft_shadows_are_judged_back() {
    let scene = scene("park_soft");
    let methods = shown(&scene, &["rt_area", "hybrid_pcf_area"], 512);
    check_judged_back(&scene, &methods);
}

/// The truth of a view that is written is the truth that pictures are held against; with its ids
/// nothing is open, with its depths hardly anything.
#[test]
fn what_is_written_as_truth_judges_pictures() {
    let scene = park();
    let nsm = shown(&scene, &["nsm"], 512).remove(0);
    let folder = tempfile::tempdir().unwrap();
    let file = write(&folder, "nsm.exr", &nsm.shares);
    let open = judged(&scene, &judging(vec![file.clone()])).unwrap();
    for format in [DataFormat::Npy, DataFormat::Exr] {
        let out = folder.path().join(format.extension());
        let request = TruthRequest {
            format,
            ..TruthRequest::new(SIZE)
        };
        let (view, gpu) = (scene.views[0].clone(), GpuRequest::default());
        let lines = block_on(write_truth(
            &request,
            (*scene).clone(),
            &view,
            &out,
            &gpu,
            &Silent,
        ))
        .unwrap();
        let read = |name: &str| {
            let file = format!("{name}.{}", format.extension());
            assert!(
                lines.iter().any(|line| line.starts_with(&file)),
                "{lines:?}"
            );
            raster::read(&out.join(file)).unwrap()
        };
        let count = |name: &str, wanted: f64| {
            let values = read(name).values;
            values.into_iter().filter(|value| *value == wanted).count() as u64
        };
        assert_eq!(count("status", 2.0), open.pixels.lit);
        assert_eq!(count("status", 3.0), open.pixels.shadow);
        assert_eq!(count("visibility", 1.0), open.pixels.lit);
        assert_eq!(count("unattributable", 1.0), open.unattributable);
        // Pixels in shadow have a blocker, and no others.
        let (status, blockers) = (read("status").values, read("blockers").values);
        let is_blocked = blockers
            .iter()
            .map(|blocker| *blocker != f64::from(u32::MAX));
        let pairs = is_blocked.zip(&status);
        assert!(
            pairs
                .clone()
                .all(|(blocked, status)| blocked == (*status == 3.0))
        );
        // A picture that is the truth has nothing wrong.
        let truth = out.join(format!("visibility.{}", format.extension()));
        let ids = out.join(format!("ids.{}", format.extension()));
        let by_ids = Judging {
            surfaces: Surfaces::Ids(ids),
            ..judging(vec![truth, file.clone()])
        };
        let by_ids = judged(&scene, &by_ids).unwrap();
        assert_eq!((by_ids.unattributable, &*by_ids.surfaces), (0, "ids"));
        assert_eq!(by_ids.pictures[0].wrong.total, 0);
        assert_eq!(by_ids.pictures[0].rank, Some(1));
        let (one, other) = (by_ids.pictures[1].wrong, open.pictures[0].wrong);
        let counts = |wrong: WrongCounts| [wrong.lit, wrong.shadow, wrong.total, wrong.in_band];
        assert_eq!(counts(one), counts(other));
        let by_depth = Judging {
            surfaces: Surfaces::Depth(out.join(format!("depth.{}", format.extension()))),
            ..judging(vec![file.clone()])
        };
        let by_depth = judged(&scene, &by_depth).unwrap();
        assert!(
            by_depth.unattributable < open.unattributable,
            "{}",
            by_depth.unattributable
        );
        // But for pixels whose rasterised triangle only touches the pixel.
        let differ = by_depth.pixels.lit.abs_diff(open.pixels.lit)
            + by_depth.pixels.shadow.abs_diff(open.pixels.shadow);
        assert!(differ <= 4, "{differ}");
        let camera = fs::read_to_string(out.join("camera.json")).unwrap();
        let camera: serde_json::Value = serde_json::from_str(&camera).unwrap();
        assert_eq!(camera["viewport"], serde_json::json!(SIZE));
        assert_eq!(camera["projections"].as_array().unwrap().len(), 16);
    }
}

#[test]
fn ids_of_another_camera_are_told() {
    let scene = park();
    let folder = tempfile::tempdir().unwrap();
    let (view, gpu, out) = (scene.views[0].clone(), GpuRequest::default(), folder.path());
    let request = TruthRequest {
        format: DataFormat::Npy,
        ..TruthRequest::new(SIZE)
    };
    block_on(write_truth(
        &request,
        (*scene).clone(),
        &view,
        out,
        &gpu,
        &Silent,
    ))
    .unwrap();
    // Upside down.
    let ids = raster::read(&out.join("ids.npy")).unwrap();
    let rows = ids.values.chunks_exact(SIZE[0] as usize).rev().flatten();
    let turned: Vec<u32> = rows.map(|id| *id as u32).collect();
    let array = Array::of_pixels(SIZE, Values::U32(turned));
    let turned = folder.path().join("turned.npy");
    fs::write(&turned, array.encode(DataFormat::Npy).unwrap()).unwrap();
    let outcome = judged(
        &scene,
        &Judging {
            surfaces: Surfaces::Ids(turned),
            ..judging(vec![out.join("visibility.npy")])
        },
    );
    let error = outcome.unwrap_err();
    assert!(
        error.contains("a surface that the camera does not see there"),
        "{error}"
    );
}

/// Judges what is made of the shares of a method, and returns the warnings.
fn warned(scene: &Arc<Scene>, name: &str, shares: &[f32]) -> String {
    let folder = tempfile::tempdir().unwrap();
    let file = write(&folder, name, shares);
    let record = judged(scene, &judging(vec![file])).unwrap();
    record.pictures[0].warnings.join("\n")
}

#[test]
fn a_picture_that_is_read_wrongly_is_told_with_the_way_out() {
    let scene = park();
    let rt = shown(&scene, &["rt"], 64).remove(0);
    let soft = crate::support::scene("park_soft");
    let rt_area = shown(&soft, &["rt_area"], 64).remove(0);
    let width = SIZE[0] as usize;
    let flipped: Vec<f32> = rt
        .shares
        .chunks_exact(width)
        .rev()
        .flatten()
        .copied()
        .collect();
    let mirrored = rt.shares.chunks_exact(width);
    let mirrored: Vec<f32> = mirrored.flat_map(|row| row.iter().rev().copied()).collect();
    let inverted: Vec<f32> = rt.shares.iter().map(|share| 1.0 - share).collect();
    let encoded = |share: &f32| {
        // The share whose linear value this is.
        let (mut low, mut high) = (0.0, 1.0);
        for _ in 0..40 {
            let middle = (low + high) * 0.5;
            if linear(middle) < f64::from(*share) {
                low = middle
            } else {
                high = middle
            }
        }
        high as f32
    };
    let encoded: Vec<f32> = rt_area.shares.iter().map(encoded).collect();
    let dim: Vec<f32> = rt.shares.iter().map(|share| 0.3 + 0.7 * share).collect();
    let bytes: Vec<f32> = rt.shares.iter().map(|share| share * 255.0).collect();
    for (name, shares, expected) in [
        ("flipped.png", &flipped, "--read-as flipped"),
        ("mirrored.exr", &mirrored, "left for right"),
        ("inverted.npy", &inverted, "--read-as inverted"),
        ("ambient.exr", &dim, "ambient light"),
        ("bytes.npy", &bytes, "its numbers reach 255"),
    ] {
        let warnings = warned(&scene, name, shares);
        assert!(warnings.contains(expected), "{name}: {warnings}");
    }
    let warnings = warned(&soft, "encoded.png", &encoded);
    assert!(warnings.contains("--read-as srgb"), "{warnings}");
    assert_eq!(warned(&soft, "linear.png", &rt_area.shares), "");
    assert_eq!(warned(&scene, "rt.png", &rt.shares), "");
    // The way out is one.
    let folder = tempfile::tempdir().unwrap();
    let right = Judging {
        reading: "flipped".parse().unwrap(),
        ..judging(vec![write(&folder, "flipped.png", &flipped)])
    };
    let record = judged(&scene, &right).unwrap();
    assert_eq!(record.pictures[0].warnings, Vec::<String>::new());
    let wrong = record.pictures[0].wrong;
    assert_eq!(
        wrong.total - wrong.in_band,
        rt.measured.wrong_outside_band()
    );
}

#[test]
fn bits_alpha_quotients_and_numbers_that_are_none() {
    let scene = park();
    let rt = shown(&scene, &["rt"], 64).remove(0);
    let folder = tempfile::tempdir().unwrap();
    let at = |name: &str| folder.path().join(name);
    let [width, height] = SIZE;
    let pixel = |x: u32, y: u32| rt.shares[(x + y * width) as usize];
    let bits = ImageBuffer::from_fn(width, height, |x, y| {
        Luma([(pixel(x, y) * 65_535.0).round() as u16])
    });
    bits.save(at("bits.png")).unwrap();
    let alpha = RgbaImage::from_fn(width, height, |x, y| {
        let grey = (pixel(x, y) * 255.0) as u8;
        Rgba([grey, grey, grey, if x + y == 7 { 128 } else { 255 }])
    });
    alpha.save(at("alpha.png")).unwrap();
    let mut none = rt.shares.clone();
    let lit = none.iter_mut().filter(|share| **share == 1.0);
    lit.take(5).for_each(|share| *share = f32::NAN);
    let none = write(&folder, "none.exr", &none);
    let record = judged(
        &scene,
        &judging(vec![at("bits.png"), at("alpha.png"), none]),
    )
    .unwrap();
    let [bits, alpha, none] = &record.pictures[..] else {
        panic!("three pictures")
    };
    assert_eq!(
        (&*bits.format, &*alpha.format),
        ("PNG, 16 bits, grey", "PNG, 8 bits, grey")
    );
    assert_eq!(bits.wrong, alpha.wrong);
    let outside = bits.wrong.total - bits.wrong.in_band;
    assert_eq!(outside, rt.measured.wrong_outside_band());
    assert!(bits.warnings.is_empty(), "{:?}", bits.warnings);
    let warning = &alpha.warnings[0];
    assert!(
        warning.contains("alpha is not read, and 8 pixels are not opaque"),
        "{warning}"
    );
    assert_eq!((none.graded.invalid.nan, none.answer), (5, Answer::Graded));
    assert!(none.wrong.shadow >= 5, "{:?}", none.wrong);
    // Half of the surfaces are darker, and one pixel that is lit is black.
    let mut colour: Vec<f32> = (0..rt.shares.len())
        .map(|at| 0.25 + (at % 2) as f32 / 4.0)
        .collect();
    let lit = (0..colour.len())
        .rev()
        .find(|at| rt.shares[*at] == 1.0)
        .unwrap();
    colour[lit] = 0.0;
    let shaded: Vec<f32> = rt
        .shares
        .iter()
        .zip(&colour)
        .map(|(one, colour)| one * colour)
        .collect();
    let quotient = Judging {
        unshadowed: Some(write(&folder, "whole.exr", &colour)),
        ..judging(vec![write(&folder, "shaded.exr", &shaded)])
    };
    let record = judged(&scene, &quotient).unwrap();
    let picture = &record.pictures[0];
    assert_eq!(picture.wrong.shadow, bits.wrong.shadow + 1);
    let warning = &picture.warnings[0];
    assert!(
        warning.contains("1 pixel facing the light, black in the picture"),
        "{warning}"
    );
}

#[test]
fn a_picture_of_another_camera_is_told_and_has_no_rank() {
    let mut scene = (*park()).clone();
    let rt = shown(&Arc::new(scene.clone()), &["rt"], 64).remove(0);
    let folder = tempfile::tempdir().unwrap();
    let file = write(&folder, "rt.png", &rt.shares);
    let own = judged(&Arc::new(scene.clone()), &judging(vec![file.clone()])).unwrap();
    scene.views.rotate_left(1);
    let right = scene.views.last().unwrap().name.clone();
    let other = judged(&Arc::new(scene), &judging(vec![file])).unwrap();
    assert_eq!(own.pictures[0].warnings, Vec::<String>::new());
    let warning = &other.pictures[0].warnings[0];
    assert!(
        warning.contains("it hardly agrees with the truth"),
        "{warning}"
    );
    assert!(
        warning.contains("--view") && warning.contains("skiagraph truth"),
        "{warning}"
    );
    assert_eq!(other.pictures[0].rank, None);
    let hint = &other.pictures[0].warnings[1];
    assert!(hint.contains(&format!("--view {right}")), "{hint}");
}

/// Numbers that are none are told and not judged, and what is right stays right.
#[test]
fn pixels_without_a_number_are_told_and_the_rest_is_judged() {
    let scene = park();
    let [rt, nsm] = <[Shown; 2]>::try_from(shown(&scene, &["rt", "nsm"], 256))
        .ok()
        .unwrap();
    let folder = tempfile::tempdir().unwrap();
    let every = |step: usize, with: f32, shares: &[f32]| -> Vec<f32> {
        let shares = shares.iter().enumerate();
        shares
            .map(|(at, share)| if at % step == 3 { with } else { *share })
            .collect()
    };
    let count = rt.shares.len();
    for (name, with, counted) in [
        ("nan", f32::NAN, true),
        ("inf", f32::INFINITY, true),
        ("negative", -1.0, false),
    ] {
        let files = [("rt", &rt.shares), ("nsm", &nsm.shares)];
        let files = files.map(|(method, shares)| {
            let few = every(120, with, shares);
            write(&folder, &format!("{name}-{method}.exr"), &few)
        });
        let record = judged(&scene, &judging(files.to_vec())).unwrap();
        let own = [&rt, &nsm].map(|shown| shown.measured.wrong_outside_band());
        for (picture, own) in record.pictures.iter().zip(own) {
            let invalid = picture.graded.invalid;
            assert!(
                invalid.total() > 10 && invalid.total() < count as u64 / 100,
                "{name}"
            );
            assert_eq!(picture.without_answer > 0, counted, "{name}");
            assert!(picture.without_answer <= invalid.total());
            if counted {
                assert!(picture.wrong_attributable() <= own, "{name}");
            }
            assert_eq!(picture.rank.is_some(), record.is_attributable(), "{name}");
            assert!(
                picture.warnings.is_empty(),
                "{name}: {:?}",
                picture.warnings
            );
        }
        assert!(
            !counted || record.pictures[0].wrong_attributable() == 0,
            "{name}"
        );
    }
    for (name, step, expected) in [
        ("some", 5, "a finite number at only"),
        ("all", 1, "finite number at"),
    ] {
        // One number, or the file would have none.
        let mut shares = match step {
            1 => vec![f32::NAN; count],
            _ => rt
                .shares
                .iter()
                .enumerate()
                .map(|(at, share)| if at % step == 0 { f32::NAN } else { *share })
                .collect(),
        };
        shares[0] = 1.0;
        let file = write(&folder, &format!("{name}.exr"), &shares);
        let record = judged(&scene, &judging(vec![file])).unwrap();
        let picture = &record.pictures[0];
        let warnings = picture.warnings.join("\n");
        assert!(warnings.contains(expected), "{name}: {warnings}");
        assert!(
            !warnings.contains("another") && !warnings.contains("--view"),
            "{name}: {warnings}"
        );
        assert_eq!(picture.rank, None, "{name}");
    }
    // One number everywhere is no picture of another view, however light that is.
    for (name, share) in [("light", 1.0), ("dark", 0.0), ("grey", 0.7)] {
        let warnings = warned(&scene, &format!("{name}.exr"), &vec![share; count]);
        assert!(
            !warnings.contains("agrees with another view"),
            "{name}: {warnings}"
        );
    }
}

/// Acne is named, and is no other camera; with depths or ids the camera is right however bad the
/// shadows are.
#[test]
fn bad_shadows_of_the_right_camera_have_a_rank_and_acne_is_named() {
    let scene = park();
    let folder = tempfile::tempdir().unwrap();
    let (view, gpu) = (scene.views[0].clone(), GpuRequest::default());
    let request = TruthRequest::new(SIZE);
    block_on(write_truth(
        &request,
        (*scene).clone(),
        &view,
        folder.path(),
        &gpu,
        &Silent,
    ))
    .unwrap();
    let acne = shown(&scene, &["nsm@cull=none,bias=0,slope_bias=0"], 512).remove(0);
    let striped = write(&folder, "acne.exr", &acne.shares);
    // Through a filter over the stripes.
    let width = SIZE[0] as usize;
    let mean = |at: usize| {
        let around = [0, 1, width, width + 1]
            .map(|step| acne.shares[(at + step).min(acne.shares.len() - 1)]);
        around.iter().sum::<f32>() / 4.0
    };
    let filtered: Vec<f32> = (0..acne.shares.len()).map(mean).collect();
    let filtered = write(&folder, "filtered.exr", &filtered);
    // Shadows of another light, and none that has to do with the scene.
    let odd: Vec<f32> = (0..acne.shares.len())
        .map(|at| ((at / 40 + at % width / 20) % 2) as f32)
        .collect();
    let odd = write(&folder, "odd.exr", &odd);
    let files = vec![odd, striped, filtered];
    for surfaces in [
        Surfaces::Ids(folder.path().join("ids.exr")),
        Surfaces::Depth(folder.path().join("depth.exr")),
        Surfaces::Rasterised,
    ] {
        let is_known = surfaces != Surfaces::Rasterised;
        let record = judged(
            &scene,
            &Judging {
                surfaces,
                ..judging(files.clone())
            },
        )
        .unwrap();
        let warnings = |index: usize| record.pictures[index].warnings.join("\n");
        for index in [1, 2] {
            assert!(
                warnings(index).contains("acne"),
                "{index}: {}",
                warnings(index)
            );
            assert!(
                !warnings(index).contains("--view"),
                "{index}: {}",
                warnings(index)
            );
        }
        let ranks: Vec<bool> = record
            .pictures
            .iter()
            .map(|picture| picture.rank.is_some())
            .collect();
        let is_open = !record.is_attributable();
        assert_eq!(
            ranks,
            [is_known && !is_open, !is_open, !is_open],
            "{}",
            warnings(0)
        );
        assert!(warnings(0).contains("hardly agrees"), "{}", warnings(0));
        assert_eq!(warnings(0).contains("--view"), !is_known, "{}", warnings(0));
    }
}

/// A filter that blurs the edges of shadows is no ambient light.
#[test]
fn a_wide_filter_is_not_taken_for_ambient_light() {
    let scene = park();
    let rt = shown(&scene, &["rt"], 64).remove(0);
    let [width, height] = SIZE.map(|side| side as i64);
    let blurred = |radius: i64| -> Vec<f32> {
        let share = |at: usize| {
            let (x, y) = (at as i64 % width, at as i64 / width);
            let rows = (y - radius).max(0)..=(y + radius).min(height - 1);
            let around = rows.flat_map(|y| {
                ((x - radius).max(0)..=(x + radius).min(width - 1))
                    .map(move |x| (y * width + x) as usize)
            });
            let around: Vec<f32> = around.map(|at| rt.shares[at]).collect();
            around.iter().sum::<f32>() / around.len() as f32
        };
        (0..rt.shares.len()).map(share).collect()
    };
    for radius in [1, 2, 3] {
        let warnings = warned(&scene, "blurred.exr", &blurred(radius));
        assert!(!warnings.contains("ambient"), "{radius}: {warnings}");
    }
    let lifted: Vec<f32> = blurred(1).iter().map(|share| 0.2 + 0.8 * share).collect();
    assert!(warned(&scene, "lifted.exr", &lifted).contains("ambient"));
}

#[test]
fn files_that_are_no_factor_of_this_size_are_told() {
    let folder = tempfile::tempdir().unwrap();
    let scene = park();
    let at = |name: &str| folder.path().join(name);
    let shares = vec![1.0; (SIZE[0] * SIZE[1]) as usize];
    let factor = write(&folder, "factor.exr", &shares);
    let colours = RgbImage::from_fn(8, 8, |x, _| image::Rgb([x as u8, 0, 9]));
    colours.save(at("colours.png")).unwrap();
    GrayImage::new(8, 8).save(at("small.png")).unwrap();
    fs::write(at("text.png"), "no picture").unwrap();
    fs::write(at("photo.jpg"), b"\xff\xd8\xff\xe0\0\x10JFIF\0").unwrap();
    let png = fs::read(at("small.png")).unwrap();
    fs::write(at("cut.png"), &png[..40]).unwrap();
    let mut exr = fs::read(&factor).unwrap();
    let window = exr.windows(10).position(|at| at == b"dataWindow").unwrap();
    exr[window + 10 + 1 + 5 + 1 + 4 + 8..][..4].copy_from_slice(&2_000_000_000i32.to_le_bytes());
    fs::write(at("absurd.exr"), &exr).unwrap();
    let error = |judging: Judging| judged(&scene, &judging).unwrap_err();
    for (name, expected) in [
        ("colours.png", "--unshadowed"),
        ("text.png", "its first bytes are not those of a picture"),
        ("photo.jpg", "it is a JPEG"),
        ("cut.png", "it cannot be decoded"),
        ("absurd.exr", "absurd.exr: "),
        ("missing.npy", "missing.npy: "),
    ] {
        let message = error(judging(vec![at(name)]));
        assert!(message.contains(expected), "{name}: {message}");
    }
    let both = error(judging(vec![factor.clone(), at("small.png")]));
    assert!(
        both.contains("has 80x64 pixels, and") && both.contains("has 8x8"),
        "{both}"
    );
    let unshadowed = error(Judging {
        unshadowed: Some(at("small.png")),
        ..judging(vec![factor.clone()])
    });
    assert!(
        unshadowed.contains("render both in one size"),
        "{unshadowed}"
    );
    let ids = error(Judging {
        surfaces: Surfaces::Ids(at("small.png")),
        ..judging(vec![factor])
    });
    assert!(ids.contains("render both in one size"), "{ids}");
}
