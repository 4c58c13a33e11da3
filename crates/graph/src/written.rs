//! How types that read themselves from text say what they may be.

/// A type that reads itself from text: its name and what it may be.
macro_rules! written {
    ($type:ty, $name:literal, $generator:ident => $schema:expr) => {
        impl schemars::JsonSchema for $type {
            fn schema_name() -> std::borrow::Cow<'static, str> {
                $name.into()
            }
            fn json_schema($generator: &mut schemars::SchemaGenerator) -> schemars::Schema {
                $schema
            }
        }
    };
}
pub(crate) use written;

/// Writes the schema of a type that documents write as a reference alone, or with fields.
macro_rules! short_or_long {
    ($type:ty, $name:literal, $long:ty) => {
        $crate::written::written!($type, $name, generator => {
            let long = <$long>::json_schema(generator);
            let reference = generator.subschema_for::<$crate::language::syntax::Reference>();
            schemars::json_schema!({ "anyOf": [reference, long] })
        });
    };
}
pub(crate) use short_or_long;
