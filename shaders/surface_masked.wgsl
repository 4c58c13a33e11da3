// As surface.wgsl, where triangles are double-sided: the normal of one that is seen from behind
// points to the eye's side.

#import "shared/masks.wgsl" instead "shared/solid.wgsl"
#import "surface.wgsl"
