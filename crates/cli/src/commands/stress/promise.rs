//! What methods promise, and on which casters a promise holds.

use crate::measure::Method;
use serde::Serialize;
use serde_json::Value;
use skiagraph_graph::ParamValue;
use std::collections::BTreeMap;

/// Which pixels must be right, outside the band.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Promise {
    /// Those of the final picture.
    Exact,
    /// Those that the method calls certain.
    Certain,
}

impl Promise {
    /// As headers have it.
    pub fn word(self) -> &'static str {
        match self {
            Self::Exact => "exact",
            Self::Certain => "certain",
        }
    }
}

/// What a built-in preset promises. Graphs know no shadows, so a document cannot say it itself.
struct Claim {
    preset: &'static str,
    promise: Promise,
    /// Whether it holds with these params.
    holds: fn(&BTreeMap<String, Value>) -> bool,
    reason: &'static str,
}

/// docs/methods.md derives each. Of `crsm_hw` nothing is proven: what snaps, and what has no area then, is the rasteriser's affair.
const CLAIMS: [Claim; 5] = [
    Claim {
        preset: "rt",
        promise: Promise::Exact,
        holds: |_| true,
        reason: "a watertight ray from every pixel, its own primitive excluded by id",
    },
    Claim {
        preset: "crsm",
        promise: Promise::Exact,
        holds: bounds,
        reason: "both layers bound the casters over all of a texel; where they disagree a ray decides",
    },
    Claim {
        preset: "crsm_depth",
        promise: Promise::Exact,
        holds: bounds,
        reason: "crsm, rays end where a third layer knows the texel to be empty",
    },
    Claim {
        preset: "crsm_single",
        promise: Promise::Certain,
        holds: bounds,
        reason: "crsm's layers; an uncertain pixel asks one triangle only, which may be the wrong one",
    },
    Claim {
        preset: "crsma_full",
        promise: Promise::Exact,
        holds: bounds,
        reason: "crsm, and what is called covered is covered by the whole one-ring",
    },
];

/// The layers bound all of a texel: it lies within √2/2 of its centre, half a diagonal, and a hair for rounding (docs/precision.md: in maps
/// of up to 12,000 texels, more than the presets allow).
fn bounds(params: &BTreeMap<String, Value>) -> bool {
    let n = params.get("n").and_then(Value::as_f64);
    params
        .get("depth")
        .is_some_and(|depth| depth == "conservative")
        && n.is_some_and(|n| n >= 0.51)
}

/// What a method promises with its params, and why; `exact` are the names of those that the user wants judged.
pub fn of(method: &Method, exact: &[String]) -> Option<(Promise, &'static str)> {
    let name = &method.preset.name;
    if exact.contains(name) {
        return Some((Promise::Exact, "--exact"));
    }
    let claim = CLAIMS.iter().find(|claim| claim.preset == name)?;
    (claim.holds)(&method.all_params()).then_some((claim.promise, claim.reason))
}

/// The param that says which faces cast no shadow.
const CULL: &str = "cull";
/// Its value with which all do.
const NONE: &str = "none";
/// Both, as `--set` takes them.
pub const WITHOUT_CULLING: &str = "cull=none";

/// The same method with all faces as casters; `None` where it is that one already. A method that culls promises nothing of open casters:
/// a sheet whose front faces the light would cast no shadow.
pub fn without_culling<'a>(method: &Method<'a>) -> Option<Method<'a>> {
    let none = method.preset.graph.parse_param(CULL, NONE).ok()?;
    if method
        .all_params()
        .get(CULL)
        .is_some_and(|cull| cull == NONE)
    {
        return None;
    }
    let mut params: BTreeMap<String, ParamValue> = method.params.clone();
    params.insert(CULL.into(), none);
    Some(Method::new(method.preset, params))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{
        parse::Assignment,
        preset::{self, Preset},
    };

    fn presets() -> Vec<Preset> {
        let built_in = skiagraph_passes::presets().into_iter();
        let names: Vec<String> = built_in.map(|preset| preset.name).collect();
        preset::load_all(&names, &skiagraph_passes::EmbeddedSources).unwrap()
    }

    fn method<'a>(presets: &'a [Preset], name: &str, set: &str) -> Method<'a> {
        let preset = presets.iter().find(|preset| preset.name == name).unwrap();
        let set: Vec<Assignment> = set
            .split_whitespace()
            .map(|set| set.parse().unwrap())
            .collect();
        Method::new(preset, preset::params(preset, &set, None).unwrap())
    }

    #[test]
    fn every_claim_is_of_a_preset_and_holds_of_it_as_it_is() {
        let presets = presets();
        for claim in &CLAIMS {
            let method = method(&presets, claim.preset, "");
            assert_eq!(of(&method, &[]), Some((claim.promise, claim.reason)));
        }
    }

    #[test]
    fn a_claim_ends_where_its_proof_does() {
        let presets = presets();
        for (name, set, promised) in [
            ("crsm", "n=0.51", true),
            ("crsm", "n=0.5", false),
            ("crsm", "depth=plane", false),
            ("crsma_full", "map_size=7 cull=back", true),
            ("crsm_single", "n=0.2", false),
            ("crsma", "", false),
            ("crsm_hw", "", false),
            ("nsm", "", false),
        ] {
            let method = method(&presets, name, set);
            assert_eq!(of(&method, &[]).is_some(), promised, "{name} {set}");
            let asked = of(&method, &[name.into()]);
            assert_eq!(asked.map(|(promise, _)| promise), Some(Promise::Exact));
        }
    }

    #[test]
    fn only_a_method_that_culls_has_another_without_culling() {
        let presets = presets();
        for (name, set, culls) in [
            ("crsm", "", true),
            ("crsm", "cull=back", true),
            ("crsm", "cull=none", false),
            ("rt", "", false),
        ] {
            let method = method(&presets, name, set);
            let other = without_culling(&method);
            assert_eq!(other.is_some(), culls, "{name} {set}");
            if let Some(other) = other {
                let params = other.all_params();
                assert_eq!(params["cull"], "none");
                assert!(of(&other, &[]).is_some());
            }
        }
    }
}
