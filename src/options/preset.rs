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

    #[test]
    fn presets_can_be_read_and_say_what_they_are_for() {
        for preset in Preset::value_variants() {
            let entries = preset.entries().unwrap();
            assert_eq!(entries.is_empty(), *preset == Preset::Default);
            assert!(preset.text().starts_with("# "));
        }
    }
}
