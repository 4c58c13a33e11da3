//! Files as such, whatever they hold: writing them whole, CSV and JSON with the place of its
//! mistakes, fingerprints of what was read.

pub mod csv;
pub mod fingerprint;
pub mod json;
pub mod picture_sources;
pub mod watch;
pub mod write;
