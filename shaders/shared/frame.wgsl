// The frame, as the host counts it.

struct Frame {
    // From 0 in the first frame.
    index: u32,
    // The time of what is shown.
    seconds: f32,
    // 1 if something of the scene has changed since the frame before, else 0.
    changed_scene: u32,
    // 1 if something of the light, or of another one of the scene, has changed.
    changed_light: u32,
    // 1 if something that stays from frame to frame is in new memory, and zero.
    fresh: u32,
}

var<uniform> frame: Frame;
