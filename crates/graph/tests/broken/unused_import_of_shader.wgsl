// Stage to write a number that the camera has nothing to do with.
#import "shared/camera.wgsl"
@fragment fn fragment() -> @location(0) f32 {
    return 1.0; // and no focal() of it
}
