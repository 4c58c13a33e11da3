//! Turns panics of libraries into errors: naga, wgpu and ron panic on some texts, and no file may
//! end the program.

use std::cell::RefCell;
use std::panic::{self, AssertUnwindSafe, PanicHookInfo};
use std::sync::Once;

/// A panic of a library that [`caught`] has caught, with its place in the library's source code.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("{message} ({place})")]
pub struct Panicked {
    /// Message of the panic; `a panic without words` if its payload is not a text.
    pub message: String,
    /// File and line in the library's source code, from the folder of the crate on:
    /// `naga-30.0.1/src/proc/a.rs:12`; `unknown place` if another panic hook has been set since the
    /// first call of [`caught`].
    pub place: String,
}

impl Panicked {
    /// Returns a hint for the author of the file on which the library panicked, for the help of a
    /// [`Diagnostic`](crate::diagnostics::Diagnostic): it says that the library is at fault, and to
    /// write the file differently.
    pub fn way_out(&self) -> String {
        format!(
            "this is a mistake of the library ({}), which may take the same written differently",
            self.place
        )
    }
}

thread_local! {
    /// Panic that the hook heard while this thread is inside of [`caught`]; `None` outside.
    static HEARD: RefCell<Option<Option<Panicked>>> = const { RefCell::new(None) };
}

/// Calls `run` and returns its result, or its panic as an error. The panic is not printed: the
/// first call sets a panic hook, which passes panics outside of `caught` on to the hook that was
/// set before.
///
/// A panic may leave state that `run` changes half changed; do not rely on this state.
///
/// # Errors
/// The panic of `run`. (A process that is built with `panic = "abort"` ends instead.)
pub fn caught<T>(run: impl FnOnce() -> T) -> Result<T, Panicked> {
    quieten();
    let outer = HEARD.replace(Some(None));
    let result = panic::catch_unwind(AssertUnwindSafe(run));
    let heard = HEARD.replace(outer).flatten();
    result.map_err(|payload| {
        heard.unwrap_or_else(|| Panicked {
            // A host has put in a hook of its own since.
            message: words(&*payload).to_owned(),
            place: "unknown place".to_owned(),
        })
    })
}

/// Puts a hook before the one that there is, once in the life of the process.
fn quieten() {
    static ONCE: Once = Once::new();
    // The hook of a thread that panics cannot be changed from it.
    if std::thread::panicking() {
        return;
    }
    ONCE.call_once(|| {
        let before = panic::take_hook();
        panic::set_hook(Box::new(move |diagnostic| {
            if !hear(diagnostic) {
                before(diagnostic);
            }
        }));
    });
}

/// Keeps a panic of a thread that is inside of [`caught`]; false on others.
fn hear(diagnostic: &PanicHookInfo<'_>) -> bool {
    HEARD.with_borrow_mut(|heard| {
        let Some(heard) = heard else {
            return false;
        };
        let place = diagnostic.location().map_or_else(String::new, |place| {
            format!("{}:{}", from_its_crate(place.file()), place.line())
        });
        *heard = Some(Panicked {
            message: words(diagnostic.payload()).to_owned(),
            place,
        });
        true
    })
}

fn words(payload: &(dyn std::any::Any + Send)) -> &str {
    let text = payload.downcast_ref::<String>().map(String::as_str);
    let text = text.or_else(|| payload.downcast_ref::<&str>().copied());
    text.unwrap_or("a panic without words")
}

/// A source file from the folder of its crate on: where registries lie differs between machines.
fn from_its_crate(file: &str) -> String {
    let parts: Vec<&str> = file.split(['/', '\\']).collect();
    let source = parts.iter().rposition(|part| *part == "src");
    let first = source.map_or(0, |at| at.saturating_sub(1));
    parts[first..].join("/")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_panic_is_an_error_with_its_place() {
        let none: Result<u32, &str> = "a".parse::<u32>().map_err(|_| "no digit");
        let error = caught(|| none.expect("a number")).expect_err("there is none");
        assert_eq!(error.message, r#"a number: "no digit""#);
        assert!(
            error.place.starts_with("located_ron/src/panics.rs:"),
            "{error}"
        );
        assert_eq!(caught(|| 1), Ok(1));
    }

    /// The inner one hears its own panic, the outer one its own after it.
    #[test]
    fn one_in_the_other() {
        let outer = caught(|| {
            let inner = caught(|| panic!("inner"));
            assert_eq!(
                inner.map_err(|error| error.message),
                Err::<(), _>("inner".to_owned())
            );
            panic!("outer");
        });
        assert_eq!(
            outer.map_err(|error| error.message),
            Err::<(), _>("outer".to_owned())
        );
    }

    #[test]
    fn places_lose_the_folders_of_a_machine() {
        let place = from_its_crate("/home/me/.cargo/registry/src/index/naga-30.0.1/src/proc/a.rs");
        assert_eq!(place, "naga-30.0.1/src/proc/a.rs");
        assert_eq!(from_its_crate("a.rs"), "a.rs");
    }
}
