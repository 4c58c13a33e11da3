// In the place of shared/steps.wgsl: sums up what a GPU does that runs 32 threads in step, as many
// steps of each kind in each round of an outer loop as the thread with most.

const TILE_STEP: u32 = 0u;
const TEXEL_STEP: u32 = 1u;
const ENTRY_STEP: u32 = 2u;
const PART_STEP: u32 = 3u;
const GROUP_STEP: u32 = 4u;
const NODE_STEP: u32 = 5u;
const TRIANGLE_STEP: u32 = 6u;
const KINDS: u32 = 7u;
const ROUNDS: u32 = 128u;

// Steps of the warp with most; of all warps; rounds that were too many to count.
struct Rounds {
    slowest: atomic<u32>,
    sum: atomic<u32>,
    lost: atomic<u32>,
}

var<storage, read_write> rounds: Rounds;
var<private> own_round: u32 = 0u;
var<private> steps: array<u32, 7>;
var<private> own_lane: u32 = 0u;
var<workgroup> most: array<atomic<u32>, 1792>;

fn flush() {
    if own_round >= ROUNDS {
        atomicAdd(&rounds.lost, 1u);
        return;
    }
    for (var kind = 0u; kind < KINDS; kind++) {
        atomicMax(&most[((own_lane / 32u) * ROUNDS + own_round) * KINDS + kind], steps[kind]);
        steps[kind] = 0u;
    }
}

fn start_rounds(lane: u32) {
    own_lane = lane;
}

fn begin_round() {
    flush();
    own_round += 1u;
}

fn count_step(kind: u32) {
    steps[kind] += 1u;
}

fn store_rounds() {
    flush();
    workgroupBarrier();
    if own_lane % 32u == 0u {
        var total = 0u;
        for (var item = 0u; item < ROUNDS * KINDS; item++) {
            total += atomicLoad(&most[(own_lane / 32u) * ROUNDS * KINDS + item]);
        }
        atomicMax(&rounds.slowest, total);
        atomicAdd(&rounds.sum, total);
    }
}
