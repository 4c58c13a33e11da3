// The texels of a map that a pixel asks.

#import "shared/map_fit.wgsl"

// Words of the param `footprint`.
const FOOTPRINT_TEXEL: u32 = 0u;
const FOOTPRINT_BILINEAR: u32 = 1u;
const FOOTPRINT_NINE: u32 = 2u;
const FOOTPRINT_CORNERS: u32 = 3u;

// Those from `first` to `last`, every `step`th in each direction.
struct Footprint {
    first: vec2<i32>,
    last: vec2<i32>,
    step: i32,
}

// Around a place in the map: the texel that it is in; the four that a bilinear lookup blends; the
// texel and the eight around it; or, of these nine, those at the corners.
fn footprint(fit: MapFit, place: vec2<f32>, kind: u32) -> Footprint {
    let edge = min(kind, FOOTPRINT_NINE);
    let first = vec2<i32>(floor(place - 0.5 * f32(edge)));
    let end = i32(fit.size) - 1;
    return Footprint(
        clamp(first, vec2(0), vec2(end)),
        clamp(first + i32(edge), vec2(0), vec2(end)),
        select(1, 2, kind == FOOTPRINT_CORNERS),
    );
}

// True if all texels that are asked let light through, and true if none does.
struct Taps {
    lit: bool,
    shadowed: bool,
}

fn taps(
    maps: texture_depth_2d_array,
    layer: u32,
    asked: Footprint,
    depth: f32,
    bias: f32,
) -> Taps {
    var taps = Taps(true, true);
    for (var y = asked.first.y; y <= asked.last.y; y += asked.step) {
        for (var x = asked.first.x; x <= asked.last.x; x += asked.step) {
            let stored = textureLoad(maps, vec2(x, y), layer, 0);
            // 1 is what the maps were cleared to: no caster, however far.
            let is_lit = stored >= 1.0 || depth <= stored + bias;
            taps.lit &= is_lit;
            taps.shadowed &= !is_lit;
        }
    }
    return taps;
}
