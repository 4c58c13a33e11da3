// Stage to trace rays by the device's own ray queries; one thread per ray, workgroups spread over
// two dimensions. Triangles are not opaque to it, so that each one found is a candidate, which is
// taken unless the ray does not see it.

enable wgpu_ray_query;

#import "shared/trace_queries.wgsl"
