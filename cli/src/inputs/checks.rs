//! Checks of inputs: room for reading and sampling, atoms that are missing, and molecules that share chains.
//!
//! Memory of a run is known once its inputs are read, and is refused then. Before, only work that alone takes more than
//! any process does is refused, by the least that it takes.
//!
//! Traces are molecules of whose residues the file has CA atoms alone, or as few. The score is of all heavy atoms, so
//! poses of a trace, a body that is mostly air, cannot be ranked.

use std::collections::BTreeMap;
use std::fs;

use crate::inputs::bodies::Bodies;
use crate::inputs::molecules::Input;
use knotdock::evaluate::{SharedChains, shared_chains};
use knotdock::geometry::obstacle::reduce::BYTES_REDUCED;
use knotdock::interface::heavy_residues;
use knotdock::memory_size::{as_size, in_words, named};
use knotdock_structures::Error;
use knotdock_structures::molecule::{InputSpec, Molecule};

/// Reading and sampling may take this many bytes whatever the limit: the whole run is refused after them.
const ALWAYS: u64 = 256 << 20;
/// Least bytes that reading takes for each byte of a file: 12 of binary STL, 15 of OBJ, 9 of PDB as measured.
const BYTE_READ: u64 = 8;
/// Least bytes that sampling takes for each node of its grid: 60 as measured of a ball.
const NODE_SAMPLED: u64 = 40;

pub fn room_to_read(specs: &[InputSpec], allowed: Option<u64>) -> Result<(), Error> {
    let size = |spec: &InputSpec| {
        let metadata = fs::metadata(&spec.path).ok()?;
        metadata.is_file().then_some(metadata.len())
    };
    let needed = |spec: &InputSpec| BYTE_READ.saturating_mul(size(spec).unwrap_or(0));
    let all = specs.iter().map(needed).fold(0, u64::saturating_add);
    let largest = specs.iter().max_by_key(|spec| needed(spec));
    let work = format!("reading alone needs {} of memory or more", in_words(all));
    refuse(all, allowed, &work, "give a smaller file").map_err(|error| match largest {
        Some(spec) => error.at(&spec.path),
        None => error,
    })
}

/// Refuses a grid of that many nodes along each axis that memory has no room for.
pub fn room_to_sample(per_axis: usize, allowed: Option<u64>) -> Result<(), Error> {
    let nodes = (per_axis as u64).saturating_pow(3);
    let needed = NODE_SAMPLED.saturating_mul(nodes);
    let work = format!(
        "sampling alone needs {} of memory or more",
        in_words(needed)
    );
    refuse(needed, allowed, &work, "use a coarser --sample-grid")
}

/// Refuses more balls of a sum than memory has room for if none were in another one.
pub fn room_for_balls(balls: u64, allowed: Option<u64>) -> Result<(), Error> {
    let needed = BYTES_REDUCED.saturating_mul(balls);
    let work = format!(
        "{balls} pairs of balls need up to {} of memory",
        in_words(needed)
    );
    refuse(needed, allowed, &work, "use a coarser --grid")
}

/// Refuses work that takes more than is allowed, and more than always is.
fn refuse(needed: u64, allowed: Option<u64>, work: &str, remedy: &str) -> Result<(), Error> {
    let Some(allowed) = allowed.filter(|&allowed| needed > allowed.max(ALWAYS)) else {
        return Ok(());
    };
    let least = as_size(named(needed));
    Err(
        Error::input(format!("{work}, and {} are allowed", in_words(allowed)))
            .help(format!("{remedy}, or allow at least --memory {least}")),
    )
}

/// Most heavy atoms of a residue of a trace; a backbone has four.
const MAX_TRACE_ATOMS: usize = 2;

/// Fewest residues that make a trace.
const MIN_TRACE_RESIDUES: usize = 3;

/// Atoms that a residue of a trace has one of. Beads of other coarse-grained models have their own warning.
const TRACED: [&str; 7] = ["CA", "CB", "P", "C1'", "C3'", "C4'", "C5'"];

/// Refuses molecules with a chain that is a trace for the most part; `sides` are their names.
pub fn refuse_traces<'a>(
    inputs: impl IntoIterator<Item = (&'a str, &'a Input)>,
) -> Result<(), Error> {
    for (side, input) in inputs {
        if let Some(chain) = trace(&input.molecule) {
            let chain = match chain.as_str() {
                "" => "its chain without a name".to_owned(),
                name => format!("its chain {name}"),
            };
            return Err(Error::input(format!(
                "the {side} is no all-atom model: of most residues of {chain} the file has one or two atoms, such as CA \
                 alone, and the score is of all heavy atoms"
            ))
            .at(&input.record.path)
            .help(
                "rebuild the missing atoms first, as PULCHRA and MODELLER do, give an all-atom model, or pick other chains \
                 as in FILE:A,B",
            ));
        }
    }
    Ok(())
}

/// The first chain that is a trace for the most part.
fn trace(molecule: &Molecule) -> Option<String> {
    // Of each chain, residues that are traced, and those that have more atoms.
    let mut chains: BTreeMap<&str, [usize; 2]> = BTreeMap::new();
    for atoms in heavy_residues(molecule) {
        let first = atoms.first().map(|&at| &molecule.atoms[at])?;
        let is_traced = |&at: &usize| {
            let atom = &molecule.atoms[at];
            // Calcium is named CA, too.
            TRACED.contains(&atom.name.as_str()) && atom.element != "Ca"
        };
        let [traced, whole] = chains.entry(&first.chain).or_default();
        if atoms.len() > MAX_TRACE_ATOMS {
            *whole += 1;
        } else if atoms.iter().any(is_traced) {
            *traced += 1;
        }
    }
    let is_trace = |[traced, whole]: &[usize; 2]| *traced >= MIN_TRACE_RESIDUES && traced > whole;
    let found = chains.into_iter().find(|(_, counts)| is_trace(counts));
    found.map(|(chain, _)| chain.to_owned())
}

impl Bodies {
    /// Warns in the report of a molecule that holds the other one and further chains, or is the same.
    pub fn note_shared_chains(&mut self) {
        let Self::Molecules(inputs) = self else {
            return;
        };
        let [receptor, ligand] = inputs.as_mut();
        if let Some(shared) = shared_chains(&ligand.molecule, &receptor.molecule) {
            let text = shared_warning(&shared, ["receptor", "ligand"], receptor);
            receptor.molecule.report.warnings.push(text);
        } else if let Some(shared) = shared_chains(&receptor.molecule, &ligand.molecule) {
            let text = shared_warning(&shared, ["ligand", "receptor"], ligand);
            ligand.molecule.report.warnings.push(text);
        } else if receptor.record.is_like(&ligand.record)
            || are_alike(&receptor.molecule, &ligand.molecule)
        {
            let text = "it is the same molecule as the receptor: if the two are related by a rotation, as in a \
                        homodimer, dock one file with --symmetry C2, which searches such poses alone";
            ligand.molecule.report.warnings.push(text.to_owned());
        }
    }
}

/// Whether two molecules have the same peptides by their sequences, and some.
fn are_alike(one: &Molecule, other: &Molecule) -> bool {
    let sequences = |molecule: &Molecule| {
        let chains = molecule.peptide_chains().into_iter();
        let mut sequences: Vec<String> = chains.map(|chain| chain.sequence()).collect();
        sequences.sort_unstable();
        sequences
    };
    let sequences = [one, other].map(sequences);
    !sequences[0].is_empty() && sequences[0] == sequences[1]
}

/// What one side holds of the other, and how to leave it out; `holder` is the side that holds it.
fn shared_warning(shared: &SharedChains, [side, other]: [&str; 2], holder: &Input) -> String {
    let shown = |name: &str| if name.is_empty() { "_" } else { name }.to_owned();
    let names: Vec<String> = shared.pairs.iter().map(|(_, own)| shown(own)).collect();
    let others: Vec<String> = shared.pairs.iter().map(|(one, _)| shown(one)).collect();
    let plural = |count: usize| if count == 1 { "chain" } else { "chains" };
    let has = if names.len() == 1 { "has" } else { "have" };
    let remedy = match shared.rest.as_slice() {
        [] => "split the file, whose chains share one name".to_owned(),
        rest => {
            let rest: Vec<String> = rest.iter().map(|name| shown(name)).collect();
            let file = holder.record.path.file_name().unwrap_or_default();
            format!(
                "pick the rest with {}:{}",
                file.to_string_lossy(),
                rest.join(",")
            )
        }
    };
    format!(
        "the {side} holds the {other} already: its {} {} {has} the sequence of {} {} of the {other}, and fills \
         the place where that would dock; {remedy}",
        plural(names.len()),
        names.join(", "),
        plural(others.len()),
        others.join(", "),
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A grid of 2^30 nodes took 60 GB whatever the limit, which was compared with the search alone.
    #[test]
    fn grids_are_refused_before_they_are_made() {
        assert!(room_to_sample(1024, Some(1 << 30)).is_err());
        assert!(room_to_sample(1024, Some(1 << 36)).is_ok());
        assert!(room_to_sample(1024, None).is_ok());
        // Small ones are left to the refusal that names what the whole run takes.
        assert!(room_to_sample(64, Some(1)).is_ok());
    }

    /// A file of 4 GB that holds nothing: its size is enough to refuse it.
    #[test]
    fn files_are_refused_by_their_size() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("large.stl");
        fs::File::create(&path).unwrap().set_len(4 << 30).unwrap();
        let spec = InputSpec::parse(path.to_str().unwrap()).unwrap();
        assert!(room_to_read(std::slice::from_ref(&spec), Some(1 << 30)).is_err());
        assert!(room_to_read(&[spec], Some(1 << 40)).is_ok());
    }

    use knotdock_structures::molecule::{InputSpec, ReadOptions, read};

    fn example(keep: impl Fn(&str, &str) -> bool) -> Molecule {
        let root = concat!(env!("CARGO_MANIFEST_DIR"), "/..");
        let path = format!("{root}/structures/examples/1ppe_ligand_unbound.pdb");
        let whole = read(&InputSpec::whole(path), &ReadOptions::default()).unwrap();
        let atoms = whole.atoms.into_iter();
        let kept = atoms.filter(|atom| keep(&atom.name, &atom.residue_name));
        Molecule::new(kept.collect(), knotdock_structures::molecule::Format::Pdb)
    }

    /// A file of CA atoms alone was ranked, and the run ended well.
    #[test]
    fn traces_are_found_and_backbones_are_none() {
        assert!(trace(&example(|name, _| name == "CA")).is_some());
        assert!(trace(&example(|name, _| ["CA", "CB"].contains(&name))).is_some());
        assert!(trace(&example(|_, _| true)).is_none());
        assert!(trace(&example(|name, _| ["N", "CA", "C", "O"].contains(&name))).is_none());
        // A few residues of which only the CA is resolved.
        let few = example(|name, residue| name == "CA" || residue != "CYS");
        assert!(trace(&few).is_none());
    }

    #[test]
    fn calcium_is_no_trace() {
        let mut ions = example(|name, _| name == "CA");
        for atom in &mut ions.atoms {
            atom.element = "Ca".to_owned();
        }
        assert!(trace(&ions).is_none());
    }
}
