//! Flags of the uniform `frame`: the scene, its lights or the memory are others than in the frame
//! before.

use crate::provider::Provider;
use std::collections::BTreeMap;

/// True for each in which something has changed.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Changed {
    pub scene: bool,
    pub light: bool,
    /// True if something that stays from frame to frame is in new memory.
    pub memory: bool,
}

impl Changed {
    const ALL: Self = Self {
        scene: true,
        light: true,
        memory: true,
    };

    /// Notes a change of what stands behind a name.
    fn note(&mut self, name: &str) {
        let (list, part) = name.split_once('.').unwrap_or((name, ""));
        let of_light = matches!(list, "light" | "lights" | "light_area" | "light_areas")
            || list == "scene" && part.starts_with("light");
        self.light |= of_light;
        self.scene |= list == "scene" && !of_light;
    }
}

/// Changes since the frame that was encoded last.
#[derive(Debug)]
pub(super) struct HostChanges {
    /// Versions of all that the provider lists; `None` while no live pass reads `frame`.
    known: Option<BTreeMap<String, u64>>,
    changed: Changed,
}

impl Default for HostChanges {
    /// Before the first frame everything is new.
    fn default() -> Self {
        Self {
            known: None,
            changed: Changed::ALL,
        }
    }
}

impl HostChanges {
    pub fn changed(&self) -> Changed {
        self.changed
    }

    /// Notes that a frame was encoded.
    pub fn clear(&mut self) {
        self.changed = Changed::default();
    }

    /// Notes what the host says of a name.
    pub fn touch(&mut self, name: &str) {
        self.changed.note(name);
    }

    /// Notes that anything of the provider's may have changed.
    pub fn touch_all(&mut self) {
        self.changed.scene = true;
        self.changed.light = true;
    }

    /// Notes that something that stays from frame to frame is in new memory.
    pub fn note_new_memory(&mut self) {
        self.changed = Changed::ALL;
    }

    /// Compares the versions of all that a provider lists with those that were known.
    pub fn compare(&mut self, provider: &dyn Provider) {
        let names = provider.names().into_iter();
        let now = names.map(|name| {
            let version = provider.version(&name);
            (name, version)
        });
        let now: Option<BTreeMap<String, u64>> = Some(now.collect());
        match (&self.known, &now) {
            (Some(known), Some(now)) => {
                let differs = |name: &&String| known.get(*name) != now.get(*name);
                let names = known.keys().chain(now.keys()).filter(differs);
                names.for_each(|name| self.changed.note(name));
            }
            _ => self.touch_all(),
        }
        self.known = now;
    }

    /// Notes that no live pass reads the flags: the first frame in which one does has both.
    pub fn forget(&mut self) {
        self.known = None;
    }
}
