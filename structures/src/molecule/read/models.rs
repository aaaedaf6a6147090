//! Models of a file: parts of one molecule, or alternatives.
//!
//! The models of an NMR ensemble or of a trajectory overlap. Those of a biological assembly (`.pdb1`) or of a complex with
//! a partner in each are side by side: two atoms that are not bonded keep a distance of some 3 Å. So the models of a file
//! are parts if hardly any atom shares a cell of 2 Å with an atom of another model.

use crate::molecule::model::{JoinedModels, count, residue_key};
use crate::molecule::read::Record;
use crate::molecule::read::assembly::copy_name;
use crate::neighbours::{Cell, SpatialHash, cell_of};
use crate::vector::squared_distance;
use std::collections::{BTreeMap, BTreeSet, HashMap, HashSet};

/// Edge of the cells, in Å. Within a protein there is an atom for every 16 Å³, so that half of these cells of 8 Å³ hold
/// one.
const CELL: f64 = 2.0;

/// Largest share of a part's atoms in cells of other models: of two models that overlap some 40% are.
const MAX_SHARED: f64 = 0.05;

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Relation {
    /// There is but one.
    Single,
    /// They are side by side.
    Parts,
    /// Some overlap.
    Alternatives,
}

/// The relation of models, by the models and positions (Å) of their atoms.
pub(crate) fn relation(atoms: impl Iterator<Item = (usize, [f64; 3])> + Clone) -> Relation {
    let cell = |position: [f64; 3]| cell_of(position, CELL);
    // The model of a cell's atoms; nothing where they are of several.
    let mut owners: HashMap<Cell, Option<usize>> = HashMap::new();
    for (model, position) in atoms.clone() {
        let owner = owners.entry(cell(position)).or_insert(Some(model));
        if *owner != Some(model) {
            *owner = None;
        }
    }
    let mut shares: BTreeMap<usize, [usize; 2]> = BTreeMap::new();
    for (model, position) in atoms {
        let [shared, all] = shares.entry(model).or_default();
        *all += 1;
        *shared += usize::from(owners.get(&cell(position)) == Some(&None));
    }
    let lies_beside = |[shared, all]: &[usize; 2]| *shared as f64 <= MAX_SHARED * *all as f64;
    match shares.len() {
        0 | 1 => Relation::Single,
        _ if shares.values().all(lies_beside) => Relation::Parts,
        _ => Relation::Alternatives,
    }
}

/// A warning where models were left out that are parts.
pub(crate) fn warning(models: usize, read: usize, ignored: usize) -> String {
    let others = models.saturating_sub(1);
    let were = if others == 1 { "was" } else { "were" };
    format!(
        "the {models} models of this file lie beside one another, as parts of one molecule do, and model {read} \
         alone is read: {} with {} {were} \
         left out; --model all reads them as one",
        count(others, "other model"),
        count(ignored, "atom")
    )
}

/// A warning where models were joined that are alternatives.
pub(crate) const ALTERNATIVES_JOINED: &str = "the models of this file lie on one another, as alternatives do, \
    and --model all reads them as one \
     molecule, in which they are counted one by one: --model 1 reads the first";

/// Makes one molecule of several models. A chain whose name an earlier model has is renamed as copies in an assembly
/// are: the second of chain A is `A-2`. If the models are parts, an atom within 0.5 Å of the same atom of an earlier
/// model is left out.
pub(crate) fn join(records: Vec<Record>, relation: Relation) -> (Vec<Record>, JoinedModels) {
    let mut of_chain: HashMap<&str, BTreeSet<usize>> = HashMap::new();
    for record in &records {
        let models = of_chain.entry(&record.atom.chain).or_default();
        models.insert(record.model);
    }
    let in_file: HashSet<&str> = of_chain.keys().copied().collect();
    let numbered = of_chain.iter().flat_map(|(&chain, models)| {
        let copies = models.iter().zip(1..);
        copies.map(move |(&model, copy)| ((chain, model), copy))
    });
    let copies: HashMap<(&str, usize), usize> = numbered.collect();
    let mut images: HashMap<_, Images<usize>> = HashMap::new();
    let mut names: Vec<Option<String>> = Vec::with_capacity(records.len());
    for record in &records {
        let (atom, model) = (&record.atom, record.model);
        let key = (
            residue_key(atom),
            atom.name.as_str(),
            atom.alternate_location,
        );
        let there = images.entry(key).or_default();
        if relation == Relation::Parts && there.has(atom.position, |other| other != model) {
            names.push(None);
            continue;
        }
        there.push(model, atom.position);
        let copy = copies[&(atom.chain.as_str(), model)];
        names.push(Some(copy_name(&atom.chain, copy, &in_file)));
    }
    let models: BTreeSet<usize> = records.iter().map(|record| record.model).collect();
    let report = JoinedModels {
        models: models.len(),
        on_axes: names.iter().filter(|name| name.is_none()).count(),
    };
    let mut joined = Vec::with_capacity(records.len());
    for (mut record, name) in records.into_iter().zip(names) {
        if let Some(name) = name {
            record.atom.chain = name;
            joined.push(record);
        }
    }
    (joined, report)
}

/// Copies nearer than this, in Å, are one, on an axis of symmetry.
const ON_AXIS: f64 = 0.5;

/// Copies up to which a new one is compared with each; more are looked up by their place.
const FEW: usize = 64;

/// Positions of the copies of one atom (Å), and the owner of each.
#[derive(Clone, Default)]
pub(crate) struct Images<T> {
    first: Vec<(T, [f64; 3])>,
    /// All of them, where they are many.
    cells: Option<SpatialHash<(T, [f64; 3])>>,
}

impl<T: Copy> Images<T> {
    pub(crate) fn is_empty(&self) -> bool {
        self.first.is_empty()
    }

    /// Whether a position is on a copy, of those that count.
    pub(crate) fn has(&self, position: [f64; 3], counts: impl Fn(T) -> bool) -> bool {
        let lies_on = |(owner, place): &(T, [f64; 3])| {
            counts(*owner) && squared_distance(*place, position) < ON_AXIS * ON_AXIS
        };
        match &self.cells {
            None => self.first.iter().any(lies_on),
            Some(cells) => cells.around(position).any(lies_on),
        }
    }

    pub(crate) fn push(&mut self, owner: T, position: [f64; 3]) {
        match &mut self.cells {
            Some(cells) => cells.push(position, (owner, position)),
            None => {
                self.first.push((owner, position));
                if self.first.len() == FEW {
                    let cells = self.cells.insert(SpatialHash::new(ON_AXIS));
                    for &(owner, place) in &self.first {
                        cells.push(place, (owner, place));
                    }
                }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Atoms on a grid of 2.5 Å, about as dense as a protein's, `side` along each edge and moved by `shift`.
    fn block(model: usize, side: i32, shift: [f64; 3]) -> Vec<(usize, [f64; 3])> {
        let places = (0..side.pow(3)).map(|i| [i / (side * side), i / side % side, i % side]);
        let place = |at: [i32; 3]| [0, 1, 2].map(|axis| 2.5 * f64::from(at[axis]) + shift[axis]);
        places.map(|at| (model, place(at))).collect()
    }

    fn of(models: &[Vec<(usize, [f64; 3])>]) -> Relation {
        relation(models.concat().into_iter())
    }

    #[test]
    fn models_beside_one_another_are_parts_and_models_on_one_another_are_not() {
        let first = block(1, 8, [0.0; 3]);
        let beside = block(2, 8, [20.0, 3.0, 1.0]);
        let on = block(3, 8, [0.7, -0.4, 0.9]);
        assert_eq!(of(std::slice::from_ref(&first)), Relation::Single);
        assert_eq!(of(&[first.clone(), beside.clone()]), Relation::Parts);
        assert_eq!(of(&[first.clone(), on.clone()]), Relation::Alternatives);
        assert_eq!(
            of(&[first.clone(), beside.clone(), on]),
            Relation::Alternatives
        );
        // Poses of a ligand about a receptor that is not in the file, two of them alike.
        let far = block(2, 8, [60.0; 3]);
        let near_far = block(3, 8, [61.0; 3]);
        assert_eq!(of(&[first, far, near_far]), Relation::Alternatives);
        assert_eq!(of(&[]), Relation::Single);
    }

    /// Each copy was compared with all before it: 100,000 operators of a file, or as many models, took minutes.
    #[test]
    fn many_copies_are_looked_up_by_their_place() {
        let mut copies = Images::default();
        for number in 0..200_000 {
            let place = [0.6 * number as f64, -3.0, 0.0];
            assert!(!copies.has(place, |_| true));
            copies.push(number, place);
        }
        for number in [0, 63, 64, 199_999] {
            let place = [0.6 * number as f64 + 0.1, -3.0, 0.2];
            assert!(copies.has(place, |owner| owner == number));
            assert!(!copies.has(place, |owner| owner > number + 1));
        }
    }
}
