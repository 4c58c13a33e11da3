// Workgroups of 8 by 8 threads, each of which takes a pixel of several tiles of so many pixels:
// some adapters take as long to start a thread as it takes for a pixel.

fn pixel_of(group: vec2<u32>, tile: u32, tiles_per_row: u32, local: vec2<u32>) -> vec2<u32> {
    return 8u * (tiles_per_row * group + vec2(tile % tiles_per_row, tile / tiles_per_row)) + local;
}
