//! `knotdock interface`: what holds a complex together, and how it scores, of any complex file.

use std::io;
use std::path::{Path, PathBuf};

use clap::Args;
use serde_json::{Map, Value, json};

use crate::arguments::options::{OfScore, OptionArguments};
use crate::arguments::output_file::check_outputs;
use crate::inputs::complex_sides::{ComplexSides, files_and_chains, for_each_model};
use crate::messages::console::Console;
use crate::tables::report::{counted, text_table};
use crate::tables::{Column, field, write_table};
use knotdock::interface::{Contact, Interface, PlacedScore, ResidueName, score_in_place};
use knotdock::options::DockOptions;
use knotdock::output::files::whole_file::write_whole;
use knotdock::table_text::cells::TableWriter;
use knotdock::threads;
use knotdock_scoring::terms::effect::Effect;
use knotdock_scoring::terms::pose::POSE_TERMS;
use knotdock_structures::Error;
use knotdock_structures::molecule::Molecule;

/// Describe the interface of complexes: contacts, hydrogen bonds, salt bridges, buried surface, and the score of each.
///
/// Any complex file will do: of a crystal, of a predictor, of another docking program, or of knotdock.
#[derive(Args, Debug)]
pub struct InterfaceCommand {
    /// Complex files (.pdb, .ent, .cif, each also .gz), and optionally the chains of both sides, such as H,L A. Without
    /// them the sides are those that a complex of knotdock names, or the two chains of a file that has two. Every model of
    /// a file is described.
    #[arg(value_name = "COMPLEX ... [CHAINS CHAINS]", required = true)]
    words: Vec<String>,
    /// Write a row for each model of each file to this table.
    #[arg(short, long, value_name = "FILE")]
    output: Option<PathBuf>,
    /// Write a row for each pair of residues in contact to this table.
    #[arg(long, value_name = "FILE")]
    contacts: Option<PathBuf>,
    /// Replace these files where they are already there.
    #[arg(long)]
    force: bool,
    #[command(flatten)]
    options: OptionArguments<OfScore>,
}

impl InterfaceCommand {
    /// Describes the complexes; the exit code: 2 if some could not be described.
    pub fn run(self, console: Console) -> Result<u8, Error> {
        let options = self.options.given()?.options;
        threads::on(options.machine.thread_count(), || {
            self.describe(&options, console)
        })?
    }

    fn describe(&self, options: &DockOptions, console: Console) -> Result<u8, Error> {
        let (files, sides) = files_and_chains(&self.words, "interface")?;
        let read: Vec<&Path> = files.iter().map(Path::new).collect();
        let written = [&self.output, &self.contacts].into_iter().flatten();
        check_outputs(written, &read, self.force, console)?;
        let (files, reading) = ((files, sides.as_ref()), options.input.reading());
        let (rows, code) = for_each_model(files, &reading, console, |file, sides| {
            row(file, sides, options)
        })?;
        if let Some(path) = &self.output {
            write_whole(path, |file| write_rows(file, &rows))?;
        }
        if let Some(path) = &self.contacts {
            write_whole(path, |file| write_pairs(file, &rows))?;
        }
        match rows.as_slice() {
            [row] => console.say(text(row)),
            rows => console.say(listing(rows)),
        }
        console.result(&json!({ "complexes": objects(&rows) }))?;
        Ok(code)
    }
}

/// The interface of a model of a file.
fn row(file: &str, sides: ComplexSides, options: &DockOptions) -> Result<InterfaceRow, Error> {
    let molecules: [&Molecule; 2] = sides.molecules.each_ref();
    let interface = Interface::of(molecules, options.terms.ph)?;
    if interface.pairs.is_empty() {
        return Err(Error::input(format!(
            "the sides do not touch: no heavy atoms of chains {} and {} are within 5 Å of each other",
            sides.chains[0], sides.chains[1]
        ))
        .at(&sides.path)
        .help("name the chains of both sides, as in `knotdock interface x.pdb H,L A`"));
    }
    Ok(InterfaceRow {
        file: file.to_owned(),
        model: sides.model,
        score: score_in_place(molecules, options)?,
        chains: sides.chains,
        interface,
    })
}

/// One complex in words.
fn text(row: &InterfaceRow) -> String {
    let InterfaceRow {
        interface, score, ..
    } = row;
    let [first, second] = &row.chains;
    let pairs = interface.pairs.iter();
    let bonded = pairs.filter(|pair| pair.hydrogen_bonds > 0 || pair.salt_bridge);
    let bonded = bonded.map(|pair| {
        let residues = pair.residues.each_ref();
        let [a, b] = residues.map(|one| format!("{} {}:{}", one.name, one.chain, one.number));
        let bonds = match pair.hydrogen_bonds {
            0 => String::new(),
            bonds => bonds.to_string(),
        };
        let bridge = if pair.salt_bridge { "yes" } else { "" };
        let distance = format!("{:.2}", pair.distance);
        vec![a, b, distance, bonds, bridge.to_owned()]
    });
    format!(
        "{}, chains {first} with {second}\n\
         {} of {} and {} residues; {}, {} and {}; {:.0} Å² buried ({:.0} and {:.0}){}\n\
         Score {:.1}: {}\n\n{}",
        row.file,
        counted(interface.pairs.len(), "contact"),
        interface.residues[0],
        interface.residues[1],
        counted(interface.hydrogen_bonds, "hydrogen bond"),
        counted(interface.salt_bridges, "salt bridge"),
        match interface.clashes {
            1 => "1 clash".to_owned(),
            clashes => format!("{clashes} clashes"),
        },
        interface.buried[0] + interface.buried[1],
        interface.buried[0],
        interface.buried[1],
        match interface.shape_complementarity {
            Some(value) => format!("; shape complementarity {value:.2}"),
            None => String::new(),
        },
        score.pose_score(),
        terms(score),
        text_table(
            "residue|residue|distance|hydrogen bonds|salt bridge",
            bonded
        )
    )
}

fn terms(score: &PlacedScore) -> String {
    let effects = knotdock_scoring::terms::effect::Effect::ALL
        .into_iter()
        .filter_map(|effect| {
            Some(format!(
                "{} {:.1}",
                effect.name(),
                score.effects[effect as usize]?
            ))
        });
    let pose = score
        .pose_terms
        .iter()
        .filter_map(|(term, value)| Some(format!("{} {:.1}", term.label, value?)));
    effects.chain(pose).collect::<Vec<_>>().join(", ")
}

fn listing(rows: &[InterfaceRow]) -> String {
    let lines = rows.iter().map(|row| {
        let interface = &row.interface;
        vec![
            row.file.clone(),
            row.model.to_string(),
            format!("{} {}", row.chains[0], row.chains[1]),
            interface.pairs.len().to_string(),
            interface.hydrogen_bonds.to_string(),
            interface.salt_bridges.to_string(),
            interface.clashes.to_string(),
            format!("{:.0}", interface.buried[0] + interface.buried[1]),
            interface
                .shape_complementarity
                .map_or_else(String::new, |value| format!("{value:.2}")),
            format!("{:.1}", row.score.pose_score()),
        ]
    });
    text_table(
        "file|model|chains|contacts|hydrogen bonds|salt bridges|clashes|buried, Å²|Sc|score",
        lines,
    )
}

#[derive(Clone, Debug)]
pub struct InterfaceRow {
    pub file: String,
    /// Its place among the models of the file, from 1.
    pub model: usize,
    pub chains: [String; 2],
    /// What holds it together.
    pub interface: Interface,
    pub score: PlacedScore,
}

impl InterfaceRow {
    fn columns(&self) -> Map<String, Value> {
        let Self {
            interface, score, ..
        } = self;
        let mut columns = Map::new();
        let mut add = |name: &str, value: Value| columns.insert(name.to_owned(), value);
        add("file", json!(self.file));
        add("model", json!(self.model));
        add("chains_1", json!(self.chains[0]));
        add("chains_2", json!(self.chains[1]));
        add("contacts", json!(interface.pairs.len()));
        add("residues_1", json!(interface.residues[0]));
        add("residues_2", json!(interface.residues[1]));
        add("hydrogen_bonds", json!(interface.hydrogen_bonds));
        add("salt_bridges", json!(interface.salt_bridges));
        add("clashes", json!(interface.clashes));
        add(
            "buried_area",
            json!(interface.buried[0] + interface.buried[1]),
        );
        add("buried_area_1", json!(interface.buried[0]));
        add("buried_area_2", json!(interface.buried[1]));
        add(
            "shape_complementarity",
            json!(interface.shape_complementarity),
        );
        add("pose_score", json!(score.pose_score()));
        add("search_score", json!(score.search_score));
        for effect in Effect::ALL {
            add(effect.name(), json!(score.effects[effect as usize]));
        }
        for term in POSE_TERMS.iter().filter(|term| term.is_shown_always) {
            add(term.id, json!(score.pose_terms.get(term.id)));
        }
        columns
    }
}

/// The rows as JSON objects, each with its pairs of residues.
pub fn objects(rows: &[InterfaceRow]) -> Vec<Value> {
    let object = |row: &InterfaceRow| {
        let mut object = row.columns();
        object.insert("pairs".to_owned(), json!(row.interface.pairs));
        Value::Object(object)
    };
    rows.iter().map(object).collect()
}

/// Writes a row for each complex.
pub fn write_rows(stream: &mut dyn io::Write, rows: &[InterfaceRow]) -> io::Result<()> {
    let mut table = TableWriter::new(stream);
    if let Some(first) = rows.first() {
        table.row(first.columns().keys())?;
    }
    for row in rows {
        table.row(row.columns().values().map(field))?;
    }
    table.flush()
}

fn pair_columns<'a>() -> [Column<(&'a InterfaceRow, &'a Contact<ResidueName>)>; 12] {
    [
        ("file", |(row, _)| json!(row.file)),
        ("model", |(row, _)| json!(row.model)),
        ("chain_1", |(_, pair)| json!(pair.residues[0].chain)),
        ("residue_1", |(_, pair)| json!(pair.residues[0].number)),
        ("name_1", |(_, pair)| json!(pair.residues[0].name)),
        ("chain_2", |(_, pair)| json!(pair.residues[1].chain)),
        ("residue_2", |(_, pair)| json!(pair.residues[1].number)),
        ("name_2", |(_, pair)| json!(pair.residues[1].name)),
        ("distance", |(_, pair)| json!(pair.distance)),
        ("hydrogen_bonds", |(_, pair)| json!(pair.hydrogen_bonds)),
        ("hydrogen_bond_distance", |(_, pair)| {
            json!(pair.hydrogen_bond_distance)
        }),
        ("salt_bridge", |(_, pair)| json!(pair.salt_bridge)),
    ]
}

pub fn write_pairs(stream: &mut dyn io::Write, rows: &[InterfaceRow]) -> io::Result<()> {
    let pairs = rows
        .iter()
        .flat_map(|row| row.interface.pairs.iter().map(move |pair| (row, pair)));
    write_table(stream, &pair_columns(), pairs)
}
