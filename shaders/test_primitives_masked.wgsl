// As test_primitives.wgsl, where triangles are masked: a hit counts only where its mask is opaque.

#import "shared/masks.wgsl" instead "shared/solid.wgsl"
#import "test_primitives.wgsl"
