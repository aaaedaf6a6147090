//! Tables of balls: comma, semicolon or tab between fields, with or without a header.

use super::{BallFile, bad_radius, number, number_of};
use crate::ball::{Ball, SMALLEST_RADIUS};
use crate::error::Error;

/// Names of the columns, in their order without a header.
const COLUMNS: [(&str, &str); 5] = [
    ("x", "x"),
    ("y", "y"),
    ("z", "z"),
    ("r", "radius"),
    ("weight", "weight"),
];

/// Place of each column; the last is optional.
struct Places {
    place: [usize; 4],
    weight: Option<usize>,
}

pub(super) fn read(text: &str) -> Result<BallFile, Error> {
    let first = text.lines().next().unwrap_or_default();
    let delimiter = [',', ';', '\t']
        .into_iter()
        .max_by_key(|&sign| first.matches(sign).count());
    let delimiter = delimiter.unwrap_or(',');
    let mut file = BallFile::default();
    let mut weights = Vec::new();
    let mut places: Option<(Places, usize)> = None;
    // Numbers need no quotes, but some programs write them: a line is a row.
    for (line, text) in (1u64..).zip(text.lines()) {
        if text.trim().is_empty() || text.starts_with('#') {
            continue;
        }
        let fields = text.split(delimiter);
        let record: Vec<&str> = fields.map(|field| field.trim().trim_matches('"')).collect();
        let (places, fields) = match &places {
            Some((places, fields)) => (places, *fields),
            None => {
                let is_header = record.iter().all(|field| number(field).is_none());
                let found = if is_header {
                    header(&record, line)?
                } else {
                    unnamed(record.len(), line)?
                };
                let (placed, fields) = places.insert((found, record.len()));
                if is_header {
                    continue;
                }
                (&*placed, *fields)
            }
        };
        if record.len() != fields {
            return Err(wrong_fields(record.len(), fields, line));
        }
        let (ball, weight) = row(&record, places, line)?;
        file.balls.push(ball);
        weights.extend(weight);
    }
    file.weights = (!weights.is_empty()).then_some(weights);
    Ok(file)
}

fn wrong_fields(found: usize, expected: usize, line: u64) -> Error {
    Error::input(format!("the row has {found} fields, not {expected}"))
        .on_line(line)
        .help("give each row x,y,z,r and perhaps a weight")
}

fn header(record: &[&str], line: u64) -> Result<Places, Error> {
    let place = |(short, long): (&str, &str)| {
        let is_named =
            |field: &&str| field.eq_ignore_ascii_case(short) || field.eq_ignore_ascii_case(long);
        record.iter().position(is_named)
    };
    let mut places = [0; 4];
    for (found, names) in places.iter_mut().zip(COLUMNS) {
        *found = place(names).ok_or_else(|| {
            Error::input(format!("the header has no column '{}'", names.0))
                .on_line(line)
                .help("name the columns x,y,z,r and perhaps weight, or leave the header out")
        })?;
    }
    Ok(Places {
        place: places,
        weight: place(COLUMNS[4]),
    })
}

fn unnamed(fields: usize, line: u64) -> Result<Places, Error> {
    match fields {
        4 | 5 => Ok(Places {
            place: [0, 1, 2, 3],
            weight: (fields == 5).then_some(4),
        }),
        found => Err(wrong_fields(found, 4, line)),
    }
}

fn row(record: &[&str], places: &Places, line: u64) -> Result<(Ball, Option<f64>), Error> {
    let field = |column: usize, place: usize| {
        let text = record.get(place).copied().unwrap_or_default();
        number_of(COLUMNS[column].0, text, line)
    };
    let mut numbers = [0.0; 4];
    for (column, value) in numbers.iter_mut().enumerate() {
        *value = field(column, places.place[column])?;
    }
    let [x, y, z, radius] = numbers;
    if radius < SMALLEST_RADIUS {
        return Err(bad_radius(radius, line));
    }
    let weight = places.weight.map(|place| field(4, place)).transpose()?;
    if let Some(weight) = weight.filter(|&weight| weight < 0.0) {
        return Err(
            Error::input(format!("the weight is {weight}; it must not be negative"))
                .on_line(line)
                .help("correct the number, or leave the ball out"),
        );
    }
    let center = [x, y, z];
    Ok((Ball { center, radius }, weight))
}
