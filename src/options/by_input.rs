//! Options that follow from the input where they are not given.

use knotdock_structures::molecule::Molecule;
use nalgebra::Vector3;

use super::{AXES, AXES_ACROSS, DockOptions};

/// Radius of gyration in Å below which a ligand needs fewer rotations than the default.
const SMALL: f64 = 14.0;
/// Rotations of the smallest ligands.
const FEWEST_ROTATIONS: usize = 1000;

/// Radius of clusters in Å if the interface is known in part (docs/research/defaults.md, "Clusters").
const CONFINED_RADIUS: f64 = 9.0;

/// Radius of gyration of a molecule's heavy atoms, Å.
fn radius_of_gyration(molecule: &Molecule) -> f64 {
    let heavy = molecule.atoms.iter().filter(|atom| !atom.is_hydrogen());
    let places: Vec<Vector3<f64>> = heavy.map(|atom| Vector3::from(atom.position)).collect();
    let count = places.len().max(1) as f64;
    let middle = places.iter().sum::<Vector3<f64>>() / count;
    let squares = places.iter().map(|place| (place - middle).norm_squared());
    (squares.sum::<f64>() / count).sqrt()
}

impl DockOptions {
    /// The options of a search for rings: residues are alike on both sides, and rotations are axes, of which there
    /// are fewer unless their number is given.
    #[must_use]
    pub fn of_rings(mut self, rotations_given: bool) -> Self {
        let Some(symmetry) = self.search.symmetry else {
            return self;
        };
        if !rotations_given {
            self.search.rotations = match symmetry.folds() {
                Some(_) => AXES_ACROSS,
                None => AXES,
            };
        }
        // Other residues of the ligand are refused by the check.
        let restraints = &mut self.restraints;
        for (receptor, ligand) in [
            (&restraints.block_receptor, &mut restraints.block_ligand),
            (&restraints.active_receptor, &mut restraints.active_ligand),
            (&restraints.site_receptor, &mut restraints.site_ligand),
        ] {
            if ligand.is_none() {
                ligand.clone_from(receptor);
            }
        }
        if restraints.interface_ligand.is_none() {
            restraints
                .interface_ligand
                .clone_from(&restraints.interface_receptor);
        }
        self
    }

    /// The options of a search with a ligand, unless `is_given` names an option that decides on them: fewer rotations of
    /// a small one, and wider clusters if the interface is known in part.
    ///
    /// The number of rotations falls with the cube of the radius of gyration, so that neighbouring rotations move a
    /// ligand's surface by one length, whatever its size (docs/research/defaults.md). What is known confines the poses,
    /// so that more of the best ones are alike.
    #[must_use]
    pub fn of_ligand(mut self, ligand: &Molecule, is_given: impl Fn(&str) -> bool) -> Self {
        if self.restraints.knows_contacts() && !is_given("cluster_radius") {
            self.ranking.cluster_radius = CONFINED_RADIUS;
        }
        if ["rotations", "fine_rotations", "symmetry"]
            .into_iter()
            .any(is_given)
        {
            return self;
        }
        let share = (radius_of_gyration(ligand) / SMALL).powi(3);
        let most = self.search.rotations;
        let count = (most as f64 * share).round() as usize;
        self.search.rotations = count.clamp(FEWEST_ROTATIONS.min(most), most);
        self
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use knotdock_structures::molecule::{Format, InputSpec, ReadOptions, read};
    use std::path::Path;

    /// Rotations by default for the example's inhibitor, blown up about the origin by a factor.
    fn rotations(factor: f64, given: &str) -> usize {
        let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("structures/examples");
        let input = InputSpec::whole(folder.join("1ppe_ligand_unbound.pdb"));
        let ligand = read(&input, &ReadOptions::default()).unwrap();
        let ligand = ligand.map_positions(|position| position.map(|x| factor * x));
        let options = DockOptions::default().of_ligand(&ligand, |name| name == given);
        options.search.rotations
    }

    /// What is known of contacts widens clusters, unless their radius is given; blocked residues do not.
    #[test]
    fn clusters_are_wider_if_contacts_are_known() {
        let ligand = Molecule::new(Vec::new(), Format::Pdb);
        let radius = |named: &str, given: &str| {
            let options = DockOptions::default().changed(|options| {
                let residues = Some("A:5".parse().unwrap());
                let restraints = &mut options.restraints;
                match named {
                    "active_receptor" => restraints.active_receptor = residues,
                    "site_ligand" => restraints.site_ligand = residues,
                    "block_ligand" => restraints.block_ligand = residues,
                    _ => (),
                }
            });
            let options = options.of_ligand(&ligand, |name| name == given);
            options.ranking.cluster_radius
        };
        let default = DockOptions::default().ranking.cluster_radius;
        for (named, expected) in [
            ("", default),
            ("block_ligand", default),
            ("active_receptor", CONFINED_RADIUS),
            ("site_ligand", CONFINED_RADIUS),
        ] {
            assert_eq!(radius(named, ""), expected, "{named}");
            assert_eq!(radius(named, "cluster_radius"), default);
        }
    }

    /// Its radius of gyration is 8.6 Å: equal steps along the surface would take 834 rotations.
    #[test]
    fn small_ligands_have_fewer_rotations_unless_these_are_given() {
        assert_eq!(rotations(1.0, ""), FEWEST_ROTATIONS);
        let larger = rotations(1.3, "");
        let expected = 3600.0 * (1.3f64 * 8.599 / SMALL).powi(3);
        assert!(
            (larger as f64 - expected).abs() < 5.0,
            "{larger} {expected}"
        );
        assert_eq!(rotations(2.0, ""), 3600);
        for given in ["rotations", "fine_rotations", "symmetry"] {
            assert_eq!(rotations(1.0, given), 3600, "{given}");
        }
    }
}
