//! The chains and residues that are requested of a file.

use std::collections::{BTreeSet, HashMap};
use std::path::Path;

use crate::molecule::model::report::DropKind;
use crate::molecule::model::residue_selection::{Picked, ResidueSelection};
use crate::molecule::model::wording::show_chain;
use crate::molecule::read::error::ReadError;
use crate::molecule::read::parse::Parsed;
use crate::molecule::read::record_filter::record::AtomRecord;

/// What to keep: of some chains all, of others some residues.
pub(crate) struct Wanted(HashMap<String, Vec<Picked>>);

impl Wanted {
    /// What the parts of a selection name in a file.
    ///
    /// # Errors
    /// [`ReadError::UnknownChain`] and [`ReadError::UnknownResidues`] where a part names nothing of it.
    pub(crate) fn new(file: &Path, parsed: &[Parsed], parts: &[String]) -> Result<Self, ReadError> {
        let mut present: Vec<String> = Vec::new();
        let mut names: BTreeSet<&str> = BTreeSet::new();
        for Parsed { raw, .. } in parsed {
            if names.insert(&raw.chain) {
                present.push(raw.chain.clone());
            }
        }
        let text = parts.join(",");
        let selection: ResidueSelection = text
            .parse()
            .map_err(|_| ReadError::Specification { text })?;
        let mut wanted: HashMap<String, Vec<Picked>> = HashMap::new();
        for picked in selection.read_among(&names) {
            if !names.contains(picked.chain.as_str()) {
                return Err(ReadError::UnknownChain {
                    file: file.to_path_buf(),
                    chain: picked.written,
                    present,
                    warnings: Vec::new(),
                });
            }
            let of_chain = || {
                let records = parsed.iter().map(|record| &record.raw);
                records.filter(|raw| raw.chain == picked.chain)
            };
            let is_there = |raw: &AtomRecord| picked.holds(raw.residue_number, raw.insertion_code);
            if !of_chain().any(is_there) {
                let numbers = || of_chain().map(|raw| raw.residue_number);
                let (first, last) = (numbers().min(), numbers().max());
                return Err(ReadError::UnknownResidues {
                    file: file.to_path_buf(),
                    part: picked.written,
                    chain: show_chain(&picked.chain).to_owned(),
                    numbers: [first.unwrap_or(0), last.unwrap_or(0)],
                });
            }
            wanted.entry(picked.chain.clone()).or_default().push(picked);
        }
        Ok(Self(wanted))
    }

    /// Why an atom is left out, if it was not requested.
    pub(crate) fn leaves_out(&self, raw: &AtomRecord) -> Option<DropKind> {
        let Some(parts) = self.0.get(&raw.chain) else {
            return Some(DropKind::Chain);
        };
        let holds = |part: &Picked| part.holds(raw.residue_number, raw.insertion_code);
        (!parts.iter().any(holds)).then_some(DropKind::OtherResidue)
    }
}
