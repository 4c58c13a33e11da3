//! Lists without repeats, and lists of keys in their own order.
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

/// Where an item stands in a list; one that is missing is put at its end.
pub fn place<T: PartialEq>(list: &mut Vec<T>, item: T) -> usize {
    let known = list.iter().position(|known| *known == item);
    known.unwrap_or_else(|| {
        list.push(item);
        list.len() - 1
    })
}

/// The value of a key in a list; a key that is missing is put at its end.
pub fn entry<K: PartialEq, V: Default>(list: &mut Vec<(K, V)>, key: K) -> &mut V {
    let known = list.iter().position(|(known, _)| *known == key);
    let place = known.unwrap_or_else(|| {
        list.push((key, V::default()));
        list.len() - 1
    });
    &mut list[place].1
}
