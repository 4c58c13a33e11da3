// Light spaces of several points of one light, each where a binding may begin.

#import "shared/light.wgsl"

struct LightSlot {
    @size(256) light: Light,
}
