// Light spaces of several points of one light, each where a binding may begin: every 256 bytes.

#import "shared/light.wgsl"

struct LightSlot {
    light: Light,
    rest: array<vec4<f32>, 7>,
}
