var<workgroup> shared_sum: f32;

@fragment fn fragment() -> @location(0) f32 {
    workgroupBarrier();
    return shared_sum;
}
