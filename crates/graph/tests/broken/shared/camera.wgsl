// A good module.
fn focal() -> f32 {
    return 1.5;
}
