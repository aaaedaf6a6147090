//! Table 1 and Figure 6: what the Minkowski sum of two solids takes by pairs, of balls and of a uniform grid's nodes.
//!
//! Both samplings are of one spacing, so that both sums are within the two solids' eps together of the true one.

use crate::card::{Card, seconds};
use crate::report::Figure;
use crate::scene::Scene;
use crate::table::{Cell, Table};
use crate::timing::least;
use knotdock_cli::plot::chart::{Axis, Colour, Panel, Series, Style};
use knotdock_scoring::gpu::Job;
use knotdock_scoring::minkowski::{Knot, Node, gap_of_balls, gap_of_nodes, write};

/// Sums that are written at most, 400 MB of nodes; of more a share is timed and scaled up.
const MOST_WRITTEN: usize = 1 << 24;
/// Sums that are streamed at most.
const MOST_STREAMED: usize = 1 << 28;
/// Where the streamed sums are used.
const PLACE: Node = [0.9, 0.1, 0.2];
/// Table 1's ratios by the paper's own counts, from 2^12 on; at 2^18 it prints 764.5.
const PAPER_RATIOS: [(u32, f64); 4] = [(12, 23.0), (15, 309.1), (18, 555.1), (21, 3785.5)];
/// The paper's times at 2^18, in milliseconds: 28 and 48 s of nodes, 104 and 47 ms of balls.
const PAPER_TIMES: [[f64; 2]; 4] = [[18.0, 28e3], [18.0, 48e3], [18.0, 104.0], [18.0, 47.0]];

/// The pairs, each with its colour.
const PAIRS: [(&str, Colour); 3] = [
    ("bunny and peg", [0x00, 0x72, 0xb2]),
    ("bunny and small bunny", [0x00, 0x9e, 0x73]),
    ("bunny and bunny", [0xe6, 0x9f, 0x00]),
];

/// One way's time.
#[derive(Clone, Copy)]
struct Measured {
    seconds: f64,
    /// Whether a share was timed.
    scaled: bool,
}

/// What sums of one kind take.
struct Sums {
    /// Of both solids.
    counts: [usize; 2],
    /// Bytes of one sum.
    bytes: usize,
    written: Measured,
    streamed: Measured,
}

/// Two solids at one grid size.
struct Row {
    pair: &'static str,
    per_axis: usize,
    epsilon: f64,
    nodes: Sums,
    balls: Sums,
    /// Seconds of balls on the card, written and streamed.
    card: [Option<f64>; 2],
}

impl Sums {
    fn of<const N: usize>(
        first: &[[f64; N]],
        second: &[[f64; N]],
        gap: impl Fn(&[[f64; N]], &[[f64; N]], Node) -> f64,
    ) -> Self {
        let mut sum = Vec::with_capacity((first.len() * second.len()).min(MOST_WRITTEN));
        let written = share(first, second.len(), MOST_WRITTEN, |first| {
            write(first, second, &mut sum);
            sum.len() as f64
        });
        let streamed = share(first, second.len(), MOST_STREAMED, |first| {
            gap(first, second, PLACE)
        });
        Self {
            counts: [first.len(), second.len()],
            bytes: size_of::<[f64; N]>(),
            written,
            streamed,
        }
    }

    fn pairs(&self) -> f64 {
        self.counts[0] as f64 * self.counts[1] as f64
    }

    fn megabytes(&self) -> f64 {
        1e-6 * self.pairs() * self.bytes as f64
    }
}

/// Times a task over the sums of all of `first`, or of as many as make `most` sums.
fn share<const N: usize>(
    first: &[[f64; N]],
    second: usize,
    most: usize,
    mut task: impl FnMut(&[[f64; N]]) -> f64,
) -> Measured {
    let rows = (most / second).clamp(1, first.len());
    let seconds = least(|| task(&first[..rows]));
    Measured {
        seconds: seconds * first.len() as f64 / rows as f64,
        scaled: rows < first.len(),
    }
}

impl Row {
    fn new(
        pair: &'static str,
        scene: &Scene,
        card: Option<&Card>,
        balls: [&[Knot]; 2],
        nodes: [&[Node]; 2],
    ) -> Self {
        let [a, b] = balls;
        Self {
            card: [
                card.and_then(|card| card.measure(|gpu| seconds(&Job::pair_sums(gpu, a, b)?))),
                card.and_then(|card| {
                    card.measure(|gpu| seconds(&Job::pair_distances(gpu, a, b, &[PLACE])?))
                }),
            ],
            pair,
            per_axis: scene.per_axis,
            epsilon: scene.epsilon(),
            nodes: Sums::of(nodes[0], nodes[1], gap_of_nodes),
            balls: Sums::of(balls[0], balls[1], gap_of_balls),
        }
    }

    fn power(&self) -> u32 {
        self.per_axis.pow(3).ilog2()
    }

    fn ratio(&self) -> f64 {
        self.nodes.pairs() / self.balls.pairs()
    }
}

/// The tables and the picture.
pub fn figure(scenes: &[Scene], card: Option<&Card>) -> Figure {
    let mut rows = Vec::new();
    // By pair, then by grid.
    for (pair, name) in PAIRS.map(|(name, _)| name).into_iter().enumerate() {
        for scene in scenes {
            let [bunny, peg, small] =
                [&scene.bunny, &scene.peg, &scene.small].map(|body| body.knots());
            let (second, nodes) = match pair {
                0 => (&peg, 1),
                1 => (&small, 2),
                _ => (&bunny, 0),
            };
            let nodes = [&scene.nodes[0][..], &scene.nodes[nodes]];
            rows.push(Row::new(name, scene, card, [&bunny, second], nodes));
        }
    }
    Figure {
        name: "fig6",
        tables: vec![("counts", counts(&rows)), ("costs", costs(&rows))],
        panels: panels(&rows),
        columns: 2,
    }
}

fn counts(rows: &[Row]) -> Table {
    let row = |row: &Row| {
        let count = |count: usize| Cell::Text(count.to_string());
        let product = |sums: &Sums| count(sums.counts[0] * sums.counts[1]);
        let paper = PAPER_RATIOS.iter().find(|(power, _)| *power == row.power());
        vec![
            Cell::Text(row.pair.to_owned()),
            Cell::Count(row.per_axis.pow(3)),
            Cell::Number(row.epsilon),
            count(row.nodes.counts[0]),
            count(row.nodes.counts[1]),
            product(&row.nodes),
            count(row.balls.counts[0]),
            count(row.balls.counts[1]),
            product(&row.balls),
            Cell::Text(format!("{:.1}", row.ratio())),
            paper.map_or(Cell::None, |(_, ratio)| Cell::Text(format!("{ratio:.1}"))),
        ]
    };
    Table {
        header: vec![
            "pair",
            "m",
            "eps",
            "nodes n1'",
            "n2'",
            "n' = n1' n2'",
            "balls n1",
            "n2",
            "n = n1 n2",
            "n' / n",
            "paper's n' / n",
        ],
        rows: rows.iter().map(row).collect(),
    }
}

fn costs(rows: &[Row]) -> Table {
    let time = |measured: Measured| match measured.scaled {
        true => Cell::Scaled(1e3 * measured.seconds),
        false => Cell::Number(1e3 * measured.seconds),
    };
    let row = |row: &Row| {
        let times = |nodes: Measured, balls: Measured| match nodes.scaled || balls.scaled {
            true => Cell::Scaled(nodes.seconds / balls.seconds),
            false => Cell::Number(nodes.seconds / balls.seconds),
        };
        vec![
            Cell::Text(row.pair.to_owned()),
            Cell::Count(row.per_axis.pow(3)),
            Cell::Number(row.nodes.megabytes()),
            Cell::Number(row.balls.megabytes()),
            time(row.nodes.written),
            time(row.balls.written),
            times(row.nodes.written, row.balls.written),
            time(row.nodes.streamed),
            time(row.balls.streamed),
            times(row.nodes.streamed, row.balls.streamed),
            Cell::milliseconds(row.card[0]),
            Cell::milliseconds(row.card[1]),
        ]
    };
    Table {
        header: vec![
            "pair",
            "m",
            "nodes (MB)",
            "balls (MB)",
            "nodes; written (ms)",
            "balls; written (ms)",
            "times faster",
            "nodes; streamed (ms)",
            "balls; streamed (ms)",
            "times faster",
            "balls; written; card (ms)",
            "balls; streamed; card (ms)",
        ],
        rows: rows.iter().map(row).collect(),
    }
}

fn panels(rows: &[Row]) -> Vec<Panel> {
    let curve = |(pair, colour): (&str, Colour), kind: &str, style, value: &dyn Fn(&Row) -> f64| {
        let rows = rows.iter().filter(|row| row.pair == pair);
        Series {
            name: format!("{pair}: {kind}"),
            colour,
            style,
            points: rows
                .map(|row| [row.per_axis.pow(3) as f64, value(row)])
                .collect(),
            labels: Vec::new(),
        }
    };
    let both = |value: &dyn Fn(&Sums) -> f64| -> Vec<Series> {
        let of = |pair| {
            [
                curve(pair, "nodes", Style::Dashed, &|row| value(&row.nodes)),
                curve(pair, "balls", Style::Line, &|row| value(&row.balls)),
            ]
        };
        PAIRS.into_iter().flat_map(of).collect()
    };
    let paper = |points: &[[f64; 2]]| Series {
        name: "paper, its own pair".to_owned(),
        colour: [0xcc, 0, 0],
        style: Style::HollowDiscs,
        labels: Vec::new(),
        points: points
            .iter()
            .map(|[power, value]| [power.exp2(), *value])
            .collect(),
    };
    let panel = |title: &str, up: &str, mut series: Vec<Series>, points: &[[f64; 2]]| {
        series.push(paper(points));
        Panel {
            title: title.to_owned(),
            across: Axis::two("grid, m"),
            up: Axis::ten(up),
            series,
        }
    };
    let ratios = PAPER_RATIOS.map(|(power, ratio)| [f64::from(power), ratio]);
    let ratio = PAIRS.map(|pair| curve(pair, "balls", Style::Line, &Row::ratio));
    vec![
        panel(
            "Sums of nodes to one of balls",
            "n' / n",
            ratio.into(),
            &ratios,
        ),
        panel(
            "Memory, all sums written",
            "MB",
            both(&Sums::megabytes),
            &[],
        ),
        panel(
            "Time, all sums written",
            "processor time, ms",
            both(&|sums| 1e3 * sums.written.seconds),
            &PAPER_TIMES,
        ),
        panel(
            "Time, sums streamed",
            "processor time, ms",
            both(&|sums| 1e3 * sums.streamed.seconds),
            &[],
        ),
    ]
}
