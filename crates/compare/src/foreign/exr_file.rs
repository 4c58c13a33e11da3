//! Decodes OpenEXR pictures.

use crate::foreign::decoded::{FLOAT, HALF, Raster, checked, guarded};
use exr::meta::{MetaData, header::Header};
use exr::prelude::{FlatSamples, ReadChannels, ReadLayers, Vec2};
use itertools::Itertools;
use std::io::Cursor;

/// Decodes the only layer of a picture: its channel Y, its channels R, G and B, or its only one;
/// with A as alpha.
///
/// # Errors
/// The reason, as the rest of a message that begins with the file.
pub(crate) fn decode(bytes: &[u8]) -> Result<Raster, String> {
    let refused = |why: exr::error::Error| format!("it cannot be decoded: {why}; save it anew");
    let meta = guarded("exr", || {
        MetaData::read_from_buffered(Cursor::new(bytes), false).map_err(refused)
    })?;
    let [header] = &meta.headers[..] else {
        return Err(format!("it has {} layers; save one", meta.headers.len()));
    };
    let size = header.layer_size;
    let list = &header.channels.list;
    let size = checked([size.x() as u64, size.y() as u64], list.len() as u64)?;
    check_window(header)?;
    let names: Vec<String> = list.iter().map(|it| it.name.to_string()).collect();
    let chosen = channels(&names)?;
    let picture = guarded("exr", || {
        let reader = exr::prelude::read().no_deep_data();
        let reader = reader.largest_resolution_level().all_channels();
        let reader = reader.first_valid_layer().all_attributes();
        reader.from_buffered(Cursor::new(bytes)).map_err(refused)
    })?;
    let list = &picture.layer_data.channel_data.list;
    let find = |name: &&String| list.iter().find(|it| it.name.to_string() == **name);
    let channels = chosen.iter().filter_map(find);
    let planes: Vec<&FlatSamples> = channels.map(|channel| &channel.sample_data).collect();
    let pixels = size[0] as usize * size[1] as usize;
    if planes.iter().any(|plane| plane.len() != pixels) {
        return Err("a channel has fewer pixels than the picture; save all at full size".into());
    }
    let mut values = Vec::with_capacity(pixels * planes.len());
    for pixel in 0..pixels {
        values.extend(planes.iter().map(|plane| number(plane, pixel)));
    }
    let kind = match planes.first() {
        Some(FlatSamples::F16(_)) => "half",
        Some(FlatSamples::U32(_)) => "uint",
        _ => "float",
    };
    Ok(Raster {
        size,
        channels: planes.len(),
        has_alpha: chosen.last().is_some_and(|name| last_part(name) == "A") && planes.len() > 1,
        values,
        precision: if kind == "half" { HALF } else { FLOAT },
        format: format!("EXR, {kind}"),
        ..Raster::default()
    })
}

fn number(samples: &FlatSamples, pixel: usize) -> f64 {
    match samples {
        FlatSamples::F16(halves) => halves[pixel].into(),
        FlatSamples::F32(floats) => floats[pixel].into(),
        FlatSamples::U32(integers) => integers[pixel].into(),
    }
}

/// Refuses a picture whose data do not fill it: pixels would be counted from another corner.
fn check_window(header: &Header) -> Result<(), String> {
    if header.deep {
        return Err("its pixels are deep (several samples each); save it flat".into());
    }
    let shown = header.shared_attributes.display_window;
    let (position, size) = (header.own_attributes.layer_position, header.layer_size);
    if shown.position == position && shown.size == size {
        return Ok(());
    }
    let window = |Vec2(wide, high): Vec2<usize>, Vec2(x, y): Vec2<i32>| {
        format!("{wide}x{high} from ({x}, {y})")
    };
    let [own, shown] = [window(size, position), window(shown.size, shown.position)];
    Err(format!(
        "its data window ({own}) is not its display window ({shown}): save the whole picture, not \
         cropped"
    ))
}

/// The name of a channel without those of layers before it.
fn last_part(name: &str) -> &str {
    name.rsplit('.').next().unwrap_or(name)
}

/// The channels that are read, of these.
fn channels(names: &[String]) -> Result<Vec<&String>, String> {
    let unique = |wanted: &str| {
        let matches = names.iter().filter(|name| last_part(name) == wanted);
        matches.exactly_one().ok()
    };
    let group = |wanted: &[&str]| {
        let names = wanted.iter().map(|name| unique(name));
        names.collect::<Option<Vec<_>>>()
    };
    let colours = group(&["Y"])
        .or_else(|| group(&["R", "G", "B"]))
        .or_else(|| group(&["R"]));
    let mut chosen = match (colours, names) {
        (Some(chosen), _) => chosen,
        (None, [only]) => return Ok(vec![only]),
        (None, _) => {
            return Err(format!(
                "its channels are {}; expected one channel, Y, or R, G and B once: save one layer",
                names.join(", ")
            ));
        }
    };
    chosen.extend(unique("A"));
    Ok(chosen)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn channels_are_found_by_their_last_name() {
        let chosen = |names: &[&str]| {
            let names: Vec<String> = names.iter().map(ToString::to_string).collect();
            channels(&names).map(|picked| picked.into_iter().cloned().collect::<Vec<_>>().join(" "))
        };
        assert_eq!(chosen(&["Y"]).unwrap(), "Y");
        assert_eq!(chosen(&["shadow"]).unwrap(), "shadow");
        assert_eq!(chosen(&["A", "B", "G", "R"]).unwrap(), "R G B A");
        assert_eq!(
            chosen(&["L.Combined.B", "L.Combined.G", "L.Combined.R"]).unwrap(),
            "L.Combined.R L.Combined.G L.Combined.B"
        );
        let message = chosen(&["a.R", "b.R", "b.G"]).unwrap_err();
        assert!(
            message.contains("a.R, b.R, b.G") && message.contains("save one layer"),
            "{message}"
        );
    }
}
