//! `knotdock inspect`: the contents of a structure file, the parts that are kept, and assumptions.

use std::path::{Path, PathBuf};

use clap::{ArgGroup, Args};
use serde_json::{Map, Value, json};

use crate::arguments::options::{OfInspect, OptionArguments};
use crate::arguments::output_file::check_outputs;
use crate::inputs::molecules::Input;
use crate::inputs::solids::{ShapeInput, is_shape};
use crate::messages::console::Console;
use crate::messages::dock::{counted_names, metal_bound, termini_text};
use crate::records::joined;
use crate::report::shown_surface;
use crate::tables::report::counted;
use crate::tables::{Column, write_table};
use knotdock::output::files::complexes::{format_of_name, write_kept_atoms};
use knotdock::output::files::whole_file::write_whole;
use knotdock::priors::{Findings, PRIORS};
use knotdock::rank::rescoring::term_counts;
use knotdock_scoring::terms::pose::TermDefinition;
use knotdock_structures::Error;
use knotdock_structures::ball_union::{Volume, union_volume};
use knotdock_structures::molecule::{
    Atom, AtomFate, DropKind, Format, InputSpec, LabelReport, Molecule, Termini,
    UnresolvedResidues, fits, one_letter,
};

/// Say what would be read of a structure: chains, residues and atoms kept, dropped and altered, gaps, and charges
/// assumed; of a mesh, its triangles and whether they close.
#[derive(Args, Debug)]
#[command(group = ArgGroup::new("written").args(["atoms", "write"]).multiple(true))]
pub struct Inspect {
    /// The structure: .pdb, .ent or .cif, each also .gz; FILE:H,L picks chains by the author's names, FILE:H:1-120,L
    /// residues too. Or a mesh.
    #[arg(value_name = "FILE")]
    file: String,
    /// Write every atom of the model to this CSV file, kept or dropped, with the reason.
    #[arg(long, value_name = "FILE")]
    atoms: Option<PathBuf>,
    /// Write what is kept, an assembly that was built for instance, to this structure file, .pdb or .cif.
    #[arg(long, value_name = "FILE")]
    write: Option<PathBuf>,
    /// Replace the files of `--atoms` and `--write` where they are already there.
    #[arg(long, requires = "written")]
    force: bool,
    #[command(flatten)]
    options: OptionArguments<OfInspect>,
}

/// Points per sphere for the accessible area: for about 0.3% of the total.
fn surface_points(atoms: usize) -> usize {
    (4_000_000 / atoms.max(1)).clamp(100, 960)
}

impl Inspect {
    pub fn run(self, console: Console) -> Result<(), Error> {
        let options = self.options.given()?.options;
        let reading = options.input.reading();
        let ph = options.terms.ph;
        let spec = InputSpec::parse(&self.file)?;
        if is_shape(&spec.path) && self.atoms.is_none() && self.write.is_none() {
            let shape = ShapeInput::read(&spec)?;
            shape.file.describe("Solid", console);
            let surface = shown_surface(&shape.surface());
            return console.result(&json!({ "input": shape.entry(None), "surface": surface }));
        }
        let structure = spec.path;
        let files = [&self.atoms, &self.write].into_iter().flatten();
        check_outputs(files, &[&structure], self.force, console)?;
        let format = self.write.as_deref().map(written_format).transpose()?;
        let (input, fates) = Input::read_with_fates(&self.file, &reading)?;
        let molecule = &input.molecule;
        if let (Some(file), Some(format)) = (&self.write, format) {
            fits(format, molecule).map_err(|error| {
                Error::input(error)
                    .at(file)
                    .help("give the file a name that ends in .cif")
            })?;
        }
        let found = Inspection::of(molecule, ph)?;
        console.say(format!(
            "{}\n{}\n{}",
            molecule.report,
            labels_text(&found, ph),
            counts_text(&found.counts)
        ));
        if let Some(path) = &self.atoms {
            write_atoms(path, &fates)?;
            console.say(format!("{} atoms in {}", fates.len(), path.display()));
        }
        if let (Some(path), Some(format)) = (&self.write, format) {
            write_kept_atoms(path, format, molecule)?;
            console.say(format!(
                "{} kept, in {}",
                counted(molecule.atoms.len(), "atom"),
                path.display()
            ));
        }
        console.result(&found.entries(&input)?)?;
        Ok(())
    }
}

struct Inspection {
    labels: LabelReport,
    unresolved: UnresolvedResidues,
    termini: Termini,
    /// Numbers of parts that pose terms read.
    counts: Vec<(&'static TermDefinition, usize)>,
    /// Solvent-accessible surface, Å².
    area: f64,
    /// Volume of the atoms' balls, Å³.
    volume: Volume,
    /// The findings of each prior, in the order of [`PRIORS`].
    findings: Vec<Findings>,
}

impl Inspection {
    fn of(molecule: &Molecule, ph: f64) -> Result<Self, Error> {
        let labels = molecule.labels(ph);
        let area = molecule
            .accessible_areas(surface_points(molecule.atoms.len()))
            .iter()
            .sum();
        let findings = PRIORS.iter().map(|prior| prior.findings(molecule));
        let findings = findings.collect();
        let unresolved = molecule.unresolved_residues();
        let termini = molecule.termini();
        let counts = term_counts(molecule, &labels, &unresolved, &termini);
        Ok(Self {
            counts: counts.map_err(Error::input)?,
            volume: union_volume(&molecule.knots().map_err(Error::input)?),
            labels: labels.report,
            unresolved,
            termini,
            area,
            findings,
        })
    }

    fn entries(self, input: &Input) -> Result<Value, Error> {
        let findings = PRIORS.iter().zip(self.findings);
        let findings = findings.map(|(prior, found)| (prior.entry_name().to_owned(), found.entry));
        let chains = chains_entry(&input.molecule.atoms);
        Ok(joined([
            json!({ "input": input.entry()?, "chains": chains, "labels": self.labels }),
            Value::Object(findings.collect()),
            json!({
                "unresolved_residues": self.unresolved,
                "terminus_residues": self.termini,
                "pose_terms": counts_entry(&self.counts),
                "accessible_area": self.area,
                "volume": self.volume.value,
                "volume_error": self.volume.error,
            }),
        ]))
    }
}

/// Chains in the order of the file, each with its residues.
fn chains_entry(atoms: &[Atom]) -> Value {
    let place = |atom: &Atom| (atom.chain.clone(), atom.residue_number, atom.insertion_code);
    let mut chains: Vec<(&str, Vec<Value>)> = Vec::new();
    for residue in atoms.chunk_by(|a, b| place(a) == place(b)) {
        let first = &residue[0];
        let insertion = first.insertion_code.map(String::from).unwrap_or_default();
        let entry = json!({
            "number": format!("{}{insertion}", first.residue_number),
            "name": first.residue_name,
            "letter": one_letter(&first.residue_name),
        });
        match chains.iter_mut().find(|(name, _)| *name == first.chain) {
            Some((_, residues)) => residues.push(entry),
            None => chains.push((&first.chain, vec![entry])),
        }
    }
    let chains = chains.into_iter();
    chains
        .map(|(name, residues)| json!({ "chain": name, "residues": residues }))
        .collect()
}

fn counts_entry(counts: &[(&TermDefinition, usize)]) -> Map<String, Value> {
    let entries = counts.iter();
    entries
        .map(|(term, count)| (term.id.to_owned(), json!(count)))
        .collect()
}

fn counts_text(counts: &[(&TermDefinition, usize)]) -> String {
    let terms = counts
        .iter()
        .map(|(term, count)| format!("{}: {count} {}", term.label, term.reads));
    format!("Pose terms: {}", terms.collect::<Vec<_>>().join("; "))
}

fn written_format(file: &Path) -> Result<Format, Error> {
    format_of_name(file).ok_or_else(|| {
        Error::input("the name of the structure to write ends neither in .pdb nor in .cif")
            .at(file)
            .help("end the name in .pdb or .cif")
    })
}

/// Labels, flexible regions, surface and findings in words.
fn labels_text(found: &Inspection, ph: f64) -> String {
    let Inspection {
        labels,
        unresolved,
        termini,
        area,
        volume,
        findings,
        ..
    } = found;
    let [amino, carboxyl] = labels.termini;
    let mut lines = vec![
        format!(
            "Charges at pH {ph}: {:+} e in all, on {} atoms; {amino} amino and {carboxyl} carboxyl ends charged{}",
            labels.net_charge,
            labels.charged_atoms,
            metal_bound(labels)
        ),
        format!(
            "Unresolved residues: {} in {}, and past {}; {} near termini or gaps",
            unresolved.residues,
            counted(unresolved.gaps, "gap"),
            termini_text(unresolved.ends),
            counted(termini.residues, "residue")
        ),
        format!("Atoms of known contact type: {}", labels.typed_atoms),
        format!(
            "Solvent-accessible surface: {area:.0} Å²; volume of the atoms' balls: {:.1} Å³",
            volume.value
        ),
    ];
    lines.extend(
        findings
            .iter()
            .flat_map(|found| found.lines.iter().cloned()),
    );
    if !labels.unknown_charges.is_empty() {
        lines.push(format!(
            "No charges known, counted as none: {}",
            counted_names(&labels.unknown_charges)
        ));
    }
    if !labels.unknown_types.is_empty() {
        lines.push(format!(
            "No contact types: {}",
            counted_names(&labels.unknown_types)
        ));
    }
    lines.join("\n")
}

/// The columns, in order.
const COLUMNS: [Column<AtomFate>; 16] = [
    ("line", |fate| json!(fate.atom.line)),
    ("record", |fate| {
        json!(if fate.atom.hetero { "HETATM" } else { "ATOM" })
    }),
    ("atom", |fate| json!(fate.atom.name)),
    ("altloc", |fate| json!(fate.atom.alternate_location)),
    ("residue", |fate| json!(fate.atom.residue_name)),
    ("chain", |fate| json!(fate.atom.chain)),
    ("number", |fate| json!(fate.atom.residue_number)),
    ("insertion", |fate| json!(fate.atom.insertion_code)),
    ("element", |fate| json!(fate.atom.element)),
    ("x", |fate| json!(fate.atom.position[0])),
    ("y", |fate| json!(fate.atom.position[1])),
    ("z", |fate| json!(fate.atom.position[2])),
    ("occupancy", |fate| json!(fate.atom.occupancy)),
    ("b_factor", |fate| json!(fate.atom.b_factor)),
    ("radius", |fate| {
        json!(fate.dropped.is_none().then_some(fate.atom.radius))
    }),
    ("dropped", |fate| json!(fate.dropped.map(reason))),
];

fn write_atoms(path: &Path, fates: &[AtomFate]) -> Result<(), Error> {
    write_whole(path, |file| write_table(file, &COLUMNS, fates))
}

/// A reason as the report names it.
fn reason(kind: DropKind) -> &'static str {
    match kind {
        DropKind::Chain => "chain",
        DropKind::OtherResidue => "other_residue",
        DropKind::Assembly => "assembly",
        DropKind::Hydrogen => "hydrogen",
        DropKind::Water => "water",
        DropKind::Residue => "residue",
        DropKind::PseudoAtom => "pseudo_atom",
        DropKind::Additive => "additive",
        DropKind::Hetatm => "hetatm",
        DropKind::AlternateLocation => "alternate_location",
        DropKind::LowConfidence => "low_confidence",
        DropKind::Model => "model",
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use knotdock_scoring::terms::pose::POSE_TERMS;

    /// Every pose term has one entry and one part of the line, by its id and its label.
    #[test]
    fn entries_and_rows_of_pose_terms_are_those_of_the_registry() {
        let counts: Vec<_> = POSE_TERMS.iter().zip(1..).collect();
        let entry = counts_entry(&counts);
        assert_eq!(entry.len(), POSE_TERMS.len());
        let text = counts_text(&counts);
        let rows: Vec<&str> = text
            .strip_prefix("Pose terms: ")
            .unwrap()
            .split("; ")
            .collect();
        assert_eq!(rows.len(), POSE_TERMS.len());
        for ((term, count), row) in counts.iter().zip(rows) {
            assert_eq!(entry[term.id], *count);
            assert!(
                row.starts_with(&format!("{}: {count} ", term.label)),
                "{row}"
            );
        }
    }
}
