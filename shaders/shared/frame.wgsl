// The frame, as whoever runs the graph counts it.

struct Frame {
    // From 0 in the first frame.
    index: u32,
    // The time of what is shown.
    seconds: f32,
}

var<uniform> frame: Frame;
