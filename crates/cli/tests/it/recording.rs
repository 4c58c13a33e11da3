//! `run --frames`: a numbered sequence of pictures. Needs an adapter.

use crate::support::skiagraph;
use std::{fs, path::Path};

fn run(folder: &Path, line: &str) -> String {
    let output = skiagraph(folder, line);
    let stderr = String::from_utf8_lossy(&output.stderr);
    assert!(output.status.success(), "{line}: {stderr}");
    String::from_utf8_lossy(&output.stdout).into_owned()
}

#[test]
fn a_path_is_saved_frame_by_frame() {
    let folder = tempfile::tempdir().unwrap();
    let file = |name: &str| fs::read(folder.path().join(name)).unwrap();
    let line = "run rt --size 48x32 --path walk --save visibility=v.bin --frames 3";
    let stdout = run(folder.path(), line);
    assert!(
        stdout.contains("saved visibility: v.0000.bin to v.0002.bin"),
        "{stdout}"
    );
    let frames = [0, 1, 2].map(|index| file(&format!("v.000{index}.bin")));
    assert!(frames[0] != frames[1] && frames[1] != frames[2]);
    assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 3);
    // Pictures, too; and all frames where no number is given.
    let line = "run rt --size 16x16 --path sunrise --save visibility=v.png";
    run(folder.path(), line);
    let pictures = fs::read_dir(folder.path()).unwrap();
    let names = pictures.map(|entry| entry.unwrap().file_name().into_string().unwrap());
    assert_eq!(names.filter(|name| name.ends_with(".png")).count(), 17);
    assert!(file("v.0016.png").starts_with(b"\x89PNG"));
}

#[test]
fn what_cannot_be_saved_as_a_sequence_is_refused_before_anything_runs() {
    let folder = tempfile::tempdir().unwrap();
    let refused = |line: &str, code: i32| {
        let output = skiagraph(folder.path(), line);
        assert_eq!(output.status.code(), Some(code), "{line}");
        String::from_utf8_lossy(&output.stderr).into_owned()
    };
    let long = refused("run rt --path walk --frames 26 --save visibility=v.png", 1);
    assert!(long.contains("the path `walk` has 25 frames"), "{long}");
    let unknown = refused("run rt --path wlak --save visibility=v.png", 1);
    assert!(unknown.contains("did you mean `walk`?"), "{unknown}");
    let several = refused("run rt --path all --save visibility=v.png", 2);
    assert!(several.contains("one path under one light"), "{several}");
    let nothing = refused("run rt --frames 3", 2);
    assert!(nothing.contains("--save"), "{nothing}");
    assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 0);
}

#[cfg(unix)]
#[test]
fn ctrl_c_keeps_the_whole_pictures_of_the_frames_before() {
    use std::{
        process::{Command, Stdio},
        time::{Duration, Instant},
    };
    let folder = tempfile::tempdir().unwrap();
    let line = "run rt --size 16x16 --frames 100000 --save visibility=v.bin";
    let child = Command::new(env!("CARGO_BIN_EXE_skiagraph"))
        .args(line.split_whitespace())
        .current_dir(folder.path())
        .stdout(Stdio::null())
        .stderr(Stdio::piped())
        .spawn()
        .unwrap();
    let began = Instant::now();
    while !folder.path().join("v.0002.bin").exists() {
        assert!(began.elapsed() < Duration::from_secs(120), "no frame");
        std::thread::sleep(Duration::from_millis(20));
    }
    let status = Command::new("kill")
        .args(["-INT", &child.id().to_string()])
        .status();
    assert!(status.unwrap().success());
    let output = child.wait_with_output().unwrap();
    let stderr = String::from_utf8_lossy(&output.stderr);
    assert_eq!(output.status.code(), Some(130), "{stderr}");
    assert!(stderr.contains("the pictures of"), "{stderr}");
    let entries = fs::read_dir(folder.path()).unwrap();
    let sizes = entries.map(|entry| entry.unwrap().metadata().unwrap().len());
    assert!(sizes.into_iter().all(|size| size == 16 * 16 * 4));
}

/// Values that shaders are told of a frame: number, time, and of this frame and the one before the
/// eye, the jitter and the light.
const TOLD: &str = r#"
    #import "shared/camera.wgsl"
    #import "shared/light.wgsl"
    #import "shared/frame.wgsl"
    var<uniform> camera_previous: Camera;
    var<uniform> light_previous: Light;
    struct Seen { eye: vec3<f32>, jitter_x: f32, to_light: vec3<f32>, jitter_y: f32 }
    struct Told { index: f32, seconds: f32, now: Seen, before: Seen }
    var<storage, read_write> told: array<Told>;
    @compute @workgroup_size(1) fn main() {
        let now = camera;
        let before = camera_previous;
        told[0] = Told(
            f32(frame.index),
            frame.seconds,
            Seen(now.eye, now.jitter.x, light.to_light, now.jitter.y),
            Seen(before.eye, before.jitter.x, light_previous.to_light, before.jitter.y),
        );
    }
"#;

#[test]
fn shaders_know_number_time_jitter_and_the_frame_before() {
    let folder = tempfile::tempdir().unwrap();
    let document = r#"(
        format: 3,
        materials: [Buffer(name: "told", count: 1)],
        passes: [Compute(name: "tell", dispatch: Groups(1, 1, 1), overwrites: ["told"])],
        outputs: ["told"],
    )"#;
    fs::write(folder.path().join("tell.ron"), document).unwrap();
    fs::write(folder.path().join("tell.wgsl"), TOLD).unwrap();
    let recorded = |flags: &str| -> Vec<Vec<f32>> {
        run(
            folder.path(),
            &format!("run tell.ron --size 16x16 --save told=t.bin {flags}"),
        );
        let frame = |index| {
            let bytes = fs::read(folder.path().join(format!("t.000{index}.bin"))).unwrap();
            let words = bytes.chunks_exact(4);
            words
                .map(|it| f32::from_le_bytes(it.try_into().unwrap()))
                .collect()
        };
        (0..5).map(frame).collect()
    };
    // Index and seconds, padding, and eight words each of this frame and of the one before.
    let (now, before) = (4..12, 12..20);
    for (flags, rate) in [("--path walk", 10.0), ("--path sunrise", 10.0), ("", 30.0)] {
        let frames = recorded(&format!("{flags} --frames 5 --jitter 3"));
        for (index, frame) in frames.iter().enumerate() {
            assert_eq!(frame[0], index as f32);
            assert!(
                (frame[1] - index as f32 / rate).abs() < 1e-6,
                "{flags}: {frame:?}"
            );
            let earlier = &frames[index.saturating_sub(1)];
            assert_eq!(
                frame[before.clone()],
                earlier[now.clone()],
                "{flags} {index}"
            );
        }
        let jitter = |index: usize| [frames[index][7], frames[index][11]];
        assert_eq!(jitter(0), [0.0, -0.16796875]);
        assert_eq!(jitter(1), [-0.25, 0.16796875]);
        assert_eq!(jitter(3), jitter(0));
        let moves = |words: std::ops::Range<usize>| frames[4][words.clone()] != frames[3][words];
        assert_eq!(moves(4..7), flags.contains("walk"));
        assert_eq!(moves(8..11), flags.contains("sunrise"));
    }
    let still = recorded("--frames 5");
    assert_eq!([still[1][7], still[1][11]], [0.0; 2]);
}
