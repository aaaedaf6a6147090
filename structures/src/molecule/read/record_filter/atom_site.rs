//! The atom table of an mmCIF file.
//!
//! Names are the author's (`auth_asym_id`, `auth_seq_id`) where given, the archive's (`label_...`) otherwise, as in the
//! PDB format; atom and residue names are `label_atom_id` and `label_comp_id`.

use std::collections::HashMap;
use std::path::Path;

use crate::molecule::chemistry::elements::NameColumn;
use crate::molecule::read::error::ReadError;
use crate::molecule::read::policy::ModelChoice;
use crate::molecule::read::record_filter::record::{
    AtomRecord, COORDINATE, Exact, FilteredRecords, NO_ALTERNATE, SHOWN_NUMBERS, coordinate, field,
    number,
};
use crate::molecule::read::record_filter::tokens::Token;

/// Prefix of the tags of the atom table, in lower case; tags are case-insensitive.
const CATEGORY: &str = "_atom_site.";

/// The header of the table as pdbtbx expects it.
const HEADER: &str = "data_filtered\nloop_\n_atom_site.group_PDB\n_atom_site.id\n_atom_site.label_atom_id\n\
_atom_site.label_alt_id\n_atom_site.label_comp_id\n_atom_site.label_asym_id\n_atom_site.label_seq_id\n\
_atom_site.pdbx_PDB_ins_code\n_atom_site.type_symbol\n_atom_site.Cartn_x\n_atom_site.Cartn_y\n_atom_site.Cartn_z\n";

/// The item of an atom table's tag.
pub(crate) fn item(tag: &str) -> Option<&str> {
    let (head, item) = (tag.get(..CATEGORY.len())?, tag.get(CATEGORY.len()..)?);
    head.eq_ignore_ascii_case(CATEGORY).then_some(item)
}

/// The atom table as tokens, row after row.
#[derive(Default)]
pub(crate) struct Table<'a> {
    /// 1-based line where it starts.
    pub(crate) line: usize,
    /// Items in column order, lower case.
    pub(crate) items: Vec<String>,
    /// All values; row r has those from r times the number of items on.
    pub(crate) values: Vec<Token<'a>>,
}

/// Columns that are used, by index.
struct Columns {
    group: Option<usize>,
    name: usize,
    alternate: Option<usize>,
    residue: usize,
    chain: [Option<usize>; 2],
    /// The archive's name of the chain.
    archive_chain: Option<usize>,
    number: [Option<usize>; 2],
    insertion: Option<usize>,
    element: Option<usize>,
    position: [usize; 3],
    occupancy: Option<usize>,
    b_factor: Option<usize>,
    model: Option<usize>,
}

impl<'a> Table<'a> {
    pub(crate) fn new(line: usize, tags: &[&str]) -> Self {
        let name = |tag: &&str| item(tag).unwrap_or("").to_ascii_lowercase();
        Self {
            line,
            items: tags.iter().map(name).collect(),
            values: Vec::new(),
        }
    }

    fn find(&self, name: &str) -> Option<usize> {
        self.items.iter().position(|item| item == name)
    }

    fn require(&self, file: &Path, column: &'static str) -> Result<usize, ReadError> {
        // Archive names have an author's counterpart that says the same.
        let author = column.replace("label_", "auth_");
        self.find(&column.to_ascii_lowercase())
            .or_else(|| self.find(&author))
            .ok_or_else(|| ReadError::MissingColumn {
                file: file.to_path_buf(),
                line: self.line,
                column,
            })
    }

    fn columns(&self, file: &Path) -> Result<Columns, ReadError> {
        self.require(file, "label_asym_id")?;
        Ok(Columns {
            group: self.find("group_pdb"),
            name: self.require(file, "label_atom_id")?,
            alternate: self.find("label_alt_id"),
            residue: self.require(file, "label_comp_id")?,
            chain: [self.find("auth_asym_id"), self.find("label_asym_id")],
            archive_chain: self.find("label_asym_id"),
            number: [self.find("auth_seq_id"), self.find("label_seq_id")],
            insertion: self.find("pdbx_pdb_ins_code"),
            element: self.find("type_symbol"),
            position: [
                self.require(file, "Cartn_x")?,
                self.require(file, "Cartn_y")?,
                self.require(file, "Cartn_z")?,
            ],
            occupancy: self.find("occupancy"),
            b_factor: self.find("b_iso_or_equiv"),
            model: self.find("pdbx_pdb_model_num"),
        })
    }

    /// Passes on the rows of the models that are wanted, counted from 1 by appearance.
    pub(crate) fn filter(
        &self,
        file: &Path,
        wanted: ModelChoice,
        filtered: &mut FilteredRecords,
    ) -> Result<(), ReadError> {
        if self.values.is_empty() {
            return Ok(());
        }
        filtered.recognised = true;
        let columns = self.columns(file)?;
        let width = self.items.len();
        filtered.text.push_str(HEADER);
        // Numbers of the models by order of appearance; rows of one model need not stand together.
        let mut models: HashMap<Option<&str>, usize> = HashMap::new();
        for row in self.values.chunks(width) {
            if row.len() < width {
                return Err(ReadError::BrokenCif {
                    file: file.to_path_buf(),
                    line: row.first().map_or(self.line, |token| token.line),
                    what: format!(
                        "the last row of the atom table has {} values for {width} columns",
                        row.len()
                    ),
                });
            }
            let row = Row { file, row };
            let model = columns.model.and_then(|column| row.value(column));
            let next = models.len() + 1;
            let number = *models.entry(model).or_insert(next);
            if !wanted.takes(number) {
                filtered.ignore(number, row.position(&columns));
                continue;
            }
            row.filter(&columns, number, filtered)?;
        }
        filtered.models = models.len();
        Ok(())
    }
}

/// A number's text without the standard uncertainty in brackets that may follow it.
fn certain(text: &str) -> &str {
    text.split('(').next().unwrap_or(text)
}

/// One row of the atom table.
struct Row<'r, 'a> {
    file: &'r Path,
    row: &'r [Token<'a>],
}

impl<'a> Row<'_, 'a> {
    fn line(&self) -> usize {
        self.row.first().map_or(0, |token| token.line)
    }

    /// A value; nothing for `.` and `?`.
    fn value(&self, column: usize) -> Option<&'a str> {
        self.row
            .get(column)?
            .kind
            .value()
            .filter(|text| !text.is_empty())
    }

    fn first_of(&self, columns: [Option<usize>; 2]) -> Option<&'a str> {
        columns
            .into_iter()
            .flatten()
            .find_map(|column| self.value(column))
    }

    fn error(&self, item: &str, text: &str, expected: &'static str) -> ReadError {
        field(
            self.file,
            self.line(),
            format!("{CATEGORY}{item}"),
            text,
            expected,
        )
    }

    /// A number, without the standard uncertainty in brackets that may follow it.
    fn number(&self, column: usize) -> Option<f64> {
        self.value(column).and_then(|text| number(certain(text)))
    }

    /// A coordinate, likewise.
    fn coordinate(&self, column: usize) -> Option<f64> {
        self.value(column)
            .and_then(|text| coordinate(certain(text)))
    }

    /// A value of one character.
    fn character(
        &self,
        column: Option<usize>,
        item: &'static str,
    ) -> Result<Option<char>, ReadError> {
        let Some(text) = column.and_then(|column| self.value(column)) else {
            return Ok(None);
        };
        let mut characters = text.chars();
        match (characters.next(), characters.next()) {
            (first, None) => Ok(first),
            _ => Err(self.error(item, text, "a single character")),
        }
    }

    /// The coordinates, where they can be read.
    fn position(&self, columns: &Columns) -> Option<[f64; 3]> {
        let [x, y, z] = columns.position.map(|column| self.coordinate(column));
        Some([x?, y?, z?])
    }

    /// The coordinates, occupancy and B value; occupancy and B value that cannot be read are counted as filled.
    fn exact(&self, columns: &Columns, defaults_filled: &mut usize) -> Result<Exact, ReadError> {
        let mut position = [0.0; 3];
        for (axis, name) in ["Cartn_x", "Cartn_y", "Cartn_z"].into_iter().enumerate() {
            let column = columns.position.get(axis).copied().unwrap_or_default();
            let value = self.coordinate(column).ok_or_else(|| {
                let text = self.value(column).unwrap_or("?");
                self.error(name, text, COORDINATE)
            })?;
            if let Some(place) = position.get_mut(axis) {
                *place = value;
            }
        }
        let mut or_default = |column: Option<usize>, default: f64| {
            column
                .and_then(|column| self.number(column))
                .unwrap_or_else(|| {
                    *defaults_filled += 1;
                    default
                })
        };
        Ok(Exact {
            position,
            occupancy: or_default(columns.occupancy, 1.0),
            b_factor: or_default(columns.b_factor, 0.0),
        })
    }

    /// The author's residue number, or else the archive's.
    fn residue_number(&self, columns: &Columns) -> Result<i64, ReadError> {
        // Waters and ions have no label_seq_id; a file without author numbers leaves them unnumbered.
        let number = self.first_of(columns.number).unwrap_or("0");
        number
            .parse()
            .map_err(|_| self.error("auth_seq_id", number, "a whole number"))
    }

    /// Adds the row's atom; `model` is its number.
    fn filter(
        &self,
        columns: &Columns,
        model: usize,
        filtered: &mut FilteredRecords,
    ) -> Result<(), ReadError> {
        let exact = self.exact(columns, &mut filtered.defaults_filled)?;
        let residue_name = self.value(columns.residue).unwrap_or("UNK");
        let chain = self.first_of(columns.chain).unwrap_or("");
        let residue_number = self.residue_number(columns)?;
        let alternate = self.character(columns.alternate, "label_alt_id")?;
        let insertion = self.character(columns.insertion, "pdbx_PDB_ins_code")?;
        let archive_chain = columns
            .archive_chain
            .and_then(|column| self.value(column))
            .filter(|name| *name != chain);
        let atom = AtomRecord {
            line: self.line(),
            model,
            chain: chain.to_string(),
            archive_chain: archive_chain.map(str::to_string),
            residue_name: residue_name.to_string(),
            residue_number,
            insertion_code: insertion,
            alternate_location: alternate,
            element: columns
                .element
                .and_then(|column| self.value(column))
                .unwrap_or("")
                .to_string(),
            name_column: NameColumn::Unknown,
            exact: Some(exact),
        };
        self.write(columns, &atom, filtered)?;
        let before = filtered.records.last();
        if before.is_some_and(|before| {
            before.chain == atom.chain && before.archive_chain != atom.archive_chain
        }) {
            filtered.chain_breaks.push(atom.line);
        }
        filtered.records.push(atom);
        Ok(())
    }

    /// Writes the row that pdbtbx reads.
    fn write(
        &self,
        columns: &Columns,
        atom: &AtomRecord,
        filtered: &mut FilteredRecords,
    ) -> Result<(), ReadError> {
        let group = match columns.group.and_then(|column| self.value(column)) {
            Some(group) if group.eq_ignore_ascii_case("HETATM") => "HETATM",
            _ => "ATOM",
        };

        let name = self.value(columns.name).unwrap_or("");
        filtered
            .text
            .push_str(&format!("{group} {} ", filtered.records.len()));
        let quote = self.quote("label_atom_id", name)?;
        let name = if name.is_empty() { "_" } else { name };
        filtered.text.push_str(&format!("{quote}{name}{quote} "));
        let character = |character: Option<char>| character.unwrap_or('?').to_string();
        self.quote("label_alt_id", &character(atom.alternate_location))?;
        self.quote("label_comp_id", &atom.residue_name)?;
        self.quote("auth_asym_id", &atom.chain)?;
        self.quote("pdbx_PDB_ins_code", &character(atom.insertion_code))?;
        // For each atom pdbtbx goes through all chains, all residues of one and all names of one. What it takes for one
        // residue is of no matter: all but the atom's name and kind travels past it.
        let shown_number = filtered.records.len() % SHOWN_NUMBERS;
        let shown = format!("\"{NO_ALTERNATE}\" \"UNK\" \"A\" {shown_number} ? \"C\" 0 0 0\n");
        filtered.text.push_str(&shown);
        Ok(())
    }

    /// The quotes for a value that pdbtbx ends where they end: it stops at the first quote of the kind it started with.
    fn quote(&self, item: &'static str, value: &str) -> Result<char, ReadError> {
        let is_plain = value.bytes().all(|byte| (32..127).contains(&byte));
        let quote = match (value.contains('"'), value.contains('\'')) {
            (false, _) => '"',
            (true, false) => '\'',
            (true, true) => return Err(self.error(item, value, "a value with one kind of quote")),
        };
        if !is_plain {
            return Err(self.error(item, value, "plain ASCII text"));
        }
        Ok(quote)
    }
}
