//! Faults of a file.

use crate::error::beginning;

/// A place in the file, and what is wrong there.
pub(super) type Fault = (String, String);

/// Why a file of another version is refused, and the way out.
pub(super) fn of_another_version(version: &str) -> String {
    format!(
        "it is glTF {}, this program reads 2.0: convert it, glTF 1.0 for example with \
         `gltf-pipeline -i old.gltf -o new.gltf`",
        beginning(version)
    )
}
