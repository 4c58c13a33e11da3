//! Scenes to draw.

use crate::camera::View;
use crate::light::DirectionalLight;
use crate::light_kind::{Light, LightKind};
use crate::mesh::Mesh;
use glam::DVec3;

/// Scene to be drawn: a mesh with its views and lights.
///
/// A scene that was loaded is right. One made by hand is not checked: [`View::check`] and
/// [`Light::check`] find numbers that no camera or light has, and the names of views, which files
/// are called by, must differ, as those of lights must.
#[derive(Clone, Debug)]
pub struct Scene {
    /// Name of the scene, shown in tables and results.
    pub name: String,
    /// Mesh whose triangles cast and receive shadows.
    pub mesh: Mesh,
    /// Views of the scene; the first is the default. A scene that was loaded has at least one.
    pub views: Vec<View>,
    /// Lights for views without a light of their own; the first is the default. A scene that was
    /// loaded has at least one.
    pub lights: Vec<Light>,
}

impl Scene {
    /// Finds the view with this name. Returns `None` if the scene has none.
    pub fn view(&self, name: &str) -> Option<&View> {
        self.views.iter().find(|view| view.name == name)
    }

    /// Returns the default light of the scene: the first of `lights`, or if that list is empty a
    /// directional light that shines along −y.
    pub fn light(&self) -> LightKind {
        first(&self.lights)
    }

    /// Returns the default light of the scene if it is directional, or else `None`.
    pub fn sun(&self) -> Option<DirectionalLight> {
        self.light().directional().copied()
    }

    /// Returns the default light of a view: its own, or else that of the scene.
    pub fn light_of(&self, view: &View) -> LightKind {
        first(&self.lights_of(view))
    }

    /// Returns the lights under which a view is drawn: its own light alone, or else all lights of
    /// the scene.
    pub fn lights_of(&self, view: &View) -> Vec<Light> {
        match &view.light {
            Some(own) => vec![own.clone()],
            None => self.lights.clone(),
        }
    }
}

/// One at least is what a scene promises.
fn first(lights: &[Light]) -> LightKind {
    let down = || DirectionalLight::new(DVec3::NEG_Y).into();
    lights.first().map_or_else(down, |light| light.kind)
}
