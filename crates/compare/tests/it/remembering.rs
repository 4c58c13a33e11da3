//! A method that traces a quarter of its pixels in each frame and keeps the answers of the frame
//! before for the others.

use crate::support::{along, park_comparison, runs, timed};
use serde_json::Value;

/// The folder that has it.
const TEMPORAL: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/../../tests/foreign/temporal");

#[test]
fn it_is_right_where_the_camera_stands_and_late_where_it_moves() {
    let compared = || {
        timed(
            park_comparison(&["temporal.ron"], TEMPORAL.as_ref(), 48),
            [2, 1, 1],
        )
    };
    let still = runs(&compared());
    let run = &still[0];
    // Four frames until every pixel had its ray, and those that show it.
    assert_eq!(run["steady"]["period"], 1);
    assert_eq!(run["steady"]["judged"]["pictures"], 1);
    assert!((33..40).contains(&run["steady"]["frames"].as_u64().unwrap()));
    assert_eq!(run["wrong"]["total"], run["wrong"]["in_band"]);

    let moving = runs(&along(compared(), "walk"));
    let frames = moving[0]["sequence"]["frames"].as_array().unwrap();
    assert_eq!(frames[0]["wrong_outside_band"], 0);
    let late = |frame: &&Value| frame["wrong_outside_band"].as_u64().unwrap() > 0;
    assert!(frames.iter().filter(late).count() > 12, "{frames:?}");
}
