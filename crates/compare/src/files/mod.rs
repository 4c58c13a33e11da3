//! Files as such, whatever they hold: writing them whole, CSV and JSON with the place of its
//! mistakes, fingerprints of what was read, locks.

pub mod csv;
pub mod fingerprint;
pub mod json;
pub mod lock;
pub mod picture_sources;
pub mod watch;
pub mod write;
