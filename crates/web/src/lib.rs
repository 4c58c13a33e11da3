//! The page of Skiagraph in a browser: what its workers call. `page/` holds the page itself.
//!
//! Structured data goes both ways as JSON, pixels as typed arrays. There are two workers: one owns
//! the device (`page::Page`), the other computes the exact reference (`judge::Judge`).

#![cfg(target_arch = "wasm32")]

mod answer;
pub mod catalogue;
pub mod documents;
pub mod judge;
pub mod measure;
pub mod page;
pub mod stage;

use wasm_bindgen::prelude::*;

#[wasm_bindgen]
extern "C" {
    #[wasm_bindgen(js_namespace = console)]
    fn error(text: &str);
}

/// Writes the message of a panic to the browser's console. The worker traps behind it, and the page
/// starts another one.
#[wasm_bindgen(start)]
pub fn start() {
    std::panic::set_hook(Box::new(|info| error(&info.to_string())));
}
