//! Why a structure could not be read: the file, the line where there is one, and what to do.

use std::path::{Path, PathBuf};

/// Why reading a structure failed.
///
/// `Display` gives the message alone; [`file`](Self::file), [`line`](Self::line) and [`remedy`](Self::remedy) give the
/// rest, so that a caller can lay the four out as it likes.
#[derive(Debug, thiserror::Error)]
pub enum ReadError {
    /// An input specification has a colon with no usable chain or residue after it.
    #[error("'{text}' names no chain and no residues after the colon")]
    Specification {
        /// The specification as given.
        text: String,
    },
    /// An input specification is empty, or nothing but chains.
    #[error("'{text}' names no file")]
    Unnamed {
        /// The specification as given.
        text: String,
    },
    /// There is no such file.
    #[error("there is no such file")]
    Missing {
        /// The path as given.
        file: PathBuf,
    },
    /// The path leads to a directory.
    #[error("this is a directory, not a structure file")]
    Directory {
        /// The path as given.
        file: PathBuf,
    },
    /// The operating system refused to read the file.
    #[error("the file cannot be read: {source}")]
    Unreadable {
        /// The path as given.
        file: PathBuf,
        /// The system's message.
        source: std::io::Error,
    },
    /// The gzip stream is cut short or damaged, or other bytes follow it.
    #[error("the gzip data cannot be unpacked: {source}")]
    Gzip {
        /// The path as given.
        file: PathBuf,
        /// What the decompressor said.
        source: std::io::Error,
    },
    /// The file, unpacked, is larger than any structure.
    #[error("the file is larger than {limit} bytes once unpacked")]
    TooLarge {
        /// The path as given.
        file: PathBuf,
        /// The largest size that is read, in bytes.
        limit: u64,
    },
    /// The file is an archive, of another compression than gzip, or of another format of molecules.
    #[error("this is {what}, not a PDB or mmCIF file")]
    Foreign {
        /// The path as given.
        file: PathBuf,
        /// What it is.
        what: &'static str,
        /// What to do with it.
        remedy: &'static str,
    },
    /// The file holds neither PDB nor mmCIF records.
    #[error("this is not a structure: no PDB record and no mmCIF data block was found")]
    NotAStructure {
        /// The path as given.
        file: PathBuf,
    },
    /// The file is a structure file without any atom.
    #[error("the file holds no atoms")]
    NoAtoms {
        /// The path as given.
        file: PathBuf,
    },
    /// A field of an atom cannot be understood.
    #[error("{field} is '{text}' where {expected} is needed")]
    Field {
        /// The path as given.
        file: PathBuf,
        /// 1-based line of the record.
        line: usize,
        /// Which field, with its columns or its mmCIF item.
        field: String,
        /// What stands there.
        text: String,
        /// What would be right.
        expected: &'static str,
    },
    /// An atom record ends before its coordinates do.
    #[error("the atom record ends after {length} characters, before its coordinates are complete")]
    ShortRecord {
        /// The path as given.
        file: PathBuf,
        /// 1-based line of the record.
        line: usize,
        /// Number of characters on the line.
        length: usize,
    },
    /// A line holds an atom record that does not stand in the columns of the format.
    #[error("the line holds an atom record that does not stand in the columns of the PDB format")]
    MisplacedRecord {
        /// The path as given.
        file: PathBuf,
        /// 1-based line of the record.
        line: usize,
    },
    /// The mmCIF text breaks the rules of the format.
    #[error("the mmCIF text is broken: {what}")]
    BrokenCif {
        /// The path as given.
        file: PathBuf,
        /// 1-based line where it shows.
        line: usize,
        /// The fault, in words.
        what: String,
    },
    /// The atom table of an mmCIF file lacks a column that cannot be done without.
    #[error("the _atom_site table has no column {column}")]
    MissingColumn {
        /// The path as given.
        file: PathBuf,
        /// 1-based line where the table starts.
        line: usize,
        /// The column, with its mmCIF name.
        column: &'static str,
    },
    /// The element of an atom is neither given nor clear from its residue and name.
    #[error("the element of atom {atom} of {residue} is not known")]
    UnknownElement {
        /// The path as given.
        file: PathBuf,
        /// 1-based line of the record.
        line: usize,
        /// Atom name.
        atom: String,
        /// Residue, chain and number.
        residue: String,
    },
    /// A chain was requested that the file does not have.
    #[error(
        "there is no chain '{chain}'; the file has {}{}",
        list_chains(present),
        warned(warnings)
    )]
    UnknownChain {
        /// The path as given.
        file: PathBuf,
        /// The chain requested.
        chain: String,
        /// Author names of the chains in the file, in file order.
        present: Vec<String>,
        /// Warnings of reading until then, such as that a further data block was not read.
        warnings: Vec<String>,
    },
    /// Residues were requested that a chain of the file does not have.
    #[error("there is no residue {part}; chain {chain} of the file has {} to {}", numbers[0], numbers[1])]
    UnknownResidues {
        /// The path as given.
        file: PathBuf,
        /// The residues requested, as `A:1-50`.
        part: String,
        /// The chain, `_` where it has no name.
        chain: String,
        /// Smallest and largest residue number of the chain.
        numbers: [i64; 2],
    },
    /// A model was requested that the file does not have.
    #[error("there is no model {model}; the file has {models}")]
    UnknownModel {
        /// The path as given.
        file: PathBuf,
        /// The model requested, from 1.
        model: usize,
        /// Number of models in the file.
        models: usize,
    },
    /// A biological assembly was requested that the file does not have.
    #[error("there is no assembly '{assembly}'; the file has {}", present.join(", "))]
    UnknownAssembly {
        /// The path as given.
        file: PathBuf,
        /// The assembly requested.
        assembly: String,
        /// Names of those that the file has.
        present: Vec<String>,
    },
    /// A biological assembly was requested of a file whose models are read as one molecule.
    #[error(
        "--assembly builds copies of one model, and --model all reads all models as one molecule"
    )]
    AssemblyOfModels {
        /// The path as given.
        file: PathBuf,
    },
    /// What the file says of its biological assemblies cannot be understood.
    #[error("the biological assemblies cannot be built: {what}")]
    BrokenAssembly {
        /// The path as given.
        file: PathBuf,
        /// 1-based line where it shows, where there is one.
        line: Option<usize>,
        /// The fault, in words.
        what: String,
    },
    /// Every atom was dropped: hydrogens, waters and additives only, or what the policies leave out besides.
    #[error("no atom is left after what is not wanted is dropped ({dropped} atoms)")]
    EmptySelection {
        /// The path as given.
        file: PathBuf,
        /// Number of atoms dropped.
        dropped: usize,
    },
    /// The parser behind the record filter refused the file.
    #[error("the parser refused the file: {what}")]
    Parser {
        /// The path as given.
        file: PathBuf,
        /// 1-based line, where the parser named one.
        line: Option<usize>,
        /// What it said.
        what: String,
    },
}

/// Names chains for a message; a blank name is shown as `_`, which also selects it.
fn list_chains(present: &[String]) -> String {
    let names: Vec<&str> = present
        .iter()
        .map(|name| if name.is_empty() { "_" } else { name })
        .collect();
    match names.as_slice() {
        [] => "none".to_string(),
        [one] => format!("only {one}"),
        several => several.join(", "),
    }
}

/// Warnings behind a message.
fn warned(warnings: &[String]) -> String {
    warnings.iter().map(|text| format!("; {text}")).collect()
}

impl ReadError {
    /// The offending file, where there is one.
    pub fn file(&self) -> Option<&Path> {
        match self {
            Self::Specification { .. } | Self::Unnamed { .. } => None,
            Self::Missing { file }
            | Self::Directory { file }
            | Self::Unreadable { file, .. }
            | Self::Gzip { file, .. }
            | Self::TooLarge { file, .. }
            | Self::Foreign { file, .. }
            | Self::NotAStructure { file }
            | Self::NoAtoms { file }
            | Self::Field { file, .. }
            | Self::ShortRecord { file, .. }
            | Self::MisplacedRecord { file, .. }
            | Self::BrokenCif { file, .. }
            | Self::MissingColumn { file, .. }
            | Self::UnknownElement { file, .. }
            | Self::UnknownChain { file, .. }
            | Self::UnknownResidues { file, .. }
            | Self::UnknownModel { file, .. }
            | Self::UnknownAssembly { file, .. }
            | Self::AssemblyOfModels { file }
            | Self::BrokenAssembly { file, .. }
            | Self::EmptySelection { file, .. }
            | Self::Parser { file, .. } => Some(file),
        }
    }

    /// The offending line (1-based, in the unpacked text), where there is one.
    pub fn line(&self) -> Option<usize> {
        match self {
            Self::Field { line, .. }
            | Self::ShortRecord { line, .. }
            | Self::MisplacedRecord { line, .. }
            | Self::BrokenCif { line, .. }
            | Self::MissingColumn { line, .. }
            | Self::UnknownElement { line, .. } => Some(*line),
            Self::Parser { line, .. } | Self::BrokenAssembly { line, .. } => *line,
            _ => None,
        }
    }

    /// Remedy for the user.
    pub fn remedy(&self) -> &'static str {
        match self {
            Self::Specification { .. } | Self::Unnamed { .. } => {
                "write FILE to read all chains, FILE:H,L to pick chains by their author names, or FILE:H:1-120,L to pick residues"
            }
            Self::Missing { file } if file.to_string_lossy().contains(',') => {
                "give one file for each side, and further conformations with --receptor-also or --ligand-also; chains are \
                 picked with FILE:H,L"
            }
            Self::Missing { .. } => {
                "check the path; chains are picked with FILE:H,L and residues with FILE:H:1-120"
            }
            Self::Directory { .. } => "name one .pdb, .ent, .cif or .mmcif file, plain or .gz",
            Self::Unreadable { .. } => {
                "check the permissions of the file and that it is on a readable disk"
            }
            Self::Gzip { .. } => {
                "fetch the file again, or unpack it with gunzip to see where it breaks"
            }
            Self::TooLarge { .. } => "cut the file down to the chains and the model to be docked",
            Self::Foreign { remedy, .. } => remedy,
            Self::NotAStructure { .. } => {
                "give a PDB or mmCIF file, plain or gzip-compressed; BinaryCIF, XML and other compressions are not read"
            }
            Self::NoAtoms { .. } => {
                "give a file with ATOM or HETATM records, or an _atom_site table"
            }
            Self::Field { .. } => "correct the record, or remove the atom",
            Self::ShortRecord { .. } => {
                "fetch the file again: it may be cut short; coordinates stand in columns 31 to 54"
            }
            Self::MisplacedRecord { .. } => {
                "begin it with ATOM or HETATM in column 1, in capitals, with blanks and no tabs, and put x, y \
                 and z into columns 31-38, 39-46 and 47-54"
            }
            Self::BrokenCif { .. } => "fetch the file again, or check the text about this line",
            Self::MissingColumn { .. } => {
                "write the file again with all columns that the wwPDB requires"
            }
            Self::UnknownElement { .. } => {
                "write the element symbol in columns 77-78 (PDB) or in _atom_site.type_symbol (mmCIF), remove \
                 the atom, or leave its residue out with \
                 --drop-residue NAME"
            }
            Self::UnknownChain { .. } => {
                "pick one of the chains listed; names are the author's and case-sensitive, _ is the blank name; \
                 residues are picked as in FILE:A:1-120"
            }
            Self::UnknownResidues { .. } => {
                "pick residues that the file has, by the author's numbers: FILE:A:1-120 or FILE:A:52A, with all \
                 parts of a list after commas"
            }
            Self::UnknownModel { .. } => {
                "ask for one of the models that the file has, which count from 1 in the order of the file, or for --model all"
            }
            Self::UnknownAssembly { .. } => {
                "ask for one of these, or leave --assembly out to read the coordinates as they stand"
            }
            Self::AssemblyOfModels { .. } => "leave one of the two out",
            Self::BrokenAssembly { .. } => {
                "fetch the file again, or leave --assembly out to read the coordinates as they stand"
            }
            Self::EmptySelection { .. } => {
                "pick other chains, or keep what is dropped: --hetatm keep, --waters keep, --hydrogens keep, a lower --min-plddt"
            }
            Self::Parser { .. } => {
                "please report this file: the record filter before the parser should have caught it"
            }
        }
    }
}

impl From<ReadError> for crate::Error {
    fn from(error: ReadError) -> Self {
        let line = error.line().and_then(|line| u64::try_from(line).ok());
        let refused = Self::input(&error).on_line(line).help(error.remedy());
        match error.file() {
            Some(file) => refused.at(file),
            None => refused,
        }
    }
}
