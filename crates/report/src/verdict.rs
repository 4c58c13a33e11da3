//! The verdict of a comparison: which method to take, in one or two sentences.

use crate::single_verdict::{Single, condition, lower};
use crate::summary::Row;
use crate::tuning;
use skiagraph_compare::records::budgets::Budgets;
use skiagraph_compare::records::regimes::{Regime, When};
use std::collections::BTreeMap;

/// Verdict on the rows of a summary: the methods that it recommends, in figures and in words.
#[derive(Debug, Default, PartialEq, Eq)]
pub struct Verdict {
    /// Index of the row that is fastest among the [exact](Row::is_exact) ones within the budgets,
    /// for each choice of frames. There is none if nothing moves and it costs next to nothing; if
    /// [shares of light](skiagraph_compare#terms) under a light with an extent are compared; or if
    /// there is a budget of wrong pixels and a row within the budgets that is not exact is faster.
    pub fastest_exact: BTreeMap<When, usize>,
    /// Indices of the recommended rows, or if none is right enough of the least wrong ones: the
    /// fastest, then those whose times cannot be told apart from it. Times are those of
    /// [`main_choice`]. It is empty if no row keeps to the budgets
    /// or no row can be judged.
    pub first: Vec<usize>,
    /// True if the rows in `first` are recommended: they have no wrong pixel outside the band (the
    /// pixels whose answer rounding decides), or keep to the budget of wrong pixels, and their
    /// times tell which is the fastest. With fewer than eight frames they do not, unless one row
    /// alone keeps to the budgets.
    pub is_taken: bool,
    /// Index of the row to show beside the first one: a less right method that is faster or cannot
    /// be told apart in time, otherwise the next best one. `None` if there is none.
    pub runner_up: Option<usize>,
    /// The verdict in words, a sentence for each entry. It is empty if no row can be judged.
    pub sentences: Vec<String>,
}

/// Judges rows that were measured on the same views: recommends a method for each choice of frames,
/// in one sentence where the same one is the best. A row takes no part if it has fewer views than
/// others, was measured an hour or more before the newest one (the machine may have been loaded
/// differently), was cut short, or could not run. A row that is beyond a budget on any view, or in
/// any frame of a camera path, is not recommended. Of a method and its tuned setting only the one
/// with less error is recommended.
pub fn verdict(rows: &[Row], budgets: &Budgets) -> Verdict {
    let verdict = |when| Single::new(rows, when, budgets);
    let verdicts: Vec<Single> = choices(rows).into_iter().filter_map(verdict).collect();
    let Some(main) = verdicts.last() else {
        return Verdict::default();
    };
    let doubtful = main.full.iter().find_map(|method| method.condition);
    let judged = doubtful.map(|condition| condition.judged());
    let under = |condition: &str, sentence: &str| match (&judged, condition) {
        (None, "") => sentence.to_owned(),
        (None, condition) => format!("{condition}: {}", lower(sentence)),
        (Some(judged), "") => format!("{judged}: {}", lower(sentence)),
        (Some(judged), _) => format!("{judged}, {}: {}", lower(condition), lower(sentence)),
    };
    let counted = main.counted(&verdicts, budgets).into_iter();
    let mut sentences: Vec<String> = counted.map(|sentence| under("", &sentence)).collect();
    let groups = grouped(&verdicts);
    for group in &groups {
        let Some(single) = group.last() else {
            continue;
        };
        let condition = match (groups.len(), verdicts.len()) {
            (1, 1) => String::new(),
            (1, _) if single.has_few_frames => String::new(),
            (1, _) => "Whatever moves".to_owned(),
            _ => condition(group),
        };
        let conditions = std::iter::once(&*condition).chain(std::iter::repeat(""));
        let own = conditions.zip(&single.sentences);
        sentences.extend(own.map(|(condition, sentence)| under(condition, sentence)));
    }
    sentences.extend(doubtful.map(|condition| condition.doubt(&main.full)));
    let beyond = main.full.iter().filter_map(|method| method.beyond(budgets));
    sentences.extend(beyond);
    sentences.extend(tuning::sentences(rows));
    let fastest_exact = |single: &Single| Some((single.when, single.fastest_exact?));
    Verdict {
        fastest_exact: verdicts.iter().filter_map(fastest_exact).collect(),
        first: main.first.clone(),
        is_taken: main.is_taken,
        runner_up: main.runner_up,
        sentences,
    }
}

/// Returns the choices of frames in which rows can be compared: the regimes that all of them have,
/// from the least that moves to the most, then a path's own frames; without regimes all frames. On
/// still views moving meshes come first, as they need not move there.
pub fn choices(rows: &[Row]) -> Vec<When> {
    let measured = || rows.iter().filter(|row| row.views() > 0);
    let has = |regime: &Regime| measured().all(|row| row.regimes().contains(regime));
    let regimes = Regime::ALL.into_iter().filter(has).map(Some);
    let mut choices: Vec<When> = regimes.filter(|_| measured().count() > 0).collect();
    let is_path = measured().any(Row::is_path);
    if !is_path {
        let is_of_meshes = |when: &When| *when >= Some(Regime::SomeMeshes);
        choices.sort_by_key(|when| !is_of_meshes(when));
    }
    if choices.is_empty() || is_path {
        choices.push(None);
    }
    choices
}

/// Returns the choice of frames whose times stand for a method where there is room for one: on
/// views those before which the light has moved, of a path its own.
pub fn main_choice(rows: &[Row]) -> When {
    choices(rows).last().copied().flatten()
}

/// The verdicts in groups with one answer, the last of all first. A verdict joins the group whose
/// first method is also among its own first ones.
fn grouped<'s, 'a>(verdicts: &'s [Single<'a>]) -> Vec<Vec<&'s Single<'a>>> {
    let mut groups: Vec<Vec<&Single>> = Vec::new();
    for single in verdicts.iter().rev() {
        let agrees = |group: &&mut Vec<&Single>| {
            let main = group[0];
            match (main.first.first(), main.is_taken == single.is_taken) {
                (Some(first), true) => single.first.contains(first),
                (None, _) => single.first.is_empty(),
                (Some(_), false) => false,
            }
        };
        match groups.iter_mut().find(agrees) {
            Some(group) => group.push(single),
            None => groups.push(vec![single]),
        }
    }
    groups.iter_mut().for_each(|group| group.reverse());
    groups
}

#[cfg(test)]
mod tests;
