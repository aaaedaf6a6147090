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

const ATOM_NAME: &str = "the name of an atom";
/// Most parentheses and `not` within each other: a recursion without a bound would run out of stack.
const MAX_DEPTH: usize = 100;

/// A selection of atoms.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) enum Expression {
    All,
    Hydrogen,
    Chain(NamePattern),
    ResidueName(NamePattern),
    /// Residues by number and insertion code as one text.
    Residue(NamePattern),
    /// Residues from one to another, each with its insertion code: none comes before `A`.
    Residues([ResidueNumber; 2]),
    Name(NamePattern),
    Not(Box<Expression>),
    And(Vec<Expression>),
    Or(Vec<Expression>),
}

/// Names that tests of `name` and `hydrogen` are applied to.
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
            Self::Residue(pattern) => {
                let residues = index.residues.values();
                let residues = residues.filter(|(text, _)| pattern.holds(text));
                index.at(residues.map(|(_, places)| places))
            }
            Self::Residues([first, last]) => {
                let residues = index.residues.range(*first..=*last);
                index.at(residues.map(|(_, (_, places))| places))
            }
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
            Self::And(parts) | Self::Or(parts) => {
                let is_all = matches!(self, Self::And(_));
                let mut chosen = vec![is_all; index.atoms.len()];
                for part in parts {
                    for (chosen, other) in chosen.iter_mut().zip(part.select(index, tested)) {
                        *chosen = if is_all {
                            *chosen & other
                        } else {
                            *chosen | other
                        };
                    }
                }
                chosen
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
        let (end, next) = (self.tokens.place(), self.tokens.next()?);
        next.ok_or_else(|| end.fault(unexpected(expected, "the end of the file")))
    }

    /// The selection that follows, and the place of its parenthesis.
    pub(super) fn selection(&mut self) -> Result<(Expression, Place), Error> {
        const EXPECTED: &str = "a selection in parentheses";
        match self.need(EXPECTED)? {
            (Token::Open, place) => Ok((self.any_of(1, place)?, place)),
            (token, place) => Err(place.fault(unexpected(EXPECTED, &token.shown()))),
        }
    }

    /// The expression between parentheses, and the one that closes.
    fn any_of(&mut self, depth: usize, open: Place) -> Result<Expression, Error> {
        if depth > MAX_DEPTH {
            return Err(open.fault(too_deep()));
        }
        // Alternatives, each with the tests that must hold at once.
        let mut alternatives = Vec::new();
        let mut all_of = vec![self.factor(depth)?];
        loop {
            let expected = "`and`, `or` or `)`";
            let (token, place) = self.need(expected)?;
            if token.is_keyword("and") {
                all_of.push(self.factor(depth)?);
            } else if token.is_keyword("or") {
                let next = vec![self.factor(depth)?];
                let tests = std::mem::replace(&mut all_of, next);
                alternatives.push(joined(tests, Expression::And));
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
        const KEYWORDS: [&str; 8] = [
            "all", "hydrogen", "segid", "chain", "residue", "resname", "name", "atom",
        ];
        let keyword = KEYWORDS
            .into_iter()
            .find(|keyword| token.is_keyword(keyword));
        Ok(match keyword.unwrap_or_default() {
            "all" => Expression::All,
            "hydrogen" => Expression::Hydrogen,
            "segid" | "chain" => self.chain()?,
            "residue" => self.residue(true)?,
            "resname" => Expression::ResidueName(self.name("the name of a residue")?),
            "name" => Expression::Name(self.name(ATOM_NAME)?),
            "atom" => Expression::And(vec![
                self.chain()?,
                self.residue(false)?,
                Expression::Name(self.name(ATOM_NAME)?),
            ]),
            _ => return Err(place.fault(unexpected(expected, &token.shown()))),
        })
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
        // Reports write `_` for a chain without a name.
        let is_unnamed = name == NamePattern::new("_") && !self.chains.contains("_");
        let name = if is_unnamed {
            NamePattern::literal("")
        } else {
            name
        };
        let with_case = name.clone().with_case();
        let is_there = self.chains.iter().any(|chain| with_case.holds(chain));
        Ok(Expression::Chain(if is_there { with_case } else { name }))
    }

    /// Residues by number: one or, if that is allowed, a range.
    fn residue(&mut self, may_be_range: bool) -> Result<Expression, Error> {
        const EXPECTED: &str = "the number of a residue";
        let (token, place) = self.need(EXPECTED)?;
        let (word, pattern) = match token {
            Token::Word(word) => (word, NamePattern::new(word)),
            Token::Quoted(word) => (word, NamePattern::literal(word)),
            token => return Err(place.fault(unexpected(EXPECTED, &token.shown()))),
        };
        if may_be_range && self.tokens.skip(|token| token == Token::Colon)? {
            let (last, last_place) = match self.need(EXPECTED)? {
                (Token::Word(last) | Token::Quoted(last), place) => (last, place),
                (token, place) => return Err(place.fault(unexpected(EXPECTED, &token.shown()))),
            };
            if let (Some(first), Some(last)) = (number(word), number(last))
                && first <= last
            {
                return Ok(Expression::Residues([first, last]));
            }
            let end = last_place.byte + last.len();
            let written = shortened(self.tokens.between(place.byte, end));
            let error = Error::input(format!("`{written}` is no range of residues"));
            return Err(place
                .fault(error.help("give the first residue before the last, as in `resid 10:20`")));
        }
        Ok(match word.parse() {
            Ok(number) => Expression::Residues([(number, None); 2]),
            Err(_) => Expression::Residue(pattern),
        })
    }
}

/// Parts as one expression; a single part stays as it is.
fn joined(mut parts: Vec<Expression>, join: fn(Vec<Expression>) -> Expression) -> Expression {
    match parts.len() {
        1 => parts.remove(0),
        _ => join(parts),
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
    let message = format!("the selection is nested more than {MAX_DEPTH} deep");
    Error::input(message).help("leave out parentheses that are not needed")
}
