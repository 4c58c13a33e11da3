#![doc = include_str!("../README.md")]

mod canvas;
mod colours;
mod data;
mod error;
mod figure;
mod frames;
mod front;
mod legend;
mod marker;
mod panel;
mod scale;
mod text;

pub use data::{Kind, Mark, Panel, Series};
pub use error::Error;
pub use figure::Figure;
pub use front::front;
pub use text::{superscript, xml};
