//! Active residues: those that the user names, or those of the favoured sites of one side.

use crate::options::DockOptions;
use crate::priors::{Site, SiteRole};
use knotdock_scoring::terms::effect::restraint::ResidueRole;
use knotdock_scoring::terms::pose::Residues;
use knotdock_structures::molecule::Partner;
use serde::{Serialize, Serializer};

/// Sets of active residues with their weight. A pose should touch all residues of one set.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ActiveResidues {
    /// Residues of receptor and ligand, each as the indices of its knots.
    pub(crate) sets: Vec<Residues>,
    /// Score of a pose in which all residues of a set are in contact.
    pub(crate) weight: f64,
    /// The sites that the sets come from; `None` if the user names the residues.
    pub(crate) assumed: Option<AssumedSite>,
}

/// Sites of one side where the other is assumed to bind.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct AssumedSite {
    /// The side with the sites.
    pub partner: Partner,
    /// Its sites, any of which may bind.
    #[serde(serialize_with = "records")]
    pub sites: Vec<Site>,
}

/// Writes the record of each site.
fn records<S: Serializer>(sites: &[Site], to: S) -> Result<S::Ok, S::Error> {
    to.collect_seq(sites.iter().map(|site| &site.record))
}

impl ActiveResidues {
    /// Residues that the user names.
    pub(crate) fn named(residues: Residues, options: &DockOptions) -> Self {
        let mut sets = vec![residues];
        sets.retain(|residues| residues.iter().any(|side| !side.is_empty()));
        Self {
            sets,
            weight: options.terms.active_weight,
            assumed: None,
        }
    }

    /// Residues of the favoured sites of one side; none if their weight is 0.
    pub(crate) fn assumed(
        sites: [&[Site]; 2],
        roles: [&[ResidueRole]; 2],
        options: &DockOptions,
    ) -> Self {
        let weight = options.restraints.peptidase_weight;
        let assumed = AssumedSite::of(sites, roles).filter(|_| weight > 0.0);
        Self {
            sets: assumed.as_ref().map_or(Vec::new(), AssumedSite::residues),
            weight,
            assumed,
        }
    }
}

impl AssumedSite {
    /// The favoured sites of one side, if the other has none, and no side has an exclusive site.
    ///
    /// Sites with excluded atoms are left out. An antibody against an enzyme may bind anywhere, so its exclusive site
    /// leaves no assumption.
    fn of(sites: [&[Site]; 2], roles: [&[ResidueRole]; 2]) -> Option<Self> {
        let of_role =
            |side: usize, role: SiteRole| sites[side].iter().filter(move |s| s.role == role);
        let has = |side: usize, role: SiteRole| of_role(side, role).next().is_some();
        if [0, 1].iter().any(|&side| has(side, SiteRole::Exclusive)) {
            return None;
        }
        let favoured = [0, 1].map(|side| has(side, SiteRole::Favoured));
        let (side, partner) = match favoured {
            [true, false] => (0, Partner::Receptor),
            [false, true] => (1, Partner::Ligand),
            _ => return None,
        };
        let is_free = |site: &&Site| {
            let mut atoms = site.residues.iter().flatten();
            !atoms.any(|&atom| roles[side].get(atom) == Some(&ResidueRole::Excluded))
        };
        let free = of_role(side, SiteRole::Favoured).filter(is_free);
        let sites: Vec<Site> = free.cloned().collect();
        (!sites.is_empty()).then_some(Self { partner, sites })
    }

    /// Residues of each site, with none of the other side.
    fn residues(&self) -> Vec<Residues> {
        let residues = self.sites.iter().map(|site| site.residues.clone());
        let of_both = |residues: Vec<Vec<usize>>| match self.partner {
            Partner::Receptor => [residues, Vec::new()],
            _ => [Vec::new(), residues],
        };
        residues.map(of_both).collect()
    }
}

impl std::fmt::Display for AssumedSite {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let reasons: Vec<&str> = self.sites.iter().map(|site| site.reason.as_str()).collect();
        write!(f, "the {} is {}", self.partner, reasons.join("; "))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::dock::effect_decisions::Decision;
    use crate::dock::scene::Scene;
    use crate::options::AntibodySurface;
    use knotdock_scoring::terms::effect::Effect;
    use knotdock_structures::molecule::{Atom, Format, InputSpec, Molecule, ReadOptions, read};

    fn example(name: &str) -> Molecule {
        let root = env!("CARGO_MANIFEST_DIR");
        let path = format!("{root}/structures/examples/1ppe_{name}.pdb");
        read(&InputSpec::whole(path), &ReadOptions::default()).unwrap()
    }

    /// Trypsin is detected on either side, and its inhibitor is not. There are no active residues without a weight,
    /// without the contact effect, with an excluded site or with other residues named.
    #[test]
    fn the_active_site_of_a_peptidase_is_active() {
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
            |options| {
                options.kernel.effects = "shape,electrostatics".to_owned().try_into().unwrap();
            },
            |options| options.restraints.block_receptor = Some("A:195".parse().unwrap()),
            |options| options.restraints.active_ligand = Some("B:5".parse().unwrap()),
            |options| {
                options.restraints.active_receptor = Some("A:20".parse().unwrap());
                options.terms.active_weight = 0.0;
            },
        ];
        for change in changes {
            assert_eq!(with(change).assumed, None);
        }
        let elsewhere =
            with(|options| options.restraints.block_receptor = Some("A:20-30".parse().unwrap()));
        assert_eq!(elsewhere.sets, default.sets);
    }

    /// The heavy chain of trastuzumab as CA atoms. It is an antibody also where all of it may bind.
    #[test]
    fn an_antibody_against_a_peptidase_may_be_anywhere() {
        let sequence = "EVQLVESGGGLVQPGGSLRLSCAASGFNIKDTYIHWVRQAPGKGLEWVARIYPTNGYTRYADSVKGRFTISADTSKNTAYLQMNSLR\
            AEDTAVYYCSRWGGDGFYAMDYWGQGTLVTVSS";
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
