//! A table as plain data, which can be written as Markdown or CSV.
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

/// A table of cells that hold text.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct Table {
    /// Text above each column, one per column.
    pub heads: Vec<String>,
    /// Number of leading columns that hold words; the other columns hold numbers.
    pub words: usize,
    /// Cells of each row, one per column.
    pub rows: Vec<Vec<String>>,
}

impl Table {
    /// Creates a table whose first `words` columns hold words, the others numbers.
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

    /// Returns the table as Markdown, with numbers aligned to the right. Several lines of text in a
    /// cell are joined by commas.
    pub fn markdown(&self) -> String {
        let cell = |text: &String| text.replace('|', "\\|").replace('\n', ", ");
        let line = |cells: &[String]| {
            let cells: Vec<String> = cells.iter().map(cell).collect();
            format!("| {} |\n", cells.join(" | "))
        };
        let rule = |column| if column < self.words { "---|" } else { "---:|" };
        let rule: String = (0..self.heads.len()).map(rule).collect();
        let rows: String = self.rows.iter().map(|row| line(row)).collect();
        format!("{}|{rule}\n{rows}", line(&self.heads))
    }

    /// Returns the table as CSV: a line per row, quoted where needed.
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
        let table = Table::new(["name", "n"], 1, [vec!["a|b, c".into(), "1\n2".into()]]);
        assert_eq!(
            table.markdown(),
            "| name | n |\n|---|---:|\n| a\\|b, c | 1, 2 |\n"
        );
        assert_eq!(table.csv().unwrap(), "name,n\n\"a|b, c\",\"1\n2\"\n");
        let short = Table::new(["name", "n"], 1, [vec!["a".into()]]);
        assert!(short.csv().is_err());
    }
}
