var<storage, read_write> items: array<u32>;
fn f0(i: u32) -> u32 {
    var stack: array<u32, 2000>;
    stack[i] = i;
    return stack[items[1]];
}
fn f1(i: u32) -> u32 {
    var stack: array<u32, 2000>;
    stack[i] = i;
    return stack[items[1]];
}
fn f2(i: u32) -> u32 {
    var stack: array<u32, 2000>;
    stack[i] = i;
    return stack[items[1]];
}
fn f3(i: u32) -> u32 {
    var stack: array<u32, 2000>;
    stack[i] = i;
    return stack[items[1]];
}
fn f4(i: u32) -> u32 {
    var stack: array<u32, 2000>;
    stack[i] = i;
    return stack[items[1]];
}
fn f5(i: u32) -> u32 {
    var stack: array<u32, 2000>;
    stack[i] = i;
    return stack[items[1]];
}
fn f6(i: u32) -> u32 {
    var stack: array<u32, 2000>;
    stack[i] = i;
    return stack[items[1]];
}
fn f7(i: u32) -> u32 {
    var stack: array<u32, 2000>;
    stack[i] = i;
    return stack[items[1]];
}
fn f8(i: u32) -> u32 {
    var stack: array<u32, 2000>;
    stack[i] = i;
    return stack[items[1]];
}
@compute @workgroup_size(64) fn main(@builtin(local_invocation_index) i: u32) {
    items[0] = f0(i);
    items[1] = f1(i);
    items[2] = f2(i);
    items[3] = f3(i);
    items[0] = f4(i);
    items[1] = f5(i);
    items[2] = f6(i);
    items[3] = f7(i);
    items[0] = f8(i);
}
