// Stage to show an import that is not there.
#import "shared/camra.wgsl"

@fragment fn fragment() -> @location(0) f32 {
    return 1.0;
}
