//! Tables of chemistry: names, elements, radii, charges and contact types of residues and their atoms.

pub(crate) mod additives;
pub(crate) mod atom_names;
pub(crate) mod charge_table;
pub(crate) mod charged_termini;
pub(crate) mod chi_angles;
pub(crate) mod contact_types;
pub(crate) mod elements;
pub(crate) mod hydrogen_bonds;
pub(crate) mod labels;
pub(crate) mod ligands;
pub(crate) mod metal_sites;
pub(crate) mod other_names;
pub(crate) mod radii;
pub(crate) mod residues;
pub(crate) mod rotamers;
pub(crate) mod site_names;
pub(crate) mod standard_names;
