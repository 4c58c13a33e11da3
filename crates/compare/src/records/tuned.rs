//! Settings of a method that `compare --tune` found.
//!
//! ```
//! use skiagraph_compare::records::tuned::Tuned;
//!
//! let tuned = Tuned {
//!     of: "nsm".into(),
//!     set: [("cull".to_owned(), "none".into()), ("slope_bias".to_owned(), 2.into())].into(),
//!     ..Tuned::default()
//! };
//! assert_eq!(tuned.words(), "cull=none, slope_bias=2");
//! assert_eq!(tuned.argument(), "nsm@cull=none,slope_bias=2");
//! let given = [("fit".to_owned(), "camera".into())].into();
//! let tuned = Tuned { given, ..tuned };
//! assert_eq!(tuned.argument(), "nsm@cull=none,fit=camera,slope_bias=2");
//! ```

use itertools::Itertools;
use serde::{Deserialize, Serialize};
use serde_json::Value;
use std::collections::BTreeMap;

/// Record of a search for good settings of one method: what was found, and on which views.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Tuned {
    /// Name of the method before the search, such as `nsm`. The results have runs of that method,
    /// too, beside the tuned ones.
    pub of: String,
    /// Values of the params that were set for all methods of the comparison (`--set`), by name.
    #[serde(default, skip_serializing_if = "BTreeMap::is_empty")]
    pub given: BTreeMap<String, Value>,
    /// Params that the search changed, with their values; empty if no setting was better than the
    /// defaults.
    pub set: BTreeMap<String, Value>,
    /// Names of the views on which the settings were chosen. The runs in the results are of other
    /// views.
    pub chosen_on: Vec<String>,
    /// Number of settings that were tried, the defaults included.
    pub tried: u32,
    /// True if the search ended because no change helps; false if it ended at the limit of its
    /// cost.
    pub is_whole: bool,
    /// Error of the defaults, from 0 to 1, the mean over the views of `chosen_on`: the share of the
    /// pixels facing the light that are wrong, without those whose right answer rounding may flip;
    /// under lights [with an extent](crate#terms) the mean square error of the [shares of
    /// light](crate#terms). A view with less than a quarter of the mean number of such pixels
    /// counts less.
    pub default_error: f64,
    /// Error of the tuned setting on the views of `chosen_on`, in the same unit.
    pub error: f64,
}

impl Tuned {
    /// Returns the changed params as a list for a reader: `cull=none, slope_bias=2`.
    pub fn words(&self) -> String {
        assignments(&self.set).join(", ")
    }

    /// Returns the tuned method as an argument of `compare`, with all params that it needs to be
    /// the same again: `nsm@cull=none,slope_bias=2`.
    pub fn argument(&self) -> String {
        let params = assignments(&self.given).chain(assignments(&self.set));
        named(&self.of, &params.sorted().join(","))
    }
}

/// Returns the name of a method with more assignments: `nsm` and `cull=none` give `nsm@cull=none`,
/// `nsm@bias=0` gives `nsm@bias=0,cull=none`. The name stays if there are none.
pub fn named(method: &str, assignments: &str) -> String {
    let sign = if method.contains('@') { ',' } else { '@' };
    match assignments {
        "" => method.to_owned(),
        assignments => format!("{method}{sign}{assignments}"),
    }
}

/// Returns each of `params` as an assignment: `cull=front`, `slope_bias=1.5`.
pub(crate) fn assignments(params: &BTreeMap<String, Value>) -> impl Iterator<Item = String> {
    let params = params.iter();
    params.map(|(name, value)| format!("{name}={}", text(value)))
}

/// A value as the command line writes it: `none`, `2`, `0.5`, `1,0,0`.
fn text(value: &Value) -> String {
    match value {
        Value::String(word) => word.clone(),
        Value::Array(list) => list.iter().map(text).collect::<Vec<_>>().join(","),
        Value::Number(number) => number.as_f64().map_or(String::new(), |n| n.to_string()),
        other => other.to_string(),
    }
}
