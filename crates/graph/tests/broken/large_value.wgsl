var<storage, read_write> items: array<u32>;
@compute @workgroup_size(64) fn main(@builtin(local_invocation_index) i: u32) {
    let zeros = array<u32, 100000>();
    items[0] = zeros[items[1]];
}
