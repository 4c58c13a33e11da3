//! OBJ and scene files made to break us: each gives a located answer, or is rightly accepted, in bounded time and memory.

use skiagraph_scene::{
    Bvh, ImportReport, Mesh, ObjOptions, SceneError, SceneFile, SceneLibrary, SceneRequest,
    obj::parse_obj,
};
use std::path::Path;

fn parse(text: impl AsRef<[u8]>) -> Result<(Mesh, ImportReport), SceneError> {
    parse_obj(
        text.as_ref(),
        Path::new("house.obj"),
        &ObjOptions::default(),
    )
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

const HOUSE: &str = "# a house\no house\nv 0 0 0\nv 1 0 0\nv 1 1 0 1.0\nv 0 1 0 0.5 0.5 0.5\nvn 0 0 1\ng wall\nusemtl brick\n\
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
    for text in ["", " \n\t\r\n", "\u{feff}", "\0\0\0\0"] {
        assert_error(text, "house.obj: ", "no triangles: the file holds 0 faces");
    }
    assert_error(
        b"\xff\xfev\0 \x000\0",
        "house.obj:1: ",
        "byte 1 of the line is not UTF-8",
    );
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
        let part = format!("(line 4) names vertex {index}, but 3 vertices stand above it");
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
    assert_error(
        "v 0 0 0\nvn 1 0 zero\n",
        "house.obj:2: ",
        "normal parse error",
    );
}

#[test]
fn a_face_of_a_hundred_thousand_corners() {
    let vertices: String = (0..100_000)
        .map(|i| format!("v {i} {} 0\n", (i / 2) * (i % 2)))
        .collect();
    let corners: String = (1..=100_000).map(|i| format!(" {i}")).collect();
    let (mesh, _) = parse(format!("{vertices}f{corners}\n")).unwrap();
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
        "names vertex 1, but 0 vertices",
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
    let (mesh, report) = parse_obj(text.as_bytes(), Path::new("house.obj"), &options).unwrap();
    assert_eq!((mesh.triangles.len(), report.faces_left_out), (1, 199_999));
}

/// The largest numbers that a model may have and the smallest that there are make a mesh with a hierarchy.
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
            "direction: (0, 0, 1)",
            "direction: (0, -3, 0)",
            "is parallel to the direction",
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
        let error = SceneFile::parse(&SCENE.replace(from, to), "garden.ron")
            .unwrap_err()
            .to_string();
        let line = if from == "direction: (0, -1, 0)" {
            3
        } else {
            4
        };
        assert!(
            error.starts_with(&format!("garden.ron:{line}:")) && error.contains(part),
            "{to}: {error}"
        );
    }
}

#[test]
fn scene_files_of_nothing_and_without_end() {
    let error = |text: &str| {
        SceneFile::parse(text, "garden.ron")
            .unwrap_err()
            .to_string()
    };
    for text in ["", " \n ", "\u{feff}", "\0", "(", &SCENE[..SCENE.len() - 1]] {
        assert!(
            error(text).starts_with("garden.ron:"),
            "{text:?}: {}",
            error(text)
        );
    }
    for bracket in ["(", "[", "{", "Some("] {
        let nested = SCENE.replace("\"garden\"", &bracket.repeat(10_000));
        assert!(error(&nested).starts_with("garden.ron:2:"), "{bracket}");
        let nested = SCENE.replace("format: 1", &format!("other: {}", bracket.repeat(10_000)));
        assert!(error(&nested).starts_with("garden.ron:2:"), "{bracket}");
    }
    // Time must not grow with the square of the views.
    let view = |i: usize| {
        format!(
            "(name: \"{i}\", eye: (0, 5, 0), direction: (0, 0, 1), fov_y_degrees: 60, near: 1, far: 100),"
        )
    };
    let views: String = (0..50_000).map(view).collect();
    let many = SCENE.replace("views: [", &format!("views: [{views}"));
    assert_eq!(
        SceneFile::parse(&many, "garden.ron").unwrap().views.len(),
        50_001
    );
    assert!(error(&many.replace("\"a\"", "\"7\"")).contains("two views are called \"7\""));
}

#[test]
fn scene_files_on_disk() {
    let folder = tempfile::tempdir().unwrap();
    let load = |name: &str| {
        let request = SceneRequest {
            argument: folder.path().join(name).display().to_string(),
            ..SceneRequest::default()
        };
        SceneLibrary::default()
            .load(&request)
            .unwrap_err()
            .to_string()
    };
    std::fs::write(folder.path().join("binary.ron"), b"(name: \"\xc3\x28\")").unwrap();
    assert!(
        load("binary.ron").contains("binary.ron: stream did not contain valid UTF-8"),
        "{}",
        load("binary.ron")
    );
    let huge = std::fs::File::create(folder.path().join("huge.ron")).unwrap();
    huge.set_len(4 << 30).unwrap();
    assert!(
        load("huge.ron").contains("huge.ron: it has 4194304 KiB, a scene file 1024 at most"),
        "{}",
        load("huge.ron")
    );
}
