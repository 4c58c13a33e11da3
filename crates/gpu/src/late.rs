//! Errors of wgpu in a browser, which tells them later: nothing there can wait.

use std::cell::{Cell, RefCell};

/// Name of what was refused, and the error.
pub(crate) type Late = (String, wgpu::Error);

thread_local! {
    static SCOPES: Cell<usize> = const { Cell::new(0) };
    static ERRORS: RefCell<Vec<Late>> = const { RefCell::new(Vec::new()) };
}

/// Ends the scope of what has this name. Its error, if there is one, is found by [`take`].
pub(crate) fn note(name: &str, scope: wgpu::ErrorScopeGuard) -> Option<wgpu::Error> {
    let (name, popped) = (name.to_owned(), scope.pop());
    SCOPES.set(SCOPES.get() + 1);
    wasm_bindgen_futures::spawn_local(async move {
        let error = popped.await;
        SCOPES.set(SCOPES.get() - 1);
        if let Some(error) = error {
            ERRORS.with_borrow_mut(|errors| errors.push((name, error)));
        }
    });
    None
}

/// Returns the first error that was told; the others follow from it, and are forgotten.
pub(crate) fn take() -> Option<Late> {
    ERRORS.take().into_iter().next()
}

/// True if all ended scopes have told whether they hold an error.
pub(crate) fn is_told() -> bool {
    SCOPES.get() == 0
}
