//! Welds the triangles of a document's nodes.

use super::animations::Bytes;
use super::beside::Beside;
use super::buffers::{self, Buffers, GLTF_FILE};
use super::document::{self, Parsed};
use super::fault::Fault;
use super::materials::Reader;
use super::nodes::{NO_TURN, Nodes, group};
use super::pose::{self, Vertices, of_normals, vectors};
use super::scene::GltfScene;
use super::vertex_alpha::Materials;
use super::{accessor, clips};
use crate::builder::{Corner, MeshBuilder};
use crate::error::{FaceRef, SceneError, plural};
use crate::material_use::MaterialUse;
use crate::mesh::Mesh;
use crate::obj::read::check_read;
use crate::report::ImportReport;
use crate::shadows::Shadows;
use crate::weld::Known;
use glam::{DMat3, DMat4, Vec2};
use gltf::{Document, Semantic, accessor::DataType, mesh::Mode};
use std::{ops::Range, path::Path};

/// Most corners of all triangles together: a small file may place one mesh any number of times.
const MOST_CORNERS: usize = 1 << 28;

/// Reads a `.gltf` or `.glb` file, and the files that it names, into a mesh in which equal
/// positions are one (welded). `materials` chooses the parts of materials that are read. The report
/// lists changes that the import made and parts that it ignored.
///
/// # Errors
/// [`SceneError`]: a file that cannot be read, is damaged, requires an extension that this program
/// does not know, or has no triangles.
pub fn load_gltf(path: &Path, materials: MaterialUse) -> Result<(Mesh, ImportReport), SceneError> {
    parse_gltf(&read(path)?, path, materials)
}

/// Reads a `.gltf` or `.glb` file into a mesh as [`load_gltf`] does, and returns the file's
/// cameras, lights and animations between mesh and report.
///
/// # Errors
/// The errors of [`load_gltf`].
pub fn load_gltf_scene(
    path: &Path,
    materials: MaterialUse,
) -> Result<(Mesh, GltfScene, ImportReport), SceneError> {
    parse_gltf_scene(&read(path)?, path, materials)
}

fn read(path: &Path) -> Result<Vec<u8>, SceneError> {
    GLTF_FILE.read(path).map_err(SceneError::unread(path))
}

/// Reads the bytes of a `.gltf` or `.glb` file into a mesh as [`load_gltf`] does. `path` names the
/// file in messages; other files that `bytes` name are searched in the folder of `path`.
///
/// # Errors
/// The errors of [`load_gltf`], except for errors of reading the file itself.
pub fn parse_gltf(
    bytes: &[u8],
    path: &Path,
    materials: MaterialUse,
) -> Result<(Mesh, ImportReport), SceneError> {
    parse_gltf_scene(bytes, path, materials).map(|(mesh, _, report)| (mesh, report))
}

/// Reads the bytes of a `.gltf` or `.glb` file as [`load_gltf_scene`] does the file: mesh, cameras,
/// lights and animations, and report. `path` names the file in messages; other files that `bytes`
/// name are searched in the folder of `path`.
///
/// # Errors
/// The errors of [`parse_gltf`].
pub fn parse_gltf_scene(
    bytes: &[u8],
    path: &Path,
    materials: MaterialUse,
) -> Result<(Mesh, GltfScene, ImportReport), SceneError> {
    let fail = |(place, reason)| SceneError::Part {
        path: path.to_owned(),
        place,
        reason,
    };
    let Parsed {
        document,
        blob,
        beside,
        placements,
    } = document::parse(bytes, materials).map_err(fail)?;
    let buffers = buffers::read(&document, blob, &beside, path).map_err(fail)?;
    let mut builder = MeshBuilder::default();
    builder.report.file = Some(path.to_owned());
    for text in &beside.remarks {
        builder.report.remark(text.clone());
    }
    let reader = Reader {
        buffers: &buffers,
        beside: &beside,
        file: path,
        of: materials,
        colours_missing: Vec::new(),
        blended: 0,
    };
    let materials = read_materials(&document, reader, &mut builder.report).map_err(fail)?;
    let mut import = Import {
        document: &document,
        buffers: &buffers,
        beside: &beside,
        materials,
        builder,
        corners: 0,
        roles: Vec::new(),
    };
    let nodes = Nodes::new(&document, &beside, placements.animations.nodes()).map_err(fail)?;
    import.read_nodes(nodes.as_ref()).map_err(fail)?;
    let materials = import.materials.all.into_iter().map(|read| read.material);
    let (mut mesh, report) = import.builder.finish(materials.collect());
    let total = mesh.triangles.len();
    for role in [Shadows::Casts, Shadows::Receives, Shadows::Neither] {
        let own = import.roles.iter().filter(|(_, own)| *own == role);
        let own = own.flat_map(|(triangles, _)| triangles.clone());
        mesh.surfaces.set_shadows(own, total, role);
    }
    check_read(&mesh, &report, path)?;
    let mut scene = GltfScene::new(&placements, nodes.as_ref(), mesh.bounds());
    if let Some(nodes) = &nodes {
        let folder = path.parent().unwrap_or(Path::new(""));
        scene.add_clips(&clips::Source {
            document: &document,
            placements: &placements,
            nodes,
            bytes: Bytes {
                read: &buffers,
                folder,
            },
            mesh: &mesh,
        });
    }
    Ok((mesh, scene, report))
}

fn read_materials(
    document: &Document,
    mut reader: Reader<'_>,
    report: &mut ImportReport,
) -> Result<Materials, Fault> {
    let mut materials = Vec::new();
    for from in document.materials() {
        let index = from.index().unwrap_or(0);
        let name = from.name().unwrap_or_default();
        let place = format!("material {index} {name:?}");
        let read = reader.read(&from, &place);
        materials.push(read.map_err(|why| (place, why))?);
    }
    report.colours_missing = reader.colours_missing;
    if reader.blended > 0 {
        let count = plural(reader.blended, "material", "materials");
        report.remark(format!(
            "{count} of alphaMode BLEND taken for opaque: --materials blend=mask cuts out what is \
             less than half opaque (a scene file says `materials: BlendMask`)"
        ));
    }
    Ok(Materials::new(materials))
}

struct Import<'a> {
    document: &'a Document,
    buffers: &'a Buffers,
    beside: &'a Beside,
    materials: Materials,
    builder: MeshBuilder,
    corners: usize,
    /// Triangles whose nodes or meshes have a role in shadows.
    roles: Vec<(Range<u32>, Shadows)>,
}

/// Where a mesh is placed.
struct Placing<'a> {
    group: String,
    /// Weights of morph targets.
    weights: &'a [f32],
    /// Where the joints of its skin are, if it has one.
    joints: Option<Vec<DMat4>>,
    /// Where its node is.
    node: DMat4,
    /// Its instances, as its node sees them.
    instances: Vec<DMat4>,
    /// The role in shadows that its node or its mesh gives it.
    role: Option<Shadows>,
}

/// The arrays of a primitive, by vertex but for the indices.
struct Arrays {
    vertices: Vertices,
    uvs: Option<Vec<[f32; 2]>>,
    /// Alpha of the vertices' colours under a mask.
    alphas: Option<Vec<f32>>,
    indices: Vec<u32>,
    /// The index that begins another strip or fan: the largest of its kind, which names no vertex.
    restart: u32,
}

impl<'a> Import<'a> {
    /// Those of the scene; of a document without scenes all meshes.
    fn read_nodes(&mut self, nodes: Option<&Nodes<'a>>) -> Result<(), Fault> {
        let Some(nodes) = nodes else {
            for mesh in self.document.meshes() {
                let placing = Placing {
                    group: group(&mesh, None),
                    weights: mesh.weights().unwrap_or_default(),
                    joints: None,
                    node: DMat4::IDENTITY,
                    instances: vec![DMat4::IDENTITY],
                    role: self.beside.mesh_roles.get(&mesh.index()).copied(),
                };
                self.read_mesh(&mesh, &placing)?;
            }
            return Ok(());
        };
        for node in &nodes.seen {
            let Some(mesh) = node.mesh() else { continue };
            let placing = self.placing(node, &mesh, nodes);
            let placing = placing.map_err(|why| (format!("node {}", node.index()), why))?;
            if nodes.moved.contains(&node.index()) {
                let shared_table = self.builder.positions.weld_to(Known::default());
                self.read_mesh(&mesh, &placing)?;
                self.builder.positions.weld_to(shared_table);
            } else {
                self.read_mesh(&mesh, &placing)?;
            }
        }
        Ok(())
    }

    fn placing(
        &mut self,
        node: &gltf::Node<'a>,
        mesh: &gltf::Mesh<'a>,
        nodes: &Nodes<'_>,
    ) -> Result<Placing<'a>, String> {
        let skin = node.skin();
        let joints = skin.map(|skin| pose::joints(&skin, nodes, self.buffers));
        let instances = match self.beside.instances.get(&node.index()) {
            Some(numbers) => {
                let (instances, is_none) = pose::instances(*numbers, self.document, self.buffers)?;
                if is_none {
                    let text = format!("node {}: an instance's {NO_TURN}", node.index());
                    self.builder.report.remark(text);
                }
                instances
            }
            None => vec![DMat4::IDENTITY],
        };
        let role = self.beside.roles.get(&node.index());
        let role = role.or(self.beside.mesh_roles.get(&mesh.index()));
        Ok(Placing {
            group: group(mesh, node.name()),
            weights: node.weights().or(mesh.weights()).unwrap_or_default(),
            joints: joints.transpose()?,
            node: nodes.worlds.get(&node.index()).copied().unwrap_or_default(),
            instances,
            role: role.copied(),
        })
    }

    fn read_mesh(&mut self, mesh: &gltf::Mesh<'_>, placing: &Placing<'_>) -> Result<(), Fault> {
        let first = self.builder.triangles();
        for primitive in mesh.primitives() {
            let place = format!("mesh {}, primitive {}", mesh.index(), primitive.index());
            let read = self.read_primitive(&primitive, placing);
            read.map_err(|why| (place, why))?;
        }
        let triangles = first..self.builder.triangles();
        self.roles
            .extend(placing.role.map(|role| (triangles, role)));
        Ok(())
    }

    fn read_primitive(
        &mut self,
        primitive: &gltf::Primitive<'_>,
        placing: &Placing<'_>,
    ) -> Result<(), String> {
        let material = primitive.material().index().unwrap_or(self.materials.plain);
        let mut arrays = self.arrays(primitive, material)?;
        let buffers = self.buffers;
        arrays.vertices.morph(primitive, placing.weights, buffers)?;
        let is_skinned = match &placing.joints {
            Some(joints) => {
                let is_skinned = arrays.vertices.skin(primitive, joints, buffers)?;
                if !is_skinned {
                    let group = &placing.group;
                    let text = format!("{group:?} has a skin, but no joints: its node places it");
                    self.builder.report.remark(text);
                }
                is_skinned
            }
            None => false,
        };
        // The transform of a skinned mesh's own node counts for nothing.
        let node = if is_skinned {
            DMat4::IDENTITY
        } else {
            placing.node
        };
        let triangles = self.triangles(primitive.mode(), &arrays.indices, arrays.restart);
        for instance in &placing.instances {
            let transform = node * *instance;
            self.place(&arrays, &triangles, material, transform, &placing.group)?;
        }
        Ok(())
    }

    /// Adds the triangles of a primitive at one place.
    fn place(
        &mut self,
        arrays: &Arrays,
        triangles: &[[u32; 3]],
        material: usize,
        transform: DMat4,
        group: &str,
    ) -> Result<(), String> {
        self.corners += 3 * triangles.len();
        if self.corners > MOST_CORNERS {
            return Err(format!(
                "more than {MOST_CORNERS} corners in all: split the file"
            ));
        }
        if !transform.is_finite() {
            return Err("the transform of an instance is not finite".to_owned());
        }
        self.builder.report.faces += triangles.len();
        let linear = DMat3::from_mat4(transform);
        let mirrored = linear.determinant() < 0.0;
        // A flattened one leaves no normal; the triangle's own stands in.
        let of_normals = of_normals(linear);
        for (number, triangle) in (1..).zip(triangles) {
            let mut corner =
                |at: usize| self.corner(arrays, triangle[at], material, transform, of_normals);
            let mut corners = [corner(0)?, corner(1)?, corner(2)?];
            let (material, uvs) = self.chosen(arrays, triangle, material)?;
            if let Some(uvs) = uvs {
                for (corner, uv) in corners.iter_mut().zip(uvs) {
                    corner.uv = Some(uv);
                }
            }
            let turned = arrays.vertices.turned.get(triangle[0] as usize) == Some(&true);
            if mirrored != turned {
                corners.swap(1, 2);
            }
            let face = || FaceRef {
                group: group.to_owned(),
                number,
                line: 0,
            };
            self.builder
                .add(corners, || None, group, Some(material as u32), face);
        }
        Ok(())
    }

    /// A triangle's material, with the alpha of its corners where it is masked.
    fn chosen(
        &mut self,
        arrays: &Arrays,
        triangle: &[u32; 3],
        material: usize,
    ) -> Result<super::vertex_alpha::Chosen, String> {
        let cut = self.materials.all[material].cut;
        let Some((cut, alphas)) = cut.zip(arrays.alphas.as_ref()) else {
            return Ok((material, None));
        };
        let alphas = triangle.map(|index| alphas.get(index as usize).copied().unwrap_or(1.0));
        let chosen = self.materials.with_alpha(material, cut, alphas)?;
        Ok(chosen.unwrap_or_else(|| {
            let name = &self.materials.all[material].material.name;
            self.builder.report.remark(format!(
                "material {name:?}: the alpha of its vertices changes over a texture, which is not \
                 followed; the texture's alone counts there"
            ));
            (material, None)
        }))
    }

    fn corner(
        &mut self,
        arrays: &Arrays,
        index: u32,
        material: usize,
        transform: DMat4,
        of_normals: DMat3,
    ) -> Result<Corner, String> {
        let at = index as usize;
        let Vertices {
            positions, normals, ..
        } = &arrays.vertices;
        let position = positions
            .get(at)
            .ok_or_else(|| format!("names vertex {index}, but there are {}", positions.len()))?;
        let placed = transform.transform_point3(*position).as_vec3();
        if !placed.is_finite() {
            return Err(format!(
                "vertex {index} is at {placed}, which is not finite"
            ));
        }
        let normal = normals.as_ref().and_then(|normals| normals.get(at));
        let uv = arrays.uvs.as_ref().and_then(|uvs| uvs.get(at));
        let (turn, offset) = self.materials.all[material].uv_transform;
        Ok(Corner {
            position: self.builder.positions.index(placed),
            normal: normal.map(|normal| of_normals * *normal),
            slot: None,
            uv: uv.map(|uv| turn * Vec2::from(*uv) + offset),
        })
    }

    /// Contents of a primitive's accessors.
    fn arrays(&self, primitive: &gltf::Primitive<'_>, material: usize) -> Result<Arrays, String> {
        let material = &self.materials.all[material];
        let positions = primitive.get(&Semantic::Positions);
        let positions = positions.ok_or("it has no POSITION, so nothing can be drawn of it")?;
        let read = |accessor: gltf::Accessor<'_>| vectors(&accessor, self.buffers);
        let positions = read(positions)?;
        let normals = primitive.get(&Semantic::Normals).map(read).transpose()?;
        let uvs = primitive.get(&Semantic::TexCoords(material.uv_set));
        let uvs = uvs.map(|accessor| accessor::floats::<2>(&accessor, self.buffers));
        let uvs = uvs.transpose()?;
        let colours = primitive.get(&Semantic::Colors(0));
        let colours = colours.filter(|_| material.cut.is_some());
        let colours = colours.filter(|accessor| accessor.dimensions().multiplicity() == 4);
        let colours = colours.map(|accessor| accessor::floats::<4>(&accessor, self.buffers));
        let alphas = colours
            .transpose()?
            .map(|colours| colours.into_iter().map(|[.., alpha]| alpha).collect());
        let indices = match primitive.indices() {
            Some(accessor) => accessor::indices(&accessor, self.buffers)
                .map_err(|why| accessor::named(&accessor, why))?,
            None => (0..positions.len() as u32).collect(),
        };
        let restart = match primitive.indices().map(|accessor| accessor.data_type()) {
            Some(DataType::U8) => u8::MAX.into(),
            Some(DataType::U16) => u16::MAX.into(),
            _ => u32::MAX,
        };
        Ok(Arrays {
            vertices: Vertices {
                positions,
                normals,
                turned: Vec::new(),
            },
            uvs,
            alphas,
            indices,
            restart,
        })
    }

    /// The triangles that a mode makes of indices; `restart` begins another strip or fan. Points
    /// and lines are counted.
    fn triangles(&mut self, mode: Mode, indices: &[u32], restart: u32) -> Vec<[u32; 3]> {
        let runs = indices.split(|&index| index == restart);
        let report = &mut self.builder.report;
        match mode {
            Mode::Points => report.points += indices.len(),
            Mode::Lines => report.lines += indices.len() / 2,
            Mode::LineLoop => report.lines += indices.len(),
            Mode::LineStrip => report.lines += indices.len().saturating_sub(1),
            Mode::Triangles => {
                let triangles = indices.chunks_exact(3);
                return triangles.map(|tri| [tri[0], tri[1], tri[2]]).collect();
            }
            Mode::TriangleStrip => return runs.flat_map(strip).collect(),
            Mode::TriangleFan => return runs.flat_map(fan).collect(),
        }
        Vec::new()
    }
}

/// Every second triangle of a strip is wound the other way.
fn strip(indices: &[u32]) -> impl Iterator<Item = [u32; 3]> {
    let triangles = indices.windows(3).enumerate();
    triangles.map(|(at, corners)| match at % 2 {
        0 => [corners[0], corners[1], corners[2]],
        _ => [corners[1], corners[0], corners[2]],
    })
}

fn fan(indices: &[u32]) -> impl Iterator<Item = [u32; 3]> {
    let rim = indices.get(1..).unwrap_or_default();
    rim.windows(2).map(|edge| [edge[0], edge[1], indices[0]])
}
