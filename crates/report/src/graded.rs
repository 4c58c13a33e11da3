//! Remarks on visibility that is a share of light, and on lights with an extent.

use itertools::Itertools;
use skiagraph_compare::records::results::{AreaReference, Run};
use skiagraph_compare::wording::thousands;
use skiagraph_reference::{Graded, Invalid};

/// Describes the [reference](skiagraph_compare#terms) of a light [with an
/// extent](skiagraph_compare#terms): its samples per pixel, its standard error, and the number of
/// pixels in penumbra. `band` is the number of pixels in the band, whose answer rounding decides.
pub fn area_reference(area: &AreaReference, band: u64) -> String {
    let (rms, worst) = (area.standard_error_rms, area.standard_error_worst);
    let [samples, penumbra, band] = [area.samples.into(), area.penumbra, band].map(thousands);
    format!(
        "the light has an extent: reference of {samples} samples per pixel, standard error \
         {rms:.5} (root mean square over PFL; the worst {worst:.5}); lit is what sees half of it \
         or more, in penumbra {penumbra}, in the band {band}"
    )
}

/// Returns remarks on the runs whose answers are [shares of light](skiagraph_compare#terms), 0 to
/// 1, a line each: the methods by error under a light [with an extent](skiagraph_compare#terms),
/// invalid shares, and the meaning of the colours of error pictures. Empty if there are no such
/// runs.
pub fn graded(runs: &[Run]) -> Vec<String> {
    let mut notes: Vec<String> = ranks(runs).into_iter().collect();
    notes.extend(runs.iter().filter_map(no_shares));
    if runs.iter().any(|run| !run.is_hard()) {
        notes.push(
            "RMSE is over PFL; *light in umbra* is the mean share that pixels show too much which \
             see less than a tenth of the light, *dark in light* that which pixels lack that see \
             more than nine tenths, *penumbra* is in between; error pictures of grades: blue too \
             light, red too dark, full colour where off by 1/4 and more, magenta NaN"
                .into(),
        );
    }
    notes
}

fn errors(run: &Run) -> Option<Graded> {
    Some(run.measured.as_ref()?.graded)
}

/// Returns a warning with the number of pixels at which a run's visibility is NaN, infinite or
/// outside 0 to 1. `None` if there are none, or the method could not run.
pub fn no_shares(run: &Run) -> Option<String> {
    let invalid = errors(run)?.invalid;
    let counts = invalid_counts(&invalid);
    let label = run.method_label();
    let text = format!("warning: {label}: visibility that is not a share of light: {counts}");
    (invalid.total() > 0).then_some(text)
}

/// Counts the pixels whose visibility is not a share of light, by kind of value.
pub fn invalid_counts(invalid: &Invalid) -> String {
    counted([
        ("NaN", invalid.nan),
        ("infinite", invalid.infinite),
        ("outside 0 to 1", invalid.outside),
    ])
}

/// Returns the counts that are not 0 as text, each behind its name.
pub fn counted<'a>(counts: impl IntoIterator<Item = (&'a str, u64)>) -> String {
    let counts = counts.into_iter().filter(|(_, count)| *count > 0);
    let mut counts = counts.map(|(what, count)| format!("{what} {}", thousands(count)));
    counts.join(", ")
}

/// Methods by their error under a light with extent, and whether the reference can tell.
fn ranks(runs: &[Run]) -> Option<String> {
    let reference = runs.first()?.area?.standard_error_rms;
    let rank = |run: &Run| Some((errors(run)?.rmse, run.method_label()));
    let mut ranks: Vec<(f64, String)> = runs.iter().filter_map(rank).collect();
    ranks.sort_by(|(one, _), (other, _)| one.total_cmp(other));
    let in_doubt = ranks.iter().filter(|(rmse, _)| *rmse < 10.0 * reference);
    let in_doubt = in_doubt.map(|(_, label)| label).join(", ");
    let listed = ranks.iter();
    let mut listed = listed.map(|(rmse, label)| format!("{label} {rmse:.5}"));
    let mut text = format!("by RMSE: {}", listed.join(", "));
    if !in_doubt.is_empty() {
        text += "; the reference's own error is more than a tenth of that of ";
        text += &in_doubt;
    }
    (!ranks.is_empty()).then_some(text)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::test_support::results as sample;
    use skiagraph_compare::records::results::Answer;
    use skiagraph_reference::Invalid;

    fn run(rmse: f64, answer: Answer) -> Run {
        let mut run = sample().runs.remove(0);
        let measured = run.measured.as_mut().unwrap();
        measured.answer = answer;
        measured.graded = Graded {
            rmse,
            ..Graded::default()
        };
        run
    }

    fn reference() -> AreaReference {
        AreaReference {
            samples: 512,
            standard_error_rms: 0.0015,
            standard_error_worst: 0.0625,
            penumbra: 1_234,
        }
    }

    #[test]
    fn ranks_say_what_the_reference_cannot_tell() {
        let mut runs = [run(0.2, Answer::Hard), run(0.01, Answer::Graded)];
        assert!(graded(&runs[..1]).is_empty());
        let notes = graded(&runs);
        assert!(
            notes[0].starts_with("RMSE is over PFL"),
            "no rank under a light without extent"
        );
        runs.iter_mut().for_each(|run| run.area = Some(reference()));
        runs[0].preset = "nsm".into();
        runs[1].preset = "soft".into();
        let invalid = Invalid {
            nan: 2,
            infinite: 0,
            outside: 1_000,
        };
        let measured = runs[1].measured.as_mut().unwrap();
        measured.graded.invalid = invalid;
        let expected = [
            "by RMSE: soft 1024 0.01000, nsm 1024 0.20000; the reference's own error is more than \
             a tenth of that of soft 1024",
            "warning: soft 1024: visibility that is not a share of light: NaN 2, outside 0 to 1 \
             1,000",
        ];
        assert_eq!(graded(&runs)[..2], expected);
        assert_eq!(
            area_reference(&reference(), 12),
            "the light has an extent: reference of 512 samples per pixel, standard error 0.00150 \
             (root mean square over PFL; the worst 0.06250); lit is what sees half of it or more, \
             in penumbra 1,234, in the band 12"
        );
    }
}
