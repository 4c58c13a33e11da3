//! Imports: textures, buffers and samplers that the host sets.

use super::in_flight::list;
use super::state::State;
use crate::error::ExecuteError;
use crate::memory::import::{differs, is_on};
use crate::memory::physical::Physical;
use crate::presence::Presence;
use skiagraph_graph::{Import, Plan};
use std::collections::BTreeMap;

/// Versions of the imports' contents, as far as the host has told them, by name.
#[derive(Default)]
pub(super) struct Imports(BTreeMap<String, u64>);

impl Imports {
    /// True if the host tells each change of the content of an import that a live pass uses by a
    /// version, or there is none to tell.
    pub fn are_told(&self, state: &State) -> bool {
        let mut imports = state.plan.imports().iter();
        imports.all(|(name, import)| {
            let has_content = !matches!(import, Import::Sampler { .. });
            !has_content || self.0.contains_key(name) || state.live(name).is_none()
        })
    }

    /// Does what [`Executor::set_import_version`](super::Executor::set_import_version) does.
    pub fn set_version(
        &mut self,
        name: &str,
        version: u64,
        state: &mut State,
    ) -> Result<(), ExecuteError> {
        described(name, &state.plan)?;
        let before = self.0.insert(name.to_owned(), version);
        if before == Some(version) {
            return Ok(());
        }
        if let Some(id) = state.live(name) {
            state.touch(id);
        }
        match before {
            Some(before) if version < before => Err(ExecuteError::ImportVersion {
                name: name.to_owned(),
                before,
                version,
            }),
            _ => Ok(()),
        }
    }

    /// Sets an import, which is a thing of the device.
    pub fn set(
        &self,
        name: &str,
        physical: Physical,
        state: &mut State,
        (device, presence): (&wgpu::Device, &Presence),
    ) -> Result<(), ExecuteError> {
        if let Some(why) = differs(&physical, described(name, &state.plan)?) {
            return Err(ExecuteError::Import {
                name: name.to_owned(),
                why,
            });
        }
        let is_own = is_on(device, &physical);
        let way_out = "hand over one that was made on the executor's device";
        presence.check_own(is_own, format!("the import `{name}`"), way_out)?;
        // One that no live pass uses waits for a plan in which one does.
        let Some(id) = state.live(name) else {
            state.memory.spare(name, physical);
            return Ok(());
        };
        // Most hosts hand over the same texture in every frame.
        let is_same = state.memory.host(id) == Some(&physical);
        if !is_same {
            presence.check()?;
        }
        let has_content = !matches!(physical, Physical::Sampler(_));
        if !is_same || has_content && !self.0.contains_key(name) {
            state.touch(id);
        }
        if state.memory.import(id, physical) {
            state.unbind(id);
        }
        Ok(())
    }
}

/// Returns the description of the import of that name.
fn described<'p>(name: &str, plan: &'p Plan) -> Result<&'p Import, ExecuteError> {
    let imports = plan.imports();
    imports.get(name).ok_or_else(|| ExecuteError::NoSuchImport {
        name: name.to_owned(),
        known: list(imports.keys().map(String::as_str)),
    })
}
