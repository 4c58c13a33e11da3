//! Skiagraph.

fn main() {}
