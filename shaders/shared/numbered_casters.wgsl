// Casters by their numbers: `corner_position` counts the corners of casters, for a stage without
// room for a list of them beside the indices. `shared/listed_corners.wgsl` stands in for this where
// some triangle casts no shadow.

#import "shared/all_cast.wgsl"
