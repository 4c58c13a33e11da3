//! Finds which pixels methods guarantee to be right, and the casters for which the guarantees hold.
//!
//! ```
//! use skiagraph_compare::{
//!     graphs::shadow_method::load_methods,
//!     measuring::guarantee::{find, without_culling},
//!     records::stress::Guarantee,
//! };
//! use skiagraph_passes::EmbeddedSources;
//!
//! let methods = load_methods(&["light_buffer", "nsm"], &[], &[], &EmbeddedSources)?;
//! let (guarantee, because) = find(&methods[0], &[])?.ok_or("the document claims it")?;
//! println!("{because}");
//! assert_eq!(guarantee, Guarantee::Exact);
//! assert!(find(&methods[1], &[])?.is_none());
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

use crate::error::{CompareError, Result};
use crate::graphs::faults::reasons;
use crate::graphs::method::Method;
use crate::records::results::Promise;
use crate::records::stress::Guarantee;
use crate::wording::did_you_mean;

/// Claims that a document may make of its method, the stronger one first. Graphs know no shadows;
/// the meaning of the words is said here, and judged by `stress`.
const CLAIMS: [Guarantee; 2] = [Guarantee::Exact, Guarantee::Certain];

/// Finds the strongest guarantee that a method's document claims under the method's params, and the
/// reason that it gives; `None` if it claims none. `exact` is a list of names of methods or
/// presets: a method in it counts as guaranteed to be exact, whatever its document claims.
///
/// # Errors
/// A claim that is not a [`Guarantee`], or whose condition cannot be evaluated.
pub fn find(method: &Method, exact: &[String]) -> Result<Option<(Guarantee, String)>> {
    let preset = &method.preset;
    if exact.contains(&method.name) || exact.contains(&preset.name) {
        return Ok(Some((Guarantee::Exact, "asked for".into())));
    }
    let (viewport, features) = (method.viewport, method.features);
    let claims = preset.graph.claims(&method.params, viewport, features);
    let claims = claims.map_err(|faults| CompareError::Input(reasons(faults.iter())))?;
    let words = CLAIMS.map(Guarantee::word);
    let mut each = claims.iter();
    if let Some(unknown) = each.find(|it| !words.contains(&it.name.as_str())) {
        let (preset, name) = (&preset.name, &unknown.name);
        let (hint, words) = (did_you_mean(name, words.into_iter()), words.join(" or "));
        return Err(CompareError::Input(format!(
            "`{preset}` claims `{name}`, which is an unknown guarantee{hint}\n  a document claims \
             {words}"
        )));
    }
    let holds = |guarantee: Guarantee| {
        let mut held = claims.iter().filter(|claim| claim.holds);
        let claim = held.find(|claim| claim.name == guarantee.word())?;
        Some((guarantee, claim.because.clone()))
    };
    Ok(CLAIMS.into_iter().find_map(holds))
}

/// The param that says which faces cast no shadow.
pub(super) const CULL: &str = "cull";
/// Its value with which all do.
pub(super) const NONE: &str = "none";
/// Assignment of the param `cull` with which front and back faces cast shadows.
pub const WITHOUT_CULLING: &str = "cull=none";

/// Returns the method with `cull=none`, so that front and back faces cast shadows; `None` if they
/// do so already, or if it has no param `cull`. A method that culls guarantees nothing for open
/// casters: a sheet whose culled side faces the light would cast no shadow.
pub fn without_culling(method: &Method) -> Option<Method> {
    let none = method.preset.graph.parse_param(CULL, NONE).ok()?;
    if method.all_params().get(CULL)? == NONE {
        return None;
    }
    let mut params = method.params.clone();
    params.insert(CULL.into(), none);
    Some(method.with(params))
}

/// Returns the guarantee that a method's document claims under the method's params, in the form for
/// results; `None` if the document claims none, or one that is not a [`Guarantee`].
pub fn promise(method: &Method) -> Option<Promise> {
    let (guarantee, _) = find(method, &[]).ok()??;
    Some(Promise {
        of: guarantee.word().into(),
        closed_only: without_culling(method).is_some(),
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::graphs::argument::Assignment;
    use crate::graphs::method::param_values;
    use crate::graphs::preset::{self, Preset};
    use crate::sink::Silent;
    use std::sync::Arc;

    fn presets() -> Vec<Arc<Preset>> {
        let built_in = skiagraph_passes::presets().into_iter();
        let names: Vec<String> = built_in.map(|preset| preset.name).collect();
        preset::load_all(&names, &skiagraph_passes::EmbeddedSources).unwrap()
    }

    fn method(presets: &[Arc<Preset>], name: &str, set: &str) -> Method {
        let preset = presets.iter().find(|preset| preset.name == name).unwrap();
        let set: Vec<Assignment> = set
            .split_whitespace()
            .map(|set| set.parse().unwrap())
            .collect();
        Method::new(preset.clone(), param_values(preset, &set, None).unwrap())
    }

    #[test]
    fn a_guarantee_ends_where_its_proof_does() {
        let presets = presets();
        for (name, set, guaranteed) in [
            ("crsm", "n=0.51", true),
            ("crsm", "n=0.5", false),
            ("crsm", "depth=plane", false),
            ("crsma_full", "map_size=7 cull=back", true),
            ("crsm_single", "n=0.2", false),
            ("rt", "", true),
            ("crsm_depth", "", true),
            ("crsm_single", "", true),
            ("crsma", "", false),
            ("crsm_hw", "", false),
            ("nsm", "", false),
        ] {
            let method = method(&presets, name, set);
            let claim = find(&method, &[]).unwrap();
            assert_eq!(claim.is_some(), guaranteed, "{name} {set}");
            let word = claim.map(|(guarantee, _)| guarantee.word());
            assert!(word.is_none_or(|word| (word == "certain") == (name == "crsm_single")));
            let asked = find(&method, &[name.into()]).unwrap();
            assert_eq!(
                asked.map(|(guarantee, _)| guarantee),
                Some(Guarantee::Exact)
            );
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
                assert!(find(&other, &[]).unwrap().is_some());
            }
        }
    }

    #[test]
    fn a_claim_that_nobody_judges_is_an_error_with_the_nearest_word() {
        let folder = tempfile::tempdir().unwrap();
        let file = folder.path().join("claims.ron");
        let text = "(format: 3, extends: \"rt.ron\", claims: {\"exakt\": (because: \"\")})";
        std::fs::write(&file, text).unwrap();
        let name = file.to_str().unwrap().to_owned();
        let presets = preset::load_all(&[name], &preset::sources(&Silent)).unwrap();
        let method = Method::new(presets[0].clone(), Default::default());
        let message = find(&method, &[]).unwrap_err().to_string();
        assert!(message.contains("claims `exakt`"), "{message}");
        assert!(message.contains("did you mean `exact`?"), "{message}");
    }
}
