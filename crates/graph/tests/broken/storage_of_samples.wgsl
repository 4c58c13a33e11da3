var image: texture_storage_2d<r32float, write>;
@compute @workgroup_size(1) fn main() { textureStore(image, vec2u(), vec4f()); }
