//! Mesh files that are loaded without a scene file.

use crate::camera::View;
use crate::error::SceneError;
use crate::gltf::{Clip, GltfScene, load_gltf_scene};
use crate::light_kind::Light;
use crate::material_use::MaterialUse;
use crate::mesh::Mesh;
use crate::obj::options::{Concave, ObjOptions, QuadDiagonal};
use crate::obj::read::load_obj;
use crate::report::{ImportReport, nothing_casts};
use crate::scene_file::MeshSource;
use crate::text::has_extension;
use std::path::Path;

/// Content of a mesh file: mesh, cameras, lights and animations.
#[derive(Clone, Debug)]
pub struct MeshFile {
    /// The file's name without its extension.
    pub name: String,
    /// Triangles and materials of the file.
    pub mesh: Mesh,
    /// One view for each perspective camera that the file places; empty for an OBJ file.
    pub views: Vec<View>,
    /// Lights of the file; empty for an OBJ file.
    pub lights: Vec<Light>,
    /// Animations of the file, which move its `views`, `lights` and parts of `mesh`; empty for an
    /// OBJ file.
    pub clips: Vec<Clip>,
    /// Changes that the import made, and parts of the file that it left out.
    pub report: ImportReport,
}

/// Options for reading a mesh file.
#[derive(Clone, Copy, Debug, Default)]
pub struct MeshFileOptions {
    /// Diagonal that splits a quad of an OBJ file.
    pub quads: QuadDiagonal,
    /// Treatment of concave polygons of an OBJ file.
    pub concave: Concave,
    /// Parts of the file's materials that are read.
    pub materials: MaterialUse,
}

impl MeshFileOptions {
    /// Returns the field `mesh` of a scene file that reads the mesh file at the path `file` with
    /// these options. Any extension but `.obj` stands for glTF.
    pub fn source(&self, file: &str) -> MeshSource {
        let file = file.to_owned();
        if has_extension(Path::new(&file), "obj") {
            return MeshSource::Obj {
                file,
                leave_out: Vec::new(),
                quads: self.quads,
                concave: self.concave,
                materials: self.materials.into(),
                source: None,
            };
        }
        MeshSource::Gltf {
            file,
            materials: self.materials,
            source: None,
        }
    }
}

impl MeshFile {
    /// Reads an `.obj`, `.gltf` or `.glb` file. Any extension but `.obj` stands for glTF.
    ///
    /// # Errors
    /// [`SceneError`]: a file that cannot be read, is damaged or holds no triangles.
    pub fn load(path: &Path, options: &MeshFileOptions) -> Result<Self, SceneError> {
        let stem = path.file_stem();
        let name = stem.map_or_else(String::new, |stem| stem.to_string_lossy().into_owned());
        let (mesh, scene, mut report) = if has_extension(path, "obj") {
            let options = ObjOptions {
                quads: options.quads,
                concave: options.concave,
                materials: options.materials.into(),
                ..ObjOptions::default()
            };
            let (mesh, report) = load_obj(path, &options)?;
            (mesh, GltfScene::default(), report)
        } else {
            load_gltf_scene(path, options.materials)?
        };
        let nothing = nothing_casts(&mesh).map(str::to_owned);
        for remark in scene.remarks.into_iter().chain(nothing) {
            report.remark(remark);
        }
        Ok(Self {
            name,
            mesh,
            views: scene.views,
            lights: scene.lights,
            clips: scene.clips,
            report,
        })
    }

    /// Returns true if a path ends in `.obj`, `.gltf` or `.glb`.
    pub fn is_one(path: &Path) -> bool {
        let mut extensions = ["obj", "gltf", "glb"].iter();
        extensions.any(|extension| has_extension(path, extension))
    }
}
