//! Reading of mmCIF files: the `_atom_site` table of the first data block that has one, methods and assemblies.
//!
//! Names are the author's (`auth_asym_id`, `auth_seq_id`) where given, the archive's (`label_...`) otherwise, as in the
//! PDB format; atom and residue names are `label_atom_id` and `label_comp_id`.

use std::collections::HashMap;

use crate::Error;
use crate::molecule::chemistry::NameColumn;
use crate::molecule::model::{Atom, count};
use crate::molecule::read::assembly::{GENERATORS, OPERATORS, assemblies};
use crate::molecule::read::cif::{Kind, Token, tokens};
use crate::molecule::read::confidence::{Provenance, is_measured};
use crate::molecule::read::pdbtbx::{MMCIF_HEADER, NO_ALTERNATE, SHOWN_NUMBERS};
use crate::molecule::read::{
    COORDINATE, FileContents, ModelChoice, Record, coordinate, field_error, number,
};

/// Category of the atom table, in lower case; tags are case-insensitive.
const ATOMS: &str = "_atom_site";

const CATEGORIES: [&str; 4] = [METHODS, QUALITY, GENERATORS, OPERATORS];
const METHODS: &str = "_exptl";
/// Scores of predictions (ModelCIF, Vallat et al., J. Mol. Biol. 435, 168021, 2023).
const QUALITY: &str = "_ma_qa_metric";

/// A row of a category: its values by their items in lower case.
pub(crate) type Row<'a> = HashMap<String, Token<'a>>;

/// Rows of categories other than the atom table. A row ends where an item comes again, in loops and pairs alike.
#[derive(Default)]
struct Categories<'a>(HashMap<&'static str, Vec<Row<'a>>>);

impl<'a> Categories<'a> {
    fn note(&mut self, tag: &str, value: Token<'a>) {
        let Some((category, item)) = tag.split_once('.') else {
            return;
        };
        let is_own = |name: &&&str| name.eq_ignore_ascii_case(category);
        let Some(category) = CATEGORIES.iter().find(is_own) else {
            return;
        };
        let rows = self.0.entry(category).or_default();
        let item = item.to_ascii_lowercase();
        match rows.last_mut() {
            Some(row) if !row.contains_key(&item) => drop(row.insert(item, value)),
            _ => rows.push(HashMap::from([(item, value)])),
        }
    }

    fn rows(&self, category: &str) -> &[Row<'a>] {
        self.0.get(category).map_or(&[], Vec::as_slice)
    }

    fn values(&self, category: &str, items: &[&str]) -> impl Iterator<Item = &'a str> {
        let rows = self.rows(category).iter();
        rows.flat_map(|row| items.iter().filter_map(|item| row.get(*item)?.kind.value()))
    }

    fn provenance(&self) -> Provenance {
        let is_measured = self.values(METHODS, &["method"]).any(is_measured);
        let mut scores = self.values(QUALITY, &["name", "type"]).peekable();
        let is_scored = scores.peek().is_some();
        let is_plddt = scores.any(|score| score.to_ascii_lowercase().contains("plddt"));
        match (is_measured, is_scored, is_plddt) {
            (true, ..) | (false, true, false) => Provenance::NoConfidence,
            (false, true, true) => Provenance::Confidence,
            (false, false, _) => Provenance::Unstated,
        }
    }
}

/// Reads the text of an mmCIF file; of the models those that `model` takes.
pub(crate) fn read(text: &str, model: ModelChoice) -> Result<FileContents, Error> {
    let mut contents = FileContents::default();
    let mut table = Table::default();
    let mut categories = Categories::default();
    let mut stream = tokens(text).peekable();
    while let Some(token) = stream.next() {
        match token.kind {
            Kind::Data(name) if !table.values.is_empty() => {
                let others = blocks_with_atoms((token.line, name), stream);
                contents.report.warnings.extend(others);
                break;
            }
            Kind::Data(_) => contents.recognised = true,
            Kind::Loop => {
                let mut tags = Vec::new();
                while let Some(Kind::Tag(tag)) = stream.peek().map(|next| next.kind) {
                    tags.push(tag);
                    stream.next();
                }
                let is_atoms = tags.iter().any(|tag| atom_item(tag).is_some());
                if is_atoms {
                    let item = |tag: &&str| atom_item(tag).unwrap_or_default();
                    table = Table {
                        line: token.line,
                        items: tags.iter().map(item).collect(),
                        values: Vec::new(),
                    };
                }
                let mut columns = tags.iter().cycle();
                while let Some(next) = stream.next_if(|next| is_value(next.kind)) {
                    check_closed(next)?;
                    if is_atoms {
                        table.values.push(next);
                    } else if let Some(tag) = columns.next() {
                        categories.note(tag, next);
                    }
                }
            }
            // A single atom may be written as pairs of tag and value.
            Kind::Tag(tag) => {
                if let Some(value) = stream.next_if(|next| is_value(next.kind)) {
                    check_closed(value)?;
                    categories.note(tag, value);
                    if let Some(item) = atom_item(tag) {
                        table.line = token.line;
                        table.items.push(item);
                        table.values.push(value);
                    }
                }
            }
            Kind::Unclosed => check_closed(token)?,
            Kind::Bare(_) | Kind::Quoted(_) => {}
        }
    }
    contents.provenance = categories.provenance();
    contents.assemblies = assemblies(categories.rows(GENERATORS), categories.rows(OPERATORS));
    table.read(model, &mut contents)?;
    Ok(contents)
}

/// A warning about data blocks after the first that have an atom table; `block` is the second's line and name.
fn blocks_with_atoms<'a>(
    mut block: (usize, &'a str),
    rest: impl Iterator<Item = Token<'a>>,
) -> Option<String> {
    let mut found: Vec<(usize, &str)> = Vec::new();
    for token in rest {
        match token.kind {
            Kind::Data(name) => block = (token.line, name),
            Kind::Tag(tag) if atom_item(tag).is_some() && found.last() != Some(&block) => {
                found.push(block);
            }
            _ => {}
        }
    }
    let (line, name) = found.first()?;
    Some(format!(
        "only the first structure is read: {} with atoms, the first, data_{name}, at line {line}",
        count(found.len(), "further data block")
    ))
}

fn is_value(kind: Kind<'_>) -> bool {
    matches!(kind, Kind::Bare(_) | Kind::Quoted(_) | Kind::Unclosed)
}

fn check_closed(token: Token<'_>) -> Result<(), Error> {
    if token.kind == Kind::Unclosed {
        return Err(broken(
            token.line,
            "a quoted value or text field is never closed",
        ));
    }
    Ok(())
}

fn broken(line: usize, what: &str) -> Error {
    Error::input(format!("the mmCIF text is broken: {what}"))
        .on_line(line as u64)
        .help("fetch the file again, or check the text about this line")
}

/// The item of an atom table's tag, in lower case.
fn atom_item(tag: &str) -> Option<String> {
    let (category, item) = tag.split_at_checked(ATOMS.len())?;
    let item = item.strip_prefix('.')?;
    category
        .eq_ignore_ascii_case(ATOMS)
        .then(|| item.to_ascii_lowercase())
}

/// The atom table as tokens, row after row.
#[derive(Default)]
struct Table<'a> {
    line: usize,
    /// Items in column order, lower case.
    items: Vec<String>,
    /// All values; row r has those from r times the number of items on.
    values: Vec<Token<'a>>,
}

/// Columns that are used, by index.
struct Columns {
    group: Option<usize>,
    name: usize,
    alternate: Option<usize>,
    residue: usize,
    /// The author's and the archive's.
    chain: [Option<usize>; 2],
    number: [Option<usize>; 2],
    insertion: Option<usize>,
    element: Option<usize>,
    position: [usize; 3],
    occupancy: Option<usize>,
    b_factor: Option<usize>,
    model: Option<usize>,
}

const POSITION: [&str; 3] = ["Cartn_x", "Cartn_y", "Cartn_z"];

impl Table<'_> {
    fn columns(&self) -> Result<Columns, Error> {
        let find = |name: &str| self.items.iter().position(|item| item == name);
        let require = |column: &str| {
            // Archive names have an author's counterpart that says the same.
            let author = || find(&column.replace("label_", "auth_"));
            find(&column.to_ascii_lowercase())
                .or_else(author)
                .ok_or_else(|| {
                    Error::input(format!("the _atom_site table has no column {column}"))
                        .on_line(self.line as u64)
                        .help("write the file again with all columns that the wwPDB requires")
                })
        };
        require("label_asym_id")?;
        let [name, residue] = [require("label_atom_id")?, require("label_comp_id")?];
        let [x, y, z] = POSITION.map(require);
        Ok(Columns {
            group: find("group_pdb"),
            name,
            alternate: find("label_alt_id"),
            residue,
            chain: ["auth_asym_id", "label_asym_id"].map(find),
            number: ["auth_seq_id", "label_seq_id"].map(find),
            insertion: find("pdbx_pdb_ins_code"),
            element: find("type_symbol"),
            position: [x?, y?, z?],
            occupancy: find("occupancy"),
            b_factor: find("b_iso_or_equiv"),
            model: find("pdbx_pdb_model_num"),
        })
    }

    /// Reads the rows of the models that are wanted, counted from 1 by appearance.
    fn read(&self, wanted: ModelChoice, contents: &mut FileContents) -> Result<(), Error> {
        if self.values.is_empty() {
            return Ok(());
        }
        contents.recognised = true;
        let columns = self.columns()?;
        let width = self.items.len();
        contents.text.push_str(MMCIF_HEADER);
        // Numbers of the models by order of appearance; rows of one model need not be together.
        let mut models: HashMap<Option<&str>, usize> = HashMap::new();
        for row in self.values.chunks(width) {
            let row = AtomRow {
                row,
                columns: &columns,
            };
            if row.row.len() < width {
                let values = row.row.len();
                let what = format!(
                    "the last row of the atom table has {values} values for {width} columns"
                );
                return Err(broken(row.line(), &what));
            }
            let next = models.len() + 1;
            let number = *models.entry(row.value(columns.model)).or_insert(next);
            if !wanted.takes(number) {
                let [x, y, z] = columns.position.map(|column| row.coordinate(column));
                contents.ignore(number, (|| Some([x?, y?, z?]))());
                continue;
            }
            row.read(number, contents)?;
        }
        contents.models = models.len();
        Ok(())
    }
}

struct AtomRow<'r, 'a> {
    row: &'r [Token<'a>],
    columns: &'r Columns,
}

impl<'a> AtomRow<'_, 'a> {
    fn line(&self) -> usize {
        self.row.first().map_or(0, |token| token.line)
    }

    /// A value; nothing for `.` and `?`.
    fn value(&self, column: impl Into<Option<usize>>) -> Option<&'a str> {
        let token = self.row.get(column.into()?)?;
        token.kind.value().filter(|text| !text.is_empty())
    }

    fn either(&self, [first, second]: [Option<usize>; 2]) -> Option<&'a str> {
        self.value(first).or_else(|| self.value(second))
    }

    fn error(&self, item: &str, text: &str, expected: &str) -> Error {
        field_error(self.line(), &format!("{ATOMS}.{item}"), text, expected)
    }

    /// The text of a number, without the standard uncertainty in brackets that may follow it.
    fn certain(&self, column: impl Into<Option<usize>>) -> Option<&'a str> {
        self.value(column)?.split('(').next()
    }

    fn coordinate(&self, column: usize) -> Option<f64> {
        self.certain(column).and_then(coordinate)
    }

    fn character(&self, column: Option<usize>, item: &str) -> Result<Option<char>, Error> {
        let text = self.value(column).unwrap_or("");
        let mut characters = text.chars();
        match (characters.next(), characters.next()) {
            (first, None) => Ok(first),
            _ => Err(self.error(item, text, "a single character")),
        }
    }

    /// Adds the row's atom; `model` is its number.
    fn read(&self, model: usize, contents: &mut FileContents) -> Result<(), Error> {
        let columns = self.columns;
        let mut position = [0.0; 3];
        for ((place, column), item) in position.iter_mut().zip(columns.position).zip(POSITION) {
            *place = self
                .coordinate(column)
                .ok_or_else(|| self.error(item, self.value(column).unwrap_or("?"), COORDINATE))?;
        }
        let [occupancy, b_factor] =
            [(columns.occupancy, 1.0), (columns.b_factor, 0.0)].map(|(column, default)| {
                contents.or_default(self.certain(column).and_then(number), default)
            });
        let chain = self.either(columns.chain).unwrap_or("");
        // Waters and ions have no label_seq_id; a file without author numbers leaves them unnumbered.
        let number = self.either(columns.number).unwrap_or("0");
        let atom = Atom {
            residue_name: self.value(columns.residue).unwrap_or("UNK").to_owned(),
            chain: chain.to_owned(),
            residue_number: number
                .parse()
                .map_err(|_| self.error("auth_seq_id", number, "a whole number"))?,
            alternate_location: self.character(columns.alternate, "label_alt_id")?,
            insertion_code: self.character(columns.insertion, "pdbx_PDB_ins_code")?,
            element: self.value(columns.element).unwrap_or("").to_owned(),
            position,
            occupancy,
            b_factor,
            line: self.line(),
            ..Atom::default()
        };
        self.write_shown(&atom, contents)?;
        let archive_chain = self.value(columns.chain[1]).filter(|name| *name != chain);
        let record = Record {
            atom,
            model,
            archive_chain: archive_chain.map(str::to_owned),
            name_column: NameColumn::Unknown,
        };
        if contents.records.last().is_some_and(|before| {
            before.atom.chain == record.atom.chain && before.archive_chain != record.archive_chain
        }) {
            contents.chain_breaks.push(record.atom.line);
        }
        contents.records.push(record);
        Ok(())
    }

    /// Writes the row that pdbtbx reads: the atom's name and kind.
    ///
    /// For each atom it goes through all chains, all residues of one and all names of one, so it sees few.
    fn write_shown(&self, atom: &Atom, contents: &mut FileContents) -> Result<(), Error> {
        let name = self.value(self.columns.name).unwrap_or("");
        let quote = self.quote("label_atom_id", name)?;
        let character = |character: Option<char>| character.map_or(String::new(), String::from);
        self.quote("label_alt_id", &character(atom.alternate_location))?;
        self.quote("label_comp_id", &atom.residue_name)?;
        self.quote("auth_asym_id", &atom.chain)?;
        self.quote("pdbx_PDB_ins_code", &character(atom.insertion_code))?;
        let is_hetero = |group: &str| group.eq_ignore_ascii_case("HETATM");
        let is_hetero = self.value(self.columns.group).is_some_and(is_hetero);
        let kind = if is_hetero { "HETATM" } else { "ATOM" };
        let name = if name.is_empty() { "_" } else { name };
        let serial = contents.records.len();
        let residue = serial % SHOWN_NUMBERS;
        contents.text.push_str(&format!(
            "{kind} {serial} {quote}{name}{quote} \"{NO_ALTERNATE}\" \"UNK\" \"A\" {residue} ? \"C\" 0 0 0\n"
        ));
        Ok(())
    }

    /// The quotes for a value. pdbtbx ends a value at the first quote of the kind that it started with.
    fn quote(&self, item: &str, value: &str) -> Result<char, Error> {
        let quote = match (value.contains('"'), value.contains('\'')) {
            (false, _) => '"',
            (true, false) => '\'',
            (true, true) => return Err(self.error(item, value, "a value with one kind of quote")),
        };
        if !value.bytes().all(|byte| (32..127).contains(&byte)) {
            return Err(self.error(item, value, "plain ASCII text"));
        }
        Ok(quote)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::collections::HashSet;

    /// pdbtbx goes through all residues of a chain for each new one: 200,000 waters took 10.9 s. So it is shown few of
    /// them, whatever their number, and the others' numbers pass it by.
    #[test]
    fn pdbtbx_is_shown_a_bounded_number_of_residues() {
        let head = "data_x\nloop_\n_atom_site.id\n_atom_site.label_atom_id\n_atom_site.label_comp_id\n\
                    _atom_site.auth_asym_id\n_atom_site.auth_seq_id\n_atom_site.Cartn_x\n_atom_site.Cartn_y\n\
                    _atom_site.Cartn_z\n";
        let shown = |waters: usize| {
            let rows = (1..=waters).map(|number| format!("{number} O HOH W {number} 1 2 3\n"));
            let text = head.to_owned() + &rows.collect::<String>();
            let model = ModelChoice::Number(1);
            let contents = read(&text, model).unwrap();
            assert_eq!(contents.records.len(), waters);
            let numbers = contents
                .text
                .lines()
                .filter(|line| line.starts_with("ATOM"));
            let number = |line: &str| line.split_whitespace().nth(6).map(str::to_owned);
            numbers.filter_map(number).collect::<HashSet<_>>().len()
        };
        assert_eq!(shown(900), 900);
        assert_eq!(shown(3000), shown(9000));
    }
}
