//! `knotdock inspect`: what a structure file holds, what would be kept of it, and what would be assumed.

use std::path::{Path, PathBuf};

use clap::{ArgGroup, Args};
use knotdock::output::report::counted;
use knotdock::output::{atom_table, molecule_file};
use knotdock::priors::{Findings, PRIORS};
use knotdock::search::DockOptions;
use knotdock_structures::ball_union::{Volume, union_volume};
use knotdock_structures::molecule::{
    Format, InputSpec, LabelReport, Termini, UnresolvedResidues, fits,
};
use serde_json::{Map, Value, json};

use super::arguments::not_negative;
use super::console::Console;
use super::dock_report::metal_bound;
use super::failure::Failure;
use super::input::Input;
use super::output_file::{check_output, is_same};
use super::reading_arguments::ReadingArguments;

/// Say what would be read of a structure: chains, residues and atoms kept, dropped and altered, gaps, and charges assumed.
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
    reading: ReadingArguments,
    /// pH at which charges are assigned.
    #[arg(long, value_name = "PH", value_parser = not_negative, default_value_t = DockOptions::default().ph)]
    ph: f64,
}

/// Points a sphere for the accessible area of a molecule: more where the errors of few atoms do not cancel, about 0.3% of the total.
fn surface_points(atoms: usize) -> usize {
    (4_000_000 / atoms.max(1)).clamp(100, 960)
}

impl Inspect {
    /// Inspects.
    pub fn run(self, console: Console) -> Result<(), Failure> {
        if self.ph > 14.0 {
            return Err(Failure::input(format!(
                "--ph is {}; it must be between 0 and 14",
                self.ph
            )));
        }
        let reading = self.reading.options();
        let structure = InputSpec::parse(&self.file)?.path;
        if let Some(file) = &self.atoms {
            check_output(file, [structure.as_path()], self.force)?;
        }
        let format = match &self.write {
            Some(file) => {
                check_output(file, [structure.as_path()], self.force)?;
                if self
                    .atoms
                    .as_ref()
                    .is_some_and(|atoms| is_same(atoms, file))
                {
                    return Err(Failure::input("--atoms and --write name one file")
                        .at(file)
                        .remedy("give each a name of its own"));
                }
                Some(written_format(file)?)
            }
            None => None,
        };
        let (input, listed) = if self.atoms.is_some() {
            let (input, listed) = Input::read_with_fates(&self.file, &reading)?;
            (input, Some(listed))
        } else {
            let [input] = Input::read_all([&self.file], &reading)?;
            (input, None)
        };
        let molecule = &input.molecule;
        if let (Some(file), Some(format)) = (&self.write, format) {
            fits(format, molecule).map_err(|error| {
                Failure::input(error)
                    .at(file)
                    .remedy("give the file a name that ends in .cif")
            })?;
        }
        let labels = molecule.labels(self.ph).report;
        let area: f64 = molecule
            .accessible_areas(surface_points(molecule.atoms.len()))
            .iter()
            .sum();
        let findings = PRIORS.map(|prior| prior.findings(molecule));
        let missing = molecule.unresolved_residues();
        let ends = molecule.termini();
        let volume = union_volume(&molecule.knots().map_err(Failure::input)?);
        console.say(format!(
            "{}\n{}",
            molecule.report,
            told(&labels, (&missing, &ends), self.ph, area, volume, &findings)
        ));
        if let (Some(path), Some(listed)) = (&self.atoms, listed) {
            atom_table::write(path, &listed)?;
            console.say(format!("{} atoms in {}", listed.len(), path.display()));
        }
        if let (Some(path), Some(format)) = (&self.write, format) {
            molecule_file::write(path, format, molecule)?;
            console.say(format!(
                "{} kept, in {}",
                counted(molecule.atoms.len(), "atom"),
                path.display()
            ));
        }
        let mut entries = Map::new();
        entries.insert("input".to_owned(), json!(input.entry()?));
        entries.insert("labels".to_owned(), json!(labels));
        for (prior, found) in PRIORS.iter().zip(findings) {
            entries.insert(prior.entry_name().to_owned(), found.entry);
        }
        for (name, entry) in [
            ("missing_residues", json!(missing)),
            ("chain_end_residues", json!(ends)),
            ("accessible_area", json!(area)),
            ("volume", json!(volume.value)),
            ("volume_error", json!(volume.error)),
        ] {
            entries.insert(name.to_owned(), entry);
        }
        console.result(&Value::Object(entries))?;
        Ok(())
    }
}

/// The format of the file to write.
fn written_format(file: &Path) -> Result<Format, Failure> {
    molecule_file::format_of_name(file).ok_or_else(|| {
        Failure::input("the name of the structure to write ends neither in .pdb nor in .cif")
            .at(file)
            .remedy("name it so: the ending says the format")
    })
}

/// The labels in words.
fn told(
    labels: &LabelReport,
    (missing, ends): (&UnresolvedResidues, &Termini),
    ph: f64,
    area: f64,
    volume: Volume,
    findings: &[Findings],
) -> String {
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
            "Missing residues: {} in {}; {} of chains that may go on; {} near ends of chains or gaps",
            missing.residues,
            counted(missing.gaps, "gap"),
            counted(missing.ends, "end"),
            counted(ends.residues, "residue")
        ),
        format!("Atoms of known contact type: {}", labels.typed_atoms),
        format!(
            "Solvent-accessible surface: {area:.0} Å²; volume of the atoms' balls: {:.1} ± {:.1} Å³",
            volume.value, volume.error
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
