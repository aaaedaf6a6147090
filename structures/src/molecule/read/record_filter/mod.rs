//! The record filter before pdbtbx: which records of a file it reads, and what is taken from the file itself.
//!
//! pdbtbx 0.12 refuses or panics on much of what real files hold. Examples are free-form REMARK, short ATOM lines,
//! odd charge columns, old DBREF and SEQADV, dummy CRYST1, blank residue names, and mmCIF values that a number or a
//! quote breaks.
//!
//! Only atoms of the wanted models pass the filter, each as a record that pdbtbx is sure to read, with a serial number.
//! What pdbtbx would change comes from an [`AtomRecord`](record::AtomRecord) of the same number:
//!
//! | fact | what pdbtbx 0.12 does with it |
//! |---|---|
//! | line number, order | regroups atoms by chain, residue and conformer |
//! | blank chain name | invents `A`, `B`, ... |
//! | residue number | adds 10,000 after 9999, for all chains that follow; does not know hybrid-36 |
//! | residue name | cuts it to three letters (PDB), to upper case |
//! | alternate location | copies the atoms without one into every conformer |
//! | element | guesses calcium for CA when the column is blank |
//! | mmCIF decimals | off by an ulp, and wrong above 2^32 |

pub(crate) mod assembly_items;
pub(crate) mod assembly_remark;
pub(crate) mod atom_line;
pub(crate) mod atom_site;
pub(crate) mod displaced;
pub(crate) mod element_column;
pub(crate) mod mmcif;
pub(crate) mod pdb;
pub(crate) mod provenance;
pub(crate) mod record;
pub(crate) mod residue_columns;
pub(crate) mod segid;
pub(crate) mod tokens;
