//! Names the folders for the results of several scenes.
//!
//! ```
//! use skiagraph_compare::measuring::scene_folders::scene_folders;
//!
//! let scenes = ["park", "city:10000", "levels/room.glb", "old/room.glb"];
//! let folders = scene_folders(&scenes.map(str::to_owned));
//! assert_eq!(folders, ["park", "city-10000", "room", "room-2"]);
//! ```

use crate::pictures::run_pictures::slug;
use skiagraph_scene::MeshFile;
use std::path::Path;

/// Returns the names of the folders below a common one that hold the results of scenes, no two
/// alike. `scenes` are names or paths as `--scene` takes them: `park`, `city:1000000`,
/// `levels/room.glb`. A folder is called after its scene (`city-1000000`, `room`), the second of
/// one name `room-2`.
pub fn scene_folders(scenes: &[String]) -> Vec<String> {
    let mut folders: Vec<String> = Vec::new();
    for scene in scenes {
        let file = Path::new(scene);
        let is_file = MeshFile::is_one(file) || scene.ends_with(".ron");
        let stem = file.file_stem().filter(|_| is_file);
        let stem = stem.map_or(scene.as_str().into(), |stem| stem.to_string_lossy());
        let name = match slug(&stem) {
            name if name.is_empty() => "scene".to_owned(),
            name => name,
        };
        // Some file systems do not tell capitals from small letters.
        let is_taken = |name: &String| {
            folders
                .iter()
                .any(|it| it.to_lowercase() == name.to_lowercase())
        };
        let numbered = (2..).map(|number| format!("{name}-{number}"));
        let free = [name.clone()].into_iter().chain(numbered);
        folders.extend(free.into_iter().find(|name| !is_taken(name)));
    }
    folders
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_scene_has_a_folder_of_its_own() {
        let scenes = [
            "park",
            "levels/Room.glb",
            "city:10000",
            "old/room.gltf",
            "night.ron",
            "park",
            "room-2",
        ];
        let folders = scene_folders(&scenes.map(str::to_owned));
        let expected = [
            "park",
            "Room",
            "city-10000",
            "room-2",
            "night",
            "park-2",
            "room-2-2",
        ];
        assert_eq!(folders, expected);
    }
}
