//! Scenes to draw.

use crate::{
    camera::View,
    light::DirectionalLight,
    light_kind::{Light, LightKind},
    mesh::Mesh,
};
use glam::DVec3;

/// A mesh with the views and the light under which it is drawn.
#[derive(Clone, Debug)]
pub struct Scene {
    /// Name shown in tables and results.
    pub name: String,
    /// Every triangle, receivers and casters alike.
    pub mesh: Mesh,
    /// At least one view; the first is the default.
    pub views: Vec<View>,
    /// The lights of all views that have none of their own: at least one; the first is the default.
    pub lights: Vec<Light>,
}

impl Scene {
    /// The view of that name, if the scene has one.
    pub fn view(&self, name: &str) -> Option<&View> {
        self.views.iter().find(|view| view.name == name)
    }

    /// The default light of the scene.
    pub fn light(&self) -> LightKind {
        first(&self.lights)
    }

    /// The default light where that is directional.
    pub fn sun(&self) -> Option<DirectionalLight> {
        self.light().directional().copied()
    }

    /// The default light of a view.
    pub fn light_of(&self, view: &View) -> LightKind {
        first(&self.lights_of(view))
    }

    /// The lights under which a view is drawn: its own, or all of the scene's.
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
