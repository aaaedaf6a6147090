//! Files of assign statements, as CNS, X-PLOR, ARIA and HADDOCK have them.
//!
//! ```text
//! ! Residue 10 of the receptor is near residue 20 or 21 of the ligand.
//! assign (resid 10 and segid A)
//!        (resid 20:21 and segid B) 2.0 2.0 0.0
//! assign (name CA and resid 11 and segid A) (name CA and resid 20 and segid B) 8.0 8.0 0.0
//!     or (name CA and resid 11 and segid A) (name CA and resid 25 and segid B)
//! ```
//!
//! - Two selections of atoms, one in each molecule in either order, and three distances d, minus and plus: the
//!   effective distance lies from d - minus to d + plus.
//! - `or` with two selections adds an alternative, which counts towards the same effective distance.
//! - A statement that is within one molecule, or may be by one of its alternatives, is left out: rigid docking keeps
//!   its distance.
//! - The upper bound is widened for the hydrogens that are not read (`hydrogens`), unless the caller wants it as
//!   written.
//! - ARIA's entries after the distances (`peak`, `volume`, `ppm1` ...) are passed over. A `weight` must be 1.
//! - `segid` and `chain` are the chain. `resid 52A` has an insertion code. Case counts in names of chains if a chain
//!   has the name in that case.
//! - Comments are `! to the end of the line` and `{ ... }`. Keywords may be cut to four letters.
//!
//! Sources: the CNS language tutorial and the X-PLOR manual, NOE statement.

mod atom_index;
mod expression;
mod hydrogens;
mod name_pattern;
mod sides;
#[cfg(test)]
mod tests;
mod tokens;

use std::collections::HashSet;

use knotdock_structures::Error;
use knotdock_structures::molecule::Molecule;

use self::expression::Selections;
use self::hydrogens::widened;
use self::sides::{Selected, Sides};
use self::tokens::{Place, Token, unexpected};
use crate::restraints::restraint::{
    Bounds, FileRestraints, NamedRestraint, SelectedAtoms, TblBounds, distance,
};
use crate::table_text::named_columns::shortened;

/// Keywords with a number after the distances, which have no effect on them.
const PASSED_OVER: [&str; 6] = ["peak", "spectrum", "volume", "ppm1", "ppm2", "cv"];

/// The restraints of a file. Lines end with LF.
pub(super) fn parse(
    text: &str,
    molecules: [&Molecule; 2],
    bounds: TblBounds,
) -> Result<FileRestraints, Error> {
    let text = text.strip_prefix('\u{feff}').unwrap_or(text);
    let sides = Sides::new(molecules);
    let mut statements = Statements {
        selections: Selections::new(text, sides.all_chains()),
        sides,
        bounds,
        selected: SelectedAtoms::default(),
    };
    let (mut list, mut within) = (Vec::new(), Vec::new());
    while let Some((token, place)) = statements.selections.tokens.next()? {
        if !token.is_keyword("assign") {
            let expected = "a statement that begins with `assign`";
            return Err(place.fault(unexpected(expected, &token.shown())));
        }
        let name = format!("restraint {}", list.len() + within.len() + 1);
        match statements.assign(name, place)? {
            Some(restraint) => list.push(restraint),
            None => within.push(place),
        }
    }
    match within.first() {
        Some(place) if list.is_empty() => {
            let subject = match within.len() {
                1 => "the restraint is".to_owned(),
                count => format!("all {count} restraints are"),
            };
            let message = format!("{subject} within one molecule, which docking does not change");
            Err(place.fault(Error::input(message).help(
                "select atoms of the receptor in one and of the ligand in the other: rigid docking keeps distances \
                 within a molecule",
            )))
        }
        _ => Ok(FileRestraints {
            list,
            within_one_molecule: within.len(),
        }),
    }
}

/// Reads statements one by one.
struct Statements<'a> {
    selections: Selections<'a>,
    sides: Sides<'a>,
    bounds: TblBounds,
    selected: SelectedAtoms,
}

/// Atoms of receptor and ligand, and how many of the two sets have hydrogens that count.
type Pair = ([Vec<usize>; 2], usize);

impl Statements<'_> {
    /// The statement after `assign`, which is at `place`; `None` if it is, or may be, within one molecule.
    fn assign(&mut self, name: String, place: Place) -> Result<Option<NamedRestraint>, Error> {
        let mut alternatives = vec![self.pair()?];
        let bounds = Bounds::about(
            self.distance("the distance")?,
            self.distance("the tolerance below")?,
            self.distance("the tolerance above")?,
        );
        let bounds = bounds.map_err(|fault| place.fault(fault))?;
        let is_passed_over = |token: Token| PASSED_OVER.iter().any(|one| token.is_keyword(one));
        // An alternative that is written twice counts once.
        let mut known = HashSet::new();
        loop {
            let tokens = &mut self.selections.tokens;
            if tokens.skip(|token| token.is_keyword("or"))? {
                if known.is_empty() {
                    known.extend(alternatives.iter().cloned());
                }
                let pair = self.pair()?;
                if known.insert(pair.clone()) {
                    alternatives.push(pair);
                }
            } else if tokens.skip(|token| token.is_keyword("weight"))? {
                let (weight, text, place) = self.number("a weight")?;
                if weight != 1.0 {
                    let text = shortened(text);
                    let message = format!("the weight is `{text}`; all restraints count alike");
                    let error = Error::input(message);
                    return Err(place.fault(
                        error.help("leave the weight out, or leave out the whole statement"),
                    ));
                }
            } else if tokens.skip(is_passed_over)? {
                self.number("a number")?;
            } else {
                break;
            }
        }
        let Some(alternatives) = alternatives.into_iter().collect::<Option<Vec<Pair>>>() else {
            return Ok(None);
        };
        let (pairs, sides): (Vec<_>, Vec<usize>) = alternatives.into_iter().unzip();
        let sides = sides.into_iter().max().unwrap_or(0);
        Ok(Some(NamedRestraint {
            name,
            line: place.line,
            pairs,
            lower: bounds.lower,
            target: bounds.target,
            upper: match self.bounds {
                TblBounds::Widened => widened(bounds.upper, sides),
                TblBounds::Written => bounds.upper,
            },
            written_upper: bounds.upper,
        }))
    }

    /// Two selections; `None` if they are of one molecule.
    fn pair(&mut self) -> Result<Option<Pair>, Error> {
        let (first, place) = self.selection()?;
        let (second, _) = self.selection()?;
        if first.side == second.side {
            return Ok(None);
        }
        let sides = usize::from(first.has_hydrogens) + usize::from(second.has_hydrogens);
        let mut pair = [first.atoms, second.atoms];
        if first.side == 1 {
            pair.reverse();
        }
        let added = self.selected.add(&pair);
        added.map_err(|fault| place.fault(fault))?;
        Ok(Some((pair, sides)))
    }

    /// One selection, and where it begins.
    fn selection(&mut self) -> Result<(Selected, Place), Error> {
        let (expression, place) = self.selections.selection()?;
        let tokens = &self.selections.tokens;
        let written = || shortened(tokens.between(place.byte, tokens.place().byte));
        let selected = self.sides.select(&expression, written);
        let selected = selected.map_err(|fault| place.fault(fault))?;
        Ok((selected, place))
    }

    /// A distance that follows.
    fn distance(&mut self, what: &'static str) -> Result<f64, Error> {
        let expected = "three distances behind the two selections";
        match self.selections.need(expected)? {
            (Token::Word(word), place) => distance(what, word).map_err(|fault| place.fault(fault)),
            (token, place) => Err(place.fault(unexpected(expected, &token.shown()))),
        }
    }

    /// A number that follows, as written and where.
    fn number(&mut self, expected: &'static str) -> Result<(f64, &str, Place), Error> {
        let (token, place) = self.selections.need(expected)?;
        let number = match token {
            Token::Word(word) => word.parse().ok().map(|number| (number, word)),
            _ => None,
        };
        let (number, word) =
            number.ok_or_else(|| place.fault(unexpected(expected, &token.shown())))?;
        Ok((number, word, place))
    }
}
