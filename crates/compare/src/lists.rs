//! Lists without repeats.
//!
//! ```
//! use skiagraph_compare::lists::unique;
//!
//! assert_eq!(unique(["rt", "nsm", "rt"]), ["rt", "nsm"]);
//! ```

/// A list without repeats, in its own order.
pub fn unique<T: PartialEq>(list: impl IntoIterator<Item = T>) -> Vec<T> {
    let mut kept = Vec::new();
    for item in list {
        if !kept.contains(&item) {
            kept.push(item);
        }
    }
    kept
}
