//! A table, as Markdown for the documentation and as CSV for programs.

use std::fmt::Write;

/// Content of a cell.
#[derive(Clone, Debug)]
pub enum Cell {
    /// Words.
    Text(String),
    /// A count; powers of two from 64 on are written as such in Markdown.
    Count(usize),
    /// Milliseconds, or another number of a few digits.
    Number(f64),
    /// A number that was not measured but scaled up from a share of the work.
    Scaled(f64),
    /// A share of a peak.
    Share(f64),
    /// Nothing.
    None,
}

/// Named columns and rows.
#[derive(Clone, Debug, Default)]
pub struct Table {
    /// Names of the columns, with their units.
    pub header: Vec<&'static str>,
    /// The rows, each as long as the header.
    pub rows: Vec<Vec<Cell>>,
}

impl Cell {
    /// Milliseconds of seconds, if they were measured.
    pub fn milliseconds(seconds: Option<f64>) -> Self {
        seconds.map_or(Self::None, |seconds| Self::Number(1e3 * seconds))
    }

    fn markdown(&self) -> String {
        match self {
            Self::Text(text) => text.clone(),
            Self::Count(count) if *count >= 64 && count.is_power_of_two() => {
                format!("2^{}", count.ilog2())
            }
            Self::Count(count) => count.to_string(),
            Self::Number(number) => few_digits(*number),
            Self::Scaled(number) => format!("≈ {}", few_digits(*number)),
            Self::Share(0.0) => "0".to_owned(),
            Self::Share(share) => format!("{share:.1e}"),
            Self::None => "-".to_owned(),
        }
    }

    fn csv(&self) -> String {
        match self {
            Self::Text(text) => text.replace(',', ";"),
            Self::Count(count) => count.to_string(),
            Self::Number(number) | Self::Scaled(number) => format!("{number:.4e}"),
            Self::Share(share) => format!("{share:.4e}"),
            Self::None => String::new(),
        }
    }
}

/// Three digits, without an exponent.
fn few_digits(number: f64) -> String {
    let digits = if number == 0.0 {
        0
    } else {
        (2 - number.abs().log10().floor() as i32).clamp(0, 6)
    };
    format!("{number:.0$}", digits as usize)
}

impl Table {
    /// As Markdown, only the rows that `keep` takes.
    pub fn markdown(&self, keep: impl Fn(&[Cell]) -> bool) -> String {
        let mut text = format!("| {} |\n", self.header.join(" | "));
        // Writing to a string cannot fail.
        let _ = writeln!(text, "|{}", "---|".repeat(self.header.len()));
        for row in self.rows.iter().filter(|row| keep(row)) {
            let cells: Vec<String> = row.iter().map(Cell::markdown).collect();
            let _ = writeln!(text, "| {} |", cells.join(" | "));
        }
        text
    }

    /// As CSV. Figures that were scaled up look like the others there.
    pub fn csv(&self) -> String {
        let mut text = self.header.join(",") + "\n";
        for row in &self.rows {
            let cells: Vec<String> = row.iter().map(Cell::csv).collect();
            text += &(cells.join(",") + "\n");
        }
        text
    }
}
