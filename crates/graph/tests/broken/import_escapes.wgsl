#import "../secrets.wgsl"

@fragment fn fragment() -> @location(0) f32 {
    return 1.0;
}
