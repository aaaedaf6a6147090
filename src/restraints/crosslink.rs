//! Presets of cross-linking reagents: the atoms that a cross-link restrains, and their distance.
//!
//! A reagent has a line here only with a published bound.

use serde::de::Error;
use serde::{Deserialize, Deserializer, Serialize};

/// A cross-linking reagent.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
#[serde(into = "String")]
pub struct Crosslink {
    /// Usual name, such as `DSS`.
    pub name: &'static str,
    /// Other names.
    pub aliases: &'static [&'static str],
    /// The atom of each residue that the bound is for.
    pub atom: &'static str,
    /// Largest distance of these atoms, in Å.
    pub upper: f64,
    /// Publication of the bound.
    pub source: &'static str,
}

/// Molecular dynamics of 807 proteins: 26 to 30 Å between CA atoms are appropriate for DSS and BS3, whose arms are both
/// 11.4 Å long. The upper end is taken.
const MERKLEY: &str = "Merkley et al., Protein Sci 23 (2014) 747-759, doi:10.1002/pro.2458";

/// All reagents that are known. A further one is one entry here.
pub const CROSSLINKS: [Crosslink; 2] = [
    Crosslink {
        name: "DSS",
        aliases: &["disuccinimidyl suberate"],
        atom: "CA",
        upper: 30.0,
        source: MERKLEY,
    },
    Crosslink {
        name: "BS3",
        aliases: &["BS(3)", "bis(sulfosuccinimidyl) suberate"],
        atom: "CA",
        upper: 30.0,
        source: MERKLEY,
    },
];

/// The names of all reagents, in words.
pub(super) fn names() -> String {
    CROSSLINKS.map(|crosslink| crosslink.name).join(", ")
}

impl TryFrom<String> for Crosslink {
    type Error = String;

    /// Finds a reagent by one of its names, whatever their case and blanks.
    fn try_from(name: String) -> Result<Self, String> {
        let plain = |name: &str| name.replace(char::is_whitespace, "").to_lowercase();
        let sought = plain(&name);
        let is_named = |crosslink: &Self| {
            let mut names = crosslink.aliases.iter().chain([&crosslink.name]);
            names.any(|name| plain(name) == sought)
        };
        CROSSLINKS.into_iter().find(is_named).ok_or_else(|| {
            let known = names();
            format!("there is no preset for the cross-links of `{name}`; there are {known}")
        })
    }
}

impl<'de> Deserialize<'de> for Crosslink {
    fn deserialize<D: Deserializer<'de>>(from: D) -> Result<Self, D::Error> {
        let name = String::deserialize(from)?;
        name.try_into().map_err(D::Error::custom)
    }
}

impl From<Crosslink> for String {
    fn from(crosslink: Crosslink) -> Self {
        crosslink.name.to_owned()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn reagents_are_found_by_any_name() {
        for crosslink in CROSSLINKS {
            assert_eq!(String::from(crosslink).try_into(), Ok(crosslink));
            for name in crosslink.aliases {
                assert_eq!(name.to_uppercase().try_into(), Ok(crosslink));
            }
            assert!(crosslink.upper > 0.0 && crosslink.source.contains("doi:"));
        }
        let found = Crosslink::try_from("bs3".to_owned()).unwrap();
        assert_eq!((found.atom, found.upper), ("CA", 30.0));
    }

    #[test]
    fn unknown_reagents_are_refused_with_the_list() {
        let error = Crosslink::try_from("XYZ".to_owned()).unwrap_err();
        assert_eq!(
            error,
            "there is no preset for the cross-links of `XYZ`; there are DSS, BS3"
        );
    }
}
