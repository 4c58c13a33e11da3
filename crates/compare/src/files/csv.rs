//! CSV: a line per record, quoted where needed.

use csv::{Error, Writer};

/// Returns the text of a CSV file: the header, then a line per record.
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
        writer.write_record(record)?;
    }
    let bytes = writer.into_inner().map_err(|error| error.into_error())?;
    Ok(String::from_utf8_lossy(&bytes).into_owned())
}
