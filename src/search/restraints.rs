//! Which atoms are to stay free of contact: what of an antibody lies away from its CDRs, and what the user blocks.

use super::options::{DockOptions, SearchError};
use knotdock_structures::molecule::{Antibody, Molecule, PARATOPE_EDGE, VariableDomain};
use serde::{Deserialize, Serialize};

/// What part of an antibody may touch.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum AntibodySurface {
    /// Its CDRs and what lies about them.
    #[default]
    Cdrs,
    /// All of it.
    Whole,
}

impl AntibodySurface {
    /// Name as on the command line.
    pub fn name(self) -> &'static str {
        match self {
            Self::Cdrs => "cdrs",
            Self::Whole => "whole",
        }
    }
}

impl std::str::FromStr for AntibodySurface {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let known = [Self::Cdrs, Self::Whole];
        let known = known.into_iter().find(|known| known.name() == text);
        known.ok_or_else(|| "cdrs or whole is needed".to_owned())
    }
}

/// Blocked atoms of both sides.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct Restraints {
    /// Whether each atom of receptor and ligand is blocked.
    pub blocked: [Vec<bool>; 2],
    /// Why, in words; empty where nothing is.
    pub reason: String,
}

impl Restraints {
    /// What the options and the two molecules call for.
    ///
    /// # Errors
    /// [`SearchError::Option`] when residues are to be blocked that a molecule does not have.
    pub fn new(molecules: [&Molecule; 2], options: &DockOptions) -> Result<Self, SearchError> {
        let named = [
            ("receptor", "block-receptor", &options.block_receptor),
            ("ligand", "block-ligand", &options.block_ligand),
        ];
        let mut reasons = Vec::new();
        let mut blocked = [Vec::new(), Vec::new()];
        for ((molecule, (side, option, residues)), blocked) in
            molecules.into_iter().zip(named).zip(&mut blocked)
        {
            *blocked = vec![false; molecule.atoms.len()];
            if options.antibody == AntibodySurface::Cdrs
                && let Some(antibody) = molecule.antibody()
            {
                for (blocked, paratope) in blocked.iter_mut().zip(&antibody.paratope) {
                    *blocked = !paratope;
                }
                reasons.push(format!(
                    "the {side} is an antibody ({}), which binds by its CDRs and what lies within {PARATOPE_EDGE} Å of them",
                    domains_told(&antibody)
                ));
            }
            if let Some(residues) = residues {
                let chosen =
                    molecule
                        .selected(residues)
                        .map_err(|unknown| SearchError::Option {
                            name: option,
                            value: unknown.part.clone(),
                            bound: format!(
                                "residues that the {side} has, among {}",
                                unknown.present()
                            ),
                        })?;
                for (blocked, chosen) in blocked.iter_mut().zip(chosen) {
                    *blocked |= chosen;
                }
                reasons.push(format!(
                    "residues {} of the {side} are blocked",
                    String::from(residues.clone())
                ));
            }
        }
        Ok(Self {
            blocked,
            reason: reasons.join("; "),
        })
    }

    /// Whether any atom is blocked.
    pub fn any(&self) -> bool {
        self.blocked.iter().flatten().any(|blocked| *blocked)
    }
}

/// The variable domains of an antibody in words.
pub fn domains_told(antibody: &Antibody) -> String {
    let told = |domain: &VariableDomain| {
        let [first, last] = &domain.residues;
        format!("{} {}:{first}-{last}", domain.kind.name(), domain.chain)
    };
    let domains = antibody.domains.iter().map(told);
    domains.collect::<Vec<_>>().join(", ")
}

#[cfg(test)]
mod tests {
    use super::*;
    use knotdock_structures::molecule::{Atom, Format};

    /// Alpha carbons of glycine, number 1 to 4, 10 Å apart.
    fn peptide() -> Molecule {
        let atom = |residue_number: i64| Atom {
            name: "CA".to_owned(),
            residue_name: "GLY".to_owned(),
            chain: "A".to_owned(),
            residue_number,
            insertion_code: None,
            alternate_location: None,
            element: "C".to_owned(),
            position: [10.0 * residue_number as f64, 0.0, 0.0],
            occupancy: 1.0,
            b_factor: 0.0,
            hetero: false,
            radius: 1.9,
            line: 1,
        };
        Molecule::new((1..=4).map(atom).collect(), Format::Pdb)
    }

    #[test]
    fn named_residues_of_either_side_are_blocked_and_nothing_else() {
        let molecule = peptide();
        let of = |receptor: Option<&str>, ligand: Option<&str>| {
            let options = DockOptions {
                block_receptor: receptor.map(|text| text.parse().unwrap()),
                block_ligand: ligand.map(|text| text.parse().unwrap()),
                ..DockOptions::default()
            };
            Restraints::new([&molecule, &molecule], &options)
        };
        let none = of(None, None).unwrap();
        assert!(!none.any() && none.reason.is_empty());
        let both = of(Some("A:2-3"), Some("A:4")).unwrap();
        assert_eq!(both.blocked[0], [false, true, true, false]);
        assert_eq!(both.blocked[1], [false, false, false, true]);
        assert_eq!(
            both.reason,
            "residues A:2-3 of the receptor are blocked; residues A:4 of the ligand are blocked"
        );
        let unknown = of(None, Some("A:4,A:9")).unwrap_err();
        assert_eq!(
            unknown.to_string(),
            "block-ligand is A:9; it must be residues that the ligand has, among A:1-4"
        );
    }
}
