//! Materials and texture coordinates of parts, in the lists of the scene's mesh.

use skiagraph_scene::{Mesh, Movable, Surfaces, material::SurfacePlace};
use std::sync::{Arc, Weak};

/// Items that lists may have too many.
const SPARE: usize = 1024;

/// Lists of the parts' meshes that were put into those of the scene's mesh: once for all parts of a
/// mesh. Those that no part uses any more are dropped when they are more than half.
#[derive(Clone, Debug, Default)]
pub(crate) struct Painted {
    placed: Vec<(Weak<Movable>, SurfacePlace)>,
    /// Items of the lists when all were used.
    used: usize,
}

impl Painted {
    /// The lists of a mesh as it is, all of which are used.
    pub fn new(surfaces: &Surfaces) -> Self {
        Self {
            used: items(surfaces),
            ..Self::default()
        }
    }

    /// Gives a part of a mesh, of these triangles, its surfaces. Returns true if the lists were
    /// packed, so that items of other parts are elsewhere.
    pub fn put(&mut self, movable: &Arc<Movable>, own: (usize, usize), whole: &mut Mesh) -> bool {
        let (surfaces, total) = (&mut whole.surfaces, whole.triangles.len());
        let mut placed = self.placed.iter();
        let placed = placed.find(|(mesh, _)| mesh.as_ptr() == Arc::as_ptr(movable));
        if let Some((_, place)) = placed {
            surfaces.put_again(&movable.rest.surfaces, *place, own);
            return false;
        }
        let is_packed = items(surfaces) > 2 * self.used.max(SPARE);
        if is_packed {
            let triangles = &whole.triangles;
            surfaces.compact(|triangle| triangles[triangle] != [0; 3]);
            self.placed.clear();
            self.used = items(surfaces);
        }
        if let Some(place) = surfaces.put(&movable.rest.surfaces, own, total) {
            self.placed.push((Arc::downgrade(movable), place));
        }
        is_packed
    }
}

fn items(surfaces: &Surfaces) -> usize {
    surfaces.materials.len() + surfaces.uvs.len()
}
