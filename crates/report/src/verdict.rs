//! The verdict of a comparison: which method to take, in one or two sentences.

use crate::contender::Contender;
use crate::summary::Row;
use crate::tuning;
use itertools::Itertools;
use skiagraph_compare::measuring::date::is_another_hour;
use skiagraph_compare::records::budgets::Budgets;
use skiagraph_compare::records::regimes::{Regime, When};
use skiagraph_compare::records::turns::LEAST_TURNS;
use skiagraph_compare::wording::{bytes, ms, or_nothing, plural};
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

/// The verdict for one choice of frames.
#[derive(Default)]
struct Single<'a> {
    when: When,
    /// All that take part.
    full: Vec<Contender<'a>>,
    /// How many of them keep to the budgets.
    within: usize,
    fastest_exact: Option<usize>,
    first: Vec<usize>,
    is_taken: bool,
    /// True if the frames are too few to tell times apart.
    has_few_frames: bool,
    runner_up: Option<usize>,
    sentences: Vec<String>,
}

impl<'a> Single<'a> {
    /// `None` if no row can be judged.
    fn new(rows: &'a [Row<'a>], when: When, budgets: &Budgets) -> Option<Self> {
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
    fn counted(&self, verdicts: &[Self], budgets: &Budgets) -> Vec<String> {
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

/// The frames of verdicts in words, as a sentence begins: `While the camera or the light moves`.
fn condition(group: &[&Single]) -> String {
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
fn lower(text: &str) -> String {
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
    let have_turns = |method: &&Contender| best.row.ratio(method.row, best.when).is_some();
    let (apart, subject) = match level {
        [_] => ("", "It is"),
        [_, level @ ..] if level.iter().all(have_turns) => {
            (": their times cannot be told apart", "They are")
        }
        _ => (
            ": they did not take turns, so their times cannot be told apart",
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
        text += &if !quickest.is_told_apart(best) {
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
    let none = match methods.iter().find_map(|method| method.condition) {
        Some(_) => "Each method is wrong on some",
        None => "None is exact here",
    };
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
    let error = |method: &Contender| {
        if is_soft {
            method.rmse
        } else {
            method.wrong.share()
        }
    };
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
        format!("{name} ({error}) cannot be told apart from it in time")
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
    let closest = closest
        .into_iter()
        .flatten()
        .map(|text| format!("; {text}"));
    let closest: String = closest.collect();
    Single {
        sentences: vec![format!("No method keeps to {budgets}{closest}.")],
        ..Single::default()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::summary;
    use crate::test_support::results as sample;
    use skiagraph_compare::records::figure::Clocks;
    use skiagraph_compare::records::results::{Results, Run};
    use skiagraph_compare::records::{statistics::FrameTimes, tuned::Tuned};

    /// A run of 100,000 pixels that face the light: method, wrong pixels outside the band, ms of a
    /// frame while the light moves, and while the camera moves; without these if they are equal.
    fn run(method: &str, wrong: u64, frame: f64, kept: f64) -> Run {
        let mut run = sample().runs.remove(0);
        (run.preset, run.map_size) = (method.into(), None);
        let measured = run.measured.as_mut().unwrap();
        (measured.wrong.total, measured.wrong.in_band) = (wrong + 6, 6);
        let set = |times: &mut FrameTimes, ms: f64| {
            *times = FrameTimes::new(Some(vec![ms; 10]), None, vec![ms; 10]).unwrap();
        };
        set(&mut measured.frame, frame);
        if kept == frame {
            measured.regimes.clear();
        }
        for (times, ms) in measured.regimes.iter_mut().zip([kept, frame]) {
            set(&mut times.frame, ms);
        }
        run
    }

    fn graded(method: &str, rmse: f64, frame: f64) -> Run {
        let mut run = run(method, 0, frame, frame);
        run.area = Some(skiagraph_compare::records::results::AreaReference {
            samples: 512,
            standard_error_rms: 0.0005,
            standard_error_worst: 0.05,
            penumbra: 900,
        });
        run.measured.as_mut().unwrap().graded.rmse = rmse;
        run
    }

    fn unavailable(method: &str) -> Run {
        let mut run = run(method, 0, 1.0, 1.0);
        (run.measured, run.unavailable) = (None, Some("no ray queries here".into()));
        run
    }

    fn of_runs(runs: &[Run]) -> Results {
        Results {
            runs: runs.to_vec(),
            ..sample()
        }
    }

    fn rows(results: &Results) -> Vec<Row<'_>> {
        let clocks = Clocks::new(results);
        let cases = results.runs.iter().map(|run| clocks.case(run));
        summary::rows(cases, [512, 256])
    }

    /// The label of the marked row, and what is said.
    fn outcome(runs: &[Run]) -> (Option<String>, Vec<String>) {
        within(runs, &Budgets::default())
    }

    fn within(runs: &[Run], budgets: &Budgets) -> (Option<String>, Vec<String>) {
        let results = of_runs(runs);
        let rows = rows(&results);
        let verdict = verdict(&rows, budgets);
        let marked = verdict.fastest_exact.values().next_back();
        let marked = marked.map(|index| rows[*index].label.clone());
        (marked, verdict.sentences)
    }

    #[test]
    fn the_fastest_exact_one_stands_beside_the_fastest_and_the_next_exact() {
        let runs = [
            run("rt", 0, 100.0, 99.0),
            run("nsm", 4_700, 10.0, 8.0),
            run("light_buffer", 0, 21.0, 20.0),
            unavailable("rt_hw"),
        ];
        let (marked, sentences) = outcome(&runs);
        assert_eq!(marked.as_deref(), Some("light_buffer"));
        assert_eq!(
            sentences,
            [
                "Whatever moves: take `light_buffer` (21.0 ms a frame). It is exact here and 4.8 \
                 times as fast as `rt`, the next such method. `nsm` is 2.1 times as fast and wrong \
                 on 4.700 % of the surfaces that face the light."
            ]
        );
    }

    #[test]
    fn who_keeps_a_map_may_win_while_only_the_camera_moves() {
        let runs = [
            run("rt", 0, 70.0, 69.0),
            run("crsma_full", 0, 380.0, 34.0),
            run("nsm", 9, 20.0, 10.0),
        ];
        let (marked, sentences) = outcome(&runs);
        assert_eq!(marked.as_deref(), Some("rt"));
        assert_eq!(
            sentences,
            [
                "While the light moves: take `rt` (70.0 ms a frame). It is exact here and 5.4 \
                 times as fast as `crsma_full`, the next such method. `nsm` is 3.5 times as fast \
                 and wrong on 0.009 % of the surfaces that face the light.",
                "While the camera moves: take `crsma_full` (34.0 ms a frame). It is exact here \
                 and 2.0 times as fast as `rt`, the next such method. `nsm` is 3.4 times as fast \
                 and wrong on 0.009 % of the surfaces that face the light.",
            ]
        );
    }

    #[test]
    fn nothing_exact_all_exact_and_level_times() {
        let (marked, sentences) =
            outcome(&[run("nsm", 500, 10.0, 10.0), run("crsm", 20, 40.0, 40.0)]);
        assert_eq!(marked, None);
        assert_eq!(
            sentences,
            [
                "None is exact here. `crsm` is the least wrong (wrong on 0.020 % of the surfaces \
                 that face the light, 40.0 ms a frame). `nsm` is 4.0 times as fast: wrong on 0.500 \
                 % of the surfaces that face the light."
            ]
        );
        let (_, sentences) = outcome(&[run("a", 0, 10.0, 10.0), run("b", 0, 10.2, 10.2)]);
        assert_eq!(
            sentences,
            [
                "Take `a` or `b`: their times cannot be told apart (10.0 ms a \
                 frame). All are exact here."
            ]
        );
        let mut later = run("b", 0, 30.0, 30.0);
        later.session = "2026-11-20T04:50:00Z".into();
        let (_, sentences) = outcome(&[run("a", 0, 10.0, 10.0), later]);
        let why = "Take `a` or `b`: they did not take turns, so their times cannot be told apart";
        assert!(sentences[0].starts_with(why), "{sentences:?}");
        let (_, sentences) = outcome(&[run("rt", 0, 10.0, 4.0)]);
        assert_eq!(
            sentences,
            ["Whatever moves: take `rt` (10.0 ms a frame). It is exact here."]
        );
        assert_eq!(outcome(&[unavailable("rt_hw")]), (None, Vec::new()));
        assert_eq!(outcome(&[]), (None, Vec::new()));
        let mut dark = run("rt", 0, 10.0, 10.0);
        dark.pixels.facing_light = 0;
        assert_eq!(outcome(&[dark]), (None, Vec::new()), "nothing to judge");
    }

    #[test]
    fn a_method_that_is_there_twice_has_no_winner() {
        let twice = |wrong| {
            [
                run("nsm", wrong, 10.0, 10.0),
                run("nsm@bias=0", wrong, 10.1, 10.1),
            ]
        };
        let (_, sentences) = outcome(&twice(500));
        assert_eq!(
            sentences,
            [
                "None is exact here. `nsm` and `nsm@bias=0` are the least wrong and cannot be told \
                 apart in time (wrong on 0.500 % of the surfaces that face the light, 10.0 ms a \
                 frame)."
            ]
        );
        assert!(outcome(&twice(0)).1[0].starts_with("Take `nsm` or `nsm@bias=0`: their times"));
        let soft = [graded("pcf", 0.1, 10.0), graded("pcf@bias=0", 0.1, 10.1)];
        assert!(outcome(&soft).1[0].starts_with("`pcf` and `pcf@bias=0` have the least error"));
    }

    /// The labels of the taken row and of the runner-up.
    fn pair(runs: &[Run], budgets: &Budgets) -> [Option<String>; 2] {
        let results = of_runs(runs);
        let rows = rows(&results);
        let verdict = verdict(&rows, budgets);
        [verdict.first.first().copied(), verdict.runner_up]
            .map(|index| Some(rows[index?].label.clone()))
    }

    #[test]
    fn the_runner_up_is_the_alternative_that_the_sentences_name() {
        let labels = |runs: &[Run]| {
            let [taken, runner_up] = pair(runs, &Budgets::default());
            [taken, runner_up].map(|label| label.unwrap_or_else(|| "none".into()))
        };
        let (rt, exact) = (run("rt", 0, 100.0, 100.0), run("buffer", 0, 21.0, 21.0));
        let (nsm, slow) = (run("nsm", 4_700, 10.0, 8.0), run("slow", 9, 300.0, 300.0));
        assert_eq!(
            labels(&[rt.clone(), exact.clone(), nsm.clone()]),
            ["buffer", "nsm"]
        );
        assert_eq!(
            labels(&[rt.clone(), exact.clone(), slow.clone()]),
            ["buffer", "rt"]
        );
        assert_eq!(
            labels(&[nsm.clone(), slow.clone()]),
            ["slow", "nsm"],
            "none is exact"
        );
        assert_eq!(
            labels(&[run("a", 9, 1.0, 1.0), run("b", 99, 9.0, 9.0)]),
            ["a", "b"]
        );
        assert_eq!(labels(&[exact]), ["buffer", "none"]);
        assert_eq!(labels(&[]), ["none", "none"]);
        assert_eq!(
            labels(&[graded("a", 0.1, 9.0), graded("b", 0.2, 1.0)]),
            ["a", "b"]
        );
        let budgets = Budgets {
            frame_ms: Some(1.0),
            ..Budgets::default()
        };
        assert_eq!(
            pair(&[rt, nsm], &budgets),
            [None, None],
            "no method keeps to it"
        );
    }

    #[test]
    fn of_fewer_than_eight_frames_no_times_are_told_apart_or_called_level() {
        let few = |run: &mut Run, frames: usize| {
            let times = &mut run.measured.as_mut().unwrap().frame;
            times.wall_frames.truncate(frames);
            times.gpu_frames.as_mut().unwrap().truncate(frames);
        };
        let judged = |runs: &[Run], frames: usize| {
            let mut runs = runs.to_vec();
            few(&mut runs[0], frames);
            let (marked, sentences) = outcome(&runs);
            assert!(
                !sentences.iter().any(|line| line.contains("told apart,")),
                "{sentences:?}"
            );
            (marked, sentences)
        };
        let exact = [run("rt", 0, 100.0, 100.0), run("nsm", 9, 10.0, 10.0)];
        let (marked, sentences) = judged(&exact, 3);
        assert_eq!(marked.as_deref(), Some("rt"));
        let few = "frames are too few to tell times apart: give --frames 8 or more.";
        assert_eq!(
            sentences,
            [format!("3 {few}"), "`rt` is exact here.".into()]
        );
        assert!(judged(&exact, 8).1[0].starts_with("Take `rt`"));
        let wrong = [
            run("crsm", 20, 40.0, 40.0),
            run("crsma", 20, 40.0, 40.0),
            run("nsm", 500, 1.0, 1.0),
        ];
        assert_eq!(
            judged(&wrong, 7).1,
            [
                format!("7 {few}"),
                "`crsm` and `crsma` are the least wrong (wrong on 0.020 % of the surfaces that \
                 face the light)."
                    .into()
            ]
        );
        let soft = [graded("pcf", 0.1, 10.0), graded("vsm", 0.2, 10.0)];
        assert_eq!(
            judged(&soft, 1).1,
            [
                few.replace("frames are", "1 frame is"),
                "`pcf` is the least wrong (RMSE 0.1000).".into()
            ]
        );
        assert_eq!(
            judged(&exact[..1], 1).1[0],
            "Take `rt` (100 ms a frame). It is exact here."
        );
    }

    #[test]
    fn a_row_of_another_hour_takes_no_part() {
        let mut old = run("quick", 0, 1.0, 1.0);
        old.session = "2026-11-20T03:00:00Z".into();
        let (marked, sentences) = outcome(&[run("rt", 0, 50.0, 50.0), old]);
        assert_eq!(marked.as_deref(), Some("rt"));
        assert_eq!(
            sentences,
            ["Take `rt` (50.0 ms a frame). It is exact here."]
        );
    }

    #[test]
    fn budgets_leave_methods_out_and_say_what_comes_closest() {
        let runs = [
            run("rt", 0, 30.0, 30.0),
            run("pssm", 400, 8.0, 8.0),
            run("nsm", 4_700, 5.0, 5.0),
        ];
        let budget = |frame_ms, wrong_percent| Budgets {
            frame_ms,
            wrong_percent,
            memory_bytes: None,
        };
        let (_, sentences) = within(&runs, &budget(None, Some(1.0)));
        assert_eq!(
            sentences,
            [
                "Within less than 1 % wrong: 2 of 3 methods.",
                "Take `pssm` (wrong on 0.400 % of the surfaces that face the light, 8.00 ms a \
                 frame).",
            ]
        );
        let (_, sentences) = within(&runs, &budget(Some(10.0), None));
        assert!(
            sentences[1].contains("`pssm` is the least wrong"),
            "{sentences:?}"
        );
        let (marked, sentences) = within(&runs, &budget(Some(40.0), None));
        assert_eq!(marked.as_deref(), Some("rt"), "{sentences:?}");
        let (marked, sentences) = within(&runs, &budget(Some(6.0), Some(1.0)));
        assert_eq!(marked, None);
        assert_eq!(
            sentences,
            [
                "No method keeps to at most 6 ms a frame and less than 1 % wrong; the fastest is \
                 `nsm` (5.00 ms a frame); the least wrong is `rt` (exact here)."
            ]
        );
        let memory = Budgets {
            memory_bytes: Some(1 << 20),
            ..Budgets::default()
        };
        let (_, sentences) = within(&runs, &memory);
        assert!(sentences[0].starts_with("No method keeps to at most 1.0 MiB; the smallest is"));
    }

    #[test]
    fn every_view_and_every_frame_keeps_to_a_budget() {
        let on = |view: &str, mut run: Run| {
            run.view = view.into();
            run
        };
        let runs = [
            on("main", run("rt", 0, 5.1, 5.1)),
            on("roofs", run("rt", 0, 53.7, 53.7)),
            on("main", run("pssm", 400, 8.0, 8.0)),
            on("roofs", run("pssm", 2_120, 9.0, 9.0)),
            on("main", run("nsm", 900, 20.0, 20.0)),
            on("roofs", run("nsm", 990, 20.0, 20.0)),
        ];
        let budget = |frame_ms, wrong_percent| Budgets {
            frame_ms,
            wrong_percent,
            memory_bytes: None,
        };
        let (marked, sentences) = within(&runs, &budget(Some(30.0), None));
        assert_eq!(marked, None);
        let on_roofs = "`rt` takes 53.7 ms on `roofs` (mean 29.4).";
        assert_eq!(
            sentences[0],
            "Within at most 30 ms a frame: 2 of 3 methods."
        );
        assert!(
            sentences[1].contains("`nsm` is the least wrong"),
            "{sentences:?}"
        );
        assert_eq!(sentences.last().unwrap(), on_roofs);
        let (_, sentences) = within(&runs, &budget(None, Some(1.5)));
        assert!(sentences[1].starts_with("Take `nsm`"), "{sentences:?}");
        let wrong = "`pssm` is wrong on 2.120 % on `roofs` (1.260 % in all).";
        assert_eq!(sentences.last().unwrap(), wrong);
        let (_, sentences) = within(&runs, &budget(Some(8.5), None));
        assert_eq!(
            sentences,
            [
                "No method keeps to at most 8.5 ms a frame; the fastest is `pssm` (9.00 ms a \
                 frame on `roofs`).",
                "`pssm` takes 9.00 ms on `roofs` (mean 8.50).",
            ]
        );
    }

    #[test]
    fn shadow_that_is_missing_is_told_before_a_small_share_of_all_surfaces() {
        let error = |lit: u64, shadow: u64| {
            let mut plant = run("nsm", 4_800, 9.0, 9.0);
            (plant.pixels.lit, plant.pixels.shadow) = (95_000, 5_000);
            let wrong = &mut plant.measured.as_mut().unwrap().wrong;
            (wrong.lit, wrong.shadow) = (lit, shadow);
            outcome(&[plant, run("rt", 0, 50.0, 50.0)]).1.remove(0)
        };
        let wrong = "wrong on 4.800 % of the surfaces that face the light";
        for (sentence, first) in [
            (error(4_780, 26), "without 95.600 % of the shadow, "),
            (
                error(100, 28_500),
                "falsely dark on 30.000 % of the light, ",
            ),
            (error(1_200, 3_606), ""),
        ] {
            let expected = format!("`nsm` is 5.6 times as fast and {first}{wrong}.");
            assert!(sentence.ends_with(&expected), "{sentence}");
        }
    }

    #[test]
    fn pixels_that_cannot_be_judged_never_vanish() {
        let doubtful = |method, wrong, in_band, ms| {
            let mut run = run(method, wrong, ms, ms);
            run.band = 57_900;
            let measured = run.measured.as_mut().unwrap();
            (measured.wrong.total, measured.wrong.in_band) = (wrong + in_band, in_band);
            run
        };
        let runs = [
            doubtful("hybrid_pcf", 0, 1_200, 30.0),
            doubtful("nsm", 51, 16_675, 9.0),
        ];
        let (marked, sentences) = outcome(&runs);
        assert_eq!(marked.as_deref(), Some("hybrid_pcf"));
        assert_eq!(
            sentences,
            [
                "Of the 42 % that can be judged: take `hybrid_pcf` (30.0 ms a frame). It is right \
                 on all of these. `nsm` is 3.3 times as fast and wrong on 0.121 % of these.",
                "On the other 58 % the right answer hangs on rounding: no method is right or wrong \
                 there. From the reference's choice differ `hybrid_pcf` 2.073 % (the least) and \
                 `nsm` 28.800 % (the most).",
            ]
        );
        for runs in [
            &runs[..1],
            &[doubtful("a", 4, 9, 1.0), doubtful("b", 3, 9, 1.0)],
        ] {
            let (_, sentences) = outcome(runs);
            assert!(
                sentences.iter().all(|line| !line.contains("exact")),
                "{sentences:?}"
            );
            assert!(
                sentences[0].starts_with("Of the 42 %") && sentences.len() == 2,
                "{sentences:?}"
            );
        }
    }

    #[test]
    fn a_share_that_is_off_is_not_exact_though_it_is_right_at_one_half() {
        let mut soft = run("pcf", 0, 5.0, 5.0);
        soft.measured.as_mut().unwrap().graded.rmse_outside_band = 0.02;
        let (marked, sentences) = outcome(&[soft, run("rt", 0, 50.0, 50.0)]);
        assert_eq!(marked.as_deref(), Some("rt"));
        assert!(
            sentences[0].contains("`pcf` is 10 times as fast and off in its shades"),
            "{sentences:?}"
        );
    }

    #[test]
    fn a_row_on_fewer_views_takes_no_part() {
        let elsewhere = |mut run: Run| {
            run.view = "other".into();
            run
        };
        let runs = [
            run("rt", 0, 50.0, 50.0),
            elsewhere(run("rt", 0, 60.0, 60.0)),
            run("quick", 0, 1.0, 1.0),
        ];
        let (marked, sentences) = outcome(&runs);
        assert_eq!(marked.as_deref(), Some("rt"));
        assert_eq!(
            sentences,
            ["Take `rt` (55.0 ms a frame). It is exact here."]
        );
        // Wrong in one view is wrong.
        let runs = [run("rt", 0, 1.0, 1.0), elsewhere(run("rt", 7, 1.0, 1.0))];
        assert!(outcome(&runs).1[0].starts_with("None is exact here"));
    }

    /// A run of what `base` was tuned to; of the defaults, if nothing is set.
    fn tuned(base: &str, set: &[(&str, serde_json::Value)], wrong: u64, frame: f64) -> Run {
        let set = set
            .iter()
            .map(|(name, value)| ((*name).to_owned(), value.clone()));
        let tuned = Tuned {
            of: base.into(),
            set: set.collect(),
            chosen_on: vec!["side".into(), "back".into()],
            tried: 40,
            is_whole: true,
            ..Tuned::default()
        };
        let mut run = run(&tuned.argument(), wrong, frame, frame);
        run.tuned = Some(tuned);
        run
    }

    #[test]
    fn tuning_is_told_and_a_setting_that_is_beaten_is_never_advised() {
        let set = [("cull", "none".into()), ("slope_bias", 2.0.into())];
        let mut rt = run("rt", 0, 100.0, 100.0);
        rt.promise = Some(skiagraph_compare::records::results::Promise {
            of: "exact".into(),
            closed_only: false,
        });
        let runs = [
            rt,
            run("nsm", 17_600, 10.0, 10.0),
            tuned("nsm", &set, 2, 12.0),
            tuned("pcf", &[], 900, 30.0),
        ];
        let labels: Vec<String> = rows(&of_runs(&runs))
            .into_iter()
            .map(|row| row.label)
            .collect();
        assert_eq!(labels, ["nsm", "nsm@cull=none,slope_bias=2", "pcf", "rt"]);
        insta::assert_snapshot!(outcome(&runs).1.join("\n"));
        // Where the defaults are better after all, they are what is advised.
        let worse = [run("nsm", 5, 10.0, 10.0), tuned("nsm", &set, 40, 12.0)];
        let sentences = outcome(&worse).1;
        assert!(
            sentences[0].contains("`nsm` is the least wrong"),
            "{sentences:?}"
        );
        assert!(!sentences[0].contains("slope_bias"), "{sentences:?}");
        // A budget that only the defaults keep to.
        let quick = Budgets {
            frame_ms: Some(11.0),
            ..Budgets::default()
        };
        let sentences = within(&runs, &quick).1;
        assert!(
            sentences[1].contains("`nsm` is the least wrong"),
            "{sentences:?}"
        );
    }

    #[test]
    fn grades_have_a_least_error_and_a_fastest() {
        let runs = [graded("rt_area", 0.01, 90.0), graded("pcf", 0.2, 9.0)];
        let expected = "`rt_area` has the least error (RMSE 0.0100, 90.0 ms a frame). `pcf` is 10 \
            times as fast: RMSE 0.2000.";
        assert_eq!(outcome(&runs), (None, vec![expected.into()]));
    }
}
