//! Inputs of structure predictors from poses: the sequences of both sides, and a few contacts of the pose as constraints of
//! the next prediction.
//!
//! Formats, as the programs document them: Boltz (`docs/prediction.md`: YAML, `constraints`), Chai-1
//! (`examples/restraints/README.md`: FASTA and a table of restraints) and Protenix (`docs/infer_json_format.md`: JSON,
//! `constraint`). AlphaFold 3 takes no contacts.
//!
//! # Conventions
//!
//! - Chains are named A, B, C ... in the order of the receptor's chains, then the ligand's. Residues are numbered from 1 in
//!   the sequence, which has the residues of the structure and none that its file does not resolve.
//! - Distances are in Å. Boltz bounds the nearest atoms of two residues, Chai and Protenix their central atoms (CA or C1').

use std::collections::{BTreeMap, HashMap};
use std::fmt::Write as _;

use knotdock_scoring::se3::Pose;
use knotdock_structures::Error;
use knotdock_structures::molecule::{Atom, Molecule, nucleotide_letter};
use nalgebra::Point3;
use serde_json::{Value, json};

use crate::interface::{ContactFinder, ResidueName};

/// A program that predicts structures and takes contacts.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Predictor {
    /// Boltz-1 and Boltz-2.
    Boltz,
    /// Chai-1.
    Chai,
    /// Protenix.
    Protenix,
}

/// Contacts that are written of a pose: three that are spread determine a rigid placement, and one more allows for an error.
pub const CONTACTS: usize = 4;
/// Distance in Å between the central atoms of the residues of two contacts on either side, if there are enough of them.
const SPREAD: f64 = 7.0;
/// Å that are added to a distance of the pose: the interface RMSD of poses of acceptable and medium quality is 1 to 4 Å.
const SLACK: f64 = 3.0;

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Polymer {
    Protein,
    Dna,
    Rna,
}

impl Polymer {
    /// Its name in Boltz and Chai, and in Protenix.
    fn names(self) -> [&'static str; 2] {
        match self {
            Self::Protein => ["protein", "proteinChain"],
            Self::Dna => ["dna", "dnaSequence"],
            Self::Rna => ["rna", "rnaSequence"],
        }
    }
}

/// A chain as predictors read it.
#[derive(Debug)]
struct Sequence {
    id: String,
    polymer: Polymer,
    letters: String,
    /// The side and the author's name.
    origin: (usize, String),
    /// The central atom of each residue, in the frame of its file.
    central: Vec<[f64; 3]>,
}

impl Sequence {
    /// The side and the author's name, of characters that every format holds.
    fn origin(&self) -> String {
        let (side, name) = &self.origin;
        let plain = |c: char| if c.is_ascii_alphanumeric() { c } else { '_' };
        let name: String = name.chars().map(plain).collect();
        format!("{} chain {name}", ["receptor", "ligand"][*side])
    }
}

/// A residue of a sequence: the chain's place, and the residue's from 0.
type Place = (usize, usize);

/// A contact of a pose.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ChosenContact {
    places: [Place; 2],
    /// Poses of the cluster that have it.
    poses: usize,
    /// Distance of the nearest heavy atoms, and of the central atoms, in Å.
    distances: [f64; 2],
}

/// Receptor and ligand as sequences.
pub struct PredictionInputs<'a> {
    sequences: Vec<Sequence>,
    /// Places of the residues of each side in the order of [`ContactFinder::residues`].
    places: [Vec<Option<Place>>; 2],
    finder: ContactFinder<'a>,
    /// Residues that predictors would have to be given in another way, and gaps.
    pub warnings: Vec<String>,
}

impl<'a> PredictionInputs<'a> {
    /// The sequences of two molecules.
    ///
    /// # Errors
    /// [`Error`] for a side without residues of proteins and nucleic acids, and for more chains than letters.
    pub fn new(molecules: [&'a Molecule; 2]) -> Result<Self, Error> {
        let finder = ContactFinder::new(molecules, PH);
        let mut sequences = Vec::new();
        let mut warnings = Vec::new();
        let mut places = [HashMap::new(), HashMap::new()];
        for (side, molecule) in molecules.into_iter().enumerate() {
            let before = sequences.len();
            let others = read_chains(side, molecule, &mut sequences, &mut places[side]);
            let name = ["receptor", "ligand"][side];
            if sequences.len() == before {
                let message = format!("the {name} has no residues of proteins or nucleic acids");
                return Err(Error::input(message).help("export its complexes as pdb or cif"));
            }
            if !others.is_empty() {
                let names = others
                    .iter()
                    .map(|(name, count)| format!("{name} ({count})"));
                let names = names.collect::<Vec<_>>().join(", ");
                warnings.push(format!(
                    "no entities are written for {names} of the {name}: add them to the input"
                ));
            }
            let gaps = molecule.unresolved_residues().gaps;
            if gaps > 0 {
                warnings.push(format!(
                    "the {name} has {gaps} gaps, and its sequence has only resolved residues: with the whole sequence, \
                     shift the numbers of the contacts"
                ));
            }
        }
        if sequences.len() > LETTERS.len() {
            return Err(
                Error::input(format!("there are {} chains", sequences.len()))
                    .help(format!("pick at most {} when you dock", LETTERS.len())),
            );
        }
        let of_side = |side: usize| {
            let residues = finder.residues()[side].iter();
            residues
                .map(|residue| places[side].get(residue).copied())
                .collect()
        };
        Ok(Self {
            places: [of_side(0), of_side(1)],
            sequences,
            finder,
            warnings,
        })
    }

    /// At most `count` contacts of a pose: those that most of the poses of its cluster have first, then the nearest, and
    /// spaced on both sides.
    pub fn contacts(&self, pose: &Pose, cluster: &[Pose], count: usize) -> Vec<ChosenContact> {
        let mut poses: HashMap<[usize; 2], usize> = HashMap::new();
        for other in cluster {
            for contact in self.finder.contacts(std::slice::from_ref(other)) {
                *poses.entry(contact.residues).or_default() += 1;
            }
        }
        let found = self.finder.contacts(std::slice::from_ref(pose)).into_iter();
        let mut all: Vec<ChosenContact> = found
            .filter_map(|contact| {
                let [first, second] = contact.residues;
                let places = [self.places[0][first]?, self.places[1][second]?];
                let [one, other] = places.map(|place| self.central(place));
                Some(ChosenContact {
                    places,
                    poses: poses.get(&contact.residues).copied().unwrap_or(0),
                    distances: [contact.distance, distance(one, pose.apply(other))],
                })
            })
            .collect();
        all.sort_by(|a, b| {
            let by_poses = b.poses.cmp(&a.poses);
            let by_distance = a.distances[0].total_cmp(&b.distances[0]);
            by_poses.then(by_distance).then(a.places.cmp(&b.places))
        });
        let mut chosen: Vec<ChosenContact> = Vec::new();
        // Small interfaces have fewer spaced ones.
        for spread in [SPREAD, SPREAD / 2.0, f64::MIN_POSITIVE] {
            for contact in &all {
                let is_spaced = |other: &ChosenContact| {
                    let ends = contact.places.into_iter().zip(other.places);
                    let mut spacings =
                        ends.map(|(a, b)| distance(self.central(a), self.central(b)));
                    spacings.all(|spacing| spacing >= spread)
                };
                if chosen.len() < count && chosen.iter().all(is_spaced) {
                    chosen.push(*contact);
                }
            }
        }
        chosen
    }

    fn central(&self, (chain, residue): Place) -> [f64; 3] {
        self.sequences[chain].central[residue]
    }

    /// The files of a pose for a predictor: names and contents.
    pub fn files(
        &self,
        predictor: Predictor,
        rank: usize,
        contacts: &[ChosenContact],
    ) -> Vec<(String, String)> {
        let name = format!("rank_{rank:04}");
        match predictor {
            Predictor::Boltz => vec![(format!("{name}.yaml"), self.boltz(contacts))],
            Predictor::Chai => vec![
                (format!("{name}.fasta"), self.fasta()),
                (format!("{name}_restraints.csv"), self.chai(contacts)),
            ],
            Predictor::Protenix => {
                let text = format!("{:#}\n", self.protenix(&name, contacts));
                vec![(format!("{name}.json"), text)]
            }
        }
    }

    /// Chain and residue of one end of a contact, and the letter of the residue.
    fn named(&self, (chain, residue): Place) -> (&str, usize, char) {
        let sequence = &self.sequences[chain];
        // A letter is a byte.
        let letter = char::from(sequence.letters.as_bytes()[residue]);
        (&sequence.id, residue + 1, letter)
    }

    fn boltz(&self, contacts: &[ChosenContact]) -> String {
        let mut text = "version: 1\nsequences:\n".to_owned();
        for sequence in &self.sequences {
            let ([kind, _], origin) = (sequence.polymer.names(), sequence.origin());
            let Sequence { id, letters, .. } = sequence;
            let _ = write!(
                text,
                "  - {kind}:  # {origin}\n      id: {id}\n      sequence: {letters}\n"
            );
        }
        text += "constraints:\n";
        for contact in contacts {
            let [one, other] = contact.places.map(|place| {
                let (id, number, _) = self.named(place);
                format!("[{id}, {number}]")
            });
            // Between the nearest atoms; 4 to 20 Å are supported, and 6 is the default.
            let bound = (contact.distances[0] + SLACK).ceil().clamp(6.0, 20.0);
            let _ = write!(
                text,
                "  - contact:\n      token1: {one}\n      token2: {other}\n      max_distance: {bound}\n      force: false\n"
            );
        }
        text
    }

    fn fasta(&self) -> String {
        let entries = self.sequences.iter().map(|sequence| {
            let ([kind, _], origin) = (sequence.polymer.names(), sequence.origin());
            format!(
                ">{kind}|name={}\n{}\n",
                origin.replace(' ', "_"),
                sequence.letters
            )
        });
        entries.collect()
    }

    fn chai(&self, contacts: &[ChosenContact]) -> String {
        let mut text = "restraint_id,chainA,res_idxA,chainB,res_idxB,connection_type,confidence,min_distance_angstrom,\
                        max_distance_angstrom,comment\n"
            .to_owned();
        for (contact, number) in contacts.iter().zip(1..) {
            let [one, other] = contact.places.map(|place| {
                let (id, number, letter) = self.named(place);
                format!("{id},{letter}{number}")
            });
            // Chai-1 was trained with distances of 10 to 30 Å.
            let bound = (contact.distances[1] + SLACK).ceil().clamp(10.0, 30.0);
            let _ = writeln!(
                text,
                "contact{number},{one},{other},contact,1.0,0.0,{bound:.1},knotdock"
            );
        }
        text
    }

    fn protenix(&self, name: &str, contacts: &[ChosenContact]) -> Value {
        let sequences = self.sequences.iter().map(|sequence| {
            let [_, kind] = sequence.polymer.names();
            json!({ kind: { "sequence": sequence.letters, "count": 1 } })
        });
        let contacts = contacts.iter().map(|contact| {
            let [(one, first), (other, second)] = contact.places;
            json!({
                "entity1": one + 1, "copy1": 1, "position1": first + 1,
                "entity2": other + 1, "copy2": 1, "position2": second + 1,
                "max_distance": (contact.distances[1] + SLACK).ceil(), "min_distance": 0,
            })
        });
        json!([{
            "name": name,
            "sequences": sequences.collect::<Vec<_>>(),
            "constraint": { "contact": contacts.collect::<Vec<_>>() },
        }])
    }
}

fn distance(one: [f64; 3], other: [f64; 3]) -> f64 {
    nalgebra::distance(&Point3::from(one), &Point3::from(other))
}

/// pH of charges, which contacts do not depend on.
const PH: f64 = 7.0;
/// Names of chains, in the order in which Chai-1 gives them.
const LETTERS: &str = "ABCDEFGHIJKLMNOPQRSTUVWXYZ";

/// Adds the chains of a side, and the places of their residues; counts of residues that are in no sequence, by name.
fn read_chains(
    side: usize,
    molecule: &Molecule,
    sequences: &mut Vec<Sequence>,
    places: &mut HashMap<ResidueName, Place>,
) -> BTreeMap<String, usize> {
    let mut others = BTreeMap::new();
    let first = sequences.len();
    let atoms = &molecule.atoms;
    let peptides = molecule.peptide_chains();
    let starts = peptides.iter().flat_map(|chain| &chain.residues);
    let letters: HashMap<usize, char> = starts
        .map(|residue| (residue.atoms.start, residue.letter))
        .collect();
    let mut start = 0;
    for residue in atoms.chunk_by(|a, b| ResidueName::of(a) == ResidueName::of(b)) {
        let name = &residue[0].residue_name;
        let (letter, polymer) = match (letters.get(&start), nucleotide_letter(name)) {
            (Some(&letter), _) => (letter, Polymer::Protein),
            (None, Some('T')) => ('T', Polymer::Dna),
            (None, Some(base)) if name.starts_with('D') => (base, Polymer::Dna),
            (None, Some(base)) => (base, Polymer::Rna),
            (None, None) => ('X', Polymer::Protein),
        };
        let is_polymer = letters.contains_key(&start) || nucleotide_letter(name).is_some();
        start += residue.len();
        let central = if polymer == Polymer::Protein {
            "CA"
        } else {
            "C1'"
        };
        let central = residue.iter().find(|atom| atom.name == central);
        let (true, Some(central)) = (is_polymer, central) else {
            *others.entry(name.clone()).or_default() += 1;
            continue;
        };
        let chain = chain_of(sequences, first, (side, &residue[0]), polymer);
        let sequence = &mut sequences[chain];
        sequence.letters.push(letter);
        sequence.central.push(central.position);
        // Chai compares letters, and has none for residues outside the twenty.
        if letter != 'X' {
            places.insert(
                ResidueName::of(&residue[0]),
                (chain, sequence.letters.len() - 1),
            );
        }
    }
    others
}

/// The place of an atom's chain among the sequences from `first` on; a new one if it is not there.
fn chain_of(
    sequences: &mut Vec<Sequence>,
    first: usize,
    (side, atom): (usize, &Atom),
    polymer: Polymer,
) -> usize {
    let is_it =
        |sequence: &Sequence| sequence.origin.1 == atom.chain && sequence.polymer == polymer;
    if let Some(place) = sequences[first..].iter().position(is_it) {
        return first + place;
    }
    let id = LETTERS.chars().nth(sequences.len()).map(String::from);
    sequences.push(Sequence {
        id: id.unwrap_or_default(),
        polymer,
        letters: String::new(),
        origin: (side, atom.chain.clone()),
        central: Vec::new(),
    });
    sequences.len() - 1
}

#[cfg(test)]
mod tests {
    use super::*;
    use knotdock_structures::molecule::{InputSpec, ReadOptions, read};
    use std::path::Path;

    fn inputs() -> [Molecule; 2] {
        let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("structures/examples");
        ["receptor", "ligand"].map(|side| {
            let input = InputSpec::whole(folder.join(format!("1ppe_{side}_bound.pdb")));
            read(&input, &ReadOptions::default()).unwrap()
        })
    }

    /// In the crystal the inhibitor's arginine 5 is in the pocket of trypsin, beside aspartate 189 (171st in the chain of
    /// the file) and serine 195.
    #[test]
    fn contacts_of_the_crystal_are_few_spread_and_numbered_in_the_sequence() {
        let molecules = inputs();
        let inputs = PredictionInputs::new(molecules.each_ref()).unwrap();
        let contacts = inputs.contacts(&Pose::identity(), &[], CONTACTS);
        assert_eq!(contacts.len(), CONTACTS);
        for (place, contact) in contacts.iter().enumerate() {
            assert!(contact.distances[0] <= 5.0 && contact.distances[1] < 15.0);
            for other in &contacts[..place] {
                for side in [0, 1] {
                    let [one, other] =
                        [contact, other].map(|contact| inputs.central(contact.places[side]));
                    assert!(distance(one, other) >= SPREAD / 2.0);
                }
            }
        }
        let residue = |place: Place| inputs.named(place);
        let all = inputs.contacts(&Pose::identity(), &[], 1000);
        assert!(
            all.iter()
                .any(|contact| residue(contact.places[1]) == ("B", 5, 'R'))
        );
        let yaml = &inputs.files(Predictor::Boltz, 1, &contacts)[0].1;
        assert!(
            yaml.contains("sequence: RVCPRILMECKKDSDCLAECVCLEHGYCG\n"),
            "{yaml}"
        );
        assert_eq!(yaml.matches("- contact:").count(), CONTACTS);
    }

    /// The contact that is chosen first is one that both poses of the cluster have, though another is nearer.
    #[test]
    fn contacts_of_more_poses_come_first() {
        let molecules = inputs();
        let inputs = PredictionInputs::new(molecules.each_ref()).unwrap();
        let nearest = inputs.contacts(&Pose::identity(), &[], 1)[0];
        // Away from the nearest contact, so that another one is left.
        let away = |step: f64| Pose {
            translation: [step, 0.0, 0.0].into(),
            ..Pose::identity()
        };
        let has = |pose: &Pose| {
            let found = inputs.finder.contacts(std::slice::from_ref(pose));
            let [first, second] = nearest.places.map(Some);
            found.iter().any(|contact| {
                let [one, other] = contact.residues;
                inputs.places[0][one] == first && inputs.places[1][other] == second
            })
        };
        let moved = (1..40)
            .map(|step| away(f64::from(step) * 0.25))
            .find(|pose| !has(pose))
            .unwrap();
        let first = inputs.contacts(&Pose::identity(), &[Pose::identity(), moved], 1)[0];
        assert_eq!((nearest.poses, first.poses), (0, 2));
        assert!(first.distances[0] >= nearest.distances[0] && first.places != nearest.places);
    }

    /// Each format holds the contacts by the numbers of the sequence that it holds.
    #[test]
    fn formats_name_the_same_residues() {
        let molecules = inputs();
        let inputs = PredictionInputs::new(molecules.each_ref()).unwrap();
        let contacts = inputs.contacts(&Pose::identity(), &[], CONTACTS);
        let json: Value =
            serde_json::from_str(&inputs.files(Predictor::Protenix, 7, &contacts)[0].1).unwrap();
        let sequences = json[0]["sequences"].as_array().unwrap();
        let chai = inputs.files(Predictor::Chai, 7, &contacts);
        assert_eq!(chai[0].0, "rank_0007.fasta");
        let sequence_of = |entity: &Value| {
            let chain = &sequences[entity.as_u64().unwrap() as usize - 1];
            chain["proteinChain"]["sequence"]
                .as_str()
                .unwrap()
                .to_owned()
        };
        let rows = chai[1].1.lines().skip(1);
        for (row, contact) in rows.zip(json[0]["constraint"]["contact"].as_array().unwrap()) {
            let fields: Vec<&str> = row.split(',').collect();
            for (field, end) in [(2, "1"), (4, "2")] {
                let place = contact[format!("position{end}")].as_u64().unwrap() as usize;
                let letter = &sequence_of(&contact[format!("entity{end}")])[place - 1..place];
                assert_eq!(fields[field], format!("{letter}{place}"));
            }
        }
    }
}
