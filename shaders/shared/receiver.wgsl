// The scene at each pixel, as shared/gbuffer.ron makes it, and its status before any map lookup or
// ray.

#import "shared/facing.wgsl"

// The receiver of the pixel, where `scene_positions` are; w: dot(n, l), 0 where there is none.
var position: texture_2d<f32>;
