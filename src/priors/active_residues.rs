//! What a pose should touch: residues that the user names, or else the active site of a peptidase.

use crate::options::DockOptions;
use crate::priors::{ActiveSite, Antibody};
use knotdock_scoring::effect::restraint::ResidueRole;
use knotdock_scoring::terms::pose::Residues;
use knotdock_structures::molecule::{Molecule, Partner};
use serde::Serialize;

/// Sets of residues, of which poses should touch all of one, and what those earn.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ActiveResidues {
    /// Residues of receptor and ligand, each as the places of its knots.
    pub(crate) sets: Vec<Residues>,
    /// What a pose earns in which all of a set touch: score.
    pub(crate) weight: f64,
    /// Where the sets are what is assumed of a peptidase.
    pub(crate) assumed: Option<AssumedSite>,
}

/// A peptidase, and where its partner is assumed to bind.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct AssumedSite {
    /// Which of the two it is.
    pub partner: Partner,
    /// Its active sites, any of which may be the one.
    pub sites: Vec<ActiveSite>,
}

impl ActiveResidues {
    /// Residues that were named.
    pub(crate) fn named(residues: Residues, options: &DockOptions) -> Self {
        let any = residues.iter().any(|side| !side.is_empty());
        Self {
            sets: if any { vec![residues] } else { Vec::new() },
            weight: options.restraints.active_weight,
            assumed: None,
        }
    }

    /// The active sites of a peptidase, where one of the two is one and nothing speaks against it; `marks` say which atoms are kept free of contact.
    pub(crate) fn assumed(
        molecules: [&Molecule; 2],
        marks: [&[ResidueRole]; 2],
        options: &DockOptions,
    ) -> Self {
        let weight = options.restraints.peptidase_weight;
        let assumed = (weight > 0.0).then(|| AssumedSite::of(molecules, marks));
        let assumed = assumed.flatten();
        let sets = assumed.as_ref().map_or(Vec::new(), |assumed| {
            let sites = assumed.sites.iter().map(|site| site.atoms.clone());
            sites.map(|atoms| assumed.side(atoms)).collect()
        });
        Self {
            sets,
            weight,
            assumed,
        }
    }
}

impl AssumedSite {
    /// Where one of the two is a peptidase and the other is none, sites left out that are to stay free of contact. What an antibody was raised against is as
    /// likely to be anywhere.
    fn of(molecules: [&Molecule; 2], marks: [&[ResidueRole]; 2]) -> Option<Self> {
        let (partner, mut sites, marks) = match molecules.map(ActiveSite::all) {
            [own, other] if other.is_empty() => (Partner::Receptor, own, marks[0]),
            [own, other] if own.is_empty() => (Partner::Ligand, other, marks[1]),
            _ => return None,
        };
        sites.retain(|site| {
            let mut atoms = site.atoms.iter().flatten();
            !atoms.any(|&atom| marks.get(atom) == Some(&ResidueRole::Excluded))
        });
        let none = sites.is_empty() || molecules.iter().any(|m| Antibody::of(m).is_some());
        (!none).then_some(Self { partner, sites })
    }

    /// Residues of the peptidase, and none of its partner.
    fn side(&self, residues: Vec<Vec<usize>>) -> Residues {
        match self.partner {
            Partner::Receptor => [residues, Vec::new()],
            _ => [Vec::new(), residues],
        }
    }
}

impl std::fmt::Display for AssumedSite {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let (partner, sites) = (self.partner, ActiveSite::all_in_words(&self.sites));
        write!(f, "the {partner} is a peptidase, {sites}")
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::dock::scene::{Decision, Scene};
    use crate::options::AntibodySurface;
    use knotdock_scoring::effect::Effect;
    use knotdock_structures::molecule::{Atom, Format, InputSpec, ReadOptions, read};

    fn example(name: &str) -> Molecule {
        let root = env!("CARGO_MANIFEST_DIR");
        let path = format!("{root}/structures/examples/1ppe_{name}.pdb");
        read(&InputSpec::whole(path), &ReadOptions::default()).unwrap()
    }

    /// Trypsin, told by itself and not by its inhibitor, on either side; with nothing to earn where nothing is asked, contacts are off, or residues are named.
    #[test]
    fn a_peptidase_is_attracted_by_its_active_site() {
        let (trypsin, inhibitor) = (example("receptor_unbound"), example("ligand_unbound"));
        let of = |molecules: [&Molecule; 2], options: &DockOptions| {
            let [receptor, ligand] = molecules;
            Scene::new(receptor, ligand, options).unwrap().active
        };
        let with = |change: fn(&mut DockOptions)| {
            let mut options = DockOptions::default();
            change(&mut options);
            of([&trypsin, &inhibitor], &options)
        };
        let default = with(|_| {});
        assert_eq!(
            default.weight,
            DockOptions::default().restraints.peptidase_weight
        );
        let site = default.assumed.clone().unwrap();
        assert_eq!(
            site.to_string(),
            "the receptor is a peptidase, of family S1 like trypsin (catalytic A:57, A:195)"
        );
        let [[receptor, ligand]] = &default.sets[..] else {
            panic!("{:?}", default.sets);
        };
        assert!(ligand.is_empty());
        let names = receptor.iter().map(|atoms| {
            let residue = &trypsin.atoms[atoms[0]];
            assert!(
                atoms
                    .iter()
                    .all(|&at| { trypsin.atoms[at].residue_number == residue.residue_number })
            );
            residue.residue_name.as_str()
        });
        assert_eq!(names.collect::<Vec<_>>(), ["HIS", "SER"]);
        let turned = of([&inhibitor, &trypsin], &DockOptions::default());
        assert_eq!(turned.assumed.unwrap().partner, Partner::Ligand);
        assert_eq!(turned.sets, [[Vec::new(), receptor.clone()]]);

        let two = of([&trypsin, &trypsin], &DockOptions::default());
        assert!(two.sets.is_empty() && two.assumed.is_none());
        let changes: [fn(&mut DockOptions); 5] = [
            |options| options.restraints.peptidase_weight = 0.0,
            |options| options.kernel.effects = "shape,electrostatics".parse().unwrap(),
            |options| options.restraints.block_receptor = Some("A:195".parse().unwrap()),
            |options| options.restraints.active_ligand = Some("B:5".parse().unwrap()),
            |options| {
                options.restraints.active_receptor = Some("A:20".parse().unwrap());
                options.restraints.active_weight = 0.0;
            },
        ];
        for change in changes {
            assert_eq!(with(change).assumed, None);
        }
        let elsewhere =
            with(|options| options.restraints.block_receptor = Some("A:20-30".parse().unwrap()));
        assert_eq!(elsewhere.sets, default.sets);
    }

    /// The heavy chain of trastuzumab, as alpha carbons; it is none the less an antibody where all of it may touch.
    #[test]
    fn an_antibody_against_a_peptidase_may_be_anywhere() {
        let sequence = "EVQLVESGGGLVQPGGSLRLSCAASGFNIKDTYIHWVRQAPGKGLEWVARIYPTNGYTRYADSVKGRFTISADTSKNTAYLQMNSLRAEDTAVYYCSRWGGDGFYAMDYWGQGTLVTVSS";
        let names =
            "ALA CYS ASP GLU PHE GLY HIS ILE LYS LEU MET ASN PRO GLN ARG SER THR VAL TRP TYR";
        let names: Vec<&str> = names.split(' ').collect();
        let letters = "ACDEFGHIKLMNPQRSTVWY";
        let atom = |(number, letter): (i64, char)| Atom {
            name: "CA".to_owned(),
            residue_name: names[letters.find(letter).unwrap()].to_owned(),
            chain: "H".to_owned(),
            residue_number: number,
            insertion_code: None,
            alternate_location: None,
            element: "C".to_owned(),
            position: [3.8 * number as f64, 0.0, 0.0],
            occupancy: 1.0,
            b_factor: 0.0,
            hetero: false,
            radius: 1.9,
            line: 1,
        };
        let atoms = (1..).zip(sequence.chars()).map(atom).collect();
        let antibody = Molecule::new(atoms, Format::Pdb);
        let trypsin = example("receptor_unbound");
        for surface in [AntibodySurface::Cdrs, AntibodySurface::Whole] {
            let options =
                DockOptions::default().changed(|options| options.restraints.antibody = surface);
            let scene = Scene::new(&trypsin, &antibody, &options).unwrap();
            let contact = |decision: &Decision| decision.effect == Effect::Contact && decision.on;
            assert!(scene.decisions.iter().any(contact));
            assert!(scene.active.sets.is_empty());
        }
    }
}
