//! Presets: files of options that the program holds, by name.
//!
//! A preset is added by a file in `presets/` and a line here.

use std::path::Path;

use knotdock_structures::Error;

use super::DockOptions;
use super::file::GivenOption;

/// A set of options with a name.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Preset {
    /// Its name.
    pub name: &'static str,
    /// Its purpose.
    pub about: &'static str,
    /// Its file of options.
    pub text: &'static str,
}

impl Preset {
    /// All presets.
    pub const ALL: [Self; 4] = [
        Self {
            name: "fast",
            about: "A first look, in about half the time",
            text: include_str!("presets/fast.toml"),
        },
        Self {
            name: "default",
            about: "What a run without a preset does",
            text: include_str!("presets/default.toml"),
        },
        Self {
            name: "thorough",
            about: "A second search about the best poses, in about twice the time",
            text: include_str!("presets/thorough.toml"),
        },
        Self {
            name: "shape",
            about: "How surfaces fit, and nothing else",
            text: include_str!("presets/shape.toml"),
        },
    ];

    /// The preset with a name.
    pub fn named(name: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|preset| preset.name == name)
    }

    /// Sets the options of the preset; returns them.
    pub fn apply(self, options: &mut DockOptions) -> Result<Vec<GivenOption>, Error> {
        options.read_toml(self.text, Path::new("preset"))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::dock::scene::Scene;
    use knotdock_scoring::terms::effect::Effect;
    use knotdock_scoring::terms::pose::POSE_TERMS;
    use knotdock_structures::molecule::{InputSpec, ReadOptions, read};

    /// `shape` turned effects off, and still ranked by `unresolved` and `termini`. A pose term that is added to the
    /// registry must be off too.
    #[test]
    fn shape_leaves_no_other_term_on() {
        let mut options = DockOptions::default();
        let shape = Preset::named("shape").unwrap();
        shape.apply(&mut options).unwrap();
        for term in POSE_TERMS {
            assert_eq!(options.terms.weight(term.id), Some(0.0), "{}", term.id);
        }
        let [receptor, ligand] = ["receptor", "ligand"].map(|side| {
            let root = env!("CARGO_MANIFEST_DIR");
            let path = format!("{root}/structures/examples/1ppe_{side}_unbound.pdb");
            read(&InputSpec::whole(path), &ReadOptions::default()).unwrap()
        });
        let scene = |options| Scene::new(&receptor, &ligand, options).unwrap();
        assert!(scene(&options).rescorer(&options).is_none());
        let decisions = scene(&options).decisions;
        assert!(
            decisions
                .iter()
                .all(|d| d.on == (d.effect == Effect::Shape))
        );
        let default = DockOptions::default();
        assert!(scene(&default).rescorer(&default).is_some());
    }

    #[test]
    fn presets_can_be_read_and_say_what_they_are_for() {
        for preset in Preset::ALL {
            let given = preset.apply(&mut DockOptions::default()).unwrap();
            assert_eq!(given.is_empty(), preset.name == "default");
            assert!(preset.text.starts_with("# "));
        }
    }
}
