//! Defines cases of spot and point lights: their positions, and the borders of the space that they
//! light.

use crate::case::HardCase;
use crate::shape::{Block, Seen, Shape, seen_under};
use glam::DVec3;
use skiagraph_scene::{LightKind, PointLight, SpotLight};

const YARD: [Block; 4] = [
    [[-4.0, -0.5, -4.0], [4.0, 0.0, 4.0]],
    [[-1.0, 0.0, -0.7], [0.0, 0.7, 0.3]],
    [[0.9, 0.0, 0.4], [1.4, 1.1, 0.9]],
    [[-0.2, 0.0, 1.5], [0.6, 0.4, 1.9]],
];
const LAMP: DVec3 = DVec3::new(0.3, 2.5, 0.4);
/// In the middle of a lid, which it lights from within.
const WITHIN: DVec3 = DVec3::new(0.3, 2.5, 0.4);
const LID: Block = [[0.2, 2.4, 0.3], [0.4, 2.6, 0.5]];
const CEILING: Block = [[-2.0, 2.5, -2.0], [2.0, 2.75, 2.0]];
const BEHIND: DVec3 = DVec3::new(-2.5, 1.25, 0.2);
const SEAM: DVec3 = DVec3::new(0.0, 1.0, 0.0);
const NEAR_FLOOR: DVec3 = DVec3::new(0.4, 0.002, 0.6);
const STAR: DVec3 = DVec3::new(4.0e6, 6.0e6, -3.0e6);

const fn point(position: DVec3) -> LightKind {
    let radius = 0.0;
    LightKind::Point(PointLight { position, radius })
}

const fn spot(position: DVec3, to: DVec3, cone_degrees: f64) -> LightKind {
    LightKind::Spot(SpotLight {
        position,
        direction: DVec3::new(to.x - position.x, to.y - position.y, to.z - position.z),
        cone_degrees,
        radius: 0.0,
    })
}

const fn in_the_yard(light: LightKind) -> Seen {
    seen_under([2.7, 3.8, 3.5], [0.2, 0.1, 0.2], light)
}

const fn below_the_ceiling(light: LightKind) -> Seen {
    seen_under([2.9, 2.2, 3.5], [0.2, 0.3, 0.2], light)
}

pub(crate) const CASES: &[HardCase] = &[
    HardCase::boxes(
        "bulb_in_a_yard",
        "a point light between boxes: shadows spread, and every side of it has some",
        in_the_yard(point(LAMP)),
        &YARD,
    ),
    HardCase::boxes(
        "edge_of_the_cone",
        "a spot light whose cone ends in the picture: receivers on its edge, and casters",
        in_the_yard(spot(LAMP, DVec3::new(0.2, 0.0, 0.3), 80.0)),
        &YARD,
    ),
    HardCase::closed(
        "light_inside_a_mesh",
        "a light in the midst of a closed box: it lights nothing, whichever faces are culled",
        in_the_yard(point(WITHIN)),
        || Shape::default().cuboids(&YARD).cuboid(LID),
    ),
    HardCase::closed(
        "light_on_a_surface",
        "a light in the face of the ceiling that it hangs from: the face does not shade it",
        below_the_ceiling(point(LAMP)),
        || Shape::default().cuboids(&YARD).cuboid(CEILING),
    ),
    HardCase::closed(
        "spot_inside_a_mesh",
        "a spot light in the midst of a closed box, whose faces are before it and behind it",
        in_the_yard(spot(WITHIN, DVec3::new(0.2, 0.0, 0.3), 100.0)),
        || Shape::default().cuboids(&YARD).cuboid(LID),
    ),
    HardCase::closed(
        "spot_on_a_surface",
        "a spot light in the face of the ceiling that it hangs from, across its own plane",
        below_the_ceiling(spot(LAMP, DVec3::new(0.8, 0.0, 0.1), 140.0)),
        || Shape::default().cuboids(&YARD).cuboid(CEILING),
    ),
    HardCase::boxes(
        "seam_of_faces",
        "casters and receivers where the faces of a point light's cube meet, three at a corner",
        seen_under([0.3, 3.4, 2.4], [0.0, 0.0, 0.1], point(SEAM)),
        // Across the edges of the cube's face that looks down, and over a corner of it.
        &[
            [[-4.0, -0.5, -4.0], [4.0, 0.0, 4.0]],
            [[0.5, 0.0, -0.25], [1.0, 0.5, 0.25]],
            [[-0.25, 0.0, 0.5], [0.25, 0.75, 1.0]],
            [[-1.25, 0.0, -1.25], [-0.75, 0.5, -0.75]],
            [[-0.875, 0.125, 0.625], [-0.625, 0.375, 0.875]],
        ],
    ),
    HardCase::boxes(
        "across_the_lights_plane",
        "a beam from behind a spot light to before it: what is behind has no place in its map",
        seen_under(
            [1.5, 3.2, 4.0],
            [0.0, 0.1, 0.0],
            spot(BEHIND, DVec3::new(1.0, 0.0, 0.0), 120.0),
        ),
        // Crosses the plane across the axis of a spot light that looks along x, before the light
        // and behind it, beside the axis.
        &[
            [[-4.0, -0.5, -4.0], [4.0, 0.0, 4.0]],
            [[-3.5, 0.5, -0.5], [0.5, 0.7, -0.2]],
            [[0.5, 0.0, 0.6], [0.9, 0.6, 1.0]],
        ],
    ),
    HardCase::boxes(
        "light_at_the_floor",
        "a light a hair above the floor: every ray grazes it",
        in_the_yard(point(NEAR_FLOOR)),
        &YARD,
    )
    // The floor's own share of the light is a thousandth of what rounding leaves of it there.
    .indeterminate_up_to(0.05),
    HardCase::boxes(
        "light_a_million_away",
        "a spot light a million times the scene away, as good as directional",
        in_the_yard(spot(STAR, DVec3::ZERO, 30.0)),
        &YARD,
    ),
];

#[cfg(test)]
pub(crate) mod answers {
    use super::*;
    use crate::tests::Answer;
    use crate::tests::answer::among_at;

    /// Tells from the geometry where light arrives.
    pub(crate) const ANSWERS: &[Answer] = &[
        ("light_inside_a_mesh", |_| Some(false)),
        ("light_on_a_surface", |p| among_at(p, LAMP, &YARD, 1e-3)),
        ("spot_inside_a_mesh", |_| Some(false)),
        ("spot_on_a_surface", |p| among_at(p, LAMP, &YARD, 1e-3)),
    ];
}
