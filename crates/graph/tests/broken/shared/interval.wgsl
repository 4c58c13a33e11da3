struct Interval { near: f32, far: f32 }

fn brightness() -> f32 {
    return 0.5;
}
