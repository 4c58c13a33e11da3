// As trace_ray_query.wgsl, where triangles are masked: a candidate is taken only where its mask is
// opaque.

#import "shared/masks.wgsl" instead "shared/solid.wgsl"
#import "trace_ray_query.wgsl"
