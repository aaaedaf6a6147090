//! The energies of pairs, as each of the two sites sees them.

use super::Problem;

/// Energies of a site's states with those of another, the other's running fastest.
pub(super) struct SiteTable {
    pub other: usize,
    columns: usize,
    energies: Vec<f64>,
}

impl SiteTable {
    /// The energies of one state with all of the other's.
    pub fn row(&self, state: usize) -> &[f64] {
        &self.energies[state * self.columns..][..self.columns]
    }
}

/// Each site's tables.
pub(super) fn site_tables(problem: &Problem) -> Vec<Vec<SiteTable>> {
    let mut tables: Vec<Vec<SiteTable>> = problem.own.iter().map(|_| Vec::new()).collect();
    for pair in &problem.pairs {
        let [a, b] = pair.sites;
        let (rows, columns) = (problem.own[a].len(), problem.own[b].len());
        let transposed = (0..rows * columns).map(|k| pair.energies[k % rows * columns + k / rows]);
        tables[b].push(SiteTable {
            other: a,
            columns: rows,
            energies: transposed.collect(),
        });
        tables[a].push(SiteTable {
            other: b,
            columns,
            energies: pair.energies.clone(),
        });
    }
    tables
}

/// Energy of a state of a site beside the others' present ones.
pub(super) fn beside(
    problem: &Problem,
    tables: &[Vec<SiteTable>],
    [site, state]: [usize; 2],
    states: &[usize],
) -> f64 {
    let with = tables[site]
        .iter()
        .map(|table| table.row(state)[states[table.other]]);
    problem.own[site][state] + with.sum::<f64>()
}
