//! Outcomes of calls.

use serde::{Serialize, de::DeserializeOwned};
use skiagraph_compare::error::with_causes;
use skiagraph_reference::Image;
use std::error::Error;
use wasm_bindgen::prelude::*;

/// Outcome of a call; an error is text for the user.
pub type Answer<T> = Result<T, JsValue>;

/// An error with its causes, as text for the user.
pub fn fault(error: impl Into<Box<dyn Error>>) -> JsValue {
    JsValue::from_str(&with_causes(&*error.into()))
}

/// Reads the JSON of a request.
pub fn parsed<T: DeserializeOwned>(json: &str) -> Answer<T> {
    serde_json::from_str(json)
        .map_err(|error| fault(format!("invalid request from the page: {error}")))
}

/// Writes a value as JSON.
pub fn json(value: &impl Serialize) -> Answer<String> {
    serde_json::to_string(value).map_err(fault)
}

/// The pixels of an image for a canvas, four bytes each.
pub fn rgba(image: &Image) -> Vec<u8> {
    let pixels = image.rgb.chunks_exact(3);
    pixels
        .flat_map(|pixel| [pixel[0], pixel[1], pixel[2], 255])
        .collect()
}
