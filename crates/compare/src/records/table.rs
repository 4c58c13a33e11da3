//! A table as plain data, and as text where that needs no more than text.
//!
//! ```
//! use skiagraph_compare::records::table::Table;
//!
//! let rows = [["nsm", "503"], ["light_buffer", "0"]];
//! let table = Table::new(["method", "wrong"], 1, rows.map(|row| row.map(str::to_owned).to_vec()));
//! assert!(table.markdown().starts_with("| method | wrong |\n|---|---:|\n"));
//! assert_eq!(table.csv()?, "method,wrong\nnsm,503\nlight_buffer,0\n");
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

use crate::files::csv;
use serde::Serialize;

/// Heads and rows of cells, which are as they are shown.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct Table {
    /// A head for each column.
    pub heads: Vec<String>,
    /// How many columns hold words, from the first on; the others hold numbers.
    pub words: usize,
    /// Rows of as many cells as there are heads.
    pub rows: Vec<Vec<String>>,
}

impl Table {
    /// A table whose first `words` columns hold words.
    pub fn new<H: Into<String>>(
        heads: impl IntoIterator<Item = H>,
        words: usize,
        rows: impl IntoIterator<Item = Vec<String>>,
    ) -> Self {
        Self {
            heads: heads.into_iter().map(Into::into).collect(),
            words,
            rows: rows.into_iter().collect(),
        }
    }

    /// The table for a document.
    pub fn markdown(&self) -> String {
        let line = |cells: &[String]| {
            let cells: Vec<String> = cells.iter().map(|cell| cell.replace('|', "\\|")).collect();
            format!("| {} |\n", cells.join(" | "))
        };
        let rule = |column| if column < self.words { "---|" } else { "---:|" };
        let rule: String = (0..self.heads.len()).map(rule).collect();
        let rows: String = self.rows.iter().map(|row| line(row)).collect();
        format!("{}|{rule}\n{rows}", line(&self.heads))
    }

    /// The table as CSV: a line per row, quoted where needed.
    ///
    /// # Errors
    /// A row that is not as long as the heads.
    pub fn csv(&self) -> Result<String, ::csv::Error> {
        csv::to_text(&self.heads, &self.rows)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_cell_may_hold_what_separates_cells() {
        let table = Table::new(["name", "n"], 1, [vec!["a|b, c".into(), "1".into()]]);
        assert_eq!(
            table.markdown(),
            "| name | n |\n|---|---:|\n| a\\|b, c | 1 |\n"
        );
        assert_eq!(table.csv().unwrap(), "name,n\n\"a|b, c\",1\n");
        let short = Table::new(["name", "n"], 1, [vec!["a".into()]]);
        assert!(short.csv().is_err());
    }
}
