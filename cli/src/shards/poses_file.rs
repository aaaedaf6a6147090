//! The file of poses: text packed by gzip, one member per pair, with the same columns for all pairs. All readers of
//! gzip take the members as one text.
//!
//! CSV packed by gzip was chosen over Parquet: the crates `parquet` and `arrow` would double the dependencies of the
//! program, and a Parquet file ends in an index, so nothing can be appended. Members of gzip can be appended, cut and
//! put in another order without being unpacked.

use std::fs::File;
use std::io::{self, BufRead, BufReader, Read, Seek, SeekFrom, Write};

use csv::StringRecord;
use flate2::Compression;
use flate2::bufread::GzDecoder;
use flate2::write::GzEncoder;

use knotdock::output::files::folder::next_line;
use knotdock::output::tables::fields::Column;
use knotdock::output::tables::quality::OF_COMPLEXES;
use knotdock::output::tables::run_table::RunTable;
use knotdock::table_text::cells::TableWriter;

/// Most bytes of a member's text.
const MAX_TEXT: u64 = 64 << 20;

/// Text as a member: the same bytes for the same text.
fn packed(text: &[u8]) -> io::Result<Vec<u8>> {
    if text.len() as u64 > MAX_TEXT {
        return Err(too_large());
    }
    let mut encoder = GzEncoder::new(Vec::new(), Compression::default());
    encoder.write_all(text)?;
    encoder.finish()
}

#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct Member {
    /// Its start and that of the next one, in bytes.
    pub range: (u64, u64),
    /// Its first line, without the line end.
    pub first_line: Vec<u8>,
}

pub(super) struct Members {
    file: BufReader<File>,
}

impl Members {
    pub fn of(file: File) -> Self {
        Self {
            file: BufReader::with_capacity(1 << 16, file),
        }
    }

    /// The next member; `None` where the file ends or what follows is no whole member.
    pub fn next(&mut self) -> io::Result<Option<Member>> {
        let start = self.file.stream_position()?;
        if self.file.fill_buf()?.is_empty() {
            return Ok(None);
        }
        let mut text = BufReader::new(GzDecoder::new(&mut self.file).take(MAX_TEXT + 1));
        let mut first_line = Vec::new();
        let read = next_line(&mut text, &mut first_line)
            .and_then(|_| io::copy(&mut text, &mut io::sink()));
        match read {
            Ok(_) if text.get_ref().limit() == 0 => return Err(too_large()),
            Ok(_) => {}
            Err(error)
                if matches!(
                    error.kind(),
                    io::ErrorKind::UnexpectedEof
                        | io::ErrorKind::InvalidInput
                        | io::ErrorKind::InvalidData
                ) =>
            {
                return Ok(None);
            }
            Err(error) => return Err(error),
        }
        Ok(Some(Member {
            range: (start, self.file.stream_position()?),
            first_line,
        }))
    }
}

fn too_large() -> io::Error {
    io::Error::new(
        io::ErrorKind::FileTooLarge,
        "the poses of a pair have more than 64 MB of text",
    )
}

pub(super) fn copy_range(
    file: &mut File,
    (start, end): (u64, u64),
    to: &mut dyn Write,
) -> io::Result<()> {
    file.seek(SeekFrom::Start(start))?;
    let copied = io::copy(&mut file.take(end - start), to)?;
    if copied < end - start {
        return Err(io::ErrorKind::UnexpectedEof.into());
    }
    Ok(())
}

/// Columns that some runs add to their tables, in this order. Each is empty where a pair has none of it.
pub const WIDE_COLUMNS: [&str; 8] = [
    "restraints_met",
    "irmsd",
    "lrmsd",
    "fnat",
    "dockq",
    "capri",
    OF_COMPLEXES[0],
    OF_COMPLEXES[1],
];

/// A pair's poses as a member of the file: each row is the pair's name and a row of its `poses.csv`.
#[derive(Clone, Debug)]
pub struct PosesOfPair(Vec<u8>);

impl PosesOfPair {
    /// The first `count` rows of a table by [`RunTable::wide`].
    pub fn new(name: &str, table: &RunTable, count: usize) -> io::Result<Self> {
        member(table.records().take(count), name).map(Self)
    }

    pub(super) fn bytes(&self) -> &[u8] {
        &self.0
    }
}

/// The first member: the names of the columns.
pub(super) fn header() -> io::Result<Vec<u8>> {
    let further = WIDE_COLUMNS.map(|name| Column {
        name: name.to_owned(),
        fields: Vec::new(),
    });
    member([RunTable::wide(&[], &further).header()], "name")
}

/// Rows as a member, each behind the same first field.
fn member(rows: impl IntoIterator<Item = StringRecord>, first: &str) -> io::Result<Vec<u8>> {
    let mut text = Vec::new();
    let mut table = TableWriter::new(&mut text);
    for row in rows {
        table.row(std::iter::once(first).chain(&row))?;
    }
    table.flush()?;
    drop(table);
    packed(&text)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn all(path: &std::path::Path) -> Vec<Member> {
        let mut members = Members::of(File::open(path).unwrap());
        std::iter::from_fn(|| members.next().unwrap()).collect()
    }

    /// A file that is cut or damaged anywhere has the members before that place.
    #[test]
    fn members_end_where_the_file_is_whole_no_more() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("poses.csv.gz");
        let texts = ["name,rank\n", "a,1\na,2\n", "b,1\n"];
        let packed: Vec<Vec<u8>> = texts
            .iter()
            .map(|text| packed(text.as_bytes()).unwrap())
            .collect();
        let whole = packed.concat();
        std::fs::write(&path, &whole).unwrap();
        let found = all(&path);
        let lines: Vec<&[u8]> = found
            .iter()
            .map(|member| member.first_line.as_slice())
            .collect();
        assert_eq!(lines, [b"name,rank".as_slice(), b"a,1", b"b,1"]);
        assert_eq!(found[2].range.1, whole.len() as u64);
        let mut text = String::new();
        let mut joined = flate2::read::MultiGzDecoder::new(whole.as_slice());
        joined.read_to_string(&mut text).unwrap();
        assert_eq!(text, texts.concat());
        let ends: Vec<usize> = found.iter().map(|member| member.range.1 as usize).collect();
        for length in 0..whole.len() {
            std::fs::write(&path, &whole[..length]).unwrap();
            let expected = ends.iter().filter(|end| **end <= length).count();
            assert_eq!(all(&path).len(), expected, "{length}");
        }
        let mut damaged = whole.clone();
        damaged[ends[0] + 15] ^= 0x55;
        std::fs::write(&path, &damaged).unwrap();
        assert_eq!(all(&path).len(), 1);
    }
}
