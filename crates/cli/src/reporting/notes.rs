//! What is said below tables, wherever they stand.

use crate::records::results::Run;

/// A band of more than one pixel in so many of those facing the light leaves too much open.
const MAX_BAND: u128 = 1000;

/// That the band of a view and viewport leaves too much open, if it does.
pub fn band_warning(run: &Run) -> Option<String> {
    let is_large = u128::from(run.band) * MAX_BAND > u128::from(run.pixels.facing_light);
    let text = "warning: the band is larger than 0.1 % of PFL; what lies in it is not proven";
    is_large.then(|| text.to_owned())
}

/// Which GPU times a run lacks on an adapter whose timestamps are true.
pub fn times_missing(run: &Run) -> Option<String> {
    let measured = run.measured.as_ref()?;
    let passes = measured.passes.iter();
    let passes = passes.map(|pass| (pass.name.as_str(), pass.gpu_ms.is_some()));
    let why = untimed(passes, measured.frame.gpu_ms.is_some())?;
    Some(format!("{}: {why}", run.method_label()))
}

/// Which GPU times are missing: of passes, each with whether it has one, and of the frame.
pub fn untimed<'a>(passes: impl Iterator<Item = (&'a str, bool)>, frame: bool) -> Option<String> {
    let untimed: Vec<&str> = passes
        .filter_map(|(name, is_timed)| (!is_timed).then_some(name))
        .collect();
    let untimed = untimed.join(", ");
    Some(match (frame, untimed.as_str()) {
        (true, "") => return None,
        (true, _) => format!(
            "the whole frame is timed over its other passes, there are no GPU times of {untimed}"
        ),
        (false, "") => "no GPU time of the whole frame: some frames had none".into(),
        (false, _) => format!("no GPU time of the whole frame: there are none of {untimed}"),
    })
}
