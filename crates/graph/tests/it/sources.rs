//! Stores of documents and shaders: folders, layers, and what is said when a file is there but
//! cannot be read.

use crate::support::Files;
use skiagraph_graph::{FolderSources, LayeredSources, MemorySources, Picture, Sources};

#[test]
fn a_folder() {
    let folder = tempfile::tempdir().expect("a temporary folder can be made");
    let root = folder.path();
    std::fs::create_dir(root.join("shaders")).expect("it can be made");
    std::fs::write(root.join("shaders/b.wgsl"), "größer").expect("it can be written");
    std::fs::write(root.join("shaders/a.wgsl"), [0xff]).expect("it can be written");
    let sources = FolderSources {
        root: root.to_owned(),
    };
    assert_eq!(sources.read("shaders/b.wgsl"), Ok(Some("größer".into())));
    assert_eq!(sources.read("shaders/c.wgsl"), Ok(None));
    assert_eq!(sources.read("shaders"), Ok(None), "a folder is no file");
    assert_eq!(
        sources.read("shaders/a.wgsl"),
        Err("it is not text in UTF-8".to_owned())
    );
    assert_eq!(sources.list("shaders"), ["a.wgsl", "b.wgsl"]);
    assert!(sources.list("nowhere").is_empty());
    let absolute = root.join("shaders/b.wgsl");
    let elsewhere = FolderSources {
        root: root.join("shaders"),
    };
    assert_eq!(
        elsewhere.read(&absolute.to_string_lossy()),
        Ok(Some("größer".into()))
    );
}

/// A device has length 0 and gives bytes for ever; to open a pipe without a writer takes for ever.
#[test]
#[cfg(unix)]
fn files_without_end() {
    let folder = tempfile::tempdir().expect("a temporary folder can be made");
    let file = |name: &str| folder.path().join(name);
    let sources = FolderSources {
        root: folder.path().to_owned(),
    };
    std::os::unix::fs::symlink("/dev/zero", file("zero.ron")).expect("it can be made");
    let made = std::process::Command::new("mkfifo")
        .arg(file("pipe.ron"))
        .status();
    assert!(made.expect("there is mkfifo").success());
    for name in ["zero.ron", "pipe.ron"] {
        assert_eq!(
            sources.read(name),
            Err("it is a device, a pipe or a socket: copy its content into a file".to_owned())
        );
    }
    let long = std::fs::File::create(file("long.ron")).expect("it can be made");
    for (length, taken) in [(8 << 20, true), ((8 << 20) + 1, false), (4 << 30, false)] {
        long.set_len(length).expect("a file may have holes");
        assert_eq!(sources.read("long.ron").is_ok(), taken, "{length} bytes");
    }
}

#[test]
fn the_first_layer_that_has_a_file_wins() {
    struct Unreadable;
    impl Sources for Unreadable {
        fn read(&self, path: &str) -> Result<Option<std::sync::Arc<str>>, String> {
            if path == "locked" {
                Err("locked".to_owned())
            } else {
                Ok(None)
            }
        }
        fn list(&self, _: &str) -> Vec<String> {
            Vec::new()
        }
    }
    let upper = Files::new([("a", "upper"), ("f/x", "")]);
    let lower = Files::new([
        ("a", "lower"),
        ("b", "lower"),
        ("locked", "lower"),
        ("f/x", ""),
        ("f/y", ""),
    ]);
    let layers = LayeredSources(vec![Box::new(upper), Box::new(Unreadable), Box::new(lower)]);
    assert_eq!(layers.read("a"), Ok(Some("upper".into())));
    assert_eq!(layers.read("b"), Ok(Some("lower".into())));
    assert_eq!(layers.read("c"), Ok(None));
    // A file that exists but is unreadable is not silently taken from elsewhere.
    assert_eq!(layers.read("locked"), Err("locked".to_owned()));
    assert_eq!(layers.list("f"), ["x", "y"]);
}

/// A store that decodes no pictures says so of those that it has, and is passed over otherwise.
#[test]
fn pictures_come_from_the_first_layer_that_has_one() {
    let plain = tempfile::tempdir().expect("a temporary folder can be made");
    std::fs::write(plain.path().join("torn.png"), "no picture").expect("it can be written");
    let folder = FolderSources {
        root: plain.path().to_owned(),
    };
    let files = Files::default()
        .picture("tile.png", 2, &[0, 255])
        .picture("torn.png", 1, &[255]);
    let layers = LayeredSources(vec![Box::new(folder), Box::new(files)]);
    let tile = layers.picture("tile.png").expect("it can be decoded");
    assert_eq!(tile.map(|picture| picture.size), Some([2, 1]));
    assert_eq!(
        layers.picture("none.png").map(|picture| picture.is_some()),
        Ok(false)
    );
    let torn = layers.picture("torn.png").err();
    assert_eq!(torn.as_deref(), Some("this program decodes no pictures"));
}

/// Texts and pictures in memory, before another store.
#[test]
fn files_in_memory_come_before_those_below() {
    let picture = Picture {
        size: [1, 1],
        texels: [[0, 0, 0, u16::MAX]].into(),
    };
    let below = MemorySources::new([("shaders/a.wgsl", "below"), ("shaders/b.wgsl", "below")]);
    let memory = MemorySources::new([("shaders/a.wgsl".to_owned(), "first".to_owned())])
        .with("shaders/a.wgsl", "above")
        .with_picture("leaf.png", picture.clone());
    assert_eq!(memory.list(""), ["leaf.png"]);
    let sources = memory.over(below);
    let read = |path: &str| sources.read(path).unwrap();
    assert_eq!(read("shaders/a.wgsl").as_deref(), Some("above"));
    assert_eq!(read("shaders/b.wgsl").as_deref(), Some("below"));
    assert_eq!(read("shaders"), None);
    assert_eq!(sources.list("shaders"), ["a.wgsl", "b.wgsl"]);
    assert_eq!(sources.picture("leaf.png").unwrap(), Some(picture));
}
