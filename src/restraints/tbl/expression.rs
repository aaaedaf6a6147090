//! Selections of atoms, between the parentheses of an assign statement.
//!
//! ```text
//! selection = "(" any-of ")"
//! any-of    = all-of { "or" all-of }
//! all-of    = factor { "and" factor }
//! factor    = "not" factor | "(" any-of ")" | test
//! test      = "all" | "hydrogen" | "segid" NAME | "chain" NAME | "resname" NAME | "name" NAME
//!           | "resid" NAME | "resid" NUMBER ":" NUMBER | "atom" NAME NAME NAME
//! ```
//!
//! So `not` binds most and `or` least, as in CNS. `atom` has a chain, a residue and a name of an atom. Names may have
//! wildcards unless they are in quotes.

use std::collections::{BTreeMap, BTreeSet};

use knotdock_structures::Error;

use crate::restraints::tbl::atom_index::{AtomIndex, ResidueNumber};
use crate::restraints::tbl::name_pattern::NamePattern;
use crate::restraints::tbl::tokens::{Place, Token, Tokens, unexpected};
use crate::table_text::named_columns::shortened;

/// Most parentheses and `not` within each other: a recursion without a bound would run out of stack.
const MAX_DEPTH: usize = 100;

/// A selection of atoms.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) enum Expression {
    All,
    Hydrogen,
    Chain(NamePattern),
    ResidueName(NamePattern),
    Residue(ResidueTest),
    Name(NamePattern),
    Not(Box<Expression>),
    And(Vec<Expression>),
    Or(Vec<Expression>),
}

/// Which residues are meant by their numbers.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) enum ResidueTest {
    /// One number without an insertion code.
    Number(i64),
    /// Number and insertion code as one text.
    Text(NamePattern),
    /// From one to another, each with its insertion code: none comes before `A`.
    Range([ResidueNumber; 2]),
}

/// What tests of `name` and `hydrogen` are applied to.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Tested {
    /// Each atom.
    Atoms,
    /// Of each atom the hydrogens that it may carry, one of which is enough.
    Hydrogens,
    /// Each atom, whatever its name.
    Residues,
}

impl Expression {
    /// Whether each atom is selected.
    pub(super) fn select(&self, index: &AtomIndex, tested: Tested) -> Vec<bool> {
        let named = |pattern: &NamePattern, names: &BTreeMap<&str, Vec<usize>>| {
            let names = names.iter().filter(|(name, _)| pattern.holds(name));
            index.at(names.map(|(_, places)| places))
        };
        let all = || vec![true; index.atoms.len()];
        match self {
            Self::All => all(),
            Self::Hydrogen if tested == Tested::Hydrogens => all(),
            Self::Hydrogen => index.atoms.iter().map(|atom| atom.is_hydrogen()).collect(),
            Self::Chain(pattern) => named(pattern, &index.chains),
            Self::ResidueName(pattern) => named(pattern, &index.residue_names),
            Self::Residue(test) => test.select(index),
            Self::Name(pattern) => match tested {
                Tested::Atoms => named(pattern, &index.names),
                Tested::Residues => all(),
                Tested::Hydrogens => {
                    let holds = |names: &[String]| names.iter().any(|name| pattern.holds(name));
                    let names = index.hydrogens.iter().zip(index.names.values());
                    let names = names.filter(|((_, hydrogens), _)| holds(hydrogens));
                    index.at(names.map(|(_, places)| places))
                }
            },
            Self::Not(inner) => {
                let mut chosen = inner.select(index, tested);
                chosen.iter_mut().for_each(|chosen| *chosen = !*chosen);
                chosen
            }
            Self::And(parts) => combined(parts, |part| part.select(index, tested), |a, b| a & b),
            Self::Or(parts) => combined(parts, |part| part.select(index, tested), |a, b| a | b),
        }
    }
}

/// The sets of at least one part, combined atom by atom.
fn combined(
    parts: &[Expression],
    select: impl Fn(&Expression) -> Vec<bool>,
    combine: fn(bool, bool) -> bool,
) -> Vec<bool> {
    let mut chosen = Vec::new();
    for (place, part) in parts.iter().enumerate() {
        let of_part = select(part);
        if place == 0 {
            chosen = of_part;
        } else {
            for (chosen, other) in chosen.iter_mut().zip(of_part) {
                *chosen = combine(*chosen, other);
            }
        }
    }
    chosen
}

impl ResidueTest {
    fn select(&self, index: &AtomIndex) -> Vec<bool> {
        let residues = &index.residues;
        match self {
            Self::Number(number) => {
                let residue = residues.get(&(*number, None)).into_iter();
                index.at(residue.map(|(_, places)| places))
            }
            Self::Text(pattern) => {
                let residues = residues.values().filter(|(text, _)| pattern.holds(text));
                index.at(residues.map(|(_, places)| places))
            }
            Self::Range([first, last]) => {
                let residues = residues.range(*first..=*last);
                index.at(residues.map(|(_, (_, places))| places))
            }
        }
    }
}

/// Reads the selections of a file.
pub(super) struct Selections<'a> {
    pub(super) tokens: Tokens<'a>,
    /// Names of the chains that there are.
    chains: BTreeSet<&'a str>,
}

impl<'a> Selections<'a> {
    pub(super) fn new(text: &'a str, chains: BTreeSet<&'a str>) -> Self {
        Self {
            tokens: Tokens::new(text),
            chains,
        }
    }

    /// The next token, which must be there.
    pub(super) fn need(&mut self, expected: &'static str) -> Result<(Token<'a>, Place), Error> {
        let end = self.tokens.place();
        self.tokens
            .next()?
            .ok_or_else(|| end.fault(unexpected(expected, "the end of the file")))
    }

    /// The selection that follows, and the place of its parenthesis.
    pub(super) fn selection(&mut self) -> Result<(Expression, Place), Error> {
        const EXPECTED: &str = "a selection in parentheses";
        match self.need(EXPECTED)? {
            (Token::Open, place) => {
                let expression = self.any_of(1, place)?;
                Ok((expression, place))
            }
            (token, place) => Err(place.fault(unexpected(EXPECTED, &token.shown()))),
        }
    }

    /// The expression between parentheses, and the one that closes.
    fn any_of(&mut self, depth: usize, open: Place) -> Result<Expression, Error> {
        if depth > MAX_DEPTH {
            return Err(open.fault(too_deep()));
        }
        // Alternatives, each as what must hold at once.
        let mut alternatives = Vec::new();
        let mut all_of = vec![self.factor(depth)?];
        loop {
            let expected = "`and`, `or` or `)`";
            let (token, place) = self.need(expected)?;
            if token.is_keyword("and") {
                all_of.push(self.factor(depth)?);
            } else if token.is_keyword("or") {
                let next = vec![self.factor(depth)?];
                alternatives.push(joined(
                    std::mem::replace(&mut all_of, next),
                    Expression::And,
                ));
            } else if token == Token::Close {
                alternatives.push(joined(all_of, Expression::And));
                return Ok(joined(alternatives, Expression::Or));
            } else {
                return Err(place.fault(unexpected(expected, &token.shown())));
            }
        }
    }

    fn factor(&mut self, depth: usize) -> Result<Expression, Error> {
        let expected = "a test such as `resid 10`";
        let (token, place) = self.need(expected)?;
        if token == Token::Open {
            return self.any_of(depth + 1, place);
        }
        if token.is_keyword("not") {
            if depth >= MAX_DEPTH {
                return Err(place.fault(too_deep()));
            }
            return Ok(Expression::Not(Box::new(self.factor(depth + 1)?)));
        }
        if token.is_keyword("all") {
            return Ok(Expression::All);
        }
        if token.is_keyword("hydrogen") {
            return Ok(Expression::Hydrogen);
        }
        if token.is_keyword("segid") || token.is_keyword("chain") {
            return self.chain();
        }
        if token.is_keyword("residue") {
            return self.residue(true);
        }
        if token.is_keyword("resname") {
            return Ok(Expression::ResidueName(self.name("the name of a residue")?));
        }
        if token.is_keyword("name") {
            return Ok(Expression::Name(self.name("the name of an atom")?));
        }
        if token.is_keyword("atom") {
            let tests = vec![
                self.chain()?,
                self.residue(false)?,
                Expression::Name(self.name("the name of an atom")?),
            ];
            return Ok(Expression::And(tests));
        }
        Err(place.fault(unexpected(expected, &token.shown())))
    }

    /// A name that follows.
    fn name(&mut self, expected: &'static str) -> Result<NamePattern, Error> {
        match self.need(expected)? {
            (Token::Word(word), _) => Ok(NamePattern::new(word)),
            (Token::Quoted(word), _) => Ok(NamePattern::literal(word)),
            (token, place) => Err(place.fault(unexpected(expected, &token.shown()))),
        }
    }

    /// A chain: in its own case where one is called so, else in any case.
    fn chain(&mut self) -> Result<Expression, Error> {
        let name = self.name("the name of a chain")?;
        // Where a chain has no name reports say `_`.
        let name = if name == NamePattern::new("_") && !self.chains.contains("_") {
            NamePattern::literal("")
        } else {
            name
        };
        let with_case = name.clone().with_case();
        let is_there = self.chains.iter().any(|chain| with_case.holds(chain));
        Ok(Expression::Chain(if is_there { with_case } else { name }))
    }

    /// Residues by number: one or, where it may be, a range.
    fn residue(&mut self, may_be_range: bool) -> Result<Expression, Error> {
        const EXPECTED: &str = "the number of a residue";
        let (token, place) = self.need(EXPECTED)?;
        let (word, pattern) = match token {
            Token::Word(word) => (word, NamePattern::new(word)),
            Token::Quoted(word) => (word, NamePattern::literal(word)),
            token => return Err(place.fault(unexpected(EXPECTED, &token.shown()))),
        };
        if may_be_range && self.tokens.skip_colon()? {
            let (last, last_place) = match self.need(EXPECTED)? {
                (Token::Word(last) | Token::Quoted(last), place) => (last, place),
                (token, place) => return Err(place.fault(unexpected(EXPECTED, &token.shown()))),
            };
            let range = [number(word), number(last)];
            return match range {
                [Some(first), Some(last)] if first <= last => {
                    Ok(Expression::Residue(ResidueTest::Range([first, last])))
                }
                _ => {
                    let end = last_place.byte + last.len();
                    let written = self.tokens.between(place.byte, end);
                    Err(place.fault(
                        Error::input(format!("`{}` is no range of residues", shortened(written)))
                            .help("give the first residue before the last, as in `resid 10:20`"),
                    ))
                }
            };
        }
        let test = match word.parse() {
            Ok(number) => ResidueTest::Number(number),
            Err(_) => ResidueTest::Text(pattern),
        };
        Ok(Expression::Residue(test))
    }
}

/// Parts as one expression: a single part is its own.
fn joined(mut parts: Vec<Expression>, join: fn(Vec<Expression>) -> Expression) -> Expression {
    match parts.pop() {
        Some(only) if parts.is_empty() => only,
        Some(last) => {
            parts.push(last);
            join(parts)
        }
        None => join(parts),
    }
}

/// A residue's number with its insertion code: `52` or `52A`.
fn number(text: &str) -> Option<ResidueNumber> {
    if let Ok(number) = text.parse() {
        return Some((number, None));
    }
    let insertion = text.chars().last().filter(char::is_ascii_alphabetic)?;
    let number = text.strip_suffix(insertion)?.parse().ok()?;
    Some((number, Some(insertion.to_ascii_uppercase())))
}

/// A selection with too many parentheses and `not` within each other.
fn too_deep() -> Error {
    Error::input(format!(
        "the selection is nested more than {MAX_DEPTH} deep"
    ))
    .help("leave out parentheses that are not needed")
}
