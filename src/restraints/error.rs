//! Why a file of restraints cannot be used, where, and what to do about it.

use std::path::{Path, PathBuf};

use knotdock_structures::Error;

use crate::restraints::crosslink;
use crate::table_text::named_columns::{AtLine, TableFault, shortened};

/// Why a file of restraints cannot be used.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[error("{fault}{}", column.map_or_else(String::new, |column| format!(" (column {column})")))]
pub struct RestraintFileError {
    /// The file.
    pub path: PathBuf,
    /// 1-based line, where one is at fault.
    pub line: Option<usize>,
    /// 1-based character of that line, in a file of statements.
    pub column: Option<usize>,
    /// The fault.
    pub fault: Box<RestraintFault>,
}

impl From<RestraintFileError> for Error {
    fn from(error: RestraintFileError) -> Self {
        let refused = Self::input(&error)
            .on_line(error.line.map(|line| line as u64))
            .help(error.remedy());
        match Some(error.path.as_path()) {
            Some(path) => refused.at(path),
            None => refused,
        }
    }
}

impl RestraintFileError {
    /// Remedy for the user.
    pub fn remedy(&self) -> String {
        self.fault.remedy()
    }
}

/// What is wrong with a file of restraints.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum RestraintFault {
    /// The file cannot be opened, is too large or no text.
    #[error("the restraints cannot be read: {0}")]
    Unreadable(String),
    /// Nothing but comments and blank lines.
    #[error("there is no restraint in the file")]
    NoRestraint,
    /// All selections together hold too many atoms.
    #[error("the restraints hold more than {0} atoms in all")]
    TooManyAtoms(usize),
    /// A number that is no distance.
    #[error("{what} is `{text}`; it must be a number of Å from 0 to {max}")]
    Distance {
        /// Which number.
        what: &'static str,
        /// As written.
        text: String,
        /// The largest that is taken, in Å.
        max: f64,
    },
    /// Bounds that contradict each other.
    #[error("{0}")]
    Bounds(String),

    /// The rows are no table with the columns of restraints.
    #[error(transparent)]
    Table(TableFault),
    /// A field that may not be empty is.
    #[error("the row has no {0}")]
    MissingField(&'static str),
    /// A field that names no residues.
    #[error("{side} is `{text}`, which does not name residues or atoms")]
    ResidueSyntax {
        /// `receptor` or `ligand`.
        side: &'static str,
        /// As written.
        text: String,
    },
    /// Residues that the molecule does not have.
    #[error("the {side} has no residue {residue}; it has {present}")]
    UnknownResidue {
        /// `receptor` or `ligand`.
        side: &'static str,
        /// As `A:57`.
        residue: String,
        /// The chains and numbers that there are, in words.
        present: String,
    },
    /// An atom that the residue does not have.
    #[error("{residue} of the {side} has no atom {atom}; it has {present}")]
    UnknownAtom {
        /// `receptor` or `ligand`.
        side: &'static str,
        /// As `A:57`.
        residue: String,
        /// Name of the atom.
        atom: String,
        /// The atoms that there are, in words.
        present: String,
    },
    /// Rows of one group with different bounds.
    #[error("the bounds differ from those of group `{group}` on line {first}")]
    GroupBounds {
        /// The group.
        group: String,
        /// 1-based line of its first row.
        first: usize,
    },

    /// A preset of a cross-linking reagent with a file of statements.
    #[error(
        "--crosslink {0} does nothing in a .tbl file, whose statements have their own distances"
    )]
    CrosslinkOfTbl(&'static str),
    /// Something else than the statement needs here.
    #[error("there must be {expected}, not {found}")]
    Syntax {
        /// What must be here, in words.
        expected: &'static str,
        /// What is here.
        found: String,
    },
    /// A comment or a quoted word that does not end.
    #[error("the {0} that begins here does not end")]
    Unclosed(&'static str),
    /// Parentheses and `not` within each other too often.
    #[error("the selection is nested more than {0} deep")]
    Nesting(usize),
    /// A range of residues that cannot be read.
    #[error("`{0}` is no range of residues")]
    ResidueRange(String),
    /// A weight other than 1.
    #[error("the weight is `{0}`; all restraints count alike")]
    Weight(String),
    /// A selection without atoms.
    #[error("{selection} selects no atom; {present}")]
    NoAtom {
        /// As written.
        selection: String,
        /// What there is, in words.
        present: String,
    },
    /// A selection whose chain both molecules have.
    #[error(
        "{selection} selects atoms of chain {chain}, and both receptor and ligand have a chain of that name"
    )]
    SharedChain {
        /// As written.
        selection: String,
        /// The chain.
        chain: String,
    },
    /// A selection with atoms of both molecules.
    #[error(
        "{selection} selects atoms of both molecules: of the receptor's {} and the ligand's {}",
        chains[0],
        chains[1]
    )]
    BothSides {
        /// As written.
        selection: String,
        /// A chain of each, in words.
        chains: [String; 2],
    },
    /// Nothing but restraints within one molecule: so many.
    #[error(
        "{}, which docking does not change",
        match .0 {
            1 => "the restraint is within one molecule".to_owned(),
            count => format!("all {count} restraints are within one molecule"),
        }
    )]
    WithinOneMolecule(usize),
}

impl RestraintFault {
    /// The fault of a range as written.
    pub(super) fn range(written: &str) -> Self {
        Self::ResidueRange(shortened(written))
    }

    /// Remedy for the user.
    pub fn remedy(&self) -> String {
        match self {
            Self::Unreadable(_) | Self::Table(TableFault::Unreadable(_)) => {
                "give a text in UTF-8: a CSV table, or a .tbl file with assign statements"
            }
            Self::NoRestraint => {
                "add rows below `receptor,ligand,upper`, or to a .tbl file statements such as \
                 `assign (resid 10 and segid A) (resid 20 and segid B) 2.0 2.0 0.0`"
            }
            Self::TooManyAtoms(_) => "select residues or atoms in place of whole chains",
            Self::Distance { .. } => "write the number with a decimal point, as in 8.5",
            Self::Bounds(_) => "correct the numbers, so that 0 <= lower <= target <= upper and upper is above 0",
            Self::Table(TableFault::FieldCount { .. }) => TableFault::FIELD_COUNT_REMEDY,
            Self::Table(_) => {
                "the first row names the columns: receptor, ligand, lower, target, upper, group; receptor and \
                 ligand are needed, and so is upper without --crosslink. Statements (assign) belong in a file whose \
                 name ends in .tbl"
            }
            Self::MissingField("upper") => {
                return format!(
                    "give the largest distance in Å, or the reagent of cross-links with --crosslink: {}",
                    crosslink::names()
                );
            }
            Self::MissingField(_) => "give residues or atoms, as in A:57 or A:57.CA",
            Self::ResidueSyntax { .. } | Self::UnknownResidue { .. } => {
                "name residues by chain and number, as in A:57, A:52A or A:1-50, and atoms as in A:57.CA; a chain \
                 without a name is _"
            }
            Self::UnknownAtom { .. } | Self::NoAtom { .. } => {
                "correct the names and numbers. What the file of the molecule lacks, or the options leave out, cannot \
                 be restrained: hydrogens need --hydrogens keep"
            }
            Self::GroupBounds { .. } => {
                "give all rows of a group the same lower, target and upper, since they are one restraint"
            }
            Self::CrosslinkOfTbl(_) => "leave out --crosslink, or give the cross-links as a CSV table",
            Self::Syntax { .. } => {
                "write `assign (selection) (selection) distance minus plus`. A selection is made of resid, resname, \
                 name, segid, chain, atom, hydrogen, all, and, or, not and parentheses"
            }
            Self::Unclosed(_) => "close it: a comment with }, a quoted word with \" on its line",
            Self::Nesting(_) => "leave out parentheses that are not needed",
            Self::ResidueRange(_) => "give the first residue before the last, as in `resid 10:20`",
            Self::Weight(_) => "leave the weight out, or leave out the whole statement",
            Self::SharedChain { .. } => {
                "give the restraints as a CSV table, whose columns say the side, or rename the chain of one molecule"
            }
            Self::BothSides { .. } => "name the chain of one of the two, as in `segid A`",
            Self::WithinOneMolecule(_) => {
                "select atoms of the receptor in one and of the ligand in the other: rigid docking keeps distances \
                 within a molecule"
            }
        }
        .to_owned()
    }
}

/// A fault and where it is, before the file's name is known.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Located {
    pub(super) line: Option<usize>,
    pub(super) column: Option<usize>,
    pub(super) fault: RestraintFault,
}

impl Located {
    /// A fault of the whole file.
    pub(super) fn in_file(fault: RestraintFault) -> Self {
        Self {
            line: None,
            column: None,
            fault,
        }
    }

    /// The error that names the file.
    pub(super) fn of(self, path: &Path) -> RestraintFileError {
        RestraintFileError {
            path: path.to_owned(),
            line: self.line,
            column: self.column,
            fault: Box::new(self.fault),
        }
    }
}

impl From<TableFault> for RestraintFault {
    fn from(fault: TableFault) -> Self {
        Self::Table(fault)
    }
}

impl From<AtLine<RestraintFault>> for Located {
    fn from(AtLine { line, fault }: AtLine<RestraintFault>) -> Self {
        Self {
            line,
            ..Self::in_file(fault)
        }
    }
}
