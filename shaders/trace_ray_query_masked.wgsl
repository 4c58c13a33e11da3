// As trace_ray_query.wgsl, where triangles are masked: a candidate is taken only where its mask is
// opaque.

enable wgpu_ray_query;

#import "shared/masks.wgsl" instead "shared/solid.wgsl"
#import "shared/trace_queries.wgsl"
