//! Chooses the colours and marks of methods: the same in every chart, table and page.

use itertools::Itertools;
use skiagraph_compare::graphs::preset::{SHIPPED, built_in};
use skiagraph_compare::lists::unique;

/// Returns the list of series for [`Figure::looks`](skiagraph_chart::Figure::looks) of a figure of
/// these methods. Built-in presets have the same place in every list: those of [`SHIPPED`] first,
/// then the other built-in ones. All other methods follow in the order of their names.
pub fn looks(methods: impl IntoIterator<Item = String>) -> Vec<String> {
    let shipped = SHIPPED.map(str::to_owned).into_iter();
    let names = shipped.chain(built_in());
    unique(names.chain(methods.into_iter().sorted()))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_built_in_preset_has_its_place_whatever_stands_beside_it() {
        let some = looks(["mine.ron".to_owned(), "crsm@n=1".into(), "esm".into()]);
        let built_in = looks(["tsm".to_owned()]);
        assert_eq!(some[..8], SHIPPED);
        assert_eq!(some[..built_in.len()], built_in);
        assert_eq!(some[built_in.len()..], ["crsm@n=1", "mine.ron"]);
    }
}
