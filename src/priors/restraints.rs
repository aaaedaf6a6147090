//! Which atoms are to stay free of contact, what of an antibody lies away from its CDRs and what the user blocks, and which are to be in contact.

use crate::error::SearchError;
use crate::options::{AntibodySurface, DockOptions};
use crate::priors::Antibody;
use knotdock_scoring::effect::restraint::ResidueRole;
use knotdock_structures::molecule::{Molecule, ResidueSelection};

/// What is wanted of the contacts of both sides' atoms.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct Restraints {
    /// A mark for each atom of receptor and ligand.
    pub marks: [Vec<ResidueRole>; 2],
    /// Of each side, the residues that are attracted, each as the places of its atoms.
    pub attracted: [Vec<Vec<usize>>; 2],
    /// Why, in words; empty where all are free.
    pub reason: String,
}

impl Restraints {
    /// What the options and the two molecules call for. Residues that are blocked and attracted are attracted.
    ///
    /// # Errors
    /// [`SearchError::Option`] when residues are named that a molecule does not have.
    pub fn new(molecules: [&Molecule; 2], options: &DockOptions) -> Result<Self, SearchError> {
        let mut reasons = Vec::new();
        let mut marks = molecules.map(|molecule| vec![ResidueRole::Free; molecule.atoms.len()]);
        let mut attracted = [Vec::new(), Vec::new()];
        for (((molecule, named), marks), attracted) in molecules
            .into_iter()
            .zip(named_residues(options))
            .zip(&mut marks)
            .zip(&mut attracted)
        {
            let side = named.side;
            if options.restraints.antibody == AntibodySurface::Cdrs
                && let Some(antibody) = Antibody::of(molecule)
            {
                for (mark, paratope) in marks.iter_mut().zip(&antibody.paratope) {
                    if !paratope {
                        *mark = ResidueRole::Excluded;
                    }
                }
                reasons.push(format!("the {side} is {}", antibody.reason()));
            }
            for (option, residues, mark, told) in [
                (named.block, named.blocked, ResidueRole::Excluded, "blocked"),
                (
                    named.attract,
                    named.attracted,
                    ResidueRole::Active,
                    "attracted",
                ),
            ] {
                let Some(residues) = residues else {
                    continue;
                };
                let chosen = selected(molecule, side, option, residues)?;
                if mark == ResidueRole::Active {
                    *attracted = molecule.atoms_by_residue(&chosen);
                }
                for (own, chosen) in marks.iter_mut().zip(chosen) {
                    if chosen {
                        *own = mark;
                    }
                }
                reasons.push(format!(
                    "residues {} of the {side} are {told}",
                    String::from(residues.clone())
                ));
            }
        }
        Ok(Self {
            marks,
            attracted,
            reason: reasons.join("; "),
        })
    }

    /// Whether any atom is marked.
    pub fn any(&self) -> bool {
        self.marks
            .iter()
            .flatten()
            .any(|mark| *mark != ResidueRole::Free)
    }
}

/// The residues that options name of one side, and the options' names.
struct Named<'a> {
    side: &'static str,
    block: &'static str,
    blocked: Option<&'a ResidueSelection>,
    attract: &'static str,
    attracted: Option<&'a ResidueSelection>,
}

/// Those of the receptor and those of the ligand.
fn named_residues(options: &DockOptions) -> [Named<'_>; 2] {
    [
        Named {
            side: "receptor",
            block: "block-receptor",
            blocked: options.restraints.block_receptor.as_ref(),
            attract: "active-receptor",
            attracted: options.restraints.active_receptor.as_ref(),
        },
        Named {
            side: "ligand",
            block: "block-ligand",
            blocked: options.restraints.block_ligand.as_ref(),
            attract: "active-ligand",
            attracted: options.restraints.active_ligand.as_ref(),
        },
    ]
}

/// The atoms of the residues that an option names.
fn selected(
    molecule: &Molecule,
    side: &str,
    option: &'static str,
    residues: &ResidueSelection,
) -> Result<Vec<bool>, SearchError> {
    molecule
        .selected(residues)
        .map_err(|unknown| SearchError::Option {
            name: option,
            value: unknown.part.clone(),
            bound: format!("residues that the {side} has, among {}", unknown.present()),
        })
}

#[cfg(test)]
pub(crate) mod tests {
    use super::*;
    use knotdock_structures::molecule::{Atom, Format};

    /// Alpha carbons of glycine, number 1 to 4, so many Å apart.
    pub fn peptide(apart: f64) -> Molecule {
        let atom = |residue_number: i64| Atom {
            name: "CA".to_owned(),
            residue_name: "GLY".to_owned(),
            chain: "A".to_owned(),
            residue_number,
            insertion_code: None,
            alternate_location: None,
            element: "C".to_owned(),
            position: [apart * residue_number as f64, 0.0, 0.0],
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
        let molecule = peptide(10.0);
        let of = |receptor: Option<&str>, ligand: Option<&str>| {
            let options = DockOptions::default().changed(|options| {
                options.restraints.block_receptor = receptor.map(|text| text.parse().unwrap());
                options.restraints.block_ligand = ligand.map(|text| text.parse().unwrap());
            });
            Restraints::new([&molecule, &molecule], &options)
        };
        let none = of(None, None).unwrap();
        assert!(!none.any() && none.reason.is_empty());
        let both = of(Some("A:2-3"), Some("A:4")).unwrap();
        use ResidueRole::{Excluded, Free};
        assert_eq!(both.marks[0], [Free, Excluded, Excluded, Free]);
        assert_eq!(both.marks[1], [Free, Free, Free, Excluded]);
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

    /// What is blocked and attracted is attracted, residue by residue.
    #[test]
    fn attracted_residues_are_marked_and_listed() {
        let molecule = peptide(10.0);
        let options = DockOptions::default().changed(|options| {
            options.restraints.block_receptor = Some("A:3-4".parse().unwrap());
            options.restraints.active_receptor = Some("A:1,A:4".parse().unwrap());
            options.restraints.active_ligand = Some("A:2".parse().unwrap());
        });
        let restraints = Restraints::new([&molecule, &molecule], &options).unwrap();
        use ResidueRole::{Active, Excluded, Free};
        assert_eq!(restraints.marks[0], [Active, Free, Excluded, Active]);
        assert_eq!(restraints.marks[1], [Free, Active, Free, Free]);
        assert_eq!(
            restraints.attracted,
            [vec![vec![0], vec![3]], vec![vec![1]]]
        );
    }
}
