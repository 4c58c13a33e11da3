//! Lists all cases.

use crate::{
    case::HardCase, fences, lamps, light, lists, map, masked, plain, rounding, soft, solids, thin,
    topology,
};

/// Returns all cases of the catalogue, in the order in which `skiagraph stress` lists them.
pub fn cases() -> Vec<HardCase> {
    [
        plain::CASES,
        rounding::CASES,
        light::CASES,
        lamps::CASES,
        map::CASES,
        lists::CASES,
        fences::CASES,
        thin::CASES,
        soft::CASES,
        solids::CASES,
        topology::CASES,
        masked::CASES,
    ]
    .concat()
}

/// Finds the case with this name. Returns `None` for an unknown name.
pub fn case(name: &str) -> Option<HardCase> {
    cases().into_iter().find(|case| case.name == name)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::case::Casters;
    use skiagraph_scene::{Mesh, Scene};
    use std::collections::{BTreeSet, HashMap};

    #[test]
    fn every_case_is_a_sound_scene_with_a_name_and_a_reason_of_its_own() {
        let mut names = BTreeSet::new();
        for case in cases() {
            assert!(names.insert(case.name), "{} twice", case.name);
            assert!(
                case.name
                    .chars()
                    .all(|c| c.is_ascii_lowercase() || c.is_ascii_digit() || c == '_'),
                "{}",
                case.name
            );
            assert!(
                !case.reason.is_empty() && !case.reason.contains('\n'),
                "{}",
                case.name
            );
            let Scene {
                name,
                mesh,
                views,
                lights,
            } = case.scene();
            assert_eq!(name, case.name);
            assert!(views.len() == 1 && views[0].name == "main", "{name}");
            assert!(lights.len() == 1, "{name}");
            assert_eq!(lights[0].check(), Ok(()), "{name}");
            assert!(mesh.positions.iter().all(|p| p.is_finite()), "{name}");
            let in_range = |index: &u32| (*index as usize) < mesh.positions.len();
            assert!(mesh.triangles.iter().flatten().all(in_range), "{name}");
            assert_eq!(mesh.triangles.len(), mesh.normal_indices.len(), "{name}");
            // One is about their number.
            let most = if name == "crowded_texel" {
                120_000
            } else {
                20_000
            };
            assert!(
                mesh.triangles.len() < most,
                "{name}: too large for a matrix that CI runs"
            );
        }
    }

    /// Every edge as often one way as the other, and every connected part wound outward.
    #[test]
    fn closed_casters_are_closed() {
        for case in cases().iter().filter(|c| c.casters == Casters::Closed) {
            let mesh = case.scene().mesh;
            let mut ways = HashMap::new();
            for &[a, b, c] in &mesh.triangles {
                for (from, to) in [(a, b), (b, c), (c, a)] {
                    let way = if from < to { 1 } else { -1 };
                    *ways.entry((from.min(to), from.max(to))).or_insert(0) += way;
                }
            }
            let open = ways.values().filter(|&&sum| sum != 0).count();
            assert_eq!(open, 0, "{}: open edges", case.name);
            for (part, volume) in volumes(&mesh) {
                assert!(
                    volume > 0.0,
                    "{}: the part of position {part} encloses {volume}",
                    case.name
                );
            }
        }
    }

    /// The volume within each set of triangles that hang together, by its lowest position.
    fn volumes(mesh: &Mesh) -> HashMap<u32, f64> {
        let mut parts: Vec<u32> = (0..mesh.positions.len() as u32).collect();
        loop {
            let before = parts.clone();
            for triangle in &mesh.triangles {
                let lowest = triangle.map(|i| parts[i as usize]).into_iter().min();
                triangle
                    .iter()
                    .for_each(|&i| parts[i as usize] = lowest.unwrap_or(i));
            }
            if parts == before {
                break;
            }
        }
        let mut volumes = HashMap::new();
        for (i, triangle) in mesh.triangles.iter().enumerate() {
            let part = parts[triangle[0] as usize];
            let origin = mesh.positions[part as usize].as_dvec3();
            let [a, b, c] = mesh.corners(i as u32).map(|corner| corner - origin);
            *volumes.entry(part).or_insert(0.0) += a.dot(b.cross(c));
        }
        volumes
    }
}
