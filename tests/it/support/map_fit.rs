//! Where a shadow map lies, read back from the device.

use super::graphs::values;
use glam::{DVec2, DVec3};
use skiagraph_gpu::FrameReport;
use skiagraph_scene::Scene;
use skiagraph_tests::cpu_reference::LightSpace;

/// As shaders/shared/map_fit.wgsl has it.
pub struct MapFit {
    /// A map of one texel over all of the scene.
    scene: LightSpace,
    /// From clip space to texels.
    pub rows: [DVec3; 2],
    /// Edge of the map, texels.
    pub size: u32,
}

impl MapFit {
    pub fn new(report: &FrameReport, scene: &Scene) -> Self {
        let words = values(report, "map_fit");
        let number = |at: usize| f64::from(f32::from_bits(words[at]));
        let row = |at: usize| DVec3::new(number(at), number(at + 1), number(at + 2));
        Self {
            scene: LightSpace::new(&scene.mesh, &scene.sun().unwrap(), 1),
            rows: [row(0), row(4)],
            size: number(8) as u32,
        }
    }

    /// A point in texels and depth.
    pub fn texel(&self, position: DVec3) -> DVec3 {
        let share = self.scene.texel(position);
        let clip = DVec3::new(2.0 * share.x - 1.0, 1.0 - 2.0 * share.y, 1.0);
        DVec3::new(self.rows[0].dot(clip), self.rows[1].dot(clip), share.z)
    }

    /// Texels along the scene's edges, if the map is upright.
    pub fn scene_size(&self) -> DVec2 {
        2.0 * DVec2::new(self.rows[0].x, -self.rows[1].y)
    }
}
