//! Mistakes of each phase, as typed values: each variant declares its kind, message, places and
//! help in one place.
//!
//! A phase reports a variant; only this folder knows its text.

/// Declares the mistakes of a phase. Each says all of itself in one arm:
///
/// ```text
/// NoColour(pass: Located<String>, known: Vec<String>) =>
///     UnknownWord("unknown colour of pass `{pass}`").at(&pass, "").suggest(&pass, known);
/// ```
///
/// is a variant and its [`Diagnostic`](crate::Diagnostic): a [`Code`](crate::Code) with the
/// message, and calls that add places and help. A variant without them does not compile, nor does a
/// field that they leave unused.
macro_rules! mistakes {
    ($(#[$doc:meta])+ $enum:ident: $(
        $(#[$note:meta])*
        $mistake:ident
            $(( $($value:ident: $of:ty),+ ))?
            $({ $($(#[$hint:meta])* $field:ident: $type:ty),+ $(,)? })?
            => $code:ident($($message:tt)+) $(.$add:ident($($argument:expr),+ $(,)?))*;
    )+) => {
        $(#[$doc])+
        #[derive(Clone, Debug)]
        pub(crate) enum $enum {
            $($(#[$note])* $mistake $(($($of),+))? $({ $($(#[$hint])* $field: $type),+ })?,)+
        }

        #[deny(unused_variables)]
        impl From<$enum> for $crate::diagnostics::Diagnostic {
            fn from(mistake: $enum) -> Self {
                match mistake {
                    $($enum::$mistake $(($($value),+))? $({ $($field),+ })? => {
                        Self::error($crate::diagnostics::Code::$code, format!($($message)+))
                            $(.$add($($argument),+))*
                    })+
                }
            }
        }
    };
}

pub(crate) mod compose;
pub(crate) mod document;
pub(crate) mod edit;
pub(crate) mod evaluation;
pub(crate) mod flow;
pub(crate) mod instantiate;
pub(crate) mod language;
pub(crate) mod layout;
pub(crate) mod limits;
pub(crate) mod link;
pub(crate) mod plan;
pub(crate) mod resource;
pub(crate) mod shader;
