//! One method in several settings: `crsm@n=1,depth=plane` beside `crsm`, `--set radius=1,2,4`,
//! `--set bias=0..0.01/5`.

use crate::args::values::Assignment;
use crate::error::CliError;
use crate::graphs::preset::Preset;
use crate::wording::did_you_mean;
use skiagraph_graph::ParamType;
use std::path::Path;

/// The param that `--map-size` sets.
pub const MAP_SIZE: &str = "map_size";

/// Most values of one param; who asks for more has written something else than was meant.
const MOST: usize = 1000;

/// `PRESET[@PARAM=VALUE,…]`: a method as it is named on the command line.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct MethodArgument {
    /// The preset's name, or the graph's path.
    pub preset: String,
    /// What is set of this one alone.
    pub own: Vec<Assignment>,
}

impl MethodArgument {
    /// Of a word of the command line. A comma also stands in the values of vectors, so that what
    /// has no `=` belongs to the value before it.
    pub fn new(word: &str) -> Self {
        // Folders have any name.
        let split = word.split_once('@').filter(|_| !Path::new(word).is_file());
        let Some((preset, own)) = split.filter(|(name, own)| !name.is_empty() && own.contains('='))
        else {
            return Self {
                preset: word.to_owned(),
                own: Vec::new(),
            };
        };
        let mut assignments: Vec<Assignment> = Vec::new();
        for part in own.split(',') {
            match (part.parse::<Assignment>(), assignments.last_mut()) {
                (Ok(assignment), _) => assignments.push(assignment),
                (Err(_), Some(last)) => last.value += &format!(",{part}"),
                (Err(_), None) => assignments.push(Assignment {
                    name: part.to_owned(),
                    value: String::new(),
                }),
            }
        }
        Self {
            preset: preset.to_owned(),
            own: assignments,
        }
    }
}

/// Presets that arguments name, each once.
pub fn presets(arguments: &[MethodArgument]) -> Vec<String> {
    let names = arguments.iter().map(|argument| argument.preset.clone());
    crate::args::values::unique(&names.collect::<Vec<_>>())
}

/// A setting of a preset: what tells it from the preset's others, `n=1,depth=plane`, and all that
/// is set.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Setting {
    /// Empty where there is only one.
    pub label: String,
    /// Names and values.
    pub set: Vec<(String, String)>,
}

/// The settings of a preset: what is set of it alone wins over what is set of all, and of each list
/// of values every one, with every one of the other lists.
///
/// # Errors
/// A param that the preset does not have, a range that is none.
pub fn settings(
    preset: &Preset,
    argument: &MethodArgument,
    all: &[Assignment],
) -> Result<Vec<Setting>, CliError> {
    let mut settings = vec![Setting::default()];
    let is_own = |name: &str| argument.own.iter().any(|own| own.name == name);
    let others = all
        .iter()
        .filter(|set| !is_own(&set.name) && preset.param(&set.name).is_some());
    let own = argument.own.iter().map(|set| (set, true));
    for (assignment, is_own) in own.chain(others.map(|set| (set, false))) {
        let name = &assignment.name;
        let Some(param) = preset.param(name) else {
            let known: Vec<&str> = preset.settable().collect();
            let hint = did_you_mean(name, known.iter().copied());
            return Err(CliError::Input(format!(
                "`{}` has no param `{name}`{hint}\n  params: {}",
                preset.name,
                known.join(", ")
            )));
        };
        let values = values(assignment, &param.ty)?;
        let is_told = is_own || values.len() > 1;
        let with = |setting: &Setting, value: &String| {
            let mut setting = setting.clone();
            setting.set.push((name.clone(), value.clone()));
            // The map's size has a column of its own.
            if is_told && name != MAP_SIZE {
                let comma = if setting.label.is_empty() { "" } else { "," };
                setting.label += &format!("{comma}{name}={value}");
            }
            setting
        };
        let each = settings.iter().flat_map(|setting| {
            let values = values.iter();
            values.map(|value| with(setting, value)).collect::<Vec<_>>()
        });
        settings = each.collect();
        if settings.len() > MOST {
            return Err(CliError::Input(format!(
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
fn values(assignment: &Assignment, ty: &ParamType) -> Result<Vec<String>, CliError> {
    let text = &assignment.value;
    let is_vector = matches!(ty, ParamType::Vec2 | ParamType::Vec3 | ParamType::Vec4);
    if let (Some((ends, count)), false) = (text.rsplit_once('/'), is_vector)
        && let Some((from, to)) = ends.split_once("..")
    {
        return range(from, to, count, ty).ok_or_else(|| {
            CliError::Usage(format!(
                "{}={text}: expected FROM..TO/COUNT, two numbers and how many values there are \
                 between them, 2 to {MOST}, both ends included, for example 0..0.01/5",
                assignment.name
            ))
        });
    }
    let between = if is_vector { ';' } else { ',' };
    let values = text.split(between).map(|value| value.trim().to_owned());
    Ok(crate::args::values::unique(&values.collect::<Vec<_>>()))
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
        match whole {
            true => format!("{}", value.round()),
            // As short as f32 allows: sums of tenths have a tail.
            false => format!("{}", value as f32),
        }
    };
    let values: Vec<String> = (0..count).map(value).collect();
    Some(crate::args::values::unique(&values))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::graphs::preset::load_all;

    fn set(text: &str) -> Assignment {
        text.parse().unwrap()
    }

    fn labels(word: &str, all: &[&str]) -> Result<Vec<String>, String> {
        let argument = MethodArgument::new(word);
        let names = [argument.preset.clone()];
        let presets = load_all(&names, &skiagraph_passes::EmbeddedSources).unwrap();
        let all: Vec<Assignment> = all.iter().map(|text| set(text)).collect();
        let settings = settings(&presets[0], &argument, &all);
        let settings = settings.map_err(|error| error.to_string())?;
        Ok(settings.into_iter().map(|setting| setting.label).collect())
    }

    #[test]
    fn a_word_is_a_method_with_what_is_set_of_it_alone() {
        let plain = MethodArgument::new("crsm");
        assert_eq!((plain.preset.as_str(), plain.own.len()), ("crsm", 0));
        let two = MethodArgument::new("crsm@n=1,depth=plane");
        assert_eq!(two.own, [set("n=1"), set("depth=plane")]);
        let vector = MethodArgument::new("my.ron@tint=1,0,0,n=2");
        assert_eq!(vector.own, [set("tint=1,0,0"), set("n=2")]);
        // A file's name may have the sign.
        assert_eq!(MethodArgument::new("a@b.ron").preset, "a@b.ron");
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
    fn a_file_below_a_folder_of_any_name_has_no_setting() {
        let folder = tempfile::tempdir().unwrap();
        let odd = folder.path().join("dir@a=b");
        std::fs::create_dir(&odd).unwrap();
        std::fs::write(odd.join("x.ron"), "").unwrap();
        let word = odd.join("x.ron").display().to_string();
        let argument = MethodArgument::new(&word);
        assert_eq!((argument.preset, argument.own.len()), (word, 0));
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
