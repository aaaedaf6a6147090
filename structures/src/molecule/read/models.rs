//! Models of a file: parts of one molecule, or alternatives.
//!
//! The models of an NMR ensemble or of a trajectory lie on one another. Those of a biological assembly (`.pdb1`) or
//! of a complex with a partner in each lie beside one another: two atoms that are not bonded keep a distance of some
//! 3 Å. So the models of a file are parts where hardly any atom shares a cell of 2 Å with an atom of another model.

use std::collections::{BTreeMap, BTreeSet, HashMap, HashSet};

use crate::molecule::model::report::JoinedModels;
use crate::molecule::model::wording::count;
use crate::molecule::read::assembly::copy_name;
use crate::molecule::read::coincidence::Copies;
use crate::molecule::read::parse::Parsed;
use crate::neighbours::cell::{Cell, cell_of};

/// Edge of the cells, in Å. Within a protein there is an atom for every 16 Å³, so that half of these cells of 8 Å³ hold
/// one.
const CELL: f64 = 2.0;

/// Share of a model's atoms up to which it lies beside the others: some 40% do so of two models that lie on one
/// another.
const MAX_SHARED: f64 = 0.05;

/// Relation between the models of a file.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Relation {
    /// There is but one.
    Single,
    /// They lie beside one another.
    Parts,
    /// Some lie on others.
    Alternatives,
}

/// How the models lie, by the models and positions (Å) of their atoms.
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
/// are: the second of chain A is `A-2`. Where the models are parts, an atom within 0.5 Å of the same atom of an earlier
/// model is left out.
pub(crate) fn join(parsed: Vec<Parsed>, relation: Relation) -> (Vec<Parsed>, JoinedModels) {
    let mut of_chain: HashMap<&str, BTreeSet<usize>> = HashMap::new();
    for record in &parsed {
        let models = of_chain.entry(&record.raw.chain).or_default();
        models.insert(record.raw.model);
    }
    let in_file: HashSet<&str> = of_chain.keys().copied().collect();
    let names: HashMap<(usize, &str), String> = of_chain
        .iter()
        .flat_map(|(chain, models)| {
            let in_file = &in_file;
            let numbered = models.iter().zip(1..);
            numbered.map(move |(model, copy)| ((*model, *chain), copy_name(chain, copy, in_file)))
        })
        .collect();
    let mut seen: HashMap<_, Copies<usize>> = HashMap::new();
    let mut repeats = Vec::with_capacity(parsed.len());
    for record in &parsed {
        let (raw, position) = (&record.raw, record.exact.position);
        let key = (
            raw.chain.as_str(),
            raw.residue_number,
            raw.insertion_code,
            (raw.residue_name.as_str(), record.name.as_str()),
            raw.alternate_location,
        );
        let there = seen.entry(key).or_default();
        let repeat = relation == Relation::Parts && there.has(position, |model| model != raw.model);
        repeats.push(repeat);
        if !repeat {
            there.push(raw.model, position);
        }
    }
    let renamed: Vec<Option<String>> = parsed
        .iter()
        .map(|record| names.get(&(record.raw.model, record.raw.chain.as_str())))
        .map(|name| name.cloned())
        .collect();
    let models: BTreeSet<usize> = parsed.iter().map(|record| record.raw.model).collect();
    let report = JoinedModels {
        models: models.len(),
        on_axes: repeats.iter().filter(|repeat| **repeat).count(),
    };
    let kept = parsed.into_iter().zip(renamed).zip(repeats);
    let joined = kept
        .filter(|(_, repeat)| !repeat)
        .map(|((mut record, name), _)| {
            if let Some(name) = name {
                record.raw.chain = name;
            }
            record
        })
        .collect();
    (joined, report)
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
}
