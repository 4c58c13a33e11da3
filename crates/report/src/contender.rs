//! Rows that a verdict chooses among, each with what decides.

use crate::summary::{Row, Wrong};
use crate::tuning;
use skiagraph_compare::records::budgets::Budgets;
use skiagraph_compare::records::figure::Worst;
use skiagraph_compare::records::figures;
use skiagraph_compare::records::regimes::{AT_REST_MS, Regime, When, time_name};
use skiagraph_compare::records::turns::Ratio;
use skiagraph_compare::wording::{ms, percent};

/// Share of the pixels facing the light in the band (the pixels whose answer rounding decides)
/// beyond which a verdict holds for the other pixels only.
const MAX_BAND: f64 = 0.01;

/// Share of the reference's shadow that is missing, or of its light that is dark, from which on a
/// verdict says so first.
const LARGE: f64 = 0.25;

/// The pixels that a verdict is of, where it is not of nearly all that face the light.
#[derive(Clone, Copy, Debug)]
pub struct Condition {
    /// Pixels in the band, and all that face the light.
    band: u64,
    facing_light: u64,
}

impl Condition {
    pub fn new(wrong: Wrong) -> Option<Self> {
        let (band, facing_light) = (wrong.band, wrong.facing_light);
        let share = band as f64 / facing_light.max(1) as f64;
        (share > MAX_BAND).then_some(Self { band, facing_light })
    }

    /// A number of pixels as a share of those that face the light.
    fn share(self, count: u64) -> String {
        format!("{:.0} %", 100.0 * count as f64 / self.facing_light as f64)
    }

    /// The pixels that sentences hold of.
    pub fn judged(self) -> String {
        let judged = self.share(self.facing_light.saturating_sub(self.band));
        format!("Of the {judged} that can be judged")
    }

    /// How much methods differ on the other pixels.
    pub fn doubt(self, methods: &[Contender]) -> String {
        let mut ranked: Vec<&Contender> = methods.iter().collect();
        ranked.sort_by_key(|method| method.wrong.in_band);
        let share = |method: &&Contender| {
            let share = percent(method.wrong.in_band, self.band);
            format!("`{}` {share}", method.label)
        };
        let (least, most) = (ranked.first(), ranked.last().filter(|_| ranked.len() > 1));
        let shares: Vec<String> = least.into_iter().chain(most).map(share).collect();
        format!(
            "On the other {} the right answer hangs on rounding: no method is right or wrong \
             there. From the reference's choice differ {}.",
            self.share(self.band),
            shares.join(" (the least) and ") + if shares.len() > 1 { " (the most)" } else { "" }
        )
    }
}

/// A row, with what decides.
#[derive(Clone, Debug)]
pub struct Contender<'a> {
    pub row: &'a Row<'a>,
    pub index: usize,
    pub label: &'a str,
    pub wrong: Wrong,
    pub is_exact: bool,
    pub rmse: f64,
    /// True if the light has an extent.
    pub is_soft: bool,
    /// Where much of what it shows cannot be judged.
    pub condition: Option<Condition>,
    pub when: When,
    /// Milliseconds of a frame.
    pub frame: f64,
    /// The slowest view, or frame of a path, in milliseconds.
    pub slowest: Worst,
    /// The view, or frame of a path, with the greatest share of wrong pixels, in percent.
    pub most_wrong: Worst,
}

impl<'a> Contender<'a> {
    pub fn new(index: usize, row: &'a Row, when: When) -> Option<Self> {
        let frame = row.frame_ms(when)?;
        let wrong = row.wrong();
        if wrong.facing_light == 0 {
            return None; // Nothing was judged.
        }
        Some(Self {
            row,
            index,
            label: &row.label,
            wrong,
            is_exact: row.is_exact(),
            rmse: row.rmse()?,
            is_soft: row.is_soft(),
            condition: Condition::new(wrong),
            when,
            frame,
            slowest: row.worst(figures::named(&time_name(when))?)?,
            most_wrong: row.worst(figures::named("wrong")?)?,
        })
    }

    /// How wrong it is, in words that stand behind `and`, or alone.
    pub fn error(&self) -> String {
        let (outside_band, facing_light) = (self.wrong.outside_band, self.wrong.facing_light);
        match self.condition {
            _ if self.is_soft => format!("RMSE {:.4}", self.rmse),
            _ if self.is_exact => self.right().into(),
            _ if outside_band == 0 => format!("off in its shades by RMSE {:.4}", self.rmse),
            // Where much lies in the band, the others are judged.
            Some(_) => {
                let judged = facing_light.saturating_sub(self.wrong.band);
                format!("wrong on {} of these", percent(outside_band, judged))
            }
            None => {
                let wrong = percent(outside_band, facing_light);
                let wrong = format!("wrong on {wrong} of the surfaces that face the light");
                // A small share of all surfaces may be all of the shadow.
                let part = |name| {
                    let [count, whole] = self.row.range(name)?;
                    let share = || percent(count as u64, whole as u64);
                    (count >= LARGE * whole.max(1.0)).then(share)
                };
                if let Some(missing) = part("missing") {
                    format!("without {missing} of the shadow, {wrong}")
                } else if let Some(dark) = part("false") {
                    format!("falsely dark on {dark} of the light, {wrong}")
                } else {
                    wrong
                }
            }
        }
    }

    /// True if one of the two is what the other one was tuned to.
    pub fn is_other_setting_of(&self, other: &Self) -> bool {
        let is_of = |tuned: &Self, base: &Self| {
            tuned.row.is_tuned() && tuning::is_default_of(base.row, tuned.row)
        };
        is_of(self, other) || is_of(other, self)
    }

    /// The figure by which settings of one method are ranked.
    pub fn error_to_rank(&self) -> f64 {
        if self.is_soft {
            self.rmse
        } else {
            self.wrong.share()
        }
    }

    pub fn is_within(&self, budgets: &Budgets) -> bool {
        let (slowest, most_wrong, bytes) =
            (self.slowest.value, self.most_wrong.value, self.row.bytes());
        budgets.frame_ms.is_none_or(|most| slowest <= most)
            && budgets.wrong_percent.is_none_or(|most| most_wrong < most)
            && budgets.memory_bytes.is_none_or(|most| bytes <= most)
    }

    /// The view or frame that breaks a budget which the method keeps to over all views.
    pub fn beyond(&self, budgets: &Budgets) -> Option<String> {
        let (slowest, most_wrong) = (&self.slowest, &self.most_wrong);
        let is_slow = |most: &f64| self.frame <= *most && slowest.value > *most;
        let slow = budgets.frame_ms.filter(is_slow).map(|_| {
            let [mean, worst] = [self.frame, slowest.value].map(ms);
            format!("takes {worst} ms{} (mean {mean})", slowest.on())
        });
        let shares = [100.0 * self.wrong.share(), most_wrong.value];
        let is_wrong = |most: &f64| shares[0] < *most && shares[1] >= *most;
        let wrong = budgets.wrong_percent.filter(is_wrong).map(|_| {
            let [total, worst] = shares.map(|share| format!("{share:.3} %"));
            format!("is wrong on {worst}{} ({total} in all)", most_wrong.on())
        });
        let beyond: Vec<String> = slow.into_iter().chain(wrong).collect();
        let name = self.name();
        (!beyond.is_empty()).then(|| format!("{name} {}.", beyond.join(" and ")))
    }

    /// That no pixel is wrong, as far as that can be judged.
    pub fn right(&self) -> &'static str {
        self.condition
            .map_or("exact here", |_| "right on all of these")
    }

    pub fn per_frame(&self) -> String {
        format!("{} ms a frame", ms(self.frame))
    }

    /// True if nothing moves and it costs next to nothing.
    pub fn is_resting(&self) -> bool {
        self.when == Some(Regime::Nothing) && self.frame < AT_REST_MS
    }

    pub fn is_told_apart(&self, other: &Self) -> bool {
        let are_resting = self.is_resting() && other.is_resting();
        !are_resting && self.row.is_told_apart(other.row, self.when)
    }

    /// True if the frames of both were timed in the same turns.
    pub fn took_turns_with(&self, other: &Self) -> bool {
        self.row.ratio(other.row, self.when).is_some()
    }

    /// How many times as fast as another method it is, with the interval.
    pub fn times_as_fast(&self, other: &Self) -> String {
        match other.row.ratio(self.row, self.when) {
            Some(Ratio { low, median, high }) => {
                let [low, median, high] = [low, median, high].map(ratio);
                let interval = format!(" ({low} to {high})");
                let interval = if low == high { "" } else { &interval };
                format!("{median} times as fast{interval}")
            }
            None => format!("{} times as fast", ratio(other.frame / self.frame)),
        }
    }

    pub fn name(&self) -> String {
        format!("`{}`", self.label)
    }
}

/// A ratio of times as it is read: two digits that count.
fn ratio(ratio: f64) -> String {
    let decimals = usize::from(ratio < 9.95);
    format!("{ratio:.decimals$}")
}
