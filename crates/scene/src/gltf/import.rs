//! Walks the nodes of a document and welds their triangles.

use super::{
    accessor,
    buffers::{self, GLTF_FILE},
    document::{self, Fault},
    materials,
};
use crate::{
    builder::{Corner, MeshBuilder},
    error::{FaceRef, SceneError},
    material::Material,
    mesh::Mesh,
    obj::read::check_read,
    report::ImportReport,
};
use glam::{DMat3, DMat4, DVec3, Mat4, Vec2, Vec3};
use gltf::{Semantic, mesh::Mode};
use std::{collections::HashSet, path::Path, sync::Arc};

/// Most corners of all triangles together: a small file may place one mesh any number of times.
const MOST_CORNERS: usize = 1 << 28;

/// Reads a `.gltf` or `.glb` file with what it names.
///
/// # Errors
/// [`SceneError`]: what cannot be read, or is damaged; what the file requires and this program does
/// not know; a file without triangles.
pub fn load_gltf(path: &Path) -> Result<(Mesh, ImportReport), SceneError> {
    let bytes = GLTF_FILE.read(path).map_err(|reason| SceneError::Read {
        path: path.to_owned(),
        reason,
    })?;
    parse_gltf(&bytes, path)
}

/// Reads the bytes of a `.gltf` or `.glb` file; other files that it names are looked for beside
/// `path`.
///
/// # Errors
/// As [`load_gltf`], but for reading.
pub fn parse_gltf(bytes: &[u8], path: &Path) -> Result<(Mesh, ImportReport), SceneError> {
    let fail = |(place, reason)| SceneError::Gltf {
        path: path.to_owned(),
        place,
        reason,
    };
    let (document, blob) = document::parse(bytes).map_err(fail)?;
    let buffers = buffers::read(&document, blob, path).map_err(fail)?;
    let mut import = Import::new(path, &buffers);
    import.read_materials(&document).map_err(fail)?;
    import.read_nodes(&document).map_err(fail)?;
    let (mesh, report) = import.finish();
    check_read(&mesh, &report, path)?;
    Ok((mesh, report))
}

struct Import<'a> {
    path: &'a Path,
    buffers: &'a [Arc<[u8]>],
    materials: Vec<materials::Read>,
    builder: MeshBuilder,
    corners: usize,
}

/// The arrays of a primitive, by vertex but for the indices.
struct Arrays {
    positions: Vec<[f32; 3]>,
    normals: Option<Vec<[f32; 3]>>,
    uvs: Option<Vec<[f32; 2]>>,
    indices: Vec<u32>,
}

impl<'a> Import<'a> {
    fn new(path: &'a Path, buffers: &'a [Arc<[u8]>]) -> Self {
        let mut builder = MeshBuilder::default();
        builder.report.file = Some(path.to_owned());
        Self {
            path,
            buffers,
            materials: Vec::new(),
            builder,
            corners: 0,
        }
    }

    fn finish(self) -> (Mesh, ImportReport) {
        let materials: Vec<Material> = self.materials.into_iter().map(|it| it.material).collect();
        self.builder.finish(materials)
    }

    /// Those of the document, and behind them the one that stands in where there is none.
    fn read_materials(&mut self, document: &gltf::Document) -> Result<(), Fault> {
        for from in document.materials() {
            let index = from.index().unwrap_or(0);
            let name = from.name().unwrap_or_default();
            let place = format!("material {index} {name:?}");
            let read = materials::read(&from, self.buffers, self.path);
            self.materials.push(read.map_err(|why| (place, why))?);
        }
        self.materials.push(materials::Read {
            material: Material::default(),
            uv_set: 0,
            uv_transform: (glam::Mat2::IDENTITY, Vec2::ZERO),
        });
        Ok(())
    }

    fn read_nodes(&mut self, document: &gltf::Document) -> Result<(), Fault> {
        let scene = document
            .default_scene()
            .or_else(|| document.scenes().next());
        let roots: Vec<gltf::Node<'_>> = match scene {
            Some(scene) => scene.nodes().collect(),
            None => {
                for mesh in document.meshes() {
                    self.read_mesh(&mesh, DMat4::IDENTITY, mesh.name())?;
                }
                return Ok(());
            }
        };
        let mut open: Vec<(gltf::Node<'_>, DMat4)> = Vec::new();
        open.extend(roots.into_iter().rev().map(|node| (node, DMat4::IDENTITY)));
        let mut seen = HashSet::new();
        while let Some((node, above)) = open.pop() {
            let place = || format!("node {}", node.index());
            if !seen.insert(node.index()) {
                let why = "two nodes have it as a child, or it is its own";
                return Err((place(), why.to_owned()));
            }
            let local = Mat4::from_cols_array_2d(&node.transform().matrix()).as_dmat4();
            let transform = above * local;
            if !transform.is_finite() {
                return Err((place(), "its transform is not finite".to_owned()));
            }
            if let Some(mesh) = node.mesh() {
                self.read_mesh(&mesh, transform, node.name().or(mesh.name()))?;
            }
            let children: Vec<_> = node.children().collect();
            open.extend(children.into_iter().rev().map(|child| (child, transform)));
        }
        Ok(())
    }

    fn read_mesh(
        &mut self,
        mesh: &gltf::Mesh<'_>,
        transform: DMat4,
        name: Option<&str>,
    ) -> Result<(), Fault> {
        let name = name.map_or_else(|| format!("mesh {}", mesh.index()), str::to_owned);
        for primitive in mesh.primitives() {
            let place = format!("mesh {}, primitive {}", mesh.index(), primitive.index());
            let read = self.read_primitive(&primitive, transform, &name);
            read.map_err(|why| (place, why))?;
        }
        Ok(())
    }

    fn read_primitive(
        &mut self,
        primitive: &gltf::Primitive<'_>,
        transform: DMat4,
        group: &str,
    ) -> Result<(), String> {
        let material = primitive
            .material()
            .index()
            .unwrap_or(self.materials.len() - 1);
        let (uv_set, (turn, offset)) = {
            let material = &self.materials[material];
            (material.uv_set, material.uv_transform)
        };
        let Arrays {
            positions,
            normals,
            uvs,
            indices,
        } = self.arrays(primitive, uv_set)?;
        let triangles = self.triangles(primitive.mode(), &indices);
        self.corners += 3 * triangles.len();
        if self.corners > MOST_CORNERS {
            return Err(format!(
                "more than {MOST_CORNERS} corners in all: split the file"
            ));
        }
        self.builder.report.faces += triangles.len();
        if normals.is_none() {
            self.builder.report.faces_without_normals += triangles.len();
        }
        let linear = DMat3::from_mat4(transform);
        let mirrored = linear.determinant() < 0.0;
        // Of a flattened one no normal is left; the triangle's own stands in.
        let of_normals = match linear.determinant() {
            0.0 => DMat3::ZERO,
            _ => linear.inverse().transpose(),
        };
        let corner = |index: u32, welded: &mut crate::weld::Welder| {
            let at = index as usize;
            let position = positions.get(at).ok_or_else(|| {
                format!("names vertex {index}, but there are {}", positions.len())
            })?;
            let placed = transform
                .transform_point3(Vec3::from(*position).as_dvec3())
                .as_vec3();
            if !placed.is_finite() {
                return Err(format!(
                    "vertex {index} is at {placed}, which is not finite"
                ));
            }
            let normal = normals.as_ref().and_then(|normals| normals.get(at));
            let uv = uvs.as_ref().and_then(|uvs| uvs.get(at));
            Ok(Corner {
                position: welded.index(placed),
                normal: normal.map(|n| of_normals * Vec3::from(*n).as_dvec3()),
                uv: uv.map(|uv| turn * Vec2::from(*uv) + offset),
            })
        };
        for (number, triangle) in (1..).zip(triangles) {
            let mut corners = Vec::with_capacity(3);
            for index in triangle {
                corners.push(corner(index, &mut self.builder.positions)?);
            }
            let mut corners = [corners[0], corners[1], corners[2]];
            if mirrored {
                corners.swap(1, 2);
            }
            let face = || FaceRef {
                group: group.to_owned(),
                number,
                line: 0,
            };
            let none = |_: &MeshBuilder| None::<DVec3>;
            self.builder
                .add(corners, none, group, Some(material as u32), face);
        }
        Ok(())
    }

    /// What a primitive's accessors hold.
    fn arrays(&self, primitive: &gltf::Primitive<'_>, uv_set: u32) -> Result<Arrays, String> {
        let of = |semantic: &Semantic| {
            let accessor = primitive.get(semantic)?;
            Some((accessor.index(), accessor))
        };
        let named = |(index, why): (usize, String)| format!("accessor {index}: {why}");
        let (index, accessor) = of(&Semantic::Positions)
            .ok_or_else(|| "it has no POSITION, so nothing can be drawn of it".to_owned())?;
        let positions =
            accessor::floats::<3>(&accessor, self.buffers).map_err(|why| named((index, why)))?;
        let normals = match of(&Semantic::Normals) {
            Some((index, accessor)) => Some(
                accessor::floats::<3>(&accessor, self.buffers)
                    .map_err(|why| named((index, why)))?,
            ),
            None => None,
        };
        let uvs = match of(&Semantic::TexCoords(uv_set)) {
            Some((index, accessor)) => Some(
                accessor::floats::<2>(&accessor, self.buffers)
                    .map_err(|why| named((index, why)))?,
            ),
            None => None,
        };
        let indices = match primitive.indices() {
            Some(accessor) => accessor::indices(&accessor, self.buffers)
                .map_err(|why| named((accessor.index(), why)))?,
            None => (0..positions.len() as u32).collect(),
        };
        Ok(Arrays {
            positions,
            normals,
            uvs,
            indices,
        })
    }

    /// The triangles that a mode makes of indices. Points and lines are counted.
    fn triangles(&mut self, mode: Mode, indices: &[u32]) -> Vec<[u32; 3]> {
        let report = &mut self.builder.report;
        match mode {
            Mode::Points => report.points += indices.len(),
            Mode::Lines => report.lines += indices.len() / 2,
            Mode::LineLoop => report.lines += indices.len(),
            Mode::LineStrip => report.lines += indices.len().saturating_sub(1),
            Mode::Triangles => {
                let triangles = indices.chunks_exact(3);
                return triangles.map(|of| [of[0], of[1], of[2]]).collect();
            }
            Mode::TriangleStrip => {
                let triangles = indices.windows(3).enumerate();
                return triangles
                    .map(|(at, of)| match at % 2 {
                        0 => [of[0], of[1], of[2]],
                        _ => [of[1], of[0], of[2]],
                    })
                    .collect();
            }
            Mode::TriangleFan => {
                let rim = indices.get(1..).unwrap_or_default();
                return rim
                    .windows(2)
                    .map(|of| [of[0], of[1], indices[0]])
                    .collect();
            }
        }
        Vec::new()
    }
}
