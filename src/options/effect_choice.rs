//! The effects of a score: `auto`, or names.

use knotdock_scoring::terms::effect::Effect;
use serde::{Deserialize, Serialize};

/// Effects of a score. Written as `auto`, or as names with commas between them.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(try_from = "String", into = "String")]
pub enum EffectChoice {
    /// Those that the inputs hold labels for.
    #[default]
    Auto,
    /// These, and shape.
    Only(Vec<Effect>),
}

impl From<EffectChoice> for String {
    fn from(choice: EffectChoice) -> Self {
        match choice {
            EffectChoice::Auto => "auto".to_owned(),
            EffectChoice::Only(effects) => {
                let names: Vec<&str> = effects.iter().map(|effect| effect.name()).collect();
                names.join(",")
            }
        }
    }
}

impl TryFrom<String> for EffectChoice {
    type Error = String;

    fn try_from(text: String) -> Result<Self, String> {
        if text == "auto" {
            return Ok(Self::Auto);
        }
        // Shape is always on, and the order of the names has no effect.
        let mut effects = vec![Effect::Shape];
        for name in text.split(',').map(str::trim) {
            let known = Effect::ALL.into_iter().find(|effect| effect.name() == name);
            effects.push(known.ok_or_else(|| {
                let names = Effect::ALL.map(Effect::name).join(", ");
                format!("there is no effect '{name}'; there is auto, or any of {names}")
            })?);
        }
        effects.sort_unstable();
        effects.dedup();
        Ok(Self::Only(effects))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn choices_are_read_and_written_alike() {
        for text in [
            "auto",
            "shape",
            "shape,electrostatics",
            "shape,electrostatics,contact",
        ] {
            let choice = EffectChoice::try_from(text.to_owned()).unwrap();
            assert_eq!(String::from(choice), text);
        }
        let text = "contact, electrostatics,contact".to_owned();
        let choice = EffectChoice::try_from(text).unwrap();
        assert_eq!(String::from(choice), "shape,electrostatics,contact");
        for bad in ["", "gravity", "shape,", "auto,shape"] {
            assert!(EffectChoice::try_from(bad.to_owned()).is_err(), "{bad}");
        }
    }
}
