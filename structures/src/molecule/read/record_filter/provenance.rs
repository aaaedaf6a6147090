//! Provenance of the coordinates, as the file states it: methods of experiments, and scores of predictions (ModelCIF,
//! Vallat et al., J. Mol. Biol. 435, 168021, 2023).

use crate::molecule::read::record_filter::tokens::Kind;

/// Provenance of the coordinates, as the file states it.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) enum Provenance {
    /// Nothing.
    #[default]
    Unstated,
    /// They were measured, or are scored by something else than pLDDT: the B column is none.
    NoConfidence,
    /// They were predicted and the B column is pLDDT.
    Confidence,
}

/// Whether a method of `EXPDTA` or `_exptl.method` is a measurement: any but the theoretical models of old and of
/// predictors.
pub(crate) fn is_measured(method: &str) -> bool {
    let method = method.trim().to_ascii_uppercase();
    !method.is_empty() && !method.contains("THEORETICAL")
}

/// Items of an mmCIF file that say it.
#[derive(Default)]
pub(crate) struct ProvenanceItems {
    /// A method of measurement is named.
    measured: bool,
    /// Local or global scores of a model are defined.
    scored: bool,
    /// One of these is pLDDT.
    by_plddt: bool,
}

impl ProvenanceItems {
    /// Takes the value of an item.
    pub(crate) fn note(&mut self, tag: &str, value: Kind<'_>) {
        let Some(text) = value.value() else {
            return;
        };
        let is = |item: &str| tag.eq_ignore_ascii_case(item);
        if is("_exptl.method") {
            self.measured |= is_measured(text);
        } else if is("_ma_qa_metric.name") || is("_ma_qa_metric.type") {
            self.scored = true;
            self.by_plddt |= text.to_ascii_lowercase().contains("plddt");
        }
    }

    /// Provenance by all records.
    pub(crate) fn provenance(&self) -> Provenance {
        match (self.measured, self.scored, self.by_plddt) {
            (true, ..) | (false, true, false) => Provenance::NoConfidence,
            (false, true, true) => Provenance::Confidence,
            (false, false, _) => Provenance::Unstated,
        }
    }
}
