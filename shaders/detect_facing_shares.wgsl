// Stage to leave every pixel that faces the light to the samples, and to decide all others, as
// detect_facing.wgsl does, where visibility is a share of the light.

#import "shared/answer_shares.wgsl" instead "shared/answer.wgsl"
#import "detect_facing.wgsl"
