//! Names of sites without mass, which force fields add to amino acids.

use crate::molecule::chemistry::elements::column_symbol;

/// The atom after which GROMACS names the two masses that stand for a group: `MCB1` and `MCB2` for the methyl of `CB`.
pub(crate) fn mass_center(name: &str) -> Option<&str> {
    name.strip_prefix('M')?.strip_suffix(['1', '2'])
}

/// Whether sites without mass have such a name, and no atom of an amino acid does.
///
/// These are lone pairs and extra points (`LPOA`, `EP1`), mass centres (`MN1`, `MW1` of tryptophan), virtual and
/// centroid atoms and orbitals of Rosetta (`NV`, `V1`, `CEN`, `ORB1`), and pseudo-atoms of NMR (`QB`).
pub(crate) fn is_site_name(name: &str, column: &str) -> bool {
    if matches!(name, "CEN" | "NV") {
        return true;
    }
    let is_centre = || mass_center(name).is_some_and(|heavy| heavy.starts_with(['C', 'N', 'W']));
    column_symbol(column).is_none()
        && (["LP", "EP", "ORB", "V", "Q"]
            .iter()
            .any(|start| name.starts_with(start))
            || is_centre())
}
