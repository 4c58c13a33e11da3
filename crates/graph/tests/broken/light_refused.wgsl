struct Light { way: array<vec4<f32>, 16> }
var<uniform> lights_lamp: Light;

@fragment fn fragment() -> @location(0) f32 {
    return lights_lamp.way[0].x;
}
