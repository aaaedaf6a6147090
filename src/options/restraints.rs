//! Options on known contacts.

use std::path::Path;

use knotdock_structures::Error;
use knotdock_structures::molecule::ResidueSelection;
use serde::{Deserialize, Serialize};

use super::definition::{Choice, Content, Form, Optional, Rule, Signed, Word, options};
use super::values::Range;
use crate::options::membrane::MembraneChoice;
use crate::plain_path::plain_path;
use crate::predictions::PredictionSource;
use crate::restraints::{Crosslink, RequiredCount, RestraintFile, TblBounds};

/// Score of a pose that touches all catalytic residues: two units of log-odds by training pairs (docs/research/effects.md,
/// "Active sites").
const PEPTIDASE_WEIGHT: f64 = 500.0;

options! {
    /// Known contacts: residues that make them or make none, antibodies, peptidases.
    RestraintOptions as restraints, "Restraints", Molecules {
        /// What may touch of an antibody: cdrs or whole.
        ///
        /// Antibodies are detected from their sequence. cdrs: the complementarity-determining regions and what lies within
        /// 5 Å of them. whole: all of it.
        antibody: AntibodySurface = AntibodySurface::Cdrs, "cdrs|whole", Choice;
        /// Residues of the receptor that are not in contact, such as H:1-50,52A,L.
        ///
        /// H:1-50 is a range with all that is inserted in it, 52A an inserted residue, L a chain. A chain without a name
        /// is _. After a residue its chain's name may be left out, unless another chain has the residue's name.
        block_receptor: Option<ResidueSelection> = None, "RESIDUES", Optional(Word);
        /// Residues of the ligand that are not in contact.
        ///
        /// Written as those of --block-receptor.
        block_ligand: Option<ResidueSelection> = None, "RESIDUES", Optional(Word);
        /// Residues of the receptor that are thought to be in contact, such as A:57,189-195.
        ///
        /// Poses that touch them rank higher, by terms.active_weight. In the search each contact of theirs earns a
        /// 250th of that, divided by their number.
        active_receptor: Option<ResidueSelection> = None, "RESIDUES", Optional(Word);
        /// Residues of the ligand that are thought to be in contact.
        ///
        /// Written as those of --active-receptor.
        active_ligand: Option<ResidueSelection> = None, "RESIDUES", Optional(Word);
        /// Residues of the receptor among which the ligand binds, such as an epitope and its surroundings.
        ///
        /// They are active, and all other residues of the receptor are blocked. Written as those of --block-receptor.
        #[serde(default)]
        site_receptor: Option<ResidueSelection> = None, "RESIDUES", Optional(Word);
        /// Residues of the ligand among which the receptor binds.
        ///
        /// They are active, and all other residues of the ligand are blocked.
        #[serde(default)]
        site_ligand: Option<ResidueSelection> = None, "RESIDUES", Optional(Word);
        /// Distances that are known between receptor and ligand: a table, or a .tbl of HADDOCK and CNS.
        ///
        /// The columns of the table are receptor, ligand, lower, target, upper and group. Residues are written as A:57,
        /// atoms as A:57.CA. Poses that cannot satisfy the distances are not searched.
        restraints: Option<RestraintFile> = None, "FILE", Optional(Content(RestraintFile::read));
        /// How many of the restraints a pose has to satisfy: a number, or a share such as 60%.
        ///
        /// Ask for fewer than all if some may be false.
        restraints_need: RequiredCount = RequiredCount::default(), "COUNT|SHARE", Word;
        /// Upper bounds of a .tbl: widened for the hydrogens that they count, or as written.
        ///
        /// HADDOCK sums over hydrogens, which are dropped here. widened: 2 Å is 2.78 Å between heavy atoms. Selections
        /// without hydrogens, such as name CA, keep their bounds.
        tbl_bounds: TblBounds = TblBounds::Widened, "widened|written", Choice;
        /// Reagent of cross-links: DSS or BS3.
        ///
        /// Rows of --restraints without an upper bound get that of the reagent, between CA atoms. DSS and BS3: 30 Å.
        crosslink: Option<Crosslink> = None, "REAGENT", Optional(Word);
        /// How likely each residue of the receptor is in the interface: a table, or bfactor.
        ///
        /// The columns of the table are chain, residue and probability, as a predictor gives them. bfactor reads the B
        /// values of the receptor's file. Poses that touch the likely residues rank higher, by
        /// terms.interface_weight.
        interface_receptor: Option<PredictionSource> = None, "FILE|bfactor", Optional(Predictions);
        /// The same of the ligand.
        interface_ligand: Option<PredictionSource> = None, "FILE|bfactor", Optional(Predictions);
        /// A membrane that no atom of the other molecule enters: receptor, ligand or two heights z.
        ///
        /// receptor or ligand: that file marks the planes as OPM and PPM do. LOW,HIGH: the lowest and highest z in Å of the
        /// receptor's file (--membrane=-15,15). Poses in it are not searched. What lies between the samples costs
        /// terms.membrane_weight.
        membrane: Option<MembraneChoice> = None, "receptor|ligand|LOW,HIGH", Optional(Signed);
        /// Score of a pose that touches the active site of a peptidase; 0 turns it off.
        ///
        /// A pose that touches some of the catalytic residues gets that share of it. Peptidases are detected from their
        /// sequence. This counts if the contact effect is on, no residue is active, and the other molecule is neither
        /// peptidase nor antibody.
        peptidase_weight: f64 = PEPTIDASE_WEIGHT, "NUMBER", Range::between(0.0, 1e6), in files;
    }
}

impl RestraintOptions {
    /// Whether residues that are in contact, or distances, are named.
    pub(crate) fn knows_contacts(&self) -> bool {
        let active = [&self.active_receptor, &self.active_ligand];
        let site = [&self.site_receptor, &self.site_ligand];
        let mut residues = active.into_iter().chain(site);
        residues.any(Option::is_some) || self.restraints.is_some()
    }

    /// Whether residues are named that have a role: blocked, active or of a site.
    pub(crate) fn names_residues(&self) -> bool {
        let named = [
            &self.block_receptor,
            &self.block_ligand,
            &self.active_receptor,
            &self.active_ligand,
            &self.site_receptor,
            &self.site_ligand,
        ];
        named.into_iter().any(Option::is_some)
    }
}

/// Predictions of an interface: a table, or the B values of the molecule's file.
struct Predictions;

impl Rule<PredictionSource> for Predictions {
    fn read(&self, text: &str, folder: &Path) -> Result<PredictionSource, Error> {
        let path = plain_path(&folder.join(text));
        PredictionSource::read(&path.to_string_lossy())
    }

    fn text(&self, source: &PredictionSource) -> Option<String> {
        Some(source.to_string())
    }

    fn form(&self) -> Form {
        Form::File
    }
}

/// Part of an antibody that may touch.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum AntibodySurface {
    /// Its CDRs and their surroundings.
    #[default]
    Cdrs,
    /// All of it.
    Whole,
}
