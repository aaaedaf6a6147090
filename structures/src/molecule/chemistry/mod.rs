//! Tables of chemistry: names, elements, radii, charges and contact types of residues and their atoms.

pub(crate) mod additives;
pub(crate) mod charged_termini;
pub(crate) mod charges;
pub(crate) mod elements;
pub(crate) mod labels;
pub(crate) mod names;
pub(crate) mod radii;
pub(crate) mod residues;
pub(crate) mod rotamers;
