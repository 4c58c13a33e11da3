//! Writes a buffer as CSV: a line per item, a column per scalar.
//!
//! ```
//! use skiagraph_compare::pictures::buffer_csv::to_csv;
//!
//! let bytes = [7_u32, 1.5_f32.to_bits()].map(u32::to_le_bytes).concat();
//! let lines = to_csv(&bytes, None, 0)?;
//! assert_eq!(lines.lines().next(), Some("item,u32,i32,f32"));
//! assert_eq!(lines.lines().nth(2), Some("1,1069547520,1069547520,1.5"));
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

use crate::files::csv;
use skiagraph_graph::{Field, Item, ItemScalar};

/// Returns the bytes of a buffer as CSV, a line per item. `item` is the item's layout as a shader
/// declares it; its scalars are the columns. With `None` each 32-bit word is an item, shown as u32,
/// i32 and f32. Items are numbered from `first` on, the index of the first item in the whole
/// buffer. Bytes behind the last whole item are left out.
pub fn to_csv(bytes: &[u8], item: Option<&Item>, first: usize) -> Result<String, ::csv::Error> {
    let words = || {
        let field = |(name, scalar): (&str, _)| Field {
            name: name.into(),
            offset: 0,
            scalar,
        };
        let readings = [
            ("u32", ItemScalar::U32),
            ("i32", ItemScalar::I32),
            ("f32", ItemScalar::F32),
        ];
        Item {
            stride: 4,
            fields: readings.map(field).into(),
        }
    };
    let Item { stride, fields } = &item.cloned().unwrap_or_else(words);
    let names = fields.iter().map(|field| match field.name.as_str() {
        "" => "value",
        name => name,
    });
    let header = ["item"].into_iter().chain(names);
    let items = bytes.chunks_exact((*stride).max(1)).enumerate();
    let records = items.map(|(index, bytes)| {
        let cells = fields.iter().map(|field| cell(bytes, field));
        [(first + index).to_string()].into_iter().chain(cells)
    });
    csv::to_text(header, records)
}

/// A scalar in the shortest digits that read back as the same; empty if the bytes end before it.
fn cell(bytes: &[u8], field: &Field) -> String {
    let word = bytes.get(field.offset..).and_then(<[u8]>::first_chunk);
    let Some(&word) = word else {
        return String::new();
    };
    match field.scalar {
        ItemScalar::F32 => f32::from_le_bytes(word).to_string(),
        ItemScalar::I32 => i32::from_le_bytes(word).to_string(),
        ItemScalar::U32 => u32::from_le_bytes(word).to_string(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn text(bytes: &[u8], item: Option<&Item>) -> String {
        to_csv(bytes, item, 0).unwrap()
    }

    #[test]
    fn items_have_a_line_each_and_padding_is_left_out() {
        let field = |name: &str, offset, scalar| Field {
            name: name.into(),
            offset,
            scalar,
        };
        let item = Item {
            stride: 12,
            fields: vec![
                field("t", 0, ItemScalar::F32),
                field("id", 8, ItemScalar::U32),
            ],
        };
        let mut bytes = Vec::new();
        for (t, id) in [(0.1f32, 7u32), (f32::INFINITY, u32::MAX)] {
            bytes.extend(t.to_le_bytes());
            bytes.extend([0xee; 4]);
            bytes.extend(id.to_le_bytes());
        }
        assert_eq!(
            text(&bytes, Some(&item)),
            "item,t,id\n0,0.1,7\n1,inf,4294967295\n"
        );
    }

    #[test]
    fn words_of_unknown_meaning_are_read_in_three_ways() {
        let bytes = [1065353216u32, u32::MAX].map(u32::to_le_bytes).concat();
        let lines = "item,u32,i32,f32\n0,1065353216,1065353216,1\n1,4294967295,-1,NaN\n";
        assert_eq!(text(&bytes, None), lines);
        let fifth = to_csv(&bytes, None, 5).unwrap();
        assert!(fifth.contains("\n5,1065353216") && fifth.contains("\n6,4294967295"));
    }
}
