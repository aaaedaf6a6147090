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
//! - What ARIA writes behind the distances (`peak`, `volume`, `ppm1` ...) is passed over. A `weight` must be 1.
//! - `segid` and `chain` are the chain. `resid 52A` has an insertion code. Case counts in names of chains where a chain
//!   is called so.
//! - Comments are `! to the end of the line` and `{ ... }`. Keywords may be cut to four letters.
//!
//! Sources: the CNS language tutorial and the X-PLOR manual, NOE statement.

mod expression;
mod name_pattern;
mod sides;
#[cfg(test)]
mod tests;
mod tokens;

use std::collections::HashSet;

use knotdock_structures::molecule::Molecule;

use self::expression::{Selections, unexpected};
use self::sides::{SIDES, Sides};
use self::tokens::{Place, Token};
use crate::named_columns::shortened;
use crate::restraints::bounds::{Bounds, distance};
use crate::restraints::error::{Located, RestraintFault};
use crate::restraints::restraint::{NamedRestraint, SelectedAtoms};

/// What may stand behind the distances with a number, and says nothing of them.
const PASSED_OVER: [&str; 6] = ["peak", "spectrum", "volume", "ppm1", "ppm2", "cv"];

/// The restraints of a file. Lines end with LF.
pub(super) fn parse(
    bytes: Vec<u8>,
    molecules: [&Molecule; 2],
) -> Result<Vec<NamedRestraint>, Located> {
    let text = String::from_utf8(bytes).map_err(|_| {
        Located::in_file(RestraintFault::Unreadable(
            "it is not text in UTF-8".to_owned(),
        ))
    })?;
    let text = text.strip_prefix('\u{feff}').unwrap_or(&text);
    let sides = Sides::new(molecules);
    let mut statements = Statements {
        selections: Selections::new(text, sides.all_chains()),
        sides,
        selected: SelectedAtoms::default(),
    };
    let mut restraints = Vec::new();
    while let Some((token, place)) = statements.selections.tokens.next()? {
        if !token.is_keyword("assign") {
            return Err(unexpected(
                "a statement that begins with `assign`",
                token,
                place,
            ));
        }
        let name = format!("restraint {}", restraints.len() + 1);
        restraints.push(statements.assign(name, place)?);
    }
    Ok(restraints)
}

/// Reads statements one by one.
struct Statements<'a> {
    selections: Selections<'a>,
    sides: Sides<'a>,
    selected: SelectedAtoms,
}

impl Statements<'_> {
    /// The statement behind `assign`, which is at `place`.
    fn assign(&mut self, name: String, place: Place) -> Result<NamedRestraint, Located> {
        let mut pairs = vec![self.pair()?];
        let bounds = Bounds::about(
            self.distance("the distance")?,
            self.distance("the tolerance below")?,
            self.distance("the tolerance above")?,
        );
        let bounds = bounds.map_err(|fault| place.fault(fault))?;
        // An alternative that is written twice counts once.
        let mut known = HashSet::new();
        loop {
            let tokens = &mut self.selections.tokens;
            if tokens.skip_keyword(&["or"])?.is_some() {
                if known.is_empty() {
                    known.extend(pairs.iter().cloned());
                }
                let pair = self.pair()?;
                if known.insert(pair.clone()) {
                    pairs.push(pair);
                }
            } else if tokens.skip_keyword(&["weight"])?.is_some() {
                let (weight, text, place) = self.number("a weight")?;
                if weight != 1.0 {
                    return Err(place.fault(RestraintFault::Weight(shortened(text))));
                }
            } else if tokens.skip_keyword(&PASSED_OVER)?.is_some() {
                self.number("a number")?;
            } else {
                break;
            }
        }
        Ok(NamedRestraint {
            name,
            line: place.line,
            pairs,
            lower: bounds.lower,
            target: bounds.target,
            upper: bounds.upper,
        })
    }

    /// Two selections: the atoms of the receptor and of the ligand.
    fn pair(&mut self) -> Result<[Vec<usize>; 2], Located> {
        let ((first_side, first), place) = self.selection()?;
        let ((second_side, second), _) = self.selection()?;
        if first_side == second_side {
            return Err(place.fault(RestraintFault::OneSide(SIDES[first_side])));
        }
        let pair = if first_side == 0 {
            [first, second]
        } else {
            [second, first]
        };
        self.selected
            .add(&pair)
            .map_err(|fault| place.fault(fault))?;
        Ok(pair)
    }

    /// One selection: the molecule that it is of, its atoms, and where it begins.
    fn selection(&mut self) -> Result<((usize, Vec<usize>), Place), Located> {
        let (expression, place) = self.selections.selection()?;
        let tokens = &self.selections.tokens;
        let written = || shortened(tokens.between(place.byte, tokens.place().byte));
        let selected = self.sides.select(&expression, written);
        let selected = selected.map_err(|fault| place.fault(fault))?;
        Ok((selected, place))
    }

    /// A distance that follows.
    fn distance(&mut self, what: &'static str) -> Result<f64, Located> {
        let expected = "three distances behind the two selections";
        match self.selections.need(expected)? {
            (Token::Word(word), place) => distance(what, word).map_err(|fault| place.fault(fault)),
            (token, place) => Err(unexpected(expected, token, place)),
        }
    }

    /// A number that follows, as written and where.
    fn number(&mut self, expected: &'static str) -> Result<(f64, &str, Place), Located> {
        let (token, place) = self.selections.need(expected)?;
        let number = match token {
            Token::Word(word) => word.parse().ok().map(|number| (number, word)),
            _ => None,
        };
        let (number, word) = number.ok_or_else(|| unexpected(expected, token, place))?;
        Ok((number, word, place))
    }
}
