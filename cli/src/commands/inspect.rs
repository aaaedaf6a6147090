//! `knotdock inspect`: the contents of a structure file, what of it is kept, and what is assumed.

use std::path::{Path, PathBuf};

use crate::records::joined;
use crate::tables::atom_table;
use crate::tables::report::counted;
use clap::{ArgGroup, Args};
use knotdock::output::files::complexes::{format_of_name, write_kept_atoms};
use knotdock::priors::{Findings, PRIORS};
use knotdock::rank::rescoring::term_counts;
use knotdock_scoring::terms::pose::TermDefinition;
use knotdock_structures::ball_union::{Volume, union_volume};
use knotdock_structures::molecule::{
    Format, InputSpec, LabelReport, Molecule, Termini, UnresolvedResidues, fits,
};
use serde_json::{Map, Value, json};

use crate::arguments::options::{OfInspect, OptionArguments};
use crate::arguments::output_file::{check_output, is_same};
use crate::inputs::molecules::Input;
use crate::messages::console::Console;
use crate::messages::dock::metal_bound;
use knotdock_structures::Error;

/// Say what would be read of a structure: chains, residues and atoms kept, dropped and altered, gaps, and charges
/// assumed.
#[derive(Args, Debug)]
#[command(group = ArgGroup::new("written").args(["atoms", "write"]).multiple(true))]
pub struct Inspect {
    /// The structure: .pdb, .ent or .cif, each also .gz; FILE:H,L picks chains by the author's names, FILE:H:1-120,L
    /// residues too.
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

/// Points a sphere for the accessible area of a molecule: more where the errors of few atoms do not cancel, about
/// 0.3% of the total.
fn surface_points(atoms: usize) -> usize {
    (4_000_000 / atoms.max(1)).clamp(100, 960)
}

impl Inspect {
    /// Inspects.
    pub fn run(self, console: Console) -> Result<(), Error> {
        let options = self.options.given()?.options;
        let reading = options.input.reading();
        let ph = options.terms.ph;
        let structure = InputSpec::parse(&self.file)?.path;
        let format = self.checked_outputs(&structure, console)?;
        let (input, fates) = if self.atoms.is_some() {
            let (input, fates) = Input::read_with_fates(&self.file, &reading)?;
            (input, Some(fates))
        } else {
            let [input] = Input::read_all([&self.file], &reading)?;
            (input, None)
        };
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
        if let (Some(path), Some(fates)) = (&self.atoms, fates) {
            atom_table::write(path, &fates)?;
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

    /// Refuses files to write that are there or coincide; returns the format of `--write`.
    fn checked_outputs(&self, structure: &Path, console: Console) -> Result<Option<Format>, Error> {
        if let Some(file) = &self.atoms {
            check_output(file, [structure], self.force, console)?;
        }
        let Some(file) = &self.write else {
            return Ok(None);
        };
        check_output(file, [structure], self.force, console)?;
        if self
            .atoms
            .as_ref()
            .is_some_and(|atoms| is_same(atoms, file))
        {
            return Err(Error::input("--atoms and --write name the same file")
                .at(file)
                .help("give each a name of its own"));
        }
        Ok(Some(written_format(file)?))
    }
}

/// Findings on a molecule.
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
    /// Inspects a molecule at a pH.
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

    /// The entries of the result.
    fn entries(self, input: &Input) -> Result<Value, Error> {
        let findings = PRIORS.iter().zip(self.findings);
        let findings = findings.map(|(prior, found)| (prior.entry_name().to_owned(), found.entry));
        Ok(joined([
            json!({ "input": input.entry()?, "labels": self.labels }),
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

/// Numbers of parts that pose terms read, by the ids of the terms.
fn counts_entry(counts: &[(&TermDefinition, usize)]) -> Map<String, Value> {
    let entries = counts.iter();
    entries
        .map(|(term, count)| (term.id.to_owned(), json!(count)))
        .collect()
}

/// Numbers of parts that pose terms read, in words.
fn counts_text(counts: &[(&TermDefinition, usize)]) -> String {
    let terms = counts
        .iter()
        .map(|(term, count)| format!("{}: {count} {}", term.label, term.reads));
    format!("Pose terms: {}", terms.collect::<Vec<_>>().join("; "))
}

/// The format of the file to write.
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
    let names = |unknown: &std::collections::BTreeMap<String, usize>| {
        let names = unknown
            .iter()
            .map(|(name, count)| format!("{count} {name}"));
        names.collect::<Vec<_>>().join(", ")
    };
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
            match unresolved.ends {
                1 => "1 terminus".to_owned(),
                ends => format!("{ends} termini"),
            },
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
            names(&labels.unknown_charges)
        ));
    }
    if !labels.unknown_types.is_empty() {
        lines.push(format!(
            "No contact types: {}",
            names(&labels.unknown_types)
        ));
    }
    lines.join("\n")
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
