// Stage to write two numbers.
struct Two {
    @location(0) image: f32,
    @location(1) other: f32,
}

@fragment fn fragment() -> Two {
    return Two(0.25, 0.5);
}
