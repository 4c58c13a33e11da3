// Receivers that no list of casters answers, each in a list of its texel's, for which the casters
// of all clusters that may shade one are binned once more and tested.

#import "shared/light_buffer.wgsl"

struct PendingState {
    // Words that PendingCasters would have needed.
    needed_words: u32,
    // Receivers that have a place.
    count: atomic<u32>,
    // Receivers that have none.
    unplaced: atomic<u32>,
    // Tests that they may take, in units of `unit_tests`.
    work: atomic<u32>,
    // Blocks of the texel that has most.
    most_blocks: atomic<u32>,
    // 1 if a part had no room.
    parts_lack: u32,
    // Receivers without an answer.
    unanswered: atomic<u32>,
}

// Casters of the layer that is binned; cull_clusters.wgsl takes it for `LiveClusters`.
struct PendingCasters {
    // LEFT_PARTS: parts of large ones, those included for which there is no room. LEFT_CROWDED:
    // casters over texels with more than a block.
    left: array<atomic<u32>, 3>,
    // Clusters that are live.
    clusters: atomic<u32>,
    // Numbers of those clusters, with room for all; then parts, two words each; from the back
    // crowded casters, which always have room.
    words: array<u32>,
}

const LEFT_PARTS: u32 = 0u;
const LEFT_CROWDED: u32 = 1u;

// Words of `pending` for each receiver: the number of its pixel, with IS_SHADED, and those that
// shared/pending_answer.wgsl or its stand-in adds.
override receiver_words: u32 = 1u;
const IS_SHADED: u32 = 0x80000000u;
// Receivers of one texel that one thread tests at most: `alone` tiles of 64 texels then take it
// about half of the 65,535 rounds after which llvmpipe ends loops.
override block_size: u32 = 128u;
// Tiles under the box of a caster that one thread does alone.
override alone: u32 = 4u;
// As many as a dimension of a dispatch has workgroups.
const MOST_BLOCKS: u32 = 65535u;
// Tests of receivers in a unit of work.
override unit_tests: u32 = 65536u;
// Units of work in a frame: 4.3e9 tests.
const MOST_WORK: u32 = 65536u;

// A texel while it lists receivers.
struct PendingTexel {
    // Bits of the depth of the farthest of them.
    max_receiver_depth: atomic<u32>,
    // How many there are.
    length: atomic<u32>,
    // The place of the first; NO_PLACE where they are too much work.
    first: atomic<u32>,
    // Casters of its list until places are claimed, then how many receivers have one.
    filled: atomic<u32>,
}

// A receiver that a caster is tested for.
struct PendingReceiver {
    position: vec3<f32>,
    place: u32,
    // The number of its pixel.
    pixel: u32,
    // True if bounds of casters hold for it.
    is_bounded: bool,
}

// The tiles of a layer that hold receivers with a place, where a device can bind it alone: the
// least, inverted, and the greatest. These are zero where there is none.
struct PendingBox {
    inverted_x: atomic<u32>,
    inverted_y: atomic<u32>,
    x: atomic<u32>,
    y: atomic<u32>,
    // Counts of `PendingCasters`, once all are counted.
    parts: u32,
    crowded: u32,
    padding: array<vec2<u32>, 29>,
}

// The same where nothing changes it.
struct PendingLayer {
    inverted_first: vec2<u32>,
    last: vec2<u32>,
    parts: u32,
    crowded: u32,
}

const NO_PLACE: u32 = 0xffffffffu;

// Arguments of an indirect dispatch, where a device can bind them alone.
struct Call {
    x: u32,
    y: u32,
    z: u32,
    unused: u32,
    padding: array<vec4<u32>, 15>,
}

// Dispatches where receivers are uncertain: a thread for each texel, pixel, tile, receiver and
// cluster, or fill_rays.wgsl's.
const CALL_TEXELS: u32 = 0u;
const CALL_PIXELS: u32 = 1u;
const CALL_TILES: u32 = 2u;
const CALL_RECEIVERS: u32 = 3u;
const CALL_CLUSTERS: u32 = 4u;
const CALL_RAYS: u32 = 5u;

// Dispatches of a layer: bin_large, bin_crowded.
const CALL_LARGE: u32 = 0u;
const CALL_CROWDED: u32 = 1u;

fn blocks_of(count: u32) -> u32 {
    return (count + block_size - 1u) / block_size;
}
