//! Times of the dockings: medians of rounds through all settings, so that a slow minute falls on all alike.

use crate::settings::{Pair, Setting};
use cpu_time::ProcessTime;
use knotdock::dock::plan::plan;
use knotdock::dock::run::{dock, molecule_points};
use knotdock::progress::NoProgress;
use std::error::Error;

/// Rounds through all settings.
const ROUNDS: usize = 3;

/// What a docking had, and took in processor seconds.
pub struct Measured {
    /// Atoms of both molecules.
    pub atoms: usize,
    /// Points per axis.
    pub grid: [usize; 3],
    /// Rotations that were searched.
    pub rotations: usize,
    /// Components of the lifted axis in use.
    pub components: usize,
    /// Poses after the search.
    pub poses: usize,
    /// Seconds of the search stage.
    pub search: f64,
    /// Seconds of planning and docking.
    pub docking: f64,
}

impl Measured {
    /// Seconds of a rotation.
    pub fn rotation(&self) -> f64 {
        self.search / self.rotations as f64
    }

    /// Points of the grid.
    pub fn points(&self) -> usize {
        self.grid.iter().product()
    }
}

/// Docks every setting in every round.
pub fn measure(pair: &Pair, settings: &[Setting]) -> Result<Vec<Measured>, Box<dyn Error>> {
    let mut rounds: Vec<Vec<Measured>> = settings.iter().map(|_| Vec::new()).collect();
    for round in 1..=ROUNDS {
        for (setting, rounds) in settings.iter().zip(&mut rounds) {
            rounds.push(docked(pair, setting)?);
        }
        eprintln!("round {round} of {ROUNDS}");
    }
    Ok(rounds.into_iter().filter_map(of_rounds).collect())
}

fn docked(pair: &Pair, setting: &Setting) -> Result<Measured, Box<dyn Error>> {
    let receptor = pair.receptor(setting);
    let start = ProcessTime::now();
    let plan = plan(&receptor, &pair.ligand, &setting.options)?;
    let outcome = dock(&plan, &molecule_points(&pair.ligand), &NoProgress)?;
    let docking = start.elapsed().as_secs_f64();
    let stages = outcome.timing.iter();
    let search = stages
        .filter(|stage| stage.name == "search")
        .map(|stage| stage.cpu_seconds.unwrap_or(stage.wall_seconds))
        .sum();
    Ok(Measured {
        atoms: receptor.atoms.len() + pair.ligand.atoms.len(),
        grid: plan.grid,
        rotations: outcome.searched,
        components: outcome.rank,
        poses: outcome.poses_kept,
        search,
        docking,
    })
}

/// The median of each time; all else is the same in every round.
fn of_rounds(rounds: Vec<Measured>) -> Option<Measured> {
    let median = |time: fn(&Measured) -> f64| {
        let mut times: Vec<f64> = rounds.iter().map(time).collect();
        times.sort_by(f64::total_cmp);
        times.get(times.len() / 2).copied()
    };
    let search = median(|one| one.search)?;
    let docking = median(|one| one.docking)?;
    let first = rounds.into_iter().next()?;
    Some(Measured {
        search,
        docking,
        ..first
    })
}
