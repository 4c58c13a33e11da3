//! Paths at which a name in a document or shader is looked for.

use std::path::Path;

/// Returns the paths of the shader called `name` for a document in `folder`, in the order in which
/// they are tried: beside the document, in the `shaders` folders beside its folder and one level
/// above, and in the store's `shaders` folder.
pub(crate) fn shader_candidates(folder: &str, name: &str) -> Vec<String> {
    module_candidates(folder, &format!("{name}.wgsl"))
}

/// Returns the paths of the module `file`, a name with its ending, for a document in `folder`: the
/// same folders as for shaders.
pub(crate) fn module_candidates(folder: &str, file: &str) -> Vec<String> {
    let folder = Path::new(folder);
    let in_shaders = format!("shaders/{file}");
    // A document in a sub-folder of pipelines (a shared sub-graph) finds the shaders of its house
    // too.
    let above = folder.ancestors().skip(1).take(2);
    let above = above.map(|above| join(above, &in_shaders));
    once_each(
        [join(folder, file)]
            .into_iter()
            .chain(above)
            .chain([in_shaders.clone()]),
    )
}

/// Returns the paths that `#import "path"` in the file `importer` may mean, in the order in which
/// they are tried: beside the importer, one folder above, and in the store's `shaders` folder.
pub(crate) fn import_candidates(importer: &str, path: &str) -> Vec<String> {
    let folder = Path::new(importer).parent().unwrap_or(Path::new(""));
    let beside = folder.ancestors().take(2).map(|folder| join(folder, path));
    once_each(beside.chain([format!("shaders/{path}")]))
}

/// Returns the paths that `Include(graph: "path")` in the document `includer` may mean, in the
/// order in which they are tried: beside the includer, and in the store's `pipelines` folder.
pub(crate) fn include_candidates(includer: &str, path: &str) -> Vec<String> {
    // One file under one name, or a cycle would not be seen as one.
    let parts = path.split('/').filter(|part| !matches!(*part, "" | "."));
    let parts: Vec<&str> = parts.collect();
    let path = parts.join("/");
    let beside = join(Path::new(folder_of(includer)), &path);
    once_each([beside, format!("pipelines/{path}")])
}

/// Returns the folder of a path; empty for a bare file name.
pub(crate) fn folder_of(path: &str) -> &str {
    let folder = Path::new(path).parent();
    folder.and_then(Path::to_str).unwrap_or("")
}

/// True if a path can lead out of the folder that it is looked for in: it has a `..`, begins with
/// `/`, or contains a backslash or a colon, which Windows takes for a folder or a drive.
pub(crate) fn escapes(path: &str) -> bool {
    path.split('/').any(|part| part == "..") || path.starts_with('/') || path.contains(['\\', ':'])
}

fn once_each(paths: impl IntoIterator<Item = String>) -> Vec<String> {
    let mut paths: Vec<String> = paths.into_iter().collect();
    paths.dedup();
    paths
}

fn join(folder: &Path, file: &str) -> String {
    folder.join(file).to_string_lossy().replace('\\', "/")
}
