//! Overlap and coverage of parts of a resource.

use crate::resource::{Resource, ResourceKind, SubresourceRange};
use std::ops::Range;

/// Returns the overlap of two parts, in the aspect of the second; `None` if they do not overlap.
pub(super) fn within(
    part: &SubresourceRange,
    asked: &SubresourceRange,
) -> Option<SubresourceRange> {
    let common = |a: &Range<u32>, b: &Range<u32>| a.start.max(b.start)..a.end.min(b.end);
    part.overlaps(asked).then(|| SubresourceRange {
        mips: common(&part.mips, &asked.mips),
        layers: common(&part.layers, &asked.layers),
        aspect: asked.aspect,
    })
}

/// True if `parts` together cover all of `whole`.
pub(super) fn fully_overwrites(
    parts: &[SubresourceRange],
    whole: &SubresourceRange,
    resource: &Resource,
) -> bool {
    whole.mips.clone().all(|mip| {
        let parts = parts.iter().filter(|part| part.mips.contains(&mip));
        let mut layers: Vec<&Range<u32>> = parts.map(|part| &part.layers).collect();
        layers.sort_by_key(|layers| layers.start);
        // Slices of a 3D texture become fewer.
        let end = match &resource.kind {
            ResourceKind::Texture(texture) => whole.layers.end.min(texture.mip_layers(mip)),
            _ => whole.layers.end,
        };
        let reach = |reached: u32, layers: &Range<u32>| {
            if layers.start <= reached {
                reached.max(layers.end)
            } else {
                reached
            }
        };
        layers.into_iter().fold(whole.layers.start, reach) >= end
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::resource::{Buffer, Origin, Texture};

    fn part(mips: Range<u32>, layers: Range<u32>) -> SubresourceRange {
        SubresourceRange {
            mips,
            layers,
            aspect: wgt::TextureAspect::All,
        }
    }

    fn resource(kind: ResourceKind) -> Resource {
        Resource {
            name: "x".into(),
            declared: None,
            kind,
            origin: Origin::Own,
            growth: None,
            keep: false,
        }
    }

    fn texture(is_3d: bool) -> Resource {
        resource(ResourceKind::Texture(Texture {
            format: wgt::TextureFormat::R8Unorm,
            size: [8, 8],
            layers: 4,
            is_3d,
            mips: 3,
            samples: 1,
            picture: None,
        }))
    }

    #[test]
    fn parts_cover_a_whole_if_nothing_is_left_between_them() {
        let array = texture(false);
        let whole = part(0..2, 0..4);
        let rows = [part(0..2, 2..4), part(0..2, 0..1), part(0..1, 1..2)];
        assert!(!fully_overwrites(&rows, &whole, &array), "layer 1 of mip 1");
        let rest = [&rows[..], &[part(1..2, 1..3)]].concat();
        assert!(fully_overwrites(&rest, &whole, &array));
        assert!(!fully_overwrites(&[], &whole, &array));
        assert!(fully_overwrites(&rows, &part(0..1, 0..4), &array));
    }

    #[test]
    fn slices_become_fewer_and_items_end_where_the_buffer_does() {
        let mips = [part(0..1, 0..4), part(1..2, 0..2), part(2..3, 0..1)];
        assert!(fully_overwrites(&mips, &part(0..3, 0..4), &texture(true)));
        assert!(!fully_overwrites(&mips, &part(0..3, 0..4), &texture(false)));
        let buffer = resource(ResourceKind::Buffer(Buffer::default()));
        let items = [part(0..1, 0..2), part(0..1, 2..5)];
        assert!(fully_overwrites(&items, &part(0..1, 0..5), &buffer));
        assert!(!fully_overwrites(&items, &SubresourceRange::WHOLE, &buffer));
    }

    #[test]
    fn what_two_parts_share_is_of_the_asked_aspect() {
        let stencil = SubresourceRange {
            aspect: wgt::TextureAspect::StencilOnly,
            ..part(0..1, 0..4)
        };
        let depth = SubresourceRange {
            aspect: wgt::TextureAspect::DepthOnly,
            ..part(0..2, 1..2)
        };
        assert_eq!(within(&stencil, &depth), None);
        let shared = within(&part(0..1, 0..9), &depth).unwrap();
        assert_eq!((shared.mips, shared.layers), (0..1, 1..2));
        assert_eq!(shared.aspect, wgt::TextureAspect::DepthOnly);
        assert_eq!(within(&part(0..1, 2..4), &depth), None);
    }
}
