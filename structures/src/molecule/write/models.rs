//! Many complexes in one file, as its models.

use std::io::Write;

use crate::molecule::model::format::Format;
use crate::molecule::model::molecule::Molecule;
use crate::molecule::write::chains::ChainMap;
use crate::molecule::write::error::WriteError;
use crate::molecule::write::{check, complex_rows, mmcif, pdb};

/// A file that gets one model after another.
///
/// The chains of each model are named as those of a complex by itself ([`write_complex`](super::write_complex)).
pub struct ModelWriter<'a, W: Write> {
    writer: &'a mut W,
    format: Format,
    /// Remarks of the head, until it is written with the first model.
    remarks: Option<Vec<String>>,
    models: usize,
    atoms: usize,
}

impl<'a, W: Write> ModelWriter<'a, W> {
    /// Begins a file with free remarks; those on the chains of the first model follow.
    pub fn new(writer: &'a mut W, format: Format, remarks: Vec<String>) -> Self {
        Self {
            writer,
            format,
            remarks: Some(remarks),
            models: 0,
            atoms: 0,
        }
    }

    /// Writes the head, once.
    fn write_head(&mut self, chains: Vec<String>) -> Result<(), WriteError> {
        let Some(mut remarks) = self.remarks.take() else {
            return Ok(());
        };
        remarks.extend(chains);
        match self.format {
            Format::Pdb => pdb::write_remarks(self.writer, &remarks),
            Format::Mmcif => mmcif::write_head(self.writer, &remarks),
        }
    }

    /// Writes receptor and placed molecules as the next model; models are counted from 1.
    ///
    /// # Errors
    /// [`WriteError`] when the writer fails, a number is not finite, or the format cannot hold the complex.
    pub fn write(&mut self, molecules: &[&Molecule]) -> Result<ChainMap, WriteError> {
        let map = ChainMap::of_complex(self.format, molecules)?;
        let rows = complex_rows(molecules, &map);
        check(self.format, &rows)?;
        self.write_head(map.remarks())?;
        self.models += 1;
        match self.format {
            Format::Pdb => pdb::write_model(self.writer, &rows, self.models)?,
            Format::Mmcif => {
                mmcif::write_model(self.writer, &rows, (self.models, self.atoms))?;
            }
        }
        self.atoms += rows.len();
        Ok(map)
    }

    /// Ends the file.
    ///
    /// # Errors
    /// [`WriteError`] when the writer fails.
    pub fn finish(mut self) -> Result<(), WriteError> {
        self.write_head(Vec::new())?;
        match self.format {
            Format::Pdb => pdb::write_end(self.writer),
            Format::Mmcif => mmcif::write_end(self.writer),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::molecule::read::policy::{ModelChoice, ReadOptions};
    use crate::molecule::{InputSpec, model_count, read_bytes};

    /// Each model reads back as the complex that was written, in either format.
    #[test]
    fn models_read_back() {
        let text =
            "ATOM      1  CA  ALA A   1       1.000   2.000   3.000  1.00 10.00           C\n";
        let spec = InputSpec::whole("x.pdb");
        let one = read_bytes(&spec, text.into(), &ReadOptions::default()).unwrap();
        let moved = |x: f64| one.map_positions(|[a, b, c]| [a + x, b, c]);
        for (format, name) in [(Format::Pdb, "x.pdb"), (Format::Mmcif, "x.cif")] {
            let mut bytes = Vec::new();
            let remarks = vec!["a remark".to_owned()];
            let mut models = ModelWriter::new(&mut bytes, format, remarks);
            for x in [10.0, 20.0, 30.0] {
                let map = models.write(&[&one, &moved(x)]).unwrap();
                assert_eq!(map.chains.len(), 2);
            }
            models.finish().unwrap();
            let text = String::from_utf8_lossy(&bytes);
            assert_eq!(text.matches("chain B is ligand chain A").count(), 1);
            assert_eq!(model_count(name.as_ref(), bytes.clone()).unwrap(), 3);
            for (number, x) in [(1, 11.0), (2, 21.0), (3, 31.0)] {
                let options = ReadOptions {
                    model: ModelChoice::Number(number),
                    ..ReadOptions::default()
                };
                let read = read_bytes(&InputSpec::whole(name), bytes.clone(), &options).unwrap();
                let found: Vec<f64> = read.atoms.iter().map(|atom| atom.position[0]).collect();
                assert_eq!(found, [1.0, x], "{name}");
            }
        }
    }
}
