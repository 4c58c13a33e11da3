// Steps that a thread does one after the other, by kinds, in rounds of an outer loop; here they are
// not counted. A document of tests has a module that counts stand in for this.

const TILE_STEP: u32 = 0u;
const TEXEL_STEP: u32 = 1u;
const ENTRY_STEP: u32 = 2u;
const PART_STEP: u32 = 3u;
// Barriers and atomics of a workgroup.
const GROUP_STEP: u32 = 4u;
// Nodes and triangles of a hierarchy.
const NODE_STEP: u32 = 5u;
const TRIANGLE_STEP: u32 = 6u;

fn start_rounds(lane: u32) {
}

fn begin_round() {
}

fn count_step(kind: u32) {
}

fn store_rounds() {
}
