var<storage, read_write> items: array<u32>;
fn count(i: u32) -> u32 {
    var stack: array<u32, 4000>;
    stack[i] = i;
    return stack[items[1]];
}
@compute @workgroup_size(64) fn main(@builtin(local_invocation_index) i: u32) {
    if i == 3u {
        items[0] = count(i);
    }
}
