struct Answer {
    @location(0) image: f32,
    @location(1) status: f32,
}

@fragment fn fragment() -> Answer {
    return Answer(1.0, 2.0);
}
