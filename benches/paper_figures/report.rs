//! What a figure leaves behind: tables as Markdown and CSV, a picture as SVG.

use crate::table::{Cell, Table};
use knotdock_cli::plot::chart::{Colour, Panel, draw};
use std::fs;
use std::io;
use std::path::Path;

/// One of the paper's figures, done again.
pub struct Figure {
    /// Stem of its files' names.
    pub name: &'static str,
    /// Its tables by name.
    pub tables: Vec<(&'static str, Table)>,
    /// Its panels.
    pub panels: Vec<Panel>,
    /// Panels to a row.
    pub columns: usize,
}

/// Colours that colour-blind readers can distinguish too (Okabe and Ito).
pub fn colour_of_grid(per_axis: usize) -> Colour {
    match per_axis {
        0..=16 => [0x56, 0xb4, 0xe9],
        17..=32 => [0x00, 0x9e, 0x73],
        33..=64 => [0xe6, 0x9f, 0x00],
        _ => [0x00, 0x00, 0x00],
    }
}

/// "m = 2^12".
pub fn grid_name(per_axis: usize) -> String {
    format!("m = 2^{}", per_axis.pow(3).ilog2())
}

/// Whether a row of a table over m' belongs to the printed ones: every third power of two, in its second column.
fn printed(row: &[Cell]) -> bool {
    match row.get(1) {
        Some(Cell::Count(modes)) => modes.ilog2() % 3 == 0,
        _ => true,
    }
}

impl Figure {
    /// Writes all files, the pictures for the documentation to `images` besides, and prints the tables.
    ///
    /// # Errors
    /// What writing gives.
    pub fn write(&self, folder: &Path, images: Option<&Path>) -> io::Result<()> {
        let svg = draw(&self.panels, self.columns).map_err(io::Error::other)?;
        fs::write(folder.join(format!("{}.svg", self.name)), &svg)?;
        if let Some(images) = images {
            fs::write(images.join(format!("{}.svg", self.name)), &svg)?;
        }
        for (name, table) in &self.tables {
            let stem = format!("{}_{name}", self.name);
            let markdown = table.markdown(printed);
            println!("{stem}\n\n{markdown}");
            fs::write(folder.join(format!("{stem}.md")), markdown)?;
            fs::write(folder.join(format!("{stem}.csv")), table.csv())?;
        }
        Ok(())
    }
}
