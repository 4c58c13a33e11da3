//! Skiagraph.
