//! Expands one method into several settings: `crsm@n=1,depth=plane` beside `crsm`,
//! `--set radius=1,2,4`, `--set bias=0..0.01/5`.
//!
//! ```
//! use skiagraph_compare::graphs::{argument::MethodArgument, preset, variants::settings};
//! use skiagraph_passes::EmbeddedSources;
//!
//! let presets = preset::load_all(&["nsm".into()], &EmbeddedSources)?;
//! let nsm = MethodArgument::new("nsm@cull=none,front");
//! let settings = settings(&presets[0], &nsm, &["bias=0..0.01/3".parse()?])?;
//! assert_eq!(settings.len(), 6);
//! assert_eq!(settings[0].set[0].value, "none");
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

use crate::error::{CompareError, Result};
use crate::graphs::argument::{Assignment, MethodArgument};
use crate::graphs::preset::Preset;
use crate::lists::unique;
use crate::wording::unknown;
use itertools::Itertools;
use skiagraph_graph::ParamType;

/// Name of the param with the width and height of the shadow map in texels, which `--map-size`
/// sets.
pub const MAP_SIZE: &str = "map_size";

/// Most values of one param; who asks for more has written something else than was meant.
const MOST: usize = 1000;

/// Returns the names in [`MethodArgument::preset`], each once, in the order of the arguments.
pub fn presets(arguments: &[MethodArgument]) -> Vec<String> {
    unique(arguments.iter().map(|argument| argument.preset.clone()))
}

/// One setting of a preset: the assignments to its params, and a label.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Setting {
    /// Text that the method's name has behind the preset's: the assignments of the method's own
    /// word, and those for all methods that list several values, without the map size:
    /// `n=1,depth=plane`. Empty if there are none.
    pub label: String,
    /// All assignments of the setting, each with a single value.
    pub set: Vec<Assignment>,
}

/// Returns the settings of a preset: one for each combination of the values that its assignments in
/// `argument` and those for all methods in `shared` list. Values of a list stand between commas,
/// vectors between semicolons (`1,0,0;0,1,0`); the range `0..0.01/5` is five values at equal
/// distances, both ends included. An assignment of `argument` wins over one of `shared`.
/// Assignments of `shared` to params that the preset does not have are ignored.
///
/// # Errors
/// A param of `argument` that the preset does not have; a malformed range; more than 1000 settings.
pub fn settings(
    preset: &Preset,
    argument: &MethodArgument,
    shared: &[Assignment],
) -> Result<Vec<Setting>> {
    let mut settings = vec![Setting::default()];
    let is_own = |name: &str| argument.own.iter().any(|own| own.name == name);
    let inherited = shared.iter().filter(|set| !is_own(&set.name));
    let inherited = inherited.filter(|set| preset.param(&set.name).is_some());
    let own = argument.own.iter().map(|set| (set, true));
    for (assignment, is_own) in own.chain(inherited.map(|set| (set, false))) {
        let name = &assignment.name;
        let Some(param) = preset.param(name) else {
            let what = format!("`{}` has no param `{name}`", preset.name);
            let text = unknown(&what, name, "params", preset.settable());
            return Err(CompareError::Input(text));
        };
        let values = values(assignment, &param.ty)?;
        let is_told = is_own || values.len() > 1;
        let with = |(setting, value): (&Setting, &String)| {
            let mut setting = setting.clone();
            // The map's size has a column of its own.
            if is_told && name != MAP_SIZE {
                let comma = if setting.label.is_empty() { "" } else { "," };
                setting.label += &format!("{comma}{name}={value}");
            }
            let (name, value) = (name.clone(), value.clone());
            setting.set.push(Assignment { name, value });
            setting
        };
        let pairs = settings.iter().cartesian_product(&values);
        settings = pairs.map(with).collect();
        if settings.len() > MOST {
            return Err(CompareError::Input(format!(
                "`{}` would run in {} settings; {MOST} are the most",
                preset.name,
                settings.len()
            )));
        }
    }
    Ok(settings)
}

/// The values of a list, `1,2,4`, or of a range, `0..0.01/5`: so many, evenly, both ends included.
/// Those of a vector stand between semicolons, as its own numbers do between commas.
fn values(assignment: &Assignment, ty: &ParamType) -> Result<Vec<String>> {
    let text = &assignment.value;
    let is_vector = matches!(ty, ParamType::Vec2 | ParamType::Vec3 | ParamType::Vec4);
    if let (Some((ends, count)), false) = (text.rsplit_once('/'), is_vector)
        && let Some((from, to)) = ends.split_once("..")
    {
        return range(from, to, count, ty).ok_or_else(|| {
            CompareError::Request(format!(
                "{}={text}: expected FROM..TO/COUNT, two numbers and how many values there are \
                 between them, 2 to {MOST}, both ends included, for example 0..0.01/5",
                assignment.name
            ))
        });
    }
    let between = if is_vector { ';' } else { ',' };
    let values = text.split(between).map(|value| value.trim().to_owned());
    Ok(unique(values))
}

fn range(from: &str, to: &str, count: &str, ty: &ParamType) -> Option<Vec<String>> {
    let number = |text: &str| text.trim().parse::<f64>().ok().filter(|n| n.is_finite());
    let (from, to) = (number(from)?, number(to)?);
    let count: usize = count.trim().parse().ok()?;
    if !(2..=MOST).contains(&count) {
        return None;
    }
    let whole = matches!(ty, ParamType::I32 | ParamType::U32);
    let value = |index: usize| {
        let share = index as f64 / (count - 1) as f64;
        let value = from * (1.0 - share) + to * share;
        if whole {
            format!("{}", value.round())
        } else {
            // As short as f32 allows: sums of tenths have a tail.
            format!("{}", value as f32)
        }
    };
    Some(unique((0..count).map(value)))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::graphs::preset::load_all;

    fn set(text: &str) -> Assignment {
        text.parse().unwrap()
    }

    fn labels(word: &str, shared: &[&str]) -> Result<Vec<String>, String> {
        let argument = MethodArgument::new(word);
        let names = [argument.preset.clone()];
        let presets = load_all(&names, &skiagraph_passes::EmbeddedSources).unwrap();
        let shared: Vec<Assignment> = shared.iter().map(|text| set(text)).collect();
        let settings = settings(&presets[0], &argument, &shared);
        let settings = settings.map_err(|error| error.to_string())?;
        Ok(settings.into_iter().map(|setting| setting.label).collect())
    }

    #[test]
    fn lists_and_ranges_are_settings_each_with_a_label() {
        assert_eq!(labels("crsm", &[]).unwrap(), [""]);
        // One value for all is nothing that tells rows apart.
        assert_eq!(labels("crsm", &["n=1"]).unwrap(), [""]);
        assert_eq!(labels("crsm@n=1", &["n=2,3"]).unwrap(), ["n=1"]);
        assert_eq!(
            labels("crsm", &["n=0.51,1", "cull=front,none"]).unwrap(),
            [
                "n=0.51,cull=front",
                "n=0.51,cull=none",
                "n=1,cull=front",
                "n=1,cull=none"
            ]
        );
        assert_eq!(
            labels("crsm", &["n=0.5..1.5/3"]).unwrap(),
            ["n=0.5", "n=1", "n=1.5"]
        );
        assert_eq!(labels("nsm", &["map_size=64,128"]).unwrap(), ["", ""]);
        assert_eq!(
            labels("rt", &["n=1,2"]).unwrap(),
            [""],
            "rt has no such param"
        );
    }

    #[test]
    fn what_is_no_range_and_no_param_says_what_was_expected() {
        let error = labels("crsm", &["n=0..1/1"]).unwrap_err();
        assert!(error.contains("expected FROM..TO/COUNT"), "{error}");
        let error = labels("crsm@deph=plane", &[]).unwrap_err();
        assert!(error.contains("did you mean `depth`?"), "{error}");
        let error = labels("crsm", &["n=0..1/1000", "cull=front,none"]).unwrap_err();
        assert!(error.contains("2000 settings"), "{error}");
    }
}
