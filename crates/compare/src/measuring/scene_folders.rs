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
use crate::records::read_back::with_scenes;
use skiagraph_scene::MeshFile;
use std::path::Path;

/// Checks that results may be written into `folder`: results of a single scene (in the folder
/// itself) must not be mixed with those of several (in its subfolders), which `report` would not
/// find then. `of_several` is true if several scenes are to be compared.
///
/// # Errors
/// The folder holds results of the other kind. The text for the user says so, with advice.
pub fn check_kind(folder: &Path, of_several: bool) -> Result<(), String> {
    let (own, page) = (folder.join("results.json"), folder.join("report.html"));
    let refused = |holds: &str, other_kind: &str| {
        Err(format!(
            "{} holds results of {holds}, which do not go together with those of {other_kind}: \
             name another folder (--out), or delete it",
            folder.display()
        ))
    };
    match of_several {
        true if own.exists() => refused("a single scene", "several"),
        // A page without results of its own is that of the scenes' folders.
        false if page.exists() && with_scenes(&[folder.into()]) != [folder] => {
            refused("several scenes", "a single one")
        }
        _ => Ok(()),
    }
}

/// Returns the names of the folders below a common one that hold the results of scenes, no two
/// alike. `scenes` are names or paths as `--scene` takes them: `park`, `city:1000000`,
/// `levels/room.glb`. A folder has the name of its scene (`city-1000000`, `room`); the second of
/// the same name is `room-2`.
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
        let taken: Vec<String> = folders.iter().map(|it| it.to_lowercase()).collect();
        let numbered = (2..).map(|number| format!("{name}-{number}"));
        let free = [name.clone()].into_iter().chain(numbered);
        folders.extend(
            free.into_iter()
                .find(|name| !taken.contains(&name.to_lowercase())),
        );
    }
    folders
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn results_of_one_scene_and_of_several_do_not_share_a_folder() {
        let folder = tempfile::tempdir().unwrap();
        let place = |name: &str| folder.path().join(name);
        let write = |name: &str| std::fs::write(place(name), "{}").unwrap();
        std::fs::create_dir(place("park")).unwrap();
        write("park/results.json");
        let both = || [false, true].map(|several| check_kind(folder.path(), several));
        assert!(
            both().iter().all(Result::is_ok),
            "results of other commands lie below"
        );
        write("report.html");
        let [single, several] = both();
        assert!(single.unwrap_err().contains("results of several scenes"));
        assert_eq!(several, Ok(()));
        write("results.json");
        let [single, several] = both();
        assert!(several.unwrap_err().contains("results of a single scene"));
        assert_eq!(single, Ok(()));
    }

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
