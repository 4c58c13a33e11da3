//! The verdict for one choice of frames.

use crate::contender::Contender;
use crate::summary::Row;
use itertools::Itertools;
use skiagraph_compare::measuring::date::is_another_hour;
use skiagraph_compare::records::budgets::Budgets;
use skiagraph_compare::records::regimes::{Regime, When};
use skiagraph_compare::records::turns::LEAST_TURNS;
use skiagraph_compare::wording::{bytes, ms, or_nothing, plural};
use std::collections::BTreeMap;

/// The verdict for one choice of frames.
#[derive(Default)]
pub struct Single<'a> {
    pub when: When,
    /// All that take part.
    pub full: Vec<Contender<'a>>,
    /// How many of them keep to the budgets.
    pub within: usize,
    pub fastest_exact: Option<usize>,
    pub first: Vec<usize>,
    pub is_taken: bool,
    /// True if the frames are too few to tell times apart.
    pub has_few_frames: bool,
    pub runner_up: Option<usize>,
    pub sentences: Vec<String>,
}

impl<'a> Single<'a> {
    /// `None` if no row can be judged.
    pub fn new(rows: &'a [Row<'a>], when: When, budgets: &Budgets) -> Option<Self> {
        let most = rows.iter().map(Row::views).max().unwrap_or_default();
        let newest = rows.iter().map(Row::session).max().unwrap_or_default();
        let takes_part = |(_, row): &(usize, &Row)| {
            let is_of_all = row.views() == most && most > 0 && row.is_whole();
            is_of_all && !is_another_hour(row.session(), newest)
        };
        let full = rows.iter().enumerate().filter(takes_part);
        let full = full.filter_map(|(index, row)| Contender::new(index, row, when));
        let full: Vec<Contender> = full.collect();
        let within = full.iter().filter(|method| method.is_within(budgets));
        let within = better_settings(within.cloned().collect());
        let full = better_settings(full);
        let mut single = if full.is_empty() {
            return None;
        } else if within.is_empty() {
            none_within(&full, budgets)
        } else if budgets.wrong_percent.is_some() {
            right_enough(&within)
        } else if full.iter().any(|method| method.is_soft) {
            graded(&within, rows)
        } else {
            hard(&within)
        };
        let frames = within.iter().map(|method| method.row.frames(when)).min();
        let too_few = frames.filter(|frames| within.len() > 1 && *frames < LEAST_TURNS);
        if let Some(frames) = too_few {
            single.sentences = without_times(&within, frames);
            // The fastest is not known.
            (single.is_taken, single.has_few_frames) = (false, true);
        }
        let within = within.len();
        Some(Self {
            when,
            full,
            within,
            ..single
        })
    }

    /// How many methods keep to the budgets, for each choice of frames where they differ.
    pub fn counted(&self, verdicts: &[Self], budgets: &Budgets) -> Vec<String> {
        let mut counts: BTreeMap<usize, Vec<&Self>> = BTreeMap::new();
        for single in verdicts {
            counts.entry(single.within).or_default().push(single);
        }
        if budgets.is_empty() || counts.keys().all(|count| *count == 0) {
            return Vec::new();
        }
        let methods = plural(self.full.len(), "method");
        let counted = if counts.len() == 1 {
            format!("{} of {methods}", self.within)
        } else {
            let counted = counts.iter().rev();
            let count = |(count, verdicts): (&usize, &Vec<&Self>)| {
                format!("{count} {}", lower(&condition(verdicts)))
            };
            format!("of {methods} {}", counted.map(count).join(", "))
        };
        vec![format!("Within {budgets}: {counted}.")]
    }
}

/// The frames of verdicts in words, as a sentence begins: `While the camera or the light moves`.
pub fn condition(group: &[&Single]) -> String {
    let has = |when: When| group.iter().any(|single| single.when == when);
    let meshes = match [Regime::SomeMeshes, Regime::AllMeshes].map(|regime| has(Some(regime))) {
        [true, true] => Some("meshes"),
        [true, false] => Some("some meshes"),
        [false, true] => Some("all meshes"),
        [false, false] => None,
    };
    let single = [
        (Regime::Nothing, "nothing"),
        (Regime::Camera, "the camera"),
        (Regime::Light, "the light"),
    ];
    let single = single.into_iter().filter(|(regime, _)| has(Some(*regime)));
    let subjects: Vec<&str> = single.map(|(_, subject)| subject).chain(meshes).collect();
    let verb = if meshes.is_some() { "move" } else { "moves" };
    let moving = format!("hile {} {verb}", subjects.join(" or "));
    match (has(None), subjects.is_empty()) {
        (true, true) => "Along the path".into(),
        (true, false) => format!("Along the path and w{moving}"),
        _ => format!("W{moving}"),
    }
}

/// A sentence's beginning as it stands within one.
pub fn lower(text: &str) -> String {
    let mut letters = text.chars();
    let first = letters.next().map(|letter| letter.to_ascii_lowercase());
    first.into_iter().chain(letters).collect()
}

/// The contenders without those that are beaten by another setting of the same method: of a method
/// and what it was tuned to, the one with the greater error is left out, and never recommended.
fn better_settings(methods: Vec<Contender>) -> Vec<Contender> {
    let is_beaten = |method: &Contender| {
        let is_setting = |other: &&Contender| method.is_other_setting_of(other);
        let settings = methods.iter().filter(is_setting);
        let error = method.error_to_rank();
        let mut orders = settings.map(|other| other.error_to_rank().total_cmp(&error));
        orders.any(|order| order.is_lt() || (order.is_eq() && method.row.is_tuned()))
    };
    let better = methods.iter().filter(|method| !is_beaten(method));
    better.cloned().collect()
}

fn least<'c, 'a>(
    methods: impl IntoIterator<Item = &'c Contender<'a>>,
    figure: impl Fn(&Contender) -> f64,
) -> Option<&'c Contender<'a>> {
    let methods = methods.into_iter();
    methods.min_by(|one, other| figure(one).total_cmp(&figure(other)))
}

fn fastest<'c, 'a>(
    methods: impl IntoIterator<Item = &'c Contender<'a>>,
) -> Option<&'c Contender<'a>> {
    least(methods, |method| method.frame)
}

/// The methods but this one.
fn rivals<'c, 'a>(
    methods: &'c [Contender<'a>],
    best: &Contender,
) -> impl Iterator<Item = &'c Contender<'a>> {
    let best = best.index;
    methods.iter().filter(move |method| method.index != best)
}

fn hard<'a>(methods: &[Contender]) -> Single<'a> {
    let exact = methods.iter().filter(|method| method.is_exact);
    let exact: Vec<Contender> = exact.cloned().collect();
    let Some(best) = fastest(&exact) else {
        return none_exact(methods);
    };
    let faster = fastest(methods.iter().filter(|method| !method.is_exact))
        .filter(|method| method.frame < best.frame || !method.is_told_apart(best));
    let next = || fastest(rivals(&exact, best));
    let level = with_level(best, &exact, |_| true);
    Single {
        fastest_exact: (!best.is_resting()).then_some(best.index),
        first: indices(&level),
        is_taken: true,
        runner_up: faster.or_else(next).map(|method| method.index),
        sentences: vec![sentence(best, &level, &exact, methods)],
        ..Single::default()
    }
}

/// The best, and those of others that cannot be told apart from it in time.
fn with_level<'c, 'a>(
    best: &'c Contender<'a>,
    methods: &'c [Contender<'a>],
    counts: impl Fn(&Contender) -> bool,
) -> Vec<&'c Contender<'a>> {
    let level = rivals(methods, best).filter(|it| counts(it) && !it.is_told_apart(best));
    [best].into_iter().chain(level).collect()
}

fn indices(methods: &[&Contender]) -> Vec<usize> {
    methods.iter().map(|method| method.index).collect()
}

/// One method to take, with those that cannot be told apart from it, beside the next exact one and
/// the fastest of all.
fn sentence(
    best: &Contender,
    level: &[&Contender],
    exact: &[Contender],
    methods: &[Contender],
) -> String {
    let names = level.iter().map(|method| method.name()).join(" or ");
    let (apart, subject) = match level {
        [_] => ("", "It is"),
        [_, level @ ..] if level.iter().all(|method| method.took_turns_with(best)) => {
            (": their times cannot be told apart", "They are")
        }
        _ => (
            ": they did not all take turns, so their times cannot be told apart",
            "They are",
        ),
    };
    let mut text = format!("Take {names}{apart} ({})", best.per_frame());
    let right = best.right();
    let next = rivals(exact, best).filter(|method| method.is_told_apart(best));
    text += &match fastest(next) {
        Some(next) => {
            let times = best.times_as_fast(next);
            format!(
                ". {subject} {right} and {times} as {}, the next such method",
                next.name()
            )
        }
        None if exact.len() == methods.len() && methods.len() > 1 => format!(". All are {right}"),
        None => format!(". {subject} {right}"),
    };
    if let Some(quickest) = fastest(methods.iter().filter(|method| !method.is_exact)) {
        let (name, error) = (quickest.name(), quickest.error());
        text += &if !quickest.took_turns_with(best) {
            format!(". {name} was not timed in turns with it, and is {error}")
        } else if !quickest.is_told_apart(best) {
            format!(". {name} is as fast, as far as can be told, and {error}")
        } else if quickest.frame < best.frame {
            let times = quickest.times_as_fast(best);
            format!(". {name} is {times} and {error}")
        } else {
            ". No other is faster".into()
        };
    }
    text + "."
}

fn none_exact<'a>(methods: &[Contender]) -> Single<'a> {
    let is_part = methods.iter().any(|method| method.condition.is_some());
    let none = is_part.then_some("Each method is wrong on some");
    let none = none.unwrap_or("None is exact here");
    let words = ["is the least wrong", "are the least wrong"];
    let mut verdict = by_error(methods, |method| method.wrong.share(), words);
    for sentence in &mut verdict.sentences {
        *sentence = format!("{none}. {sentence}.");
    }
    verdict
}

/// The method with the least error, those that are as right and cannot be told apart from it in
/// time, and the fastest one beside it, as one sentence without its end. `words` say of one and of
/// several that they are it.
fn by_error<'a>(
    methods: &[Contender],
    error: impl Fn(&Contender) -> f64,
    words: [&str; 2],
) -> Single<'a> {
    let least_error = methods.iter().map(&error).fold(f64::INFINITY, f64::min);
    let is_least = |method: &Contender| error(method) == least_error;
    let Some(best) = fastest(methods.iter().filter(|method| is_least(method))) else {
        return Single::default();
    };
    let level = with_level(best, methods, is_least);
    let names = level.iter().map(|method| method.name()).join(" and ");
    let are = match level[..] {
        [_] => words[0].to_owned(),
        _ => format!("{} and cannot be told apart in time", words[1]),
    };
    let (figure, time) = (best.error(), best.per_frame());
    let mut text = format!("{names} {are} ({figure}, {time})");
    let fastest = fastest(rivals(methods, best).filter(|method| error(method) > least_error));
    let is_faster = |method: &&Contender| method.frame < best.frame || !method.is_told_apart(best);
    text += &match fastest {
        Some(fastest) if is_faster(&fastest) => format!(". {}", faster(fastest, best)),
        Some(_) => ". No other is faster".into(),
        None => String::new(),
    };
    let next = || least(rivals(methods, best), &error);
    let runner_up = fastest.filter(is_faster).or_else(next);
    Single {
        first: indices(&level),
        runner_up: runner_up.map(|method| method.index),
        sentences: vec![text],
        ..Single::default()
    }
}

/// The sentences on methods whose frames are too few to tell their times apart.
fn without_times(methods: &[Contender], frames: usize) -> Vec<String> {
    let is_soft = methods.iter().any(|method| method.is_soft);
    let are = |count| if count == 1 { "is" } else { "are" };
    let by = |is_named: &dyn Fn(&&Contender) -> bool| {
        let named = methods.iter().filter(is_named);
        let named: Vec<String> = named.map(Contender::name).collect();
        format!("{} {}", named.join(" and "), are(named.len()))
    };
    let few = format!(
        "{} {} too few to tell times apart: give --frames {LEAST_TURNS} or more.",
        plural(frames, "frame"),
        are(frames)
    );
    let exact = methods.iter().find(|method| method.is_exact && !is_soft);
    let error = |method: &Contender| method.error_to_rank();
    let sentence = match (exact, least(methods, error)) {
        (Some(exact), _) => format!("{} {}.", by(&|method| method.is_exact), exact.right()),
        (None, Some(best)) => {
            let named = by(&|method| error(method) == error(best));
            format!("{named} the least wrong ({}).", best.error())
        }
        (None, None) => return vec![few],
    };
    vec![few, sentence]
}

/// How much faster another method is, and its error.
fn faster(fastest: &Contender, than: &Contender) -> String {
    let (name, error) = (fastest.name(), fastest.error());
    if fastest.is_told_apart(than) {
        let times = fastest.times_as_fast(than);
        format!("{name} is {times}: {error}")
    } else {
        let why = if fastest.took_turns_with(than) {
            "cannot be told apart from it in time"
        } else {
            "was not timed in turns with it"
        };
        format!("{name} ({error}) {why}")
    }
}

/// Judges errors of shares: the least one, and the fastest.
fn graded<'a>(methods: &[Contender], rows: &[Row]) -> Single<'a> {
    let words = ["has the least error", "have the least error"];
    let mut verdict = by_error(methods, |method| method.rmse, words);
    let errors = methods.iter().map(|method| method.rmse);
    let least_error = errors.fold(f64::INFINITY, f64::min);
    let own = rows.iter().filter_map(Row::reference_error);
    let own = own.reduce(f64::max).filter(|own| least_error < 10.0 * own);
    let more = or_nothing(own, |own| {
        format!(
            ". The reference's own error is {own:.4}: more samples would tell more \
             (--reference-samples)"
        )
    });
    for sentence in &mut verdict.sentences {
        *sentence += &format!("{more}.");
    }
    verdict
}

/// The fastest of methods that are all right enough, with those that cannot be told apart from it.
fn right_enough<'a>(methods: &[Contender]) -> Single<'a> {
    let Some(best) = fastest(methods) else {
        return Single::default();
    };
    let level = with_level(best, methods, |_| true);
    let figures = |method: &&Contender| {
        let (name, error, time) = (method.name(), method.error(), method.per_frame());
        format!("{name} ({error}, {time})")
    };
    let names = level[1..].iter().map(figures).join(", ");
    let also = match names.as_str() {
        "" => String::new(),
        names => format!(". Not told apart from it in time: {names}"),
    };
    Single {
        fastest_exact: best.is_exact.then_some(best.index),
        first: indices(&level),
        is_taken: true,
        runner_up: fastest(rivals(methods, best)).map(|method| method.index),
        sentences: vec![format!("Take {}{also}.", figures(&best))],
        ..Single::default()
    }
}

/// That no method keeps to the budgets, and which come closest to each.
fn none_within<'a>(methods: &[Contender], budgets: &Budgets) -> Single<'a> {
    let fastest = || {
        let method = least(methods, |method| method.slowest.value)?;
        let (time, place) = (ms(method.slowest.value), method.slowest.on());
        Some(format!(
            "the fastest is {} ({time} ms a frame{place})",
            method.name()
        ))
    };
    let least_wrong = || {
        let method = least(methods, |method| method.most_wrong.value)?;
        let error = match method.most_wrong.on() {
            place if place.is_empty() || method.is_exact => method.error(),
            place => format!("wrong on {:.3} %{place}", method.most_wrong.value),
        };
        Some(format!("the least wrong is {} ({error})", method.name()))
    };
    let smallest = || {
        let method = least(methods, |method| method.row.bytes() as f64)?;
        let size = bytes(method.row.bytes());
        Some(format!("the smallest is {} ({size})", method.name()))
    };
    let closest = [
        budgets.frame_ms.and_then(|_| fastest()),
        budgets.wrong_percent.and_then(|_| least_wrong()),
        budgets.memory_bytes.and_then(|_| smallest()),
    ];
    let closest = closest.into_iter().flatten();
    let closest: String = closest.map(|text| format!("; {text}")).collect();
    Single {
        sentences: vec![format!("No method keeps to {budgets}{closest}.")],
        ..Single::default()
    }
}
