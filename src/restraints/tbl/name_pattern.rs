//! Names with the wildcards of CNS.
//!
//! `*` stands for any characters, `%` for one, `#` for any digits and `+` for one digit. `*` and `#` may stand for
//! nothing. Source: CNS language tutorial, atom selection; `#` and `+` as in its ancestor CHARMM.

/// What a name must be.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct NamePattern {
    text: String,
    has_wildcards: bool,
    ignores_case: bool,
}

impl NamePattern {
    /// A name with wildcards, in any case.
    pub(super) fn new(text: &str) -> Self {
        Self {
            has_wildcards: text.contains(['*', '%', '#', '+']),
            ..Self::literal(text)
        }
    }

    /// A name without wildcards, in any case.
    pub(super) fn literal(text: &str) -> Self {
        Self {
            text: text.to_owned(),
            has_wildcards: false,
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
        match (self.has_wildcards, self.ignores_case) {
            (true, _) => self.matches(name),
            (false, true) => self.text.eq_ignore_ascii_case(name),
            (false, false) => self.text == name,
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
            let may_repeat = matches!(part, '*' | '#');
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
}
