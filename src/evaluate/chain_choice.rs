//! The user's choice of chains: which chain of the native a docked chain is measured against.

use knotdock_structures::Error;

use super::residues::{Residues, Segment};

/// The user's choice of chains. By default every assignment that the sequences allow is tried.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct ChainChoice {
    /// Names of docked chains, each with the name of a native chain that it may be. A chain that is listed several times
    /// may be any of its chains, or all of them if it holds several; one that is not listed may be any.
    pub map: Vec<(String, String)>,
    /// Whether the user named chains at all: then no contact of the native is too small to be meant.
    pub named: bool,
}

impl ChainChoice {
    /// Whether a docked segment may be matched with one of the native's.
    pub(super) fn allows(&self, user: &Segment, native: &Segment) -> bool {
        let mut own = self
            .map
            .iter()
            .filter(|(one, _)| one == user.chain())
            .peekable();
        own.peek().is_none() || own.any(|(_, to)| to == native.chain())
    }

    /// Refuses chains that are not there.
    pub(super) fn check(&self, docked: [&Residues; 2], natives: &[&Residues]) -> Result<(), Error> {
        let known = |chain: &str, among: &[&Residues], molecule: &'static str| {
            let segments = || among.iter().flat_map(|one| &one.segments);
            if segments().any(|segment| segment.chain() == chain) {
                return Ok(());
            }
            let mut chains: Vec<String> = segments().map(|one| one.chain().to_owned()).collect();
            chains.dedup();
            let chains = chains.join(", ");
            Err(Error::input(format!(
                "no chain {chain} is in the {molecule}, which has {chains}"
            ))
            .help("name chains of protein or nucleic acid as DOCKED:NATIVE, such as --map A:E,B:F"))
        };
        for (user, native) in &self.map {
            known(user, &docked, "docked molecules")?;
            known(native, natives, "native")?;
        }
        Ok(())
    }
}
