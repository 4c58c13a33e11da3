//! Helps with lists: removes repeats, and finds or adds items and keys.
//!
//! ```
//! use skiagraph_compare::lists::unique;
//!
//! assert_eq!(unique(["rt", "nsm", "rt"]), ["rt", "nsm"]);
//! ```

/// Returns the items in their order, without repeats: the first of equal items is kept.
pub fn unique<T: PartialEq>(list: impl IntoIterator<Item = T>) -> Vec<T> {
    let mut kept = Vec::new();
    for item in list {
        if !kept.contains(&item) {
            kept.push(item);
        }
    }
    kept
}

/// Returns the index of an item in a list; a missing item is added at the end first.
pub fn place<T: PartialEq>(list: &mut Vec<T>, item: T) -> usize {
    let known = list.iter().position(|known| *known == item);
    known.unwrap_or_else(|| {
        list.push(item);
        list.len() - 1
    })
}

/// Returns the value of a key in a list of pairs; a missing key is added at the end with a default
/// value first.
pub fn entry<K: PartialEq, V: Default>(list: &mut Vec<(K, V)>, key: K) -> &mut V {
    let known = list.iter().position(|(known, _)| *known == key);
    let place = known.unwrap_or_else(|| {
        list.push((key, V::default()));
        list.len() - 1
    });
    &mut list[place].1
}
