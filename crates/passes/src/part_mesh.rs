//! Meshes that are prepared once, for any number of parts.

use crate::error::Error;
use crate::parts::Room;
use glam::{DAffine3, Vec3};
use skiagraph_scene::{Bvh, Mesh, Movable, TwoLevelBvh};
use std::ops::Range;
use std::sync::{Arc, OnceLock};

/// Mesh in a space of its own that is prepared once, on any thread, for any number of parts of any
/// scene: instances, levels of detail, meshes that are streamed in.
/// [`SceneProvider::add_mesh`](crate::SceneProvider::add_mesh) and
/// [`SceneProvider::replace_part`](crate::SceneProvider::replace_part) then only write its items
/// where the part is. Materials, masks and roles in shadows are the mesh's.
#[derive(Clone, Debug)]
pub struct PartMesh(Arc<Prepared>);

#[derive(Debug)]
struct Prepared {
    /// The mesh as the only part.
    movable: Arc<Movable>,
    /// A hierarchy over it, and the order of its nodes.
    tree: OnceLock<(Bvh, Arc<[u32]>)>,
}

impl PartMesh {
    /// Prepares a mesh: finds the normals of its positions, and the positions that lights are laid
    /// around.
    ///
    /// # Errors
    /// [`Error::NotFinite`] for a position or normal that is not finite, [`Error::Corner`] for an
    /// index beyond the mesh's positions, [`Error::Lacks`] for a triangle without normals, material
    /// or texture coordinates that others have.
    pub fn new(mesh: &Mesh) -> Result<Self, Error> {
        for (what, list) in [("position", &mesh.positions), ("normal", &mesh.normals)] {
            if let Some(index) = list.iter().position(|value: &Vec3| !value.is_finite()) {
                let value = list[index];
                return Err(Error::NotFinite { what, index, value });
            }
        }
        check_corners(mesh, 0..mesh.triangles.len())?;
        check_lists(mesh)?;
        let prepared = Self::unchecked(mesh);
        prepared.0.movable.moved_border(0, &DAffine3::IDENTITY);
        Ok(prepared)
    }

    pub(crate) fn unchecked(mesh: &Mesh) -> Self {
        Self(Arc::new(Prepared {
            movable: Arc::new(Movable::joined(&[mesh])),
            tree: OnceLock::new(),
        }))
    }

    /// Builds the hierarchy over the mesh, too, which methods that trace rays need. Without it each
    /// part gets one of its own when it is added to a scene that rays go through, and so does a
    /// mesh of which some triangles cast no shadows.
    #[must_use]
    pub fn with_hierarchy(self) -> Self {
        let rest = &self.0.movable.rest;
        if rest.casters().len() < rest.triangles.len() {
            return self;
        }
        self.0.tree.get_or_init(|| {
            let tree = Bvh::build(&self.0.movable.rest);
            let order = tree.order().into();
            (tree, order)
        });
        self
    }

    /// Returns the room that so many parts of this mesh need in a scene
    /// ([`SceneProvider::reserve`](crate::SceneProvider::reserve)).
    pub fn room(&self, parts: usize) -> Room {
        Room::of(&self.0.movable.rest, parts)
    }

    pub(crate) fn movable(&self) -> &Arc<Movable> {
        &self.0.movable
    }

    /// True if the nodes of a part are in the order of its hierarchy.
    pub(crate) fn has_order(&self, order: &Arc<[u32]>) -> bool {
        let own = self.0.tree.get();
        own.is_some_and(|(_, own)| Arc::ptr_eq(own, order))
    }

    /// Adds its hierarchy to that of a scene, for triangles from `first` on.
    pub(crate) fn add_to(&self, tree: &mut TwoLevelBvh, piece: usize, first: usize) {
        let rest = &self.0.movable.rest;
        match self.0.tree.get() {
            Some((own, order)) => tree.add_tree(piece, (own, order), rest, first as u32),
            None => tree.add(piece, rest, first as u32),
        }
    }
}

/// Refuses a mesh if some of its triangles have other things that it lacks.
fn check_lists(mesh: &Mesh) -> Result<(), Error> {
    let surfaces = &mesh.surfaces;
    let corners = |list: &[[u32; 3]], most: usize| {
        let is_there = move |own: &[u32; 3]| own.iter().all(|index| (*index as usize) < most);
        list.iter().take_while(|own| is_there(own)).count()
    };
    let triangles = mesh.triangles.len();
    let normals = corners(&mesh.normal_indices, mesh.normals.len());
    let materials = surfaces.of.iter();
    let is_there = |own: &&u32| (**own as usize) < surfaces.materials.len();
    let materials = materials.take_while(is_there).count();
    let uvs = corners(&surfaces.uv_indices, surfaces.uvs.len());
    let unless = |is_empty: bool, count: usize| if is_empty { triangles } else { count };
    let lists = [
        ("normals", normals),
        ("material", unless(surfaces.of.is_empty(), materials)),
        (
            "texture coordinates",
            unless(surfaces.uv_indices.is_empty(), uvs),
        ),
    ];
    match lists.into_iter().find(|(_, count)| *count < triangles) {
        Some((what, triangle)) => Err(Error::Lacks { triangle, what }),
        None => Ok(()),
    }
}

/// Refuses a mesh if some of its triangles have corners that it lacks. Builders of hierarchies do
/// not look at indices, and the memory behind the positions may belong to anything.
pub(crate) fn check_corners(mesh: &Mesh, triangles: Range<usize>) -> Result<(), Error> {
    let corners = mesh.positions.len();
    let mut used = mesh.triangles[triangles].as_flattened().iter();
    match used.find(|index| **index as usize >= corners) {
        Some(&index) => Err(Error::Corner { index, corners }),
        None => Ok(()),
    }
}
