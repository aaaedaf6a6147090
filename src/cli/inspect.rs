//! `knotdock inspect`: what a structure file holds, what would be kept of it, and what would be assumed.

use clap::Args;
use knotdock::search::DockOptions;
use knotdock_structures::molecule::LabelReport;
use serde_json::json;

use super::arguments::not_negative;
use super::console::Console;
use super::failure::Failure;
use super::input::Input;

/// Say what would be read of a structure: chains, residues and atoms kept, dropped and altered, gaps, and charges assumed.
#[derive(Args, Debug)]
pub struct Inspect {
    /// The structure: .pdb, .ent or .cif, each also .gz; FILE:H,L picks chains by the author's names.
    #[arg(value_name = "FILE")]
    file: String,
    /// pH at which charges are assigned.
    #[arg(long, value_name = "PH", value_parser = not_negative, default_value_t = DockOptions::default().ph)]
    ph: f64,
}

/// Points a sphere for the accessible area: about 1% of the total.
const SURFACE_POINTS: usize = 200;

impl Inspect {
    /// Inspects.
    pub fn run(self, console: Console) -> Result<(), Failure> {
        if self.ph > 14.0 {
            return Err(Failure::input(format!(
                "--ph is {}; it must be between 0 and 14",
                self.ph
            )));
        }
        let input = Input::read(&self.file)?;
        let molecule = &input.molecule;
        let labels = molecule.labels(self.ph).report;
        let area: f64 = molecule.accessible_areas(SURFACE_POINTS).iter().sum();
        console.say(format!(
            "{}\n{}",
            molecule.report,
            told(&labels, self.ph, area)
        ));
        console.result(&json!({
            "input": input.entry()?,
            "labels": labels,
            "accessible_area": area,
        }));
        Ok(())
    }
}

/// The labels in words.
fn told(labels: &LabelReport, ph: f64, area: f64) -> String {
    let names = |unknown: &std::collections::BTreeMap<String, usize>| {
        let names = unknown
            .iter()
            .map(|(name, count)| format!("{count} {name}"));
        names.collect::<Vec<_>>().join(", ")
    };
    let [amino, carboxyl] = labels.termini;
    let mut lines = vec![
        format!(
            "Charges at pH {ph}: {:+} e in all, on {} atoms; {amino} amino and {carboxyl} carboxyl ends charged",
            labels.net_charge, labels.charged_atoms
        ),
        format!(
            "Gaps in chains, where residues are missing: {}",
            labels.gaps
        ),
        format!("Atoms of known contact type: {}", labels.typed_atoms),
        format!("Solvent-accessible surface: {area:.0} Å²"),
    ];
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
