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

/// Returns the index of the first item of `list` that equals `item`. If there is none, `item` is
/// added at the end.
pub fn place<T: PartialEq>(list: &mut Vec<T>, item: T) -> usize {
    let index = list.iter().position(|listed| *listed == item);
    index_or_push(list, index, || item)
}

fn index_or_push<T>(list: &mut Vec<T>, index: Option<usize>, new: impl FnOnce() -> T) -> usize {
    index.unwrap_or_else(|| {
        list.push(new());
        list.len() - 1
    })
}

/// Returns the first item of `list` that `is` tells; if there is none, `new` is added at the end.
pub fn find_or_push<T>(
    list: &mut Vec<T>,
    is: impl FnMut(&T) -> bool,
    new: impl FnOnce() -> T,
) -> &mut T {
    let index = list.iter().position(is);
    let place = index_or_push(list, index, new);
    &mut list[place]
}

/// Returns the value beside the first `key` in a list of pairs. If there is none, `key` is added at
/// the end with the default value.
pub fn entry<K: PartialEq, V: Default>(list: &mut Vec<(K, V)>, key: K) -> &mut V {
    let index = list.iter().position(|(listed, _)| *listed == key);
    let place = index_or_push(list, index, || (key, V::default()));
    &mut list[place].1
}
