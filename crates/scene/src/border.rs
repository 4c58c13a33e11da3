//! The border to libraries that parse what others wrote.

use skiagraph_located_ron::panics;

/// Calls a library's parser. Known causes of panics are kept from it; an unknown panic is an error
/// like any other.
///
/// # Errors
/// Names the library, and what it said.
pub(crate) fn caught<T>(library: &str, parse: impl FnOnce() -> T) -> Result<T, String> {
    panics::caught(parse).map_err(|panicked| {
        let text = panicked.message;
        format!("the library `{library}` failed on it ({text}): save the file in another program")
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_panic_of_a_library_is_an_error() {
        assert_eq!(caught("obj", || 3), Ok(3));
        let error = caught("obj", || Vec::<u8>::new()[7]).unwrap_err();
        assert!(
            error.contains("`obj`") && error.contains("index is 7"),
            "{error}"
        );
    }
}
