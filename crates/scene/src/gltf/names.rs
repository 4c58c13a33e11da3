//! Names of views and lights, made of those of a file.

use crate::error::beginning;
use std::collections::HashSet;

/// Most letters that are kept of a name.
const LONGEST: usize = 48;

/// Names that are taken.
#[derive(Default)]
pub(super) struct Names {
    taken: HashSet<String>,
}

impl Names {
    /// A name in small letters, digits and `_`, a letter first, as commands and files take it;
    /// `fallback` for one that has none of them, and in front of one that begins otherwise.
    pub fn plain(name: &str, fallback: &str) -> String {
        let mut plain = String::new();
        for letter in name.chars() {
            if letter.is_ascii_alphanumeric() {
                plain.push(letter.to_ascii_lowercase());
            } else if !plain.is_empty() && !plain.ends_with('_') {
                plain.push('_');
            }
            if plain.len() == LONGEST {
                break;
            }
        }
        let plain = plain.trim_end_matches('_');
        match plain.chars().next() {
            None => fallback.to_owned(),
            // `all` means all of them.
            Some(first) if first.is_ascii_digit() || plain == "all" => {
                format!("{fallback}_{plain}")
            }
            Some(_) => plain.to_owned(),
        }
    }

    /// The name, or with the first number from 2 behind it that is not taken.
    pub fn unlike(&mut self, name: &str) -> String {
        let numbered = (2..).map(|number| format!("{name}_{number}"));
        let mut names = std::iter::once(name.to_owned()).chain(numbered);
        let free = names.find(|name| self.taken.insert(name.clone()));
        free.unwrap_or_else(|| name.to_owned())
    }

    /// The same, and a remark if another `what` has the name; `its` says what is called.
    pub fn noted(&mut self, plain: &str, what: &str, its: &str) -> (String, Option<String>) {
        let name = self.unlike(plain);
        let remark = format!("another {what} has that name: {its} called {name}");
        let remark = (name != plain).then_some(remark);
        (name, remark)
    }
}

/// Names an item of a file for messages: by its number, and by its name if it has one.
pub(super) fn titled(what: &str, number: usize, name: Option<&str>) -> String {
    match name {
        Some(name) => format!("{what} {number} {:?}", beginning(name)),
        None => format!("{what} {number}"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_are_plain_and_unlike() {
        for (name, plain) in [
            ("Camera.001", "camera_001"),
            ("  Living Room (south) ", "living_room_south"),
            ("3rd", "camera_7_3rd"),
            ("all", "camera_7_all"),
            ("カメラ", "camera_7"),
            ("", "camera_7"),
        ] {
            assert_eq!(Names::plain(name, "camera_7"), plain, "{name}");
        }
        assert_eq!(Names::plain(&"x".repeat(99), "").len(), LONGEST);
        let mut names = Names::default();
        let distinct = ["a", "b", "a", "a_2", "a"].map(|name| names.unlike(name));
        assert_eq!(distinct, ["a", "b", "a_2", "a_2_2", "a_3"]);
    }
}
