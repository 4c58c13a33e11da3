// Casters that follow each other in clusters, as many in each as a workgroup has threads.

// Around all corners of a cluster's casters.
struct ClusterBox {
    low: vec3<f32>,
    high: vec3<f32>,
}

// Clusters that may shade a receiver of the layer that is binned.
struct LiveClusters {
    // Workgroups in x, y, z of bin_large, as bin_casters.wgsl has no binding left for them: one for
    // each PARTS_PER_GROUP parts.
    large_groups: array<atomic<u32>, 3>,
    count: atomic<u32>,
    numbers: array<u32>,
}
