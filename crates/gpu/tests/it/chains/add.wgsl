// Stage to add up the last buffer of a chain.
var<storage, read> input: array<u32>;
var<storage, read_write> out: array<u32>;

@compute @workgroup_size(1) fn main() {
    var sum = 0u;
    for (var i = 0u; i < arrayLength(&input); i++) {
        sum = sum * 31u + input[i];
    }
    out[0] = sum;
}
