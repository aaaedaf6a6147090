//! `interface.csv`: the residues that the best clusters touch.

use std::io;

use crate::interface::ResidueShare;
use crate::output::tables::fields::number;
use crate::table_text::cells::TableWriter;

/// Name of the file.
pub const INTERFACE: &str = "interface.csv";

/// Writes a row for each residue of either side: `side`, `chain`, `residue` (number and insertion code), `name`,
/// `clusters` (that touch it) and `share` (of those that were counted).
pub fn write_shares(
    sides: [(&str, &[ResidueShare]); 2],
    stream: &mut dyn io::Write,
) -> io::Result<()> {
    let mut table = TableWriter::new(stream);
    table.row(["side", "chain", "residue", "name", "clusters", "share"])?;
    for (side, shares) in sides {
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
