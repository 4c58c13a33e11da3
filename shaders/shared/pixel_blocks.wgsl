// Workgroups of 8 by 8 threads that take 32 by 32 pixels: a thread one of each of 16 blocks, since
// some adapters take as long to start a thread as it takes for a pixel. Eight threads that run in
// step have blocks of 2 by 4 pixels, whose receivers are much alike.

const BLOCKS: u32 = 16u;

// `lane`: number of the thread in its workgroup.
fn pixel_of(group: vec2<u32>, lane: u32, block: u32) -> vec2<u32> {
    return 32u * group + vec2(2u * block + (lane & 1u), lane / 8u * 4u + ((lane / 2u) & 3u));
}
