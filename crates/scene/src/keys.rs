//! Interpolation between keyframes.

use glam::DVec3;

/// Returns the mistake in the order of keys, if there is one.
pub(crate) fn not_later<K>(keys: &[K], time: fn(&K) -> f64) -> Option<String> {
    let mut pairs = keys.windows(2).map(|pair| [time(&pair[0]), time(&pair[1])]);
    let late = pairs.find(|[before, after]| !(before < after && after.is_finite()))?;
    Some(format!(
        "a key at {} s follows one at {} s, expected a later time",
        late[1], late[0]
    ))
}

/// A value between keys.
pub(crate) fn spline<K>(
    keys: &[K],
    time: fn(&K) -> f64,
    vector: impl Fn(&K) -> DVec3,
    at: f64,
) -> DVec3 {
    // The last key that has passed, but one that has another behind it.
    let passed = keys.partition_point(|key| time(key) <= at).max(1) - 1;
    let from = passed.min(keys.len().saturating_sub(2));
    let [a, b] = match keys.get(from..from + 2) {
        Some([a, b]) => [a, b],
        _ => return keys.first().map_or(DVec3::ZERO, vector),
    };
    // The slope at a key is that between its neighbours.
    let slope = |key: usize| {
        let before = &keys[key.saturating_sub(1)];
        let after = &keys[(key + 1).min(keys.len() - 1)];
        (vector(after) - vector(before)) / (time(after) - time(before))
    };
    let (before, after) = (slope(from), slope(from + 1));
    // A key that stands still is the same to the last bit in every frame.
    if vector(a) == vector(b) && before == DVec3::ZERO && after == DVec3::ZERO {
        return vector(a);
    }
    let span = time(b) - time(a);
    let t = ((at - time(a)) / span).clamp(0.0, 1.0);
    let (square, cube) = (t * t, t * t * t);
    vector(a) * (2.0 * cube - 3.0 * square + 1.0)
        + before * (span * (cube - 2.0 * square + t))
        + vector(b) * (3.0 * square - 2.0 * cube)
        + after * (span * (cube - square))
}
