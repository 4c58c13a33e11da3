//! Imports: textures, buffers and samplers that the host sets.

use super::executor::Executor;
use super::in_flight::list;
use super::runner::Runner;
use crate::error::ExecuteError;
use crate::memory::import::{differs, is_on};
use crate::memory::physical::Physical;
use skiagraph_graph::{Import, Origin, Resource};

impl Executor {
    /// Sets the texture of the import `name`, which
    /// [`PlanRequest::imports`](skiagraph_graph::PlanRequest::imports) describes. Its content
    /// counts as changed, even if the texture is the one set before, unless the host tells its
    /// [version](Self::set_import_version): passes that run only when an input has changed (`run:
    /// OnChange` in the document) and read it run in the next frame. The texture may have more
    /// usages than described.
    ///
    /// # Errors
    /// [`ExecuteError::NoSuchImport`] if the plan has no import of this name,
    /// [`ExecuteError::Import`] if the texture differs from its description,
    /// [`ExecuteError::OtherDevice`] if it is of another device, [`ExecuteError::DeviceLost`] if
    /// the device is lost.
    pub fn import_texture(
        &mut self,
        name: &str,
        texture: &wgpu::Texture,
    ) -> Result<(), ExecuteError> {
        self.runner.import(name, Physical::Texture(texture.clone()))
    }

    /// Sets the buffer of the import `name`, which
    /// [`PlanRequest::imports`](skiagraph_graph::PlanRequest::imports) describes. Its content
    /// counts as changed, even if the buffer is the one set before, unless the host tells its
    /// [version](Self::set_import_version): passes with `run: OnChange` that read it run in the
    /// next frame. The buffer may have more usages than described.
    ///
    /// # Errors
    /// Those of [`import_texture`](Self::import_texture).
    pub fn import_buffer(&mut self, name: &str, buffer: &wgpu::Buffer) -> Result<(), ExecuteError> {
        self.runner.import(name, Physical::Buffer(buffer.clone()))
    }

    /// Sets the sampler of the import `name`, which
    /// [`PlanRequest::imports`](skiagraph_graph::PlanRequest::imports) describes. Passes with `run:
    /// OnChange` that use it run in the next frame if it is not the one set before. wgpu tells
    /// neither how a sampler filters nor which device it is of, so a wrong one is refused only when
    /// a pass binds it.
    ///
    /// # Errors
    /// Those of [`import_texture`](Self::import_texture).
    pub fn import_sampler(
        &mut self,
        name: &str,
        sampler: &wgpu::Sampler,
    ) -> Result<(), ExecuteError> {
        self.runner.import(name, Physical::Sampler(sampler.clone()))
    }

    /// Tells which version the content of the import `name` has: a number that is larger whenever
    /// the host has written into the texture or buffer. From then on only another version, another
    /// texture or buffer, and [`touch`](Self::touch) count as a change; so a host whose camera and
    /// scene stand still may hand over its depth in every frame, and no pass runs (see
    /// [`encode`](Self::encode)). What is written without a new version is not seen.
    ///
    /// # Errors
    /// [`ExecuteError::NoSuchImport`] if the plan has no import of this name.
    /// [`ExecuteError::ImportVersion`] if the version is lower than the one before, as that of a
    /// content that was seen already may be: it is taken over, and the content counts as changed.
    pub fn set_import_version(&mut self, name: &str, version: u64) -> Result<(), ExecuteError> {
        let runner = &mut self.runner;
        runner.check_import(name)?;
        let before = runner.import_versions.insert(name.to_owned(), version);
        if before == Some(version) {
            return Ok(());
        }
        if let Some(id) = runner.state.live(name) {
            runner.state.touch(id);
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

    /// Marks the content of the import or provided resource `name` as changed, after the host has
    /// written to it. In the next frame, passes with `run: OnChange` (which run only when an input
    /// has changed) that read it run, and those with `run: Always` also where the frame would
    /// otherwise compute nothing new (see [`encode`](Self::encode)); the frame after that finds
    /// this content as `.previous` (content of the frame before). With a provider that counts
    /// [`versions`](crate::Provider::version), call [`refresh`](Self::refresh) instead.
    ///
    /// # Errors
    /// [`ExecuteError::NotOfHost`] if the plan has neither an import nor a provided resource of
    /// this name. A name that no pass uses is accepted.
    pub fn touch(&mut self, name: &str) -> Result<(), ExecuteError> {
        let of_host = |resource: &Resource| resource.origin == Origin::Host;
        if !self.plan().imports().contains_key(name) {
            self.runner.host_changes.changed.note(name);
        }
        let live = self.runner.state.live(name);
        if let Some(id) = live.filter(|id| of_host(self.plan().resource(*id))) {
            self.runner.state.touch(id);
        } else if !self.plan().offers(name) {
            let used = self.plan().used().filter(|used| of_host(used));
            return Err(ExecuteError::NotOfHost {
                name: name.to_owned(),
                known: list(used.map(|resource| resource.name.as_str())),
            });
        }
        Ok(())
    }
}

impl Runner {
    /// Returns the description of the import of that name.
    fn check_import(&self, name: &str) -> Result<&Import, ExecuteError> {
        let imports = self.plan().imports();
        imports.get(name).ok_or_else(|| ExecuteError::NoSuchImport {
            name: name.to_owned(),
            known: list(imports.keys().map(String::as_str)),
        })
    }

    /// True if the host tells each change of an import's content by a version, or there is none to
    /// tell.
    pub fn knows_imports(&self) -> bool {
        let mut imports = self.plan().imports().iter();
        imports.all(|(name, import)| {
            matches!(import, Import::Sampler { .. }) || self.import_versions.contains_key(name)
        })
    }

    fn import(&mut self, name: &str, physical: Physical) -> Result<(), ExecuteError> {
        let described = self.check_import(name)?;
        if let Some(why) = differs(&physical, described) {
            return Err(ExecuteError::Import {
                name: name.to_owned(),
                why,
            });
        }
        let is_own = is_on(&self.device, &physical);
        let way_out = "hand over one that was made on the executor's device";
        self.presence
            .check_own(is_own, format!("the import `{name}`"), way_out)?;
        // One that no live pass uses waits for a plan in which one does.
        let Some(id) = self.state.live(name) else {
            self.state.memory.spare(name, physical);
            return Ok(());
        };
        // Most hosts hand over the same texture in every frame.
        let is_same = self.state.memory.host(id) == Some(&physical);
        if !is_same {
            self.presence.check()?;
        }
        let has_content = !matches!(physical, Physical::Sampler(_));
        if !is_same || has_content && !self.import_versions.contains_key(name) {
            self.state.touch(id);
        }
        if self.state.memory.import(id, physical) {
            self.state.unbind(id);
        }
        Ok(())
    }
}
