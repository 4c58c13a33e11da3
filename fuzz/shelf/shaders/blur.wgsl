struct Params { factor: f32 }
var<uniform> params: Params;
var image: texture_2d<f32>;
var nearest: sampler;
@fragment fn fragment(@builtin(position) place: vec4<f32>) -> @location(0) vec4<f32> {
    return params.factor * textureSampleLevel(image, nearest, place.xy, 0.0);
}
