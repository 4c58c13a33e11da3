//! Results, to be compared with those of another run. The command line's tests have it, too.

use serde_json::Value;

/// Results without times, and without the commands that measured them.
pub fn timeless(mut value: Value) -> Value {
    fn clear(value: &mut Value) {
        match value {
            Value::Object(fields) if fields.contains_key("p95") => *value = Value::Null,
            Value::Object(fields) => {
                for of_the_hour in ["began", "date", "machine", "session", "turns"] {
                    fields.remove(of_the_hour);
                }
                for frames in ["gpu_frames", "cpu_frames", "wall_frames"] {
                    fields.remove(frames);
                }
                fields.remove("commands");
                // The reason has times in it.
                fields.remove("gpu_unavailable");
                fields.values_mut().for_each(clear);
            }
            Value::Array(items) => items.iter_mut().for_each(clear),
            _ => {}
        }
    }
    clear(&mut value);
    value
}
