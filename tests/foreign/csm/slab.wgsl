// The camera's view from the slab before up to `end`, as the light sees it.
struct Slab { @size(144) light: Light, @size(112) end: f32 }
