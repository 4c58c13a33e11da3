//! A buffer as a table: a line per item, a column per scalar.

use skiagraph_graph::{Field, Item, Scalar};

/// The lines of a buffer: with the items as a shader declares them, or, where none does, its words read in three ways. Bytes
/// behind the last whole item are left out.
pub fn to_csv(bytes: &[u8], item: Option<&Item>) -> Result<Vec<u8>, csv::Error> {
    let words = || {
        let field = |name: &str, scalar| Field {
            name: name.into(),
            offset: 0,
            scalar,
        };
        Item {
            stride: 4,
            fields: vec![
                field("u32", Scalar::U32),
                field("i32", Scalar::I32),
                field("f32", Scalar::F32),
            ],
        }
    };
    let Item { stride, fields } = &item.cloned().unwrap_or_else(words);
    let mut writer = csv::Writer::from_writer(Vec::new());
    let names = fields.iter().map(|field| match field.name.as_str() {
        "" => "value",
        name => name,
    });
    writer.write_record(["item"].into_iter().chain(names))?;
    for (index, bytes) in bytes.chunks_exact((*stride).max(1)).enumerate() {
        let cells = fields.iter().map(|field| cell(bytes, field));
        writer.write_record([index.to_string()].into_iter().chain(cells))?;
    }
    writer
        .into_inner()
        .map_err(|error| error.into_error().into())
}

/// A scalar in the shortest digits that read back as the same; empty if the bytes end before it.
fn cell(bytes: &[u8], field: &Field) -> String {
    let Some(Ok(word)) = bytes
        .get(field.offset..field.offset + 4)
        .map(<[u8; 4]>::try_from)
    else {
        return String::new();
    };
    match field.scalar {
        Scalar::F32 => f32::from_le_bytes(word).to_string(),
        Scalar::I32 => i32::from_le_bytes(word).to_string(),
        Scalar::U32 => u32::from_le_bytes(word).to_string(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn text(bytes: &[u8], item: Option<&Item>) -> String {
        String::from_utf8(to_csv(bytes, item).unwrap()).unwrap()
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
            fields: vec![field("t", 0, Scalar::F32), field("id", 8, Scalar::U32)],
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
    }
}
