//! Tables of chemistry: names, elements, radii, charges and contact types of residues and their atoms.

mod additives;
mod charged_termini;
mod charges;
mod elements;
mod labels;
mod names;
mod radii;
mod residues;
mod rotamers;

pub use self::labels::{LabelReport, Labels};
pub use self::names::{plain_atom_name, plain_residue_name, standard_residue_name};
pub use self::residues::{CONTACT_TYPES, atom_kinds, nucleotide_letter, one_letter};
pub use self::rotamers::{Rotamer, log_probability, rotamers};

pub(crate) use self::additives::is_additive;
pub(crate) use self::charged_termini::{BOND, Caps};
pub(crate) use self::charges::{
    CARBOXYL, Charges, TERMINI_PKA, amino_terminus, backbone, cofactor, ion, is_modified,
    nucleotide, side_chain_charges,
};
pub(crate) use self::elements::{
    NameColumn, Origin, Resolved, column_symbol, element, is_hard, is_hydrogen, is_metal, resolve,
};
pub(crate) use self::names::{is_site_name, known_as, links_nucleotides, mass_center};
pub(crate) use self::radii::{all_atom_radius, radius};
pub(crate) use self::residues::{
    amino_acid_type, backbone_type, base, is_amino_acid, is_nucleotide, is_water, known_atom,
    nucleotide_type, parent, side_chain, side_chains, standard_atom_name,
};
pub(crate) use self::rotamers::ChiAngles;
