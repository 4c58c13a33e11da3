//! Parses methods as the command line names them: `PRESET[@PARAM=VALUE,…]`.
//!
//! ```
//! use skiagraph_compare::graphs::argument::{Assignment, MethodArgument};
//!
//! let method = MethodArgument::new("crsm@n=1,depth=plane");
//! assert_eq!(method.preset, "crsm");
//! assert_eq!(method.own[1], "depth=plane".parse::<Assignment>()?);
//! # Ok::<(), String>(())
//! ```

use itertools::Itertools;
use std::{fmt, path::Path, str::FromStr};

/// An assignment of a value to a param of a graph, `NAME=VALUE`. The value stays text until the
/// graph that has the param parses it.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Assignment {
    /// Name of the param.
    pub name: String,
    /// Value as the user wrote it.
    pub value: String,
}

impl FromStr for Assignment {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        match text.split_once('=') {
            Some((name, value)) if !name.trim().is_empty() => Ok(Self {
                name: name.trim().into(),
                value: value.trim().into(),
            }),
            _ => Err("expected NAME=VALUE, for example slope_bias=2".into()),
        }
    }
}

/// A method as the command line names it: `PRESET[@PARAM=VALUE,…]`.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct MethodArgument {
    /// Name of a built-in method, or path of a graph document; with the document in an open include
    /// behind it (`contact.ron@over=msm`) in arguments of
    /// [`openings`](crate::graphs::openings::arguments).
    pub preset: String,
    /// Assignments of params behind the `@`, for this method alone.
    pub own: Vec<Assignment>,
}

impl MethodArgument {
    /// Splits a word of the command line into a preset and its assignments. A part without `=`
    /// belongs to the value before it, as vectors contain commas. A word that is the path of a
    /// file, or that has no `=` behind the `@`, is not split.
    pub fn new(word: &str) -> Self {
        // Folders have any name.
        let split = word.split_once('@').filter(|_| !Path::new(word).is_file());
        let split = split.filter(|(name, own)| !name.is_empty() && own.contains('='));
        let (preset, own) = split.map_or((word, None), |(preset, own)| (preset, Some(own)));
        let mut assignments: Vec<Assignment> = Vec::new();
        for part in own.into_iter().flat_map(|own| own.split(',')) {
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

/// Writes the method as it can be typed again.
impl fmt::Display for MethodArgument {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        let own = self.own.iter();
        let own = own.map(|Assignment { name, value }| format!("{name}={value}"));
        let sign = if self.own.is_empty() { "" } else { "@" };
        write!(f, "{}{sign}{}", self.preset, own.format(","))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn set(text: &str) -> Assignment {
        text.parse().unwrap()
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
    fn assignments_keep_everything_after_the_first_equals_sign() {
        assert_eq!(
            "a=b=c".parse(),
            Ok(Assignment {
                name: "a".into(),
                value: "b=c".into()
            })
        );
        assert!("=1".parse::<Assignment>().is_err());
        assert!("cull".parse::<Assignment>().is_err());
    }
}
