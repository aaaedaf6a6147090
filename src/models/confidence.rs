//! Confidence of a predicted model, read from the files that its program wrote.
//!
//! Entries are found by their names, whichever file they are in, so that one reader serves all programs:
//!
//! - PAE: `pae` (AlphaFold 3, ColabFold, Boltz), `token_pair_pae` (Protenix), `predicted_aligned_error`.
//! - Tokens: `token_chain_ids`, `token_res_ids` (AlphaFold 3).
//! - pLDDT: `atom_plddts` (AlphaFold 3), `atom_plddt` (Protenix), `plddt` (ColabFold, Boltz).
//! - ipTM of pairs of chains: `chain_pair_iptm` (AlphaFold 3, Protenix), `pair_chains_iptm` (Boltz), `pairwise_iptm`
//!   (ColabFold), `per_chain_pair_iptm` (Chai).
//! - Of the whole: `iptm`, `ptm`, and by which the program ranks `ranking_score`, `confidence_score` (Boltz),
//!   `aggregate_score` (Chai).
//!
//! # Conventions
//!
//! PAE is row-major: row i is aligned, column j is scored. pLDDT is from 0 to 100; values from 0 to 1 are multiplied.

use std::collections::BTreeMap;
use std::fmt;
use std::io::Read;
use std::path::Path;

use flate2::bufread::MultiGzDecoder;
use knotdock_structures::Error;
use serde::Deserialize;
use serde::de::{Deserializer, SeqAccess, Visitor};

use super::numpy::{Array, MAX_VALUES, NPY, NPZ, read_npy, read_npz};
use crate::bounded_read::read_bounded;

/// Most bytes of a confidence file, packed or not: the largest has two numbers for each pair of 10,000 tokens.
const MAX_FILE: u64 = 2 << 30;
/// Largest PAE that is possible, in Å; programs stop at about 32.
const MAX_PAE: f32 = 1000.0;

/// A square matrix of predicted aligned errors.
#[derive(Clone, Debug, PartialEq)]
pub struct Pae {
    /// Tokens: rows, and columns.
    pub tokens: usize,
    /// Errors in Å, (tokens, tokens), row-major: row i is aligned, column j is scored.
    pub values: Vec<f32>,
}

impl Pae {
    /// The errors of all tokens if one is aligned, in Å.
    pub fn row(&self, aligned: usize) -> &[f32] {
        let row = self.values.chunks_exact(self.tokens.max(1)).nth(aligned);
        row.unwrap_or_default()
    }
}

/// ipTM of pairs of chains.
#[derive(Clone, Debug, PartialEq)]
pub enum ChainPairIptm {
    /// By the places of both chains in the structure.
    Matrix(Vec<Vec<Option<f64>>>),
    /// By the names of both, as `A-B`.
    Named(BTreeMap<String, f64>),
}

/// Confidence of one model; each part is `None` if no file has it.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Confidence {
    /// Predicted aligned errors of tokens.
    pub pae: Option<Pae>,
    /// Chain of each token.
    pub token_chains: Option<Vec<String>>,
    /// Residue number of each token, by the author.
    pub token_residues: Option<Vec<i64>>,
    /// pLDDT, 0 to 100, of each atom, token or residue.
    pub plddt: Option<Vec<f32>>,
    /// ipTM of pairs of chains, 0 to 1.
    pub chain_pair_iptm: Option<ChainPairIptm>,
    /// ipTM of the whole, 0 to 1.
    pub iptm: Option<f64>,
    /// pTM of the whole, 0 to 1.
    pub ptm: Option<f64>,
    /// Score by which the program ranks its models.
    pub ranking_score: Option<f64>,
}

impl Confidence {
    /// Reads the files of one model. Where two have the same entry, that of the later file counts.
    ///
    /// # Errors
    /// [`Error`] with the file for one that cannot be read, has none of the entries, or has numbers that cannot be.
    pub fn read<'a>(files: impl IntoIterator<Item = &'a Path>) -> Result<Self, Error> {
        let mut all = Self::default();
        for file in files {
            let bytes = read_bounded(file, MAX_FILE).map_err(|error| {
                Error::input(format!("the confidences cannot be read: {error}"))
                    .at(file)
                    .help("check the path and the permissions of the file")
            })?;
            all.add(Self::parse(bytes).map_err(|error| error.at(file))?);
        }
        Ok(all)
    }

    /// Reads the content of a file: JSON, which may be packed by gzip, `.npz` or `.npy`.
    ///
    /// # Errors
    /// As [`Confidence::read`], without the file.
    pub fn parse(mut bytes: Vec<u8>) -> Result<Self, Error> {
        if bytes.starts_with(&[0x1f, 0x8b]) {
            let mut unpacked = Vec::new();
            let stream = MultiGzDecoder::new(bytes.as_slice()).take(MAX_FILE + 1);
            { stream }.read_to_end(&mut unpacked).map_err(|error| {
                Error::input(format!("the gzip data cannot be unpacked: {error}"))
                    .help("fetch the file again")
            })?;
            if unpacked.len() as u64 > MAX_FILE {
                return Err(Error::input("it has more than 2 GB once unpacked").help(AS_WRITTEN));
            }
            bytes = unpacked;
        }
        let found = match bytes.as_slice() {
            bytes if bytes.starts_with(NPZ) => Self::of_arrays(read_npz(bytes, &ARRAYS)?)?,
            bytes if bytes.starts_with(NPY) => {
                Self::of_arrays(vec![("pae".to_owned(), read_npy(bytes)?)])?
            }
            bytes => Self::of_json(bytes)?,
        };
        found.checked()
    }

    fn add(&mut self, later: Self) {
        fn replace<T>(old: &mut Option<T>, new: Option<T>) {
            if new.is_some() {
                *old = new;
            }
        }
        replace(&mut self.pae, later.pae);
        replace(&mut self.token_chains, later.token_chains);
        replace(&mut self.token_residues, later.token_residues);
        replace(&mut self.plddt, later.plddt);
        replace(&mut self.chain_pair_iptm, later.chain_pair_iptm);
        replace(&mut self.iptm, later.iptm);
        replace(&mut self.ptm, later.ptm);
        replace(&mut self.ranking_score, later.ranking_score);
    }

    fn of_json(bytes: &[u8]) -> Result<Self, Error> {
        let written: Written = serde_json::from_slice(bytes).map_err(|error| {
            let line = error.line() as u64;
            Error::input(format!("these are no confidences of a model: {error}"))
                .on_line((line > 0).then_some(line))
                .help(AS_WRITTEN)
        })?;
        let matrix = written.chain_pair_iptm.map(ChainPairIptm::Matrix);
        let places = written.pair_chains_iptm.map(by_place).transpose()?;
        let named = written.pairwise_iptm.map(ChainPairIptm::Named);
        Ok(Self {
            pae: written.pae,
            token_chains: written.token_chain_ids,
            token_residues: written.token_res_ids,
            plddt: written.atom_plddts.or(written.plddt.and_then(|one| one.0)),
            chain_pair_iptm: matrix.or(places).or(named),
            iptm: written.iptm,
            ptm: written.ptm,
            ranking_score: written.ranking_score,
        })
    }

    fn of_arrays(arrays: Vec<(String, Array)>) -> Result<Self, Error> {
        let mut found = Self::default();
        for (name, array) in arrays {
            let single = || array.values.first().map(|&value| f64::from(value));
            match name.as_str() {
                "pae" => found.pae = Some(pae_of(array)?),
                "plddt" => found.plddt = Some(array.values),
                "iptm" => found.iptm = single(),
                "ptm" => found.ptm = single(),
                "aggregate_score" => found.ranking_score = single(),
                "per_chain_pair_iptm" => {
                    let chains = array.shape.last().copied().unwrap_or(0);
                    if chains == 0 || array.values.len() != chains * chains {
                        return Err(not_square("ipTM", &array.shape));
                    }
                    let rows = array.values.chunks(chains);
                    let defined = |&value: &f32| (!value.is_nan()).then_some(f64::from(value));
                    let rows = rows.map(|row| row.iter().map(defined).collect());
                    found.chain_pair_iptm = Some(ChainPairIptm::Matrix(rows.collect()));
                }
                _ => (),
            }
        }
        Ok(found)
    }

    /// The same with pLDDT from 0 to 100, if all numbers are possible.
    fn checked(mut self) -> Result<Self, Error> {
        let Self { pae, plddt, .. } = &mut self;
        if let Some(pae) = pae {
            let wrong = pae
                .values
                .iter()
                .position(|value| !(0.0..=MAX_PAE).contains(value));
            if let Some(at) = wrong {
                return Err(Error::input(format!(
                    "the PAE of tokens {} and {} is {}; it must be a number in Å from 0 up",
                    at / pae.tokens + 1,
                    at % pae.tokens + 1,
                    pae.values[at]
                ))
                .help(AS_WRITTEN));
            }
        }
        if let Some(plddt) = plddt {
            if let Some(wrong) = plddt.iter().find(|value| !(0.0..=100.0).contains(*value)) {
                return Err(Error::input(format!(
                    "a pLDDT is {wrong}; it must be a number from 0 to 100"
                ))
                .help(AS_WRITTEN));
            }
            if plddt.iter().all(|&value| value <= 1.0) {
                plddt.iter_mut().for_each(|value| *value *= 100.0);
            }
        }
        let pairs: Vec<f64> = match &self.chain_pair_iptm {
            Some(ChainPairIptm::Matrix(rows)) => {
                if rows.iter().any(|row| row.len() != rows.len()) {
                    let columns = rows.iter().map(Vec::len).max().unwrap_or(0);
                    return Err(not_square("ipTM", &[rows.len(), columns]));
                }
                rows.iter().flatten().copied().flatten().collect()
            }
            Some(ChainPairIptm::Named(pairs)) => pairs.values().copied().collect(),
            None => Vec::new(),
        };
        let mut shares = pairs.iter().chain(&self.iptm).chain(&self.ptm);
        if let Some(wrong) = shares.find(|value| !(0.0..=1.0).contains(*value)) {
            return Err(Error::input(format!(
                "an ipTM or pTM is {wrong}; it must be a number from 0 to 1"
            ))
            .help(AS_WRITTEN));
        }
        match self == Self::default() {
            true => Err(Error::input("it has no PAE, pLDDT, ipTM or pTM").help(AS_WRITTEN)),
            false => Ok(self),
        }
    }
}

/// Remedy for a file with other content.
const AS_WRITTEN: &str = "give the file as AlphaFold 3, Boltz, ColabFold, Chai or Protenix wrote it; NaN and null are refused";

/// The arrays that are read of a `.npz` file.
const ARRAYS: [&str; 6] = [
    "pae",
    "plddt",
    "iptm",
    "ptm",
    "aggregate_score",
    "per_chain_pair_iptm",
];

fn not_square(kind: &str, shape: &[usize]) -> Error {
    Error::input(format!("the {kind} is not square: its shape is {shape:?}")).help(AS_WRITTEN)
}

/// The PAE of an array of the shape (tokens, tokens) or (1, tokens, tokens).
fn pae_of(array: Array) -> Result<Pae, Error> {
    match array.shape.as_slice() {
        &[rows, columns] | &[1, rows, columns] if rows == columns && rows > 0 => Ok(Pae {
            tokens: rows,
            values: array.values,
        }),
        shape => Err(not_square("PAE", shape)),
    }
}

/// A matrix of Boltz, whose rows and columns are numbered by text: `{"0": {"0": 0.9, "1": 0.4}, ...}`.
fn by_place(rows: BTreeMap<String, BTreeMap<String, Option<f64>>>) -> Result<ChainPairIptm, Error> {
    let chains = rows.len().min(MAX_CHAINS);
    let mut matrix = vec![vec![None; chains]; chains];
    for (row, columns) in &rows {
        for (column, value) in columns {
            let places = row.parse::<usize>().ok().zip(column.parse::<usize>().ok());
            let place = places.and_then(|(row, column)| matrix.get_mut(row)?.get_mut(column));
            let unknown =
                || Error::input("the ipTM of chains is not numbered from 0").help(AS_WRITTEN);
            *place.ok_or_else(unknown)? = *value;
        }
    }
    Ok(ChainPairIptm::Matrix(matrix))
}

/// Most chains of a model.
const MAX_CHAINS: usize = 1_000;

/// The entries of a JSON file; all others are skipped unread.
#[derive(Deserialize, Default)]
#[serde(default)]
struct Written {
    #[serde(
        alias = "token_pair_pae",
        alias = "predicted_aligned_error",
        deserialize_with = "square"
    )]
    pae: Option<Pae>,
    token_chain_ids: Option<Vec<String>>,
    token_res_ids: Option<Vec<i64>>,
    #[serde(alias = "atom_plddt")]
    atom_plddts: Option<Vec<f32>>,
    plddt: Option<ListOnly>,
    chain_pair_iptm: Option<Vec<Vec<Option<f64>>>>,
    pair_chains_iptm: Option<BTreeMap<String, BTreeMap<String, Option<f64>>>>,
    pairwise_iptm: Option<BTreeMap<String, f64>>,
    iptm: Option<f64>,
    ptm: Option<f64>,
    #[serde(alias = "confidence_score", alias = "aggregate_score")]
    ranking_score: Option<f64>,
}

/// A list of numbers; Protenix has a single number, the mean, under the same name.
struct ListOnly(Option<Vec<f32>>);

impl<'de> Deserialize<'de> for ListOnly {
    fn deserialize<D: Deserializer<'de>>(from: D) -> Result<Self, D::Error> {
        struct ListVisitor;
        impl<'de> Visitor<'de> for ListVisitor {
            type Value = ListOnly;
            fn expecting(&self, f: &mut fmt::Formatter) -> fmt::Result {
                f.write_str("a number or a list of numbers")
            }
            fn visit_f64<E>(self, _: f64) -> Result<ListOnly, E> {
                Ok(ListOnly(None))
            }
            fn visit_u64<E>(self, _: u64) -> Result<ListOnly, E> {
                Ok(ListOnly(None))
            }
            fn visit_seq<A: SeqAccess<'de>>(self, mut list: A) -> Result<ListOnly, A::Error> {
                let mut values = Vec::new();
                while let Some(value) = list.next_element()? {
                    values.push(value);
                }
                Ok(ListOnly(Some(values)))
            }
        }
        from.deserialize_any(ListVisitor)
    }
}

/// Reads a square matrix row by row into one list: a value for each of 25 million numbers would not fit into memory.
fn square<'de, D: Deserializer<'de>>(from: D) -> Result<Option<Pae>, D::Error> {
    struct Rows;
    impl<'de> Visitor<'de> for Rows {
        type Value = Option<Pae>;
        fn expecting(&self, f: &mut fmt::Formatter) -> fmt::Result {
            f.write_str("a square matrix of numbers")
        }
        fn visit_seq<A: SeqAccess<'de>>(self, mut rows: A) -> Result<Option<Pae>, A::Error> {
            use serde::de::Error;
            let mut values: Vec<f32> = Vec::new();
            let (mut count, mut tokens) = (0, 0);
            while rows.next_element_seed(Row(&mut values))?.is_some() {
                if count == 0 {
                    tokens = values.len();
                    if tokens * tokens > MAX_VALUES {
                        let message = format!("the PAE has more than {MAX_VALUES} values");
                        return Err(A::Error::custom(message));
                    }
                    values.reserve_exact(tokens * tokens - tokens);
                }
                count += 1;
                if values.len() != count * tokens || count > tokens {
                    let message = format!(
                        "the PAE is not square: row {count} has {} values, the first has {tokens}",
                        values.len() + tokens - count * tokens
                    );
                    return Err(A::Error::custom(message));
                }
            }
            if count != tokens || tokens == 0 {
                let message = format!("the PAE is not square: it has {count} rows of {tokens}");
                return Err(A::Error::custom(message));
            }
            Ok(Some(Pae { tokens, values }))
        }
        fn visit_unit<E>(self) -> Result<Option<Pae>, E> {
            Ok(None)
        }
    }
    from.deserialize_any(Rows)
}

/// A row of numbers that is added to a list.
struct Row<'a>(&'a mut Vec<f32>);

impl<'de> serde::de::DeserializeSeed<'de> for Row<'_> {
    type Value = ();
    fn deserialize<D: Deserializer<'de>>(self, from: D) -> Result<(), D::Error> {
        from.deserialize_seq(self)
    }
}

impl<'de> Visitor<'de> for Row<'_> {
    type Value = ();
    fn expecting(&self, f: &mut fmt::Formatter) -> fmt::Result {
        f.write_str("a row of numbers")
    }
    fn visit_seq<A: SeqAccess<'de>>(self, mut row: A) -> Result<(), A::Error> {
        while let Some(value) = row.next_element()? {
            if self.0.len() >= MAX_VALUES {
                let message = format!("the PAE has more than {MAX_VALUES} values");
                return Err(serde::de::Error::custom(message));
            }
            self.0.push(value);
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::super::numpy::tests::{npy, npz};
    use super::*;

    fn json(text: &str) -> Result<Confidence, Error> {
        Confidence::parse(text.as_bytes().to_vec())
    }

    /// The entries of each program's files, as its source writes them.
    #[test]
    fn entries_of_each_program_are_read() {
        let pae = Pae {
            tokens: 2,
            values: vec![0.5, 9.0, 8.0, 0.25],
        };
        let af3 = json(
            r#"{"atom_plddts": [90.5, 50], "contact_probs": [[1, 0], [0, 1]], "pae": [[0.5, 9], [8, 0.25]],
               "token_chain_ids": ["X", "X2"], "token_res_ids": [1, -1]}"#,
        )
        .unwrap();
        assert_eq!(af3.pae.as_ref(), Some(&pae));
        assert_eq!(af3.token_chains.unwrap(), ["X", "X2"]);
        assert_eq!(
            (af3.token_residues, af3.plddt),
            (Some(vec![1, -1]), Some(vec![90.5, 50.0]))
        );
        let summary = json(
            r#"{"chain_pair_iptm": [[0.9, null], [0.4, 0.8]], "iptm": 0.5, "ptm": 0.6, "ranking_score": -99.0}"#,
        )
        .unwrap();
        let matrix = vec![vec![Some(0.9), None], vec![Some(0.4), Some(0.8)]];
        assert_eq!(summary.chain_pair_iptm, Some(ChainPairIptm::Matrix(matrix)));
        assert_eq!((summary.iptm, summary.ptm), (Some(0.5), Some(0.6)));
        let protenix = json(
            r#"{"plddt": 93.0, "token_pair_pae": [[0.5, 9], [8, 0.25]], "atom_plddt": [0.5, 1]}"#,
        );
        let protenix = protenix.unwrap();
        assert_eq!(
            (protenix.pae, protenix.plddt),
            (Some(pae.clone()), Some(vec![50.0, 100.0]))
        );
        let colabfold =
            json(r#"{"plddt": [90, 0.5], "max_pae": 31.75, "pairwise_iptm": {"A-B": 0.25}}"#);
        let colabfold = colabfold.unwrap();
        assert_eq!(colabfold.plddt, Some(vec![90.0, 0.5]));
        let named = BTreeMap::from([("A-B".to_owned(), 0.25)]);
        assert_eq!(colabfold.chain_pair_iptm, Some(ChainPairIptm::Named(named)));
        let boltz = json(
            r#"{"confidence_score": 0.7, "pair_chains_iptm": {"0": {"0": 0.9, "1": 0.3}, "1": {"1": 0.8, "0": 0.4}}}"#,
        )
        .unwrap();
        let matrix = vec![vec![Some(0.9), Some(0.3)], vec![Some(0.4), Some(0.8)]];
        assert_eq!(boltz.chain_pair_iptm, Some(ChainPairIptm::Matrix(matrix)));
        assert_eq!(boltz.ranking_score, Some(0.7));
        let scores = Confidence::parse(npz(&[
            ("aggregate_score", npy("(1,)", &[0.75])),
            ("iptm", npy("(1,)", &[0.5])),
            (
                "per_chain_pair_iptm",
                npy("(1, 2, 2)", &[0.5, f32::NAN, 0.25, 1.0]),
            ),
        ]))
        .unwrap();
        assert_eq!((scores.ranking_score, scores.iptm), (Some(0.75), Some(0.5)));
        let matrix = vec![vec![Some(0.5), None], vec![Some(0.25), Some(1.0)]];
        assert_eq!(scores.chain_pair_iptm, Some(ChainPairIptm::Matrix(matrix)));
        for file in [
            npz(&[("pae", npy("(2, 2)", &pae.values))]),
            npy("(1, 2, 2)", &pae.values),
        ] {
            assert_eq!(Confidence::parse(file).unwrap().pae.as_ref(), Some(&pae));
        }
    }

    #[test]
    fn wrong_numbers_are_refused() {
        for (text, part) in [
            (
                r#"{"pae": [[1, 2], [3]]}"#,
                "not square: row 2 has 1 values",
            ),
            (
                r#"{"pae": [[1, 2], [3, 4], [5, 6]]}"#,
                "not square: row 3 has 2",
            ),
            (r#"{"pae": [[1, 2]]}"#, "not square: it has 1 rows of 2"),
            (r#"{"pae": []}"#, "not square"),
            (r#"{"pae": [[]]}"#, "not square"),
            (r#"{"pae": [[NaN]]}"#, "no confidences of a model"),
            (r#"{"pae": [[null]]}"#, "no confidences of a model"),
            (r#"{"pae": [[-1]]}"#, "the PAE of tokens 1 and 1 is -1"),
            (r#"{"plddt": [101]}"#, "a pLDDT is 101"),
            (r#"{"iptm": 1.5}"#, "an ipTM or pTM is 1.5"),
            (
                r#"{"chain_pair_iptm": [[1], [1]]}"#,
                "the ipTM is not square",
            ),
            (
                r#"{"pair_chains_iptm": {"A": {"B": 1}}}"#,
                "not numbered from 0",
            ),
            (r#"{"name": "x"}"#, "no PAE, pLDDT, ipTM or pTM"),
            ("[1]", "no confidences of a model"),
            ("", "no confidences of a model"),
        ] {
            let error = json(text).unwrap_err();
            assert!(error.message().contains(part), "{text}: {error}");
            assert!(error.remedy().is_some());
        }
        let nan = npz(&[("pae", npy("(1, 1)", &[f32::NAN]))]);
        assert!(
            Confidence::parse(nan)
                .unwrap_err()
                .message()
                .contains("is NaN")
        );
        let oblong = npz(&[("pae", npy("(1, 2)", &[1.0, 2.0]))]);
        let error = Confidence::parse(oblong).unwrap_err();
        assert!(
            error.message().contains("not square: its shape is [1, 2]"),
            "{error}"
        );
    }
}
