var<private> table: array<u32, 100000>;
var<storage, read_write> items: array<u32>;
@compute @workgroup_size(64) fn main(@builtin(local_invocation_index) i: u32) {
    table[i] = i;
    items[0] = table[items[1]];
}
