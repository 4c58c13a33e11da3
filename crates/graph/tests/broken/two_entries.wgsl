@fragment fn bright() -> @location(0) f32 {
    return 1.0;
}

@fragment fn dark() -> @location(0) f32 {
    return 0.0;
}
