// Stage to show a mistake in the second of two imports.
#import "shared/camera.wgsl"
#import "shared/unparsable.wgsl"

@fragment fn fragment() -> @location(0) f32 {
    return focal() + bad();
}
