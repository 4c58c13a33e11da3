// As test_casters.wgsl, where triangles are masked: a hit counts only where its mask is opaque.

#import "shared/masks.wgsl" instead "shared/solid.wgsl"
#import "test_casters.wgsl"
