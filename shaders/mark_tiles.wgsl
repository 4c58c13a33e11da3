// Stage to find, for each tile of the grid, the farthest receiver of its texels and which of them
// hold a receiver; one thread per tile.

#import "shared/light_buffer.wgsl"

var<storage, read> texels: array<Texel>;
var<storage, read_write> tiles: array<vec4<u32>>;

@compute @workgroup_size(64)
fn main(@builtin(global_invocation_id) thread: vec3<u32>) {
    let size = u32(map_fit.size);
    let columns = (size + TILE - 1u) / TILE;
    let layer = thread.x / (columns * columns);
    let tile = vec2(thread.x % columns, thread.x / columns % columns);
    if layer >= map_layers {
        return;
    }
    var depth = 0u;
    var taken = vec2(0u);
    for (var row = 0u; row < TILE; row++) {
        var taken_in_row = 0u;
        for (var column = 0u; column < TILE; column++) {
            let texel = tile * TILE + vec2(column, row);
            if all(texel < vec2(size)) {
                let texel_depth = texels[texel_number(layer, texel)].max_receiver_depth;
                depth = max(depth, texel_depth);
                taken_in_row |= select(0u, 1u << column, texel_depth != 0u);
            }
        }
        taken[row / 4u] |= taken_in_row << (8u * (row % 4u));
    }
    tiles[tile_number(layer, tile)] = vec4(depth, taken, 0u);
}
