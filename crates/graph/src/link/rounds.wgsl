// Stages of a group that ends early: the arguments of its dispatches and draws are 0 in the rounds
// that do not run.

// 0 once no round runs any more.
var<storage, read> counter: u32;
// 1 if this round runs, else 0.
var<storage, read_write> goes: u32;
// Arguments that a pass of the document has written.
var<storage, read> asked: array<u32>;
var<storage, read_write> arguments: array<u32, 4>;

override x: u32 = 0;
override y: u32 = 0;
override z: u32 = 0;
override w: u32 = 0;

@compute @workgroup_size(1) fn begin() {
    goes = min(counter, 1u);
}

@compute @workgroup_size(1) fn direct() {
    let numbers = array(x, y, z, w);
    for (var i = 0u; i < 4u; i++) {
        arguments[i] = goes * numbers[i];
    }
}

@compute @workgroup_size(1) fn indirect() {
    let count = arrayLength(&asked);
    for (var i = 0u; i < 4u; i++) {
        arguments[i] = goes * select(0u, asked[min(i, count - 1u)], i < count);
    }
}
