// A module with a type error in line 3.
fn good() -> f32 { return 1.0; }
fn bad() -> f32 { return 1u; }
