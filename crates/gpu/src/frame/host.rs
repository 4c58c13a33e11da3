//! Exchange between the host and an executor: imports, provided resources, outputs.

use super::executor::{Executor, list};
use crate::{
    error::ExecuteError,
    memory::{
        import::differs,
        memory::{Memory, ResourceFactory},
        physical::Physical,
    },
    provider::Provider,
};
use skiagraph_graph::{Origin, Resource, ResourceId, ResourceKind, Target};

impl Executor {
    /// Hands over a texture that the plan was told of in
    /// [`PlanRequest::imports`](skiagraph_graph::PlanRequest::imports). Its content counts as
    /// changed.
    ///
    /// # Errors
    /// If the plan has no such import, the texture is not as described, or it is another one and
    /// the device is lost.
    pub fn import_texture(
        &mut self,
        name: &str,
        texture: &wgpu::Texture,
    ) -> Result<(), ExecuteError> {
        self.import(name, Physical::Texture(texture.clone()))
    }

    /// Hands over a buffer; see [`import_texture`](Self::import_texture).
    ///
    /// # Errors
    /// Those of [`import_texture`](Self::import_texture).
    pub fn import_buffer(&mut self, name: &str, buffer: &wgpu::Buffer) -> Result<(), ExecuteError> {
        self.import(name, Physical::Buffer(buffer.clone()))
    }

    /// Hands over a sampler; see [`import_texture`](Self::import_texture). wgpu does not tell how
    /// it filters: what disagrees with the description is refused where it is bound.
    ///
    /// # Errors
    /// Those of [`import_texture`](Self::import_texture).
    pub fn import_sampler(
        &mut self,
        name: &str,
        sampler: &wgpu::Sampler,
    ) -> Result<(), ExecuteError> {
        self.import(name, Physical::Sampler(sampler.clone()))
    }

    fn import(&mut self, name: &str, physical: Physical) -> Result<(), ExecuteError> {
        let imports = self.plan().imports();
        let Some(described) = imports.get(name) else {
            let known: Vec<&str> = imports.keys().map(String::as_str).collect();
            return Err(ExecuteError::NoSuchImport {
                name: name.to_owned(),
                known: list(&known),
            });
        };
        if let Some(why) = differs(&physical, described) {
            return Err(ExecuteError::Import {
                name: name.to_owned(),
                why,
            });
        }
        // One that no live pass uses waits for a plan in which one does.
        let Some(id) = self.state.live(name) else {
            self.state.memory.spare(name, physical);
            return Ok(());
        };
        // Most hosts hand over the same texture in every frame.
        if self.state.memory.host(id) != Some(&physical) {
            self.presence.check()?;
        }
        self.state.contents.touch(id);
        if self.state.memory.import(id, physical) {
            self.state.unbind(id);
        }
        Ok(())
    }

    /// Tells that the content of an import or provided resource has changed, so that passes with
    /// `run: OnChange` that read it run in the next frame, and that the one after it finds this
    /// content as `.previous`. (A provider that counts [`versions`](Provider::version) needs
    /// [`refresh`](Self::refresh) instead.)
    ///
    /// # Errors
    /// If the plan has nothing of the host's under this name. (One that no live pass uses is fine.)
    pub fn touch(&mut self, name: &str) -> Result<(), ExecuteError> {
        let of_host = |resource: &Resource| resource.origin == Origin::Host;
        if !self.plan().imports().contains_key(name) {
            self.host_changes.touch(name);
        }
        let live = self.state.live(name);
        if let Some(id) = live.filter(|id| of_host(self.plan().resource(*id))) {
            self.state.contents.touch(id);
        } else if !self.plan().offers(name) {
            let used = self.plan().schedule().lifetimes.keys();
            let used = used
                .map(|id| self.plan().resource(*id))
                .filter(|used| of_host(used));
            let used: Vec<&str> = used.map(|resource| resource.name.as_str()).collect();
            return Err(ExecuteError::NotOfHost {
                name: name.to_owned(),
                known: list(&used),
            });
        }
        Ok(())
    }

    /// Asks the provider for every resource of another [version](Provider::version) than before,
    /// and for what it could not build then. Frames that were encoded before keep what they were
    /// encoded with.
    ///
    /// # Errors
    /// If one cannot be built, or is described otherwise than when the graph was planned (more
    /// items, say, or a light of another kind: [`ExecuteError::OtherThanPlanned`]), or the device
    /// is lost. The rest stays as it was and is asked for again the next time.
    pub fn refresh(&mut self, provider: &mut dyn Provider) -> Result<(), ExecuteError> {
        let refreshed = self.refresh_live(provider);
        if refreshed.is_ok() {
            self.note_changes(provider);
        } else {
            self.host_changes.touch_all();
        }
        refreshed
    }

    /// Notes what of the provider's has changed, after live passes have what they bind of it.
    pub(super) fn note_changes(&mut self, provider: &dyn Provider) {
        match self.state.uniform {
            Some(_) => self.host_changes.compare(provider),
            None => self.host_changes.forget(),
        }
    }

    fn refresh_live(&mut self, provider: &mut dyn Provider) -> Result<(), ExecuteError> {
        let known: Vec<(ResourceId, Option<u64>)> = self.state.memory.provided().collect();
        for (id, version) in known {
            let state = &mut self.state;
            if Some(provider.version(&state.plan.resource(id).name)) == version {
                continue;
            }
            self.presence.check()?;
            let before = state.memory.host(id).cloned();
            let mut factory = ResourceFactory {
                device: &self.device,
                queue: &self.queue,
                provider: &mut *provider,
            };
            state.memory.refresh(id, &state.plan, None, &mut factory)?;
            state.contents.touch(id);
            let now = state.memory.host(id);
            if now.is_some() {
                self.host_changes.touch(&state.plan.resource(id).name);
            }
            if now == before.as_ref() {
                continue;
            }
            if Memory::is_alike(now, before.as_ref()) {
                state.rebind(id)
            } else {
                state.unbind(id)
            }
        }
        Ok(())
    }

    /// An output or capture as the last frame left it, for the host to bind. A resource that is
    /// also read as it was in the frame before has another view in every frame, and
    /// [`resize`](Self::resize) and the like make new ones.
    pub fn output_view(&self, name: &str) -> Option<wgpu::TextureView> {
        let target = self.readable(name)?;
        let dimension = match &self.plan().resource(target.id).kind {
            ResourceKind::Texture(texture) if texture.is_3d => wgpu::TextureViewDimension::D3,
            _ if target.part.layers.len() == 1 => wgpu::TextureViewDimension::D2,
            _ => wgpu::TextureViewDimension::D2Array,
        };
        self.state
            .memory
            .view(target, dimension, &self.ping_pong)
            .ok()
    }

    /// A buffer among the outputs and captures as the last frame left it.
    pub fn output_buffer(&self, name: &str) -> Option<wgpu::Buffer> {
        let target = self.readable(name)?;
        self.state
            .memory
            .buffer(target.id, &self.ping_pong)
            .ok()
            .cloned()
    }

    fn readable(&self, name: &str) -> Option<&Target> {
        let mut readable = self.plan().readable().iter();
        readable
            .find(|(known, _)| known == name)
            .map(|(_, target)| target)
    }
}
