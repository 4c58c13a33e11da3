//! Writes values of params as the command line takes them.

use serde_json::Value;
use std::collections::BTreeMap;

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
