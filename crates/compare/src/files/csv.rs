//! CSV: a line per record, quoted where needed.

use csv::{Error, Writer};
use std::borrow::Cow;

/// Returns the text of a CSV file: the header, then a line per record. Text that a spreadsheet
/// would take for a formula ([`inert`]) has an apostrophe before it.
///
/// # Errors
/// A record that is not as long as the header.
pub fn to_text<H: AsRef<[u8]>, C: AsRef<[u8]>, R: IntoIterator<Item = C>>(
    header: impl IntoIterator<Item = H>,
    records: impl IntoIterator<Item = R>,
) -> Result<String, Error> {
    let mut writer = Writer::from_writer(Vec::new());
    writer.write_record(header)?;
    for record in records {
        let cells: Vec<C> = record.into_iter().collect();
        writer.write_record(cells.iter().map(|cell| inert(cell.as_ref())))?;
    }
    let bytes = writer.into_inner().map_err(|error| error.into_error())?;
    Ok(String::from_utf8_lossy(&bytes).into_owned())
}

/// Puts an apostrophe before text that begins with a sign by which spreadsheets know formulas, as
/// OWASP advises; numbers stay numbers.
fn inert(cell: &[u8]) -> Cow<'_, [u8]> {
    let is_number = || str::from_utf8(cell).is_ok_and(|text| text.parse::<f64>().is_ok());
    match cell.first() {
        Some(b'=' | b'+' | b'-' | b'@' | b'\t' | b'\r') if !is_number() => {
            Cow::Owned([b"'", cell].concat())
        }
        _ => Cow::Borrowed(cell),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn no_text_is_a_formula_and_numbers_stay_numbers() {
        let texts = [
            "=1+1",
            "+a",
            "-x",
            "@sum",
            "\t=1",
            "\r=1",
            "-",
            "=HYPERLINK(\"a\")",
            "-1-1",
        ];
        let numbers = [
            "-1.5",
            "+2",
            "-1e-9",
            "-inf",
            "0",
            "a=b",
            "",
            "nsm@bias=0",
            "–",
        ];
        let csv = to_text(["x"], texts.iter().chain(&numbers).map(|cell| [*cell])).unwrap();
        let mut reader = csv::Reader::from_reader(csv.as_bytes());
        let cells: Vec<String> = reader
            .records()
            .map(|record| record.unwrap()[0].to_owned())
            .collect();
        let guarded = texts.map(|text| format!("'{text}"));
        assert_eq!(cells[..texts.len()], guarded);
        assert_eq!(cells[texts.len()..], numbers);
    }
}
