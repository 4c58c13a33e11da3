// What the camera sees from the slab before up to `end`, as the light sees it.
struct Slab { @size(112) light: Light, @size(144) end: f32 }
