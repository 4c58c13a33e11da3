fn far(span: Interval) -> f32 {
    return span.far;
}

@fragment fn fragment() -> @location(0) f32 {
    return far(Interval(1.0, 2.0));
}
