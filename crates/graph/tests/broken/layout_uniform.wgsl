struct Camera { view: mat4x4<f32>, projection: mat4x4<f32> }
var<uniform> camera: Camera;

@fragment fn fragment(@builtin(position) position: vec4<f32>) -> @location(0) f32 {
    return camera.projection[0].x;
}
