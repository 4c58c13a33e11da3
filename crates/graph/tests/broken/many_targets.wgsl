struct Outputs {
    @location(0) part0: f32,
    @location(1) part1: f32,
    @location(2) part2: f32,
    @location(3) part3: f32,
    @location(4) part4: f32,
    @location(5) part5: f32,
    @location(6) part6: f32,
    @location(7) part7: f32,
    @location(8) part8: f32,
}

@fragment fn fragment() -> Outputs {
    return Outputs(0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0);
}
