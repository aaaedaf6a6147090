//! Priors: knowledge of kinds of proteins beyond the two structures at hand, such as where an antibody binds.
//!
//! A prior finds the sites of a molecule that mostly bind. A new kind of protein is one file here and one line in
//! [`PRIORS`], which docking runs and `knotdock inspect` read.

pub mod active_residues;
mod antibody;
pub mod flexible_regions;
mod peptidase;
pub mod residue_roles;
pub mod restrained;
#[cfg(test)]
mod test_chains;

use knotdock_structures::molecule::Molecule;

/// Role of a site in the score of a pose.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SiteRole {
    /// The molecule binds here alone: contacts of its other atoms take off the score.
    Exclusive,
    /// A pose scores by the share of the residues that touch; any of several sites may be the one that binds.
    Favoured,
}

/// A part of a molecule that mostly binds.
#[derive(Clone, Debug, PartialEq)]
pub struct Site {
    /// Role in the score.
    pub role: SiteRole,
    /// Its residues in file order, each by the indices of those atoms that belong to the site.
    pub residues: Vec<Vec<usize>>,
    /// The kind of the molecule and its site, in words that follow "the receptor is".
    pub reason: String,
    /// Entry of `run.json`.
    pub record: serde_json::Value,
}

/// The sites of a molecule that all priors find.
pub(crate) fn sites(molecule: &Molecule) -> Vec<Site> {
    let sites = PRIORS.iter().map(|prior| prior.sites(molecule));
    sites.flatten().collect()
}

/// Sites found in a molecule, for the report of `knotdock inspect`.
#[derive(Clone, Debug, PartialEq)]
pub struct Findings {
    /// The entry in JSON.
    pub entry: serde_json::Value,
    /// Lines for people; empty if nothing was found.
    pub lines: Vec<String>,
}

/// Knowledge of one kind of proteins.
pub trait Prior: Sync {
    /// The sites of a molecule; none if it is of another kind.
    fn sites(&self, molecule: &Molecule) -> Vec<Site>;

    /// Name of the entry that [`Prior::findings`] give in JSON.
    fn entry_name(&self) -> &'static str;

    /// The findings in a molecule, for `knotdock inspect`.
    fn findings(&self, molecule: &Molecule) -> Findings;
}

/// All priors.
pub const PRIORS: [&dyn Prior; 2] = [&antibody::AntibodyPrior, &peptidase::PeptidasePrior];

#[cfg(test)]
mod tests {
    use super::*;
    use knotdock_structures::molecule::{Format, InputSpec, ReadOptions, read};

    #[test]
    fn trypsin_is_a_peptidase_and_no_antibody() {
        let root = env!("CARGO_MANIFEST_DIR");
        let path = format!("{root}/structures/examples/1ppe_receptor_unbound.pdb");
        let trypsin = read(&InputSpec::whole(path), &ReadOptions::default()).unwrap();
        let found: Vec<&str> = PRIORS
            .iter()
            .filter(|prior| !prior.sites(&trypsin).is_empty())
            .map(|prior| prior.entry_name())
            .collect();
        assert_eq!(found, ["active_sites"]);
        for prior in PRIORS {
            let has_site = !prior.sites(&trypsin).is_empty();
            assert_eq!(!prior.findings(&trypsin).lines.is_empty(), has_site);
            for site in prior.sites(&trypsin) {
                assert!(!site.residues.is_empty() && !site.reason.is_empty());
                assert!(
                    site.residues
                        .iter()
                        .flatten()
                        .all(|&atom| atom < trypsin.atoms.len())
                );
            }
        }
    }

    #[test]
    fn names_are_distinct_and_nothing_is_found_in_nothing() {
        let empty = Molecule::new(Vec::new(), Format::Pdb);
        let names = PRIORS.map(|prior| prior.entry_name());
        assert_eq!(names, ["antibody", "active_sites"]);
        assert!(PRIORS.iter().all(|prior| prior.sites(&empty).is_empty()));
    }
}
