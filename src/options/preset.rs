//! Presets: files of options that the program holds, by name.
//!
//! A preset is added by a file in `presets/` and a line here.

use std::path::Path;

use clap::ValueEnum;

use super::DockOptions;
use super::file::{ConfigError, Entry, read_text};

/// A set of options with a name.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum Preset {
    /// A first look, in about half the time.
    Fast,
    /// What a run without a preset does.
    Default,
    /// A second search about the best poses, in about twice the time.
    Thorough,
    /// How surfaces fit, and nothing else.
    Shape,
}

impl Preset {
    /// Its file of options.
    pub fn text(self) -> &'static str {
        match self {
            Self::Fast => include_str!("presets/fast.toml"),
            Self::Default => include_str!("presets/default.toml"),
            Self::Thorough => include_str!("presets/thorough.toml"),
            Self::Shape => include_str!("presets/shape.toml"),
        }
    }

    /// The options that it gives.
    ///
    /// # Errors
    /// [`ConfigError`] if its file cannot be read, which a test rules out.
    pub fn entries(self) -> Result<Vec<Entry>, ConfigError> {
        read_text::<DockOptions>(self.text(), Path::new("preset"))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::dock::scene::Scene;
    use crate::options::text;
    use knotdock_scoring::terms::effect::Effect;
    use knotdock_scoring::terms::pose::POSE_TERMS;
    use knotdock_structures::molecule::{InputSpec, ReadOptions, read};

    /// `shape` turned effects off, and still ranked by `unresolved` and `termini`. A pose term that is added to the
    /// registry must be off too.
    #[test]
    fn shape_leaves_no_other_term_on() {
        let words = Preset::Shape.entries().unwrap().into_iter();
        let words = words.flat_map(|entry| entry.words);
        let options: DockOptions = text::read(words.map(Into::into)).unwrap();
        for term in POSE_TERMS {
            assert_eq!(options.terms.weights.get(term.id), 0.0, "{}", term.id);
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
        for preset in Preset::value_variants() {
            let entries = preset.entries().unwrap();
            assert_eq!(entries.is_empty(), *preset == Preset::Default);
            assert!(preset.text().starts_with("# "));
        }
    }
}
