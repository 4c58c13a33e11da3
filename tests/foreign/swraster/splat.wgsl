#import "shared/light.wgsl"
#import "shared/geometry.wgsl"
struct Params { map_size: u32 }
var<uniform> params: Params;
var<storage, read_write> map: array<atomic<u32>>;
@compute @workgroup_size(64) fn main(@builtin(global_invocation_id) id: vec3<u32>) {
  if 3u * id.x >= arrayLength(&scene_indices) { return; }
  let s = f32(params.map_size);
  var p: array<vec3<f32>, 3>;
  for (var i = 0u; i < 3u; i++) { let c = light_clip(corner_position(3u * id.x + i)); p[i] = vec3((vec2(c.x, -c.y) * 0.5 + 0.5) * s, c.z); }
  let area = (p[1].x - p[0].x) * (p[2].y - p[0].y) - (p[1].y - p[0].y) * (p[2].x - p[0].x);
  if area == 0.0 { return; }
  let lo = vec2<i32>(max(floor(min(p[0].xy, min(p[1].xy, p[2].xy))), vec2(0.0)));
  let hi = vec2<i32>(min(ceil(max(p[0].xy, max(p[1].xy, p[2].xy))), vec2(s - 1.0)));
  for (var y = lo.y; y <= hi.y; y++) { for (var x = lo.x; x <= hi.x; x++) {
    let q = vec2<f32>(vec2(x, y)) + 0.5;
    let w0 = ((p[1].x - q.x) * (p[2].y - q.y) - (p[1].y - q.y) * (p[2].x - q.x)) / area;
    let w1 = ((p[2].x - q.x) * (p[0].y - q.y) - (p[2].y - q.y) * (p[0].x - q.x)) / area;
    let w2 = 1.0 - w0 - w1;
    if w0 >= 0.0 && w1 >= 0.0 && w2 >= 0.0 {
      let depth = clamp(w0 * p[0].z + w1 * p[1].z + w2 * p[2].z, 0.0, 1.0);
      atomicMax(&map[u32(y) * params.map_size + u32(x)], 4294967040u - u32(depth * 4294967040.0));
    } } }
}
