//! Settings of a provider: camera, light and mesh, as a host has them in each frame.

use crate::{error::Error, eye::Eye, lights, provider::SceneProvider, shape::Shape};
use glam::{DAffine3, Vec3};
use skiagraph_scene::{Camera, LightKind, Mesh, Movable, Scene, View, packed_masks::mask_words};
use std::sync::Arc;

impl SceneProvider {
    /// The scene, with the mesh as it was set last.
    pub fn scene(&self) -> &Arc<Scene> {
        &self.scene
    }

    /// The camera of a view, and its first light or the scene's.
    pub fn set_view(&mut self, view: &View, viewport: [u32; 2]) {
        self.set_camera(&view.camera(viewport));
        let light = self.scene.light_of(view);
        let mut lights = lights::from_scene(&self.scene);
        // A view may be under one of the scene's lights, or have one of its own.
        if !lights.contains(&light) {
            lights = vec![light];
        }
        if lights != self.lights {
            self.versions.set_lights(lights.clone());
            self.lights = lights;
        }
        self.set_light(light);
    }

    /// Another camera, whose depths are as `shared/gbuffer.ron` draws them: 1 near, 0 far. For
    /// depths that a host draws itself, [`set_eye`](Self::set_eye) knows which end is near.
    pub fn set_camera(&mut self, camera: &Camera) {
        self.set_eye(&Eye::from(camera));
    }

    /// Another camera, by its matrices.
    pub fn set_eye(&mut self, eye: &Eye) {
        if *eye != self.eye {
            self.eye = *eye;
            self.versions.set_camera(*eye);
        }
    }

    /// The light.
    pub fn light(&self) -> LightKind {
        self.light
    }

    /// Which of [`lights`](Self::lights) the light is; the first, if it is none of them.
    pub fn light_number(&self) -> usize {
        let number = self.lights.iter().position(|light| *light == self.light);
        number.unwrap_or_default()
    }

    /// All lights of the scene, or the view's own.
    pub fn lights(&self) -> &[LightKind] {
        &self.lights
    }

    /// Another light. A plan depends on the light's kind: what was planned under a light of another
    /// kind is planned anew, and its `refresh` is
    /// [`ExecuteError::OtherThanPlanned`](skiagraph_gpu::ExecuteError::OtherThanPlanned) until
    /// then.
    pub fn set_light(&mut self, light: LightKind) {
        if light != self.light {
            self.light = light;
            self.versions.set_light(light);
        }
    }

    /// Another mesh, in one piece. A plan counts items: what was planned for a mesh of other counts
    /// is planned anew ([`replace_graph`](skiagraph_gpu::Executor::replace_graph)).
    pub fn set_mesh(&mut self, mesh: Mesh) {
        self.masks = mask_words(&mesh);
        Arc::make_mut(&mut self.scene).mesh = mesh;
        self.hierarchies.forget();
        self.shape = Shape::default();
        self.versions.change_mesh();
    }

    /// Another mesh, in parts that [`set_transforms`](Self::set_transforms) moves; for plans, as
    /// [`set_mesh`](Self::set_mesh). Parts that were [joined](Movable::joined) have no places until
    /// they are given some: executors may be made before that, and `encode` is an error.
    pub fn set_parts(&mut self, parts: impl Into<Arc<Movable>>) {
        let parts = parts.into();
        self.set_mesh(parts.rest.clone());
        let (count, is_joined) = (parts.parts(), parts.is_joined());
        self.shape = Shape {
            maps: if is_joined {
                Vec::new()
            } else {
                vec![DAffine3::IDENTITY; count]
            },
            mirrored: vec![false; count],
            parts: Some(parts),
            is_unplaced: is_joined,
            is_deformed: true,
        };
    }

    /// The same mesh at other places: positions and normals in the order and number of those that
    /// are there. Hierarchies are refitted (or built, the first time, or when refitting has made
    /// them bad), adjacency and all else is kept. Triangles stay wound as they are: what is
    /// mirrored needs [`set_mesh`](Self::set_mesh) or [`set_transforms`](Self::set_transforms).
    /// Equal places are no change.
    ///
    /// # Errors
    /// Other numbers of positions or normals, or one that is not finite. Nothing has changed then.
    pub fn deform(&mut self, positions: Vec<Vec3>, normals: Vec<Vec3>) -> Result<(), Error> {
        let mesh = &self.scene.mesh;
        let expected = [mesh.positions.len(), mesh.normals.len()];
        let given = [positions.len(), normals.len()];
        if given != expected {
            return Err(Error::Deformed { expected, given });
        }
        for (what, list) in [("position", &positions), ("normal", &normals)] {
            if let Some(index) = list.iter().position(|v| !v.is_finite()) {
                let value = list[index];
                return Err(Error::NotFinite { what, index, value });
            }
        }
        // The maps of parts, if there are any, no longer say where those are.
        self.shape.maps.clear();
        self.shape.is_unplaced = false;
        if mesh.positions == positions && mesh.normals == normals {
            return Ok(());
        }
        let mesh = &mut Arc::make_mut(&mut self.scene).mesh;
        (mesh.positions, mesh.normals) = (positions, normals);
        self.shape.is_deformed = true;
        self.versions.change_shape();
        Ok(())
    }

    /// Moves each part of what [`set_parts`](Self::set_parts) or
    /// [`of_parts`](Self::of_parts) was given from where it rests by the map of the same index.
    /// Only parts whose maps are others than before are moved, and equal maps cost nothing. The
    /// triangles of a part that its map mirrors are wound the other way, as in glTF, so that its
    /// outside stays outside.
    ///
    /// # Errors
    /// A provider without parts, other than one map for each part, or a map by which a part cannot
    /// be moved (not finite, singular); the error names the part. Nothing has changed then.
    pub fn set_transforms(&mut self, maps: &[DAffine3]) -> Result<(), Error> {
        let parts = self.shape.parts.clone().ok_or(Error::NoParts)?;
        parts.check_count(maps.len())?;
        let before = &self.shape.maps;
        let others = (0..maps.len()).filter(|&part| before.get(part) != Some(&maps[part]));
        let moved = others.map(|part| Ok((part, parts.moved_part(part, &maps[part])?)));
        let moved: Vec<_> = moved.collect::<Result<_, Error>>()?;
        self.shape.maps = maps.to_vec();
        if moved.is_empty() && !self.shape.is_unplaced {
            return Ok(());
        }
        let mesh = &mut Arc::make_mut(&mut self.scene).mesh;
        let mut is_elsewhere = std::mem::take(&mut self.shape.is_unplaced);
        let mut is_turned = false;
        for (part, moved) in &moved {
            let was = &mut self.shape.mirrored[*part];
            let change = parts.put(*part, moved, *was, mesh);
            *was = moved.is_mirrored;
            is_elsewhere |= change.is_elsewhere;
            is_turned |= change.is_turned;
        }
        if is_turned {
            // Its texture coordinates come in the order of corners.
            self.masks = mask_words(mesh);
            self.versions.change_winding();
        }
        if is_elsewhere || is_turned {
            self.versions.change_shape();
        }
        Ok(())
    }
}
