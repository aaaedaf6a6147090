//! Names with the wildcards of CNS.
//!
//! `*` stands for any characters, `%` for one, `#` for any digits and `+` for one digit. `*` and `#` may stand for
//! nothing. Source: CNS language tutorial, atom selection; `#` and `+` as in its ancestor CHARMM.

/// What a name must be.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct NamePattern {
    text: String,
    /// Of a pattern with wildcards the fewest characters that it stands for.
    shortest: Option<usize>,
    ignores_case: bool,
}

impl NamePattern {
    /// A name with wildcards, in any case.
    pub(super) fn new(text: &str) -> Self {
        if !text.contains(['*', '%', '#', '+']) {
            return Self::literal(text);
        }
        // Of what may stand for nothing, several in a row are one: `*` if it is among them, else `#`.
        let mut shown = String::with_capacity(text.len());
        for part in text.chars() {
            match (shown.chars().next_back(), part) {
                (Some('*'), '*' | '#') | (Some('#'), '#') => {}
                (Some('#'), '*') => {
                    shown.pop();
                    shown.push('*');
                }
                _ => shown.push(part),
            }
        }
        let shortest = shown.chars().filter(|part| !may_be_nothing(*part)).count();
        Self {
            shortest: Some(shortest),
            ..Self::literal(&shown)
        }
    }

    /// A name without wildcards, in any case.
    pub(super) fn literal(text: &str) -> Self {
        Self {
            text: text.to_owned(),
            shortest: None,
            ignores_case: true,
        }
    }

    /// The same, of which the case counts.
    pub(super) fn with_case(self) -> Self {
        Self {
            ignores_case: false,
            ..self
        }
    }

    /// Whether a name is one of these.
    pub(super) fn holds(&self, name: &str) -> bool {
        match (self.shortest, self.ignores_case) {
            // Of a pattern that the name is long enough for, every second character at least stands for one of it.
            (Some(shortest), _) => shortest <= name.len() && self.matches(name),
            (None, true) => self.text.eq_ignore_ascii_case(name),
            (None, false) => self.text == name,
        }
    }

    /// Whether a name is one of those with wildcards.
    fn matches(&self, name: &str) -> bool {
        let name: Vec<char> = name.chars().collect();
        // How many characters of the name the pattern so far may have taken. So no pattern takes more than a step for
        // each pair of characters, whatever its wildcards.
        let mut reached = vec![false; name.len() + 1];
        reached[0] = true;
        for part in self.text.chars() {
            let may_repeat = may_be_nothing(part);
            let mut next = vec![false; name.len() + 1];
            next[0] = may_repeat && reached[0];
            for (before, &letter) in name.iter().enumerate() {
                let goes_on = reached[before] || may_repeat && next[before];
                next[before + 1] =
                    goes_on && self.takes(part, letter) || may_repeat && reached[before + 1];
            }
            reached = next;
        }
        reached[name.len()]
    }

    /// Whether a character of the pattern may stand for a letter.
    fn takes(&self, part: char, letter: char) -> bool {
        match part {
            '*' | '%' => true,
            '#' | '+' => letter.is_ascii_digit(),
            part if self.ignores_case => part.eq_ignore_ascii_case(&letter),
            part => part == letter,
        }
    }
}

/// Whether a character of a pattern stands for any number of characters.
fn may_be_nothing(part: char) -> bool {
    matches!(part, '*' | '#')
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn wildcards_stand_for_what_they_stand_for() {
        for (pattern, held, others) in [
            (
                "CA",
                &["CA", "ca"] as &[&str],
                &["C", "CAB", "CB", ""] as &[&str],
            ),
            ("*", &["", "C", "HB1"], &[]),
            ("H*", &["H", "HB", "HB12"], &["CH", ""]),
            ("*1", &["1", "HB1", "H11"], &["H12", ""]),
            ("H%", &["HA", "H1"], &["H", "HA1"]),
            ("HB#", &["HB", "HB1", "HB12"], &["HBA", "HB1A"]),
            ("HB+", &["HB1"], &["HB", "HB12", "HBA"]),
            ("*B#", &["HB1", "CB", "BB"], &["BA"]),
            ("#A", &["1A", "A", "52A"], &["BA"]),
            ("##*#", &["", "C", "1C1"], &[]),
            ("C##", &["C", "C12"], &["CA", ""]),
            ("#+*%", &["12", "1A", "11CA"], &["1", "A1", ""]),
        ] {
            let pattern = NamePattern::new(pattern);
            assert!(held.iter().all(|name| pattern.holds(name)), "{pattern:?}");
            assert!(
                !others.iter().any(|name| pattern.holds(name)),
                "{pattern:?}"
            );
        }
        assert!(NamePattern::literal("H*").holds("h*"));
        assert!(!NamePattern::literal("H*").holds("HA"));
        assert!(!NamePattern::new("b*").with_case().holds("B"));
    }

    /// A match that tries all ways would take longer than the world has.
    #[test]
    fn many_wildcards_take_no_time() {
        let pattern = NamePattern::new(&"*#".repeat(200));
        assert!(pattern.holds(&"1".repeat(200)));
        assert!(!NamePattern::new(&("*1".repeat(100) + "x")).holds(&"1".repeat(200)));
    }

    /// Found by an audit: a pattern of 1,000 characters took a millisecond for each atom and statement.
    #[test]
    fn long_patterns_are_short_or_hold_nothing() {
        assert_eq!(NamePattern::new(&"*#".repeat(500)), NamePattern::new("*"));
        assert_eq!(NamePattern::new(&"#".repeat(500)), NamePattern::new("#"));
        let long = NamePattern::new(&"%#".repeat(500));
        assert_eq!(long.shortest, Some(500));
        assert!(!long.holds("CA"));
    }
}
