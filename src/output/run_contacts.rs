//! The contacts of every pose of a run.

use std::collections::HashSet;
use std::io;

use knotdock_structures::molecule::Molecule;
use rayon::prelude::*;

use crate::interface::{CONSENSUS, Contact, ContactFinder, ResidueShare, residue_shares};
use crate::output::tables::fields::number;
use crate::output::tables::poses::PoseTable;
use crate::pose_space::arrangement::Arrangement;
use crate::table_text::cells::TableWriter;

/// Rows whose contacts are listed, and that reports show.
pub const MAX_ROWS: usize = 2000;

/// The contacts of the first [`MAX_ROWS`] rows of a run of molecules.
pub struct RunContacts<'a> {
    /// Residues that contacts are of.
    pub finder: ContactFinder<'a>,
    /// The contacts of each row.
    pub rows: Vec<Vec<Contact>>,
    /// Rows that represent the best clusters, which the shares count.
    pub firsts: Vec<usize>,
}

impl<'a> RunContacts<'a> {
    /// The contacts of molecules in the poses of a table; charges are those at a pH.
    pub fn of(
        molecules: [&'a Molecule; 2],
        table: &PoseTable,
        arrangement: Arrangement,
        ph: f64,
    ) -> Self {
        let finder = ContactFinder::new(molecules, ph);
        let rows = table.rows().get(..MAX_ROWS).unwrap_or(table.rows());
        let contacts = rows.par_iter().map(|row| {
            // A pose that forms no ring places nothing.
            let poses = arrangement.images(&row.pose).unwrap_or_default();
            finder.contacts(&poses)
        });
        let contacts = contacts.collect();
        let mut seen = HashSet::new();
        let firsts = (0..rows.len()).filter(|&row| match table.field(row, "cluster") {
            None | Some("") => true,
            Some(cluster) => seen.insert(cluster),
        });
        let firsts = firsts.take(CONSENSUS).collect();
        Self {
            finder,
            rows: contacts,
            firsts,
        }
    }

    /// The share of the best clusters that touches each residue of either side.
    pub fn shares(&self) -> [Vec<ResidueShare>; 2] {
        let clusters = self.firsts.iter().map(|&row| self.rows[row].as_slice());
        residue_shares(&self.finder, &clusters.collect::<Vec<_>>())
    }

    /// Writes `interface.csv`, a row per residue of either side: `side`, `chain`, `residue` (number and insertion code),
    /// `name`, `clusters` (that touch it) and `share` (of those that were counted).
    pub(crate) fn write_shares(&self, stream: &mut dyn io::Write) -> io::Result<()> {
        let mut table = TableWriter::new(stream);
        table.row(["side", "chain", "residue", "name", "clusters", "share"])?;
        for (side, shares) in ["receptor", "ligand"].into_iter().zip(self.shares()) {
            for share in shares {
                let residue = &share.residue;
                table.row([
                    side,
                    &residue.chain,
                    &residue.number,
                    &residue.name,
                    &share.clusters.to_string(),
                    &number(share.share),
                ])?;
            }
        }
        table.flush()
    }
}
