//! Warnings about the atoms that are kept: parts that are missing or there twice, and molecules other than the all-atom
//! proteins that the score was tuned on.

use std::collections::{BTreeMap, BTreeSet, HashSet};

use crate::molecule::chemistry::{cofactor, is_water, side_chain};
use crate::molecule::model::{
    Atom, GroupKind, Residue, agreeing, count, examples, residue_key, show_chain,
};
use crate::neighbours::SpatialHash;
use crate::vector::squared_distance;

pub(crate) fn warnings(atoms: &[Atom], residues: &[Residue<'_>]) -> Vec<String> {
    let mut warnings = traces(atoms, residues);
    warnings.extend(missing_side_chains(atoms, residues));
    warnings.extend(duplicates(atoms));
    warnings.extend(in_one_place(atoms));
    warnings.extend(ligands(atoms, residues));
    warnings.extend(overlaps(atoms, residues));
    warnings.extend(coarse_grained(atoms, residues));
    warnings.extend(without_protein(residues));
    warnings
}

fn names<'a>(atoms: &'a [Atom], residue: &Residue<'_>) -> BTreeSet<&'a str> {
    residue
        .members(atoms)
        .map(|atom| atom.name.as_str())
        .collect()
}

/// Whether all that is left of a residue is the atom that a trace through the chain follows.
fn is_trace(names: &BTreeSet<&str>, kind: GroupKind) -> bool {
    let only = |name: &str| names.len() == 1 && names.contains(name);
    match kind {
        GroupKind::AminoAcid | GroupKind::ModifiedResidue => only("CA"),
        GroupKind::Nucleotide => only("P") || only("C4'"),
        _ => false,
    }
}

/// Chains of which more than half of the residues are a single CA or P atom.
fn traces(atoms: &[Atom], residues: &[Residue<'_>]) -> Vec<String> {
    let mut chains: BTreeMap<&str, [usize; 2]> = BTreeMap::new();
    for residue in residues {
        let is_polymer = matches!(residue.kind, GroupKind::AminoAcid | GroupKind::Nucleotide)
            // A modified residue reduced to its CA is no longer known as one.
            || residue.atoms.len() == 1;
        if is_polymer {
            let [traced, all] = chains.entry(residue.key.chain).or_default();
            *all += 1;
            *traced += usize::from(is_trace(&names(atoms, residue), residue.kind));
        }
    }
    let traces = chains
        .iter()
        .filter(|(_, [traced, all])| *traced > 1 && 2 * traced > *all);
    let warning = |(chain, [traced, _]): (&&str, &[usize; 2])| {
        format!(
            "chain {} is a trace: {traced} residues have only their CA or P atom, so that its shape cannot be scored",
            show_chain(chain)
        )
    };
    traces.map(warning).collect()
}

/// Amino acids with a backbone but without all of their side chain.
fn missing_side_chains(atoms: &[Atom], residues: &[Residue<'_>]) -> Option<String> {
    let mut incomplete = Vec::new();
    let mut missing_atoms = 0;
    for residue in residues
        .iter()
        .filter(|residue| residue.kind == GroupKind::AminoAcid)
    {
        let names = names(atoms, residue);
        // GROMACS and CHARMM write isoleucine's CD1 as CD.
        let has = |atom: &str| names.contains(atom) || atom == "CD1" && names.contains("CD");
        let expected = side_chain(residue.known_as).unwrap_or(&[]);
        let missing = expected.iter().filter(|atom| !has(atom.name)).count();
        if missing > 0 && !is_trace(&names, residue.kind) {
            missing_atoms += missing;
            let key = residue.key;
            let place = format!("{}{}", show_chain(key.chain), key.number_text());
            incomplete.push(format!("{} {place}", key.name));
        }
    }
    let residues = agreeing(incomplete.len(), "residue lacks", "residues lack");
    (!incomplete.is_empty()).then(|| {
        let examples = examples(&incomplete, 3);
        format!("{residues} side-chain atoms ({missing_atoms} in all: {examples})")
    })
}

/// Atoms that are there twice: same residue, same name, no alternate location.
fn duplicates(atoms: &[Atom]) -> Option<String> {
    // By key: where chains were merged under one name, residues of one key are several.
    let key = |atom| (residue_key(atom), atom.name.as_str());
    let distinct: HashSet<_> = atoms.iter().map(key).collect();
    let repeated = atoms.len() - distinct.len();
    let atoms = agreeing(repeated, "atom repeats", "atoms repeat");
    (repeated > 0).then(|| {
        format!("{atoms} the residue and name of another, and all are kept: two chains of one name, or two models?")
    })
}

/// Atoms that are all in one place, as in files that were written before there were coordinates.
fn in_one_place(atoms: &[Atom]) -> Option<String> {
    // Fewest atoms among which coincident positions are looked for.
    const PLACED: usize = 10;
    let [x, y, z] = atoms.first()?.position;
    let is_same = |atom: &Atom| atom.position == [x, y, z];
    (atoms.len() >= PLACED && atoms.iter().all(is_same)).then(|| {
        format!("all atoms are in one place ({x}, {y}, {z}), so that no score means anything: were coordinates ever written?")
    })
}

/// Ligands that are kept without charges and contact types: an inhibitor fills the site that the partner would take.
fn ligands(atoms: &[Atom], residues: &[Residue<'_>]) -> Option<String> {
    // Fewest heavy atoms of a ligand: caps of chains and small ions have fewer.
    const MIN_ATOMS: usize = 6;
    const SHOWN: usize = 3;
    let mut found: BTreeMap<&str, [usize; 2]> = BTreeMap::new();
    let mut hetero = false;
    for residue in residues {
        let heavy = residue
            .members(atoms)
            .filter(|atom| !atom.is_hydrogen())
            .count();
        let name = residue.key.name;
        let is_unknown = residue.kind == GroupKind::Cofactor && cofactor(name).is_none();
        if is_unknown && heavy >= MIN_ATOMS && !is_water(name) {
            let [residues, all_heavy] = found.entry(name).or_default();
            *residues += 1;
            *all_heavy += heavy;
            hetero |= residue.members(atoms).any(|atom| atom.hetero);
        }
    }
    if found.is_empty() {
        return None;
    }
    let shown = found.iter().take(SHOWN).map(|(name, [residues, atoms])| {
        format!("{residues} {name} ({})", count(*atoms, "heavy atom"))
    });
    let mut ligands = shown.collect::<Vec<_>>().join(", ");
    if found.len() > SHOWN {
        ligands += &format!(" and {} more", count(found.len() - SHOWN, "kind"));
    }
    let names: Vec<&str> = found.keys().copied().collect();
    let drop_hetero = if hetero { "--hetatm drop or " } else { "" };
    Some(format!(
        "small molecules are kept as solid atoms without charges or contact types, which are not known: {ligands}; if one fills the \
         binding site, leave it out with {drop_hetero}--drop-residue {}",
        names.join(",")
    ))
}

/// Amino acids made of beads: more than half of them have several atoms, or one that is no CA, but neither N nor C.
fn coarse_grained(atoms: &[Atom], residues: &[Residue<'_>]) -> Option<String> {
    let mut beads: BTreeSet<&str> = BTreeSet::new();
    let (mut coarse, mut all) = (0, 0);
    for residue in residues
        .iter()
        .filter(|residue| residue.kind == GroupKind::AminoAcid)
    {
        let names = names(atoms, residue);
        all += 1;
        if !is_trace(&names, residue.kind) && !names.contains("N") && !names.contains("C") {
            coarse += 1;
            beads.extend(names);
        }
    }
    (coarse > 1 && 2 * coarse > all).then(|| {
        let beads: Vec<&str> = beads.into_iter().collect();
        format!(
            "{coarse} of {} are coarse-grained (beads {}): radii, charges and potentials are those of atoms, and nothing \
             was tuned on beads",
            count(all, "amino acid"),
            examples(&beads, 4)
        )
    })
}

fn without_protein(residues: &[Residue<'_>]) -> Option<String> {
    let protein = residues
        .iter()
        .filter(|residue| residue.is_peptide())
        .count();
    let is_nucleotide = |residue: &&Residue<'_>| residue.kind == GroupKind::Nucleotide;
    let nucleotides = residues.iter().filter(is_nucleotide).count();
    if residues.is_empty() || protein > nucleotides {
        return None;
    }
    let what = if nucleotides > 0 {
        let nucleotides = count(nucleotides, "nucleotide");
        format!(
            "mostly nucleic acid ({nucleotides}, {})",
            count(protein, "amino acid")
        )
    } else {
        "neither protein nor nucleic acid".to_owned()
    };
    Some(format!(
        "{what}: the score was tuned on proteins alone, so that nothing is known of how well such poses are ranked"
    ))
}

/// Distance in Å below which atoms of different residues are in one place. Bonded ones are separated by more than 1.2
/// Å, except hydrogens.
const ON_TOP: f64 = 0.5;

/// The limit (Å) for fewer than [`FEW`] atoms between two chains, which come to lie so by chance where bodies overlap.
const IN_ONE_PLACE: f64 = 0.1;
const FEW: usize = 3;

/// The limit (Å) for residues of one number and different names, which are alternatives of one place.
const ONE_NUMBER: f64 = 1.2;

/// Most atoms of a cell that are looked at: where there are more, they are counted as far as these show.
const MAX_IN_CELL: usize = 64;

const SHOWN: usize = 3;

/// Atoms of one chain that are on atoms of another, or of its other residues.
struct Overlap {
    atoms: usize,
    /// Their least distance, squared (Å²).
    least: f64,
    residues: BTreeSet<usize>,
}

/// Atoms on top of atoms of other residues: chains, copies and residues that a file holds twice in one place.
fn overlaps(atoms: &[Atom], residues: &[Residue<'_>]) -> Vec<String> {
    // Atoms that all share one place have their own warning, or are made up.
    if atoms
        .windows(2)
        .all(|pair| pair[0].position == pair[1].position)
    {
        return Vec::new();
    }
    let mut one_number = BTreeSet::new();
    // By the two chains.
    let mut overlaps: BTreeMap<(&str, &str), Overlap> = BTreeMap::new();
    for (residue, other, squared) in on_top(atoms, residues) {
        let (own, there) = (&residues[residue], &residues[other]);
        if is_one_number(own, there) {
            one_number.insert((other, residue));
        } else {
            let none = || Overlap {
                atoms: 0,
                least: f64::INFINITY,
                residues: BTreeSet::new(),
            };
            let chains = (there.key.chain, own.key.chain);
            let overlap = overlaps.entry(chains).or_insert_with(none);
            overlap.atoms += 1;
            overlap.least = overlap.least.min(squared);
            overlap.residues.insert(residue);
        }
    }
    overlaps
        .retain(|_, overlap| overlap.atoms >= FEW || overlap.least < IN_ONE_PLACE * IN_ONE_PLACE);
    let mut warnings: Vec<String> = overlaps
        .iter()
        .map(|((first, second), overlap)| {
            let (is_same, first, chain) = (first == second, show_chain(first), show_chain(second));
            let lie = if overlap.atoms == 1 { "lies" } else { "lie" };
            let atoms = count(overlap.atoms, "atom");
            let names = overlap.residues.iter().map(|&residue| residues[residue].key.to_string());
            let examples = examples(&names.collect::<Vec<_>>(), SHOWN);
            if is_same {
                format!("{atoms} of chain {chain} {lie} on atoms of its other residues ({examples}), and all are counted: are residues there twice?")
            } else {
                format!(
                    "{atoms} of chain {chain} {lie} on atoms of chain {first}, and all are counted: are these copies or \
                     models of one molecule? FILE:{first} reads one"
                )
            }
        })
        .collect();
    if !one_number.is_empty() {
        let names = one_number.iter().map(|&(first, second)| {
            let (key, other) = (residues[first].key, residues[second].key.name);
            let number = key.number_text();
            format!(
                "{} {number} as {} and {other}",
                show_chain(key.chain),
                key.name
            )
        });
        let places = agreeing(
            one_number.len(),
            "residue number holds",
            "residue numbers hold",
        );
        warnings.push(format!(
            "{places} two residues in one place ({}), and all their atoms are counted: keep one in the file, or mark them as \
             alternate locations",
            examples(&names.collect::<Vec<_>>(), SHOWN)
        ));
    }
    warnings
}

fn is_one_number(a: &Residue<'_>, b: &Residue<'_>) -> bool {
    a.key.place() == b.key.place() && a.key.name != b.key.name
}

/// For each atom that is on one of an earlier residue: its own residue, that one, and the square of their distance (Å²).
fn on_top(atoms: &[Atom], residues: &[Residue<'_>]) -> Vec<(usize, usize, f64)> {
    let mut residue_of = vec![usize::MAX; atoms.len()];
    for (index, residue) in residues.iter().enumerate() {
        for &atom in &residue.atoms {
            residue_of[atom] = index;
        }
    }
    let positions = atoms.iter().map(|atom| atom.position);
    let cells = SpatialHash::of_crowded_points(positions, ONE_NUMBER, MAX_IN_CELL);
    // An atom that repeats the residue and the name of another has its own warning.
    let is_on = |own: &Residue<'_>, there: &Residue<'_>, squared: f64| {
        let limit = if is_one_number(own, there) {
            ONE_NUMBER
        } else {
            ON_TOP
        };
        own.key != there.key && squared < limit * limit
    };
    let on_earlier = |(atom, &residue): (&Atom, &usize)| {
        cells.around(atom.position).find_map(|&index| {
            let other = residue_of[index];
            let squared = squared_distance(atoms[index].position, atom.position);
            let is_found = other < residue && is_on(&residues[residue], &residues[other], squared);
            is_found.then_some((residue, other, squared))
        })
    };
    atoms
        .iter()
        .zip(&residue_of)
        .filter_map(on_earlier)
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::molecule::model::residues;

    /// A residue with atoms 1.3 Å apart along x.
    fn residue(chain: &str, name: &str, number: i64, atoms: &[&str], y: f64) -> Vec<Atom> {
        let place = |place: usize| [4.0 * number as f64 + 1.3 * place as f64, y, 0.0];
        let atom = |(index, atom): (usize, &&str)| Atom {
            name: (*atom).to_owned(),
            residue_name: name.to_owned(),
            chain: chain.to_owned(),
            residue_number: number,
            element: "C".to_owned(),
            position: place(index),
            ..Atom::default()
        };
        atoms.iter().enumerate().map(atom).collect()
    }

    /// Residues of a chain along x, 4 Å apart, each with three atoms.
    fn chain(name: &str, residue_name: &str, numbers: std::ops::Range<i64>, y: f64) -> Vec<Atom> {
        let backbone = ["N", "CA", "C"];
        let of = |number| residue(name, residue_name, number, &backbone, y);
        numbers.flat_map(of).collect()
    }

    fn overlaps_of(atoms: &[Vec<Atom>]) -> Vec<String> {
        let atoms = atoms.concat();
        overlaps(&atoms, &residues(&atoms))
    }

    #[test]
    fn chains_and_residues_in_one_place_are_named() {
        let first = chain("A", "ALA", 1..11, 0.0);
        let starts = |warned: Vec<String>, start: &str| {
            assert_eq!(warned.len(), 1);
            assert!(warned[0].starts_with(start), "{warned:?}");
        };
        assert!(overlaps_of(&[first.clone(), chain("B", "ALA", 1..11, 3.0)]).is_empty());
        let warned = overlaps_of(&[first.clone(), chain("B", "ALA", 1..11, 0.1)]);
        starts(warned, "30 atoms of chain B lie on atoms of chain A");
        // Bodies that overlap have an atom on another by chance; an ion given twice is in one place.
        let ion = |x: f64| {
            let mut ion = chain("C", "ZN", 1..2, 0.0);
            ion.truncate(1);
            ion[0].position[0] = 4.0 + x;
            ion
        };
        assert!(overlaps_of(&[first.clone(), ion(0.3)]).is_empty());
        let warned = overlaps_of(&[first.clone(), ion(0.0)]);
        starts(warned, "1 atom of chain C lies on atoms of chain A");
        // Two names at one number, on one another and a little apart.
        for y in [0.0, 0.9] {
            let warned = overlaps_of(&[first.clone(), chain("A", "SER", 5..6, y)]);
            let start = "1 residue number holds two residues in one place (A 5 as ALA and SER)";
            starts(warned, start);
        }
        // Merged chains may repeat a number elsewhere.
        assert!(overlaps_of(&[first.clone(), chain("A", "SER", 5..6, 9.0)]).is_empty());
        // Other numbers in one place.
        let mut shifted = chain("A", "ALA", 1..11, 0.0);
        for atom in &mut shifted {
            atom.residue_number += 100;
        }
        let warned = overlaps_of(&[first, shifted]);
        assert!(
            warned[0].contains("of its other residues (ALA A 101, ALA A 102, ALA A 103, ...)"),
            "{warned:?}"
        );
    }

    /// Atoms that share one place must not cost the square of their number.
    #[test]
    fn many_atoms_in_one_place_take_no_longer_than_others() {
        let mut atoms = chain("A", "ALA", 1..20_001, 0.0);
        for atom in &mut atoms {
            atom.position = [0.0; 3];
        }
        assert!(overlaps_of(std::slice::from_ref(&atoms)).is_empty());
        let last = atoms.len() - 1;
        atoms[last].position = [9.0; 3];
        assert_eq!(overlaps_of(&[atoms]).len(), 1);
    }

    #[test]
    fn beads_nucleic_acids_and_small_molecules_are_named() {
        let of = |molecule: &[(&str, i64, &[&str])]| {
            let all = molecule.iter();
            let atoms = all.map(|(name, number, atoms)| residue("A", name, *number, atoms, 0.0));
            let atoms = atoms.collect::<Vec<_>>().concat();
            let residues = residues(&atoms);
            let coarse = coarse_grained(&atoms, &residues).into_iter();
            coarse.chain(without_protein(&residues)).collect::<Vec<_>>()
        };
        let backbone: &[&str] = &["N", "CA", "C", "O"];
        assert!(of(&[("ALA", 1, backbone), ("GLY", 2, backbone)]).is_empty());
        // Martini: a bead for the backbone, up to four for the side chain.
        let martini = of(&[("ALA", 1, &["BB"]), ("LEU", 2, &["BB", "SC1"])]);
        assert_eq!(martini.len(), 1);
        let expected = "2 of 2 amino acids are coarse-grained (beads BB, SC1)";
        assert!(martini[0].starts_with(expected), "{martini:?}");
        // A trace has its own warning.
        assert!(of(&[("ALA", 1, &["CA"]), ("LEU", 2, &["CA"])]).is_empty());
        let nucleic = of(&[("DA", 1, &["P", "O5'"]), ("DT", 2, &["P", "O5'"])]);
        assert!(nucleic[0].starts_with("mostly nucleic acid (2 nucleotides, 0 amino acids)"));
        let ligand = of(&[("LIG", 1, &["C1", "C2"])]);
        assert!(ligand[0].starts_with("neither protein nor nucleic acid"));
        assert!(of(&[]).is_empty());
    }
}
