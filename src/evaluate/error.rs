//! Why poses cannot be judged by the native given.

/// Why an [`Evaluator`](super::Evaluator) could not be made.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum EvaluateError {
    /// A molecule holds no residue of protein or nucleic acid.
    #[error("the {molecule} has no residue of protein or nucleic acid")]
    NoResidues {
        /// Which molecule: "receptor", "ligand", "native", "native receptor" or "native ligand".
        molecule: &'static str,
    },
    /// A coordinate is NaN or infinite.
    #[error("the {molecule} has an atom (line {line}) whose coordinates are not finite")]
    NotFinite {
        /// Which molecule, as above.
        molecule: &'static str,
        /// 1-based line of the atom in its file.
        line: usize,
    },
    /// No chain of the native is that of the user's molecule.
    #[error("no chain of the native has the sequence of the {side}")]
    Unmatched {
        /// "receptor" or "ligand".
        side: &'static str,
    },
    /// Receptor and ligand are the same chain, of which the native has one copy.
    #[error(
        "receptor and ligand match the same chain of the native, which has only one copy of it"
    )]
    OneCopy,
    /// A choice of chains names one that is not there.
    #[error("no chain {chain} is in the {molecule}, which has {}", chains.join(", "))]
    UnknownChain {
        /// "docked molecules" or "native".
        molecule: &'static str,
        /// The chain named.
        chain: String,
        /// The chains that are there.
        chains: Vec<String>,
    },
    /// Too little of a docked side has a match for the figures to mean anything.
    #[error(
        "only {matched} of the docked {side}'s {residues} residues are matched with the native; a quarter or 50 are needed"
    )]
    DockedShare {
        /// "receptor" or "ligand".
        side: &'static str,
        /// Residues matched.
        matched: usize,
        /// Residues of the docked side.
        residues: usize,
    },
    /// The native's two sides do not touch.
    #[error("the native's receptor and ligand have no heavy atoms within 5 Å of each other")]
    NoContact,
    /// Too little of the native's interface has a match for the figures to mean anything.
    #[error(
        "only {matched} of the {interface} residues that the native's {side} has at the interface are matched in the \
         {side} that was docked; at least half are needed"
    )]
    Interface {
        /// "receptor" or "ligand".
        side: &'static str,
        /// Interface residues matched.
        matched: usize,
        /// Interface residues of the native on this side.
        interface: usize,
    },
    /// Too few backbone atoms to superpose.
    #[error(
        "only {atoms} backbone atoms of the {side} are matched with the native; at least 3 are needed"
    )]
    Backbone {
        /// "receptor" or "ligand".
        side: &'static str,
        /// Backbone atoms matched.
        atoms: usize,
    },
    /// Too few backbone atoms to superpose, of residues whose neighbours across the interface are matched as well.
    #[error(
        "only {} and {} backbone atoms of receptor and ligand are matched on both sides of one place of the native's interface; some of \
         each and 3 in all are needed",
        atoms[0], atoms[1]
    )]
    Across {
        /// Backbone atoms matched of receptor and ligand, within 10 Å of a matched residue across.
        atoms: [usize; 2],
    },
}

impl EvaluateError {
    /// Remedy for the user.
    pub fn remedy(&self) -> &'static str {
        match self {
            Self::NoResidues { .. } => {
                "name chains of protein or nucleic acid; waters, ions and cofactors are not compared"
            }
            Self::NotFinite { .. } => "correct the coordinates in the file",
            Self::Unmatched { .. } => {
                "name the chains of the native that belong to each side with --native-receptor FILE:CHAINS and \
                 --native-ligand FILE:CHAINS, and check that they are the same proteins and that receptor and ligand are \
                 not exchanged"
            }
            Self::OneCopy => {
                "give a native with both copies: of a crystal, `knotdock inspect FILE --assembly 1 --write COMPLEX.pdb` builds the \
                 biological assembly"
            }
            Self::UnknownChain { .. } => {
                "name chains of protein or nucleic acid as DOCKED:NATIVE, such as --map A:E,B:F"
            }
            Self::DockedShare { .. } => {
                "check that the native's chain is that of the docked molecule and no fragment or other peptide. Where the native \
                 has one domain of it, give --receptor and --ligand as docked, cut to that domain"
            }
            Self::NoContact => {
                "check that the two are in one common frame and that the chains named are neighbours in the native; \
                 --native-receptor FILE:CHAINS and --native-ligand FILE:CHAINS choose them"
            }
            Self::Interface { .. } => {
                "check that the native is of the same proteins and that receptor and ligand are not exchanged; name the \
                 native's chains with --native-receptor FILE:CHAINS and --native-ligand FILE:CHAINS. Only residues of \
                 the same name are matched"
            }
            Self::Backbone { .. } => {
                "give files with backbone atoms (N, CA, C and O) for all residues"
            }
            Self::Across { .. } => {
                "what is missing of one side lies where the other is known: give files with the residues of the interface and their \
                 backbone atoms (N, CA, C and O), and check that the native is of the same proteins"
            }
        }
    }
}
