//! OBJ and scene files made to break us: each gives a located answer, or is rightly accepted, in
//! bounded time and memory.

use crate::bounds::bounded;
use skiagraph_located_ron::diagnostics::Diagnostic;
use skiagraph_scene::{
    Bvh, Concave, ImportReport, Limit, Mesh, MeshFile, MeshFileOptions, ObjOptions, SceneError,
    SceneFile, SceneLibrary, obj::parse_obj,
};
use std::path::Path;

#[track_caller]
fn parse(text: impl AsRef<[u8]>) -> Result<(Mesh, ImportReport), SceneError> {
    parse_with(text.as_ref(), &ObjOptions::default())
}

#[track_caller]
fn parse_with(text: &[u8], options: &ObjOptions) -> Result<(Mesh, ImportReport), SceneError> {
    let path = Path::new("house.obj");
    bounded(&String::from_utf8_lossy(text), || {
        parse_obj(text, path, options)
    })
}

#[track_caller]
fn parse_scene(text: &str) -> Result<SceneFile, SceneError> {
    bounded(text, || SceneFile::parse(text, "garden.ron"))
}

/// A line per mistake of a scene file.
#[track_caller]
fn told(text: &str) -> String {
    let lines: Vec<String> = match parse_scene(text) {
        Err(SceneError::SceneFile(diagnostics)) => {
            diagnostics.iter().map(Diagnostic::brief).collect()
        }
        other => panic!("{other:?}"),
    };
    lines.join("\n")
}

/// Asserts that the error begins with `place` and holds `part`.
#[track_caller]
fn assert_error(text: impl AsRef<[u8]>, place: &str, part: &str) {
    let error = parse(text).expect_err("it is wrong").to_string();
    assert!(
        error.starts_with(place) && error.contains(part),
        "no {place:?} with {part:?} in {}",
        error.chars().take(500).collect::<String>()
    );
    assert!(error.len() < 1000, "it says {} bytes", error.len());
}

const HOUSE: &str = "# a house\no house\nv 0 0 0\nv 1 0 0\nv 1 1 0 1.0\nv 0 1 0 0.5 0.5 0.5\nvn 0 \
    0 1\ng wall\nusemtl brick\n\
    f 1//1 2//1 3//1 4//1\nf 1/1/1 2/1/1 \\\n 4/1/-1\nl 1 2 3\np 1\n";

/// Cut off after any byte it is a smaller mesh, or the error names the file.
#[test]
fn cut_off_anywhere() {
    let faces = |end: usize| parse(&HOUSE[..end]).map(|(mesh, _)| mesh.triangles.len());
    assert_eq!(faces(HOUSE.len()).unwrap(), 3);
    for end in 0..HOUSE.len() {
        match faces(end) {
            Ok(count) => assert!((1..=3).contains(&count)),
            Err(error) => assert!(error.to_string().starts_with("house.obj:"), "{error}"),
        }
    }
}

#[test]
fn files_of_nothing() {
    for text in ["", " \n\t\r\n", "\u{feff}"] {
        assert_error(text, "house.obj: ", "no triangles: the file holds 0 faces");
    }
    assert_error("\0\0\0\0", "house.obj:1: ", "not an OBJ file");
    assert_error(b"\xff\xfev\0 \x000\0", "house.obj:1: ", "in \"v 0\"");
    assert_error("v 0 0\0 0\n", "house.obj:1: ", "parse error");
}

#[test]
fn indices_that_name_nothing() {
    let vertices = "v 0 0 0\nv 1 0 0\nv 0 1 0\n";
    for index in [
        "0",
        "4",
        "-4",
        "-0",
        "2147483648",
        "4294967297",
        "18446744073709551617",
        "-9223372036854775808",
    ] {
        let there = if index.starts_with('-') {
            "3 vertices stand above it"
        } else {
            "the file has 3 vertices"
        };
        let part = format!("(line 4) names vertex {index}, but {there}");
        assert_error(format!("{vertices}f 1 2 {index}\n"), "house.obj: ", &part);
    }
    // A million of them: the first are named, the rest counted.
    assert_error(
        format!("{vertices}{}", "f 1 2 9\n".repeat(1_000_000)),
        "house.obj: 1000000 faces",
        "and 999995 more",
    );
}

#[test]
fn vertices_that_are_no_numbers() {
    for value in ["nan", "inf", "-inf", "1e39", "1e400"] {
        let text = format!("v 0 0 0\nv {value} 0 0\nv 0 1 0\nf 1 2 3\n");
        assert_error(text, "house.obj: ", "(line 4) has its corner 2 at");
    }
    for value in ["0x10", "1,5", "--1", "1e", "", "∞"] {
        assert_error(
            format!("v 0 0 0\nv 0 0 {value}\n"),
            "house.obj:2: ",
            "position parse error",
        );
    }
}

#[test]
fn a_face_of_a_hundred_thousand_corners() {
    let vertices: String = (0..100_000)
        .map(|i| format!("v {i} {} 0\n", (i / 2) * (i % 2)))
        .collect();
    let corners: String = (1..=100_000).map(|i| format!(" {i}")).collect();
    let text = format!("{vertices}f{corners}\n");
    assert_error(&text, "house.obj: ", "more than 10,000 corners");
    let fanned = ObjOptions {
        concave: Concave::Fan,
        ..ObjOptions::default()
    };
    let (mesh, _) = parse_with(text.as_bytes(), &fanned).unwrap();
    assert_eq!(mesh.triangles.len(), 99_998);
    // As many corners at one point: nothing is left.
    assert_error(
        format!("v 0 0 0\nf{}\n", " 1".repeat(100_000)),
        "house.obj: ",
        "no triangles",
    );
}

/// Lines of ten million bytes, of each kind; the error shows the beginning.
#[test]
fn lines_of_ten_megabytes() {
    let long = |part: &str| part.repeat(10_000_000 / part.len());
    let square = "v 0 0 0\nv 1 0 0\nv 1 1 0\n";
    assert_error(
        format!("v{}\n", long(" x")),
        "house.obj:1: ",
        "position parse error",
    );
    assert_error(
        format!("f {}\n", long("1/")),
        "house.obj: ",
        "has the corner \"1/1/1/",
    );
    assert_error(
        format!("{square}f 1 2 {}\n", long("9")),
        "house.obj: ",
        "names vertex 9999",
    );
    assert_error(
        format!("g {}\nf 1 2 3\n", long("name")),
        "house.obj: ",
        "names vertex 1, but the file has 0 vertices",
    );
    for harmless in [
        long("#"),
        format!("usemtl {}", long("a")),
        format!("g {}", long("a ")),
        long(" "),
        long("\\\n"),
    ] {
        let (mesh, _) = parse(format!("{square}{harmless}\nf 1 2 3\n")).unwrap();
        assert_eq!(mesh.triangles.len(), 1);
    }
    let (mesh, _) = parse(format!("{square}f 1 2 {}3\n", long("\\\n"))).unwrap();
    assert_eq!(mesh.triangles.len(), 1);
}

/// Many groups, and as many names that are left out: time must not grow with their product.
#[test]
fn two_hundred_thousand_groups() {
    let groups: String = (0..200_000)
        .map(|i| format!("g group{i}\nf 1 2 3\n"))
        .collect();
    let options = ObjOptions {
        leave_out: (1..200_000).map(|i| format!("group{i}")).collect(),
        ..ObjOptions::default()
    };
    let text = format!("v 0 0 0\nv 1 0 0\nv 0 1 0\n{groups}");
    let (mesh, _) = parse_with(text.as_bytes(), &options).unwrap();
    assert_eq!(mesh.triangles.len(), 1);
}

/// The largest numbers that a model may have and the smallest that there are make a mesh with a
/// hierarchy.
#[test]
fn numbers_at_their_ends() {
    let text = "v 3e11 0 0\nv -3e11 3e11 0\nv 0 -3e11 3e11\nv 1e-45 0 0\nv 0 1e-45 0\nv 0 0 1e-45\n\
        f 1 2 3\nf 4 5 6\nf 1 5 6\n";
    let (mesh, _) = parse(text).unwrap();
    assert!(mesh.normals.iter().all(|normal| normal.is_normalized()));
    assert_eq!(Bvh::build(&mesh).primitives.len(), 3);
}

const SCENE: &str = r#"(
format: 1, name: "garden", mesh: Generated("park"),
light: (direction: (0, -1, 0)),
views: [(name: "a", eye: (0, 5, 0), direction: (0, 0, 1), fov_y_degrees: 60, near: 1, far: 100)],
)"#;

#[test]
fn views_that_make_no_camera() {
    for (from, to, part) in [
        (
            "fov_y_degrees: 60",
            "fov_y_degrees: 0",
            "fov_y_degrees is 0, expected more than 0 and less than 180",
        ),
        (
            "fov_y_degrees: 60",
            "fov_y_degrees: 180",
            "fov_y_degrees is 180",
        ),
        (
            "fov_y_degrees: 60",
            "fov_y_degrees: -60",
            "fov_y_degrees is -60",
        ),
        (
            "fov_y_degrees: 60",
            "fov_y_degrees: NaN",
            "fov_y_degrees is NaN",
        ),
        (
            "fov_y_degrees: 60",
            "fov_y_degrees: 1e-46",
            "its camera overflows 32-bit numbers",
        ),
        ("near: 1", "near: 100", "expected 0 < near < far"),
        ("near: 1", "near: 0", "expected 0 < near < far"),
        ("near: 1", "near: -1", "expected 0 < near < far"),
        ("near: 1", "near: NaN", "expected 0 < near < far"),
        ("far: 100", "far: inf", "expected 0 < near < far"),
        (
            "eye: (0, 5, 0)",
            "eye: (0, NaN, 0)",
            "the eye [0, NaN, 0] is not finite",
        ),
        (
            "eye: (0, 5, 0)",
            "eye: (0, 1e300, 0)",
            "its camera overflows 32-bit numbers",
        ),
        (
            "direction: (0, 0, 1)",
            "direction: (0, 0, 0)",
            "must be finite and longer than 0",
        ),
        (
            "direction: (0, 0, 1)",
            "direction: (0, inf, 0)",
            "must be finite and longer than 0",
        ),
        (
            "direction: (0, -1, 0)",
            "direction: (0, 0, 0)",
            "the light's direction",
        ),
        (
            "direction: (0, -1, 0)",
            "direction: (NaN, 0, 0)",
            "the light's direction",
        ),
    ] {
        assert!(SCENE.contains(from));
        let error = told(&SCENE.replace(from, to));
        let line = 4 - usize::from(from == "direction: (0, -1, 0)");
        assert!(
            error.starts_with(&format!("garden.ron:{line}:")) && error.contains(part),
            "{to}: {error}"
        );
    }
}

#[test]
fn scene_files_of_nothing_and_without_end() {
    for text in ["", " \n ", "\u{feff}", "\0", "(", &SCENE[..SCENE.len() - 1]] {
        assert!(
            told(text).starts_with("garden.ron:"),
            "{text:?}: {}",
            told(text)
        );
    }
    for bracket in ["(", "[", "{", "Some("] {
        let nested = SCENE.replace("\"garden\"", &bracket.repeat(10_000));
        assert!(told(&nested).starts_with("garden.ron:2:"), "{bracket}");
        let nested = SCENE.replace("format: 1", &format!("other: {}", bracket.repeat(10_000)));
        assert!(told(&nested).starts_with("garden.ron:2:"), "{bracket}");
    }
    // Time must not grow with the square of the views.
    let view = |i: usize| {
        format!(
            "(name: \"{i}\", eye: (0, 5, 0), direction: (0, 0, 1), fov_y_degrees: 60, near: 1, \
             far: 100),"
        )
    };
    let views: String = (0..20_000).map(view).collect();
    let many = SCENE.replace("views: [", &format!("views: [{views}"));
    assert_eq!(parse_scene(&many).unwrap().views.len(), 20_001);
    assert!(told(&many.replace("\"a\"", "\"7\"")).contains("two views are called \"7\""));
}

/// Returns the message about a scene file or a bare mesh on disk.
#[track_caller]
fn said_of_file(path: &Path) -> String {
    let argument = path.display().to_string();
    let load = || {
        if MeshFile::is_one(path) {
            MeshFile::load(path, &MeshFileOptions::default()).err()
        } else {
            SceneLibrary::default().load(&argument).err()
        }
    };
    bounded(&argument, load).unwrap().to_string()
}

#[test]
fn files_that_are_no_text_or_too_long() {
    let folder = tempfile::tempdir().unwrap();
    let file = |name: &str| folder.path().join(name);
    std::fs::write(file("binary.ron"), b"(name: \"\xc3\x28\")").unwrap();
    let sparse = |name: &str| {
        let huge = std::fs::File::create(file(name)).unwrap();
        huge.set_len(4 << 30).unwrap();
    };
    sparse("huge.ron");
    sparse("huge.obj");
    std::fs::create_dir(file("folder.obj")).unwrap();
    for (name, message) in [
        (
            "binary.ron",
            "it is not UTF-8 text: save it in that encoding",
        ),
        (
            "huge.ron",
            "it has 4096 MiB, a scene file 1 at most: a mesh belongs into an .obj file of its own",
        ),
        (
            "huge.obj",
            "it has 4096 MiB, an .obj file 2048 at most: split it, or leave groups out of it",
        ),
        ("folder.obj", "it is a folder, expected a file"),
    ] {
        let begin = format!("cannot read {}: ", file(name).display());
        assert_eq!(said_of_file(&file(name)), format!("{begin}{message}"));
    }
}

/// A device has length 0 and gives bytes for ever; to open a pipe that is never written takes for
/// ever.
#[test]
#[cfg(unix)]
fn devices_and_pipes() {
    let folder = tempfile::tempdir().unwrap();
    let file = |name: &str| folder.path().join(name);
    for name in ["zero.ron", "zero.obj"] {
        std::os::unix::fs::symlink("/dev/zero", file(name)).unwrap();
    }
    for name in ["pipe.ron", "pipe.obj"] {
        let made = std::process::Command::new("mkfifo")
            .arg(file(name))
            .status();
        assert!(made.unwrap().success());
    }
    std::fs::write(
        file("garden.ron"),
        SCENE.replace("Generated(\"park\")", "Obj(file: \"zero.obj\")"),
    )
    .unwrap();
    for (name, read) in [
        ("zero.ron", "zero.ron"),
        ("zero.obj", "zero.obj"),
        ("pipe.ron", "pipe.ron"),
        ("pipe.obj", "pipe.obj"),
        ("garden.ron", "zero.obj"),
    ] {
        assert_eq!(
            said_of_file(&file(name)),
            format!(
                "cannot read {}: it is a device, a pipe or a socket, of unknown length: copy its \
                 content into a file, and name that",
                file(read).display()
            )
        );
    }
}

/// The kernel's files say that they are regular and of no length, whatever they hold: what is read
/// counts.
#[test]
#[cfg(target_os = "linux")]
fn a_file_that_is_longer_than_it_says() {
    let path = Path::new("/proc/self/status");
    assert_eq!(std::fs::metadata(path).unwrap().len(), 0);
    let limit = |mib| Limit {
        of: "a list",
        mib,
        way_out: "shorten it",
    };
    let error = limit(0).read(path).unwrap_err().to_string();
    assert_eq!(
        error,
        "it has more than 0 MiB, a list 0 at most: shorten it"
    );
    assert!(!limit(1024).read(path).unwrap().is_empty());
}
