// As trace_light_space.wgsl, where triangles are masked: a hit counts only where its mask is
// opaque.

#import "shared/masks.wgsl" instead "shared/solid.wgsl"
#import "shared/ray_total_uniform.wgsl" instead "shared/ray_total.wgsl"
#import "trace_light_space.wgsl"
