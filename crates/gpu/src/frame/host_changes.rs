//! Flags of the uniform `frame`: the scene, its lights or the memory have changed since the frame
//! before.

use crate::provider::Provider;
use std::collections::BTreeMap;

/// Changes since the frame before.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Changed {
    pub scene: bool,
    pub light: bool,
    /// True if a resource that lasts from frame to frame has new memory.
    pub memory: bool,
}

impl Changed {
    const ALL: Self = Self {
        scene: true,
        light: true,
        memory: true,
    };

    /// Sets the flag of the provided resource with this name.
    pub fn note(&mut self, name: &str) {
        let (list, part) = name.split_once('.').unwrap_or((name, ""));
        let of_light = matches!(list, "light" | "lights" | "light_area" | "light_areas")
            || list == "scene" && part.starts_with("light");
        self.light |= of_light;
        self.scene |= list == "scene" && !of_light;
    }
}

/// Changes since the last encoded frame.
#[derive(Debug)]
pub(super) struct HostChanges {
    /// Versions of all provided resources by name; `None` while no live pass reads `frame`.
    known: Option<BTreeMap<String, u64>>,
    pub changed: Changed,
}

impl Default for HostChanges {
    /// Creates the state before the first frame, in which everything counts as changed.
    fn default() -> Self {
        Self {
            known: None,
            changed: Changed::ALL,
        }
    }
}

impl HostChanges {
    /// Notes that a frame to which these changes were told never ran.
    pub fn tell_again(&mut self, changed: Changed) {
        self.changed.scene |= changed.scene;
        self.changed.light |= changed.light;
        self.changed.memory |= changed.memory;
    }

    /// Notes that any provided resource may have changed.
    pub fn touch_all(&mut self) {
        self.changed.scene = true;
        self.changed.light = true;
    }

    /// Notes that a resource that lasts from frame to frame has new memory.
    pub fn note_new_memory(&mut self) {
        self.changed = Changed::ALL;
    }

    /// Notes the provided resources whose versions differ from the known ones.
    pub fn compare(&mut self, provider: &dyn Provider) {
        let names = provider.names().into_iter();
        let now = names.map(|name| {
            let version = provider.version(&name);
            (name, version)
        });
        let now: BTreeMap<String, u64> = now.collect();
        if let Some(before) = &self.known {
            let differs = |name: &&String| before.get(*name) != now.get(*name);
            let names = before.keys().chain(now.keys()).filter(differs);
            names.for_each(|name| self.changed.note(name));
        } else {
            self.touch_all();
        }
        self.known = Some(now);
    }

    /// Forgets the known versions, because no live pass reads the flags. The first frame that reads
    /// them again gets scene and light as changed. The flag of memory, which depends on no version,
    /// is not touched.
    pub fn forget(&mut self) {
        self.known = None;
    }
}
