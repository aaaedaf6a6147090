//! The plan of a run in words.

use crate::dock::plan::DockPlan;
use crate::options::{EngineChoice, Precision};

impl std::fmt::Display for DockPlan {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        // Three significant digits or so, two decimals of an Ångström.
        let below = -self.angstrom.log10().floor() as i32;
        let (digits, finer) = ((2 + below).max(0) as usize, (3 - below).max(0) as usize);
        let rotations = self.search.space.sampled(self.rotations);
        write!(
            f,
            "{} {rotations} ({:.1} degrees covering radius), grid {} x {} x {} at {:.digits$} {unit}, {} modes \
             below {:.finer$} per {unit}, \
             window of {} on {} x {} x {}, lifted axis -{K}..{K}; about {:.0} MB with {} in flight",
            self.rotations,
            self.covering_radius_degrees,
            self.grid[0],
            self.grid[1],
            self.grid[2],
            self.spacing,
            self.modes,
            self.search.engine.modes().cut,
            self.spreading_width,
            self.fine_grid[0],
            self.fine_grid[1],
            self.fine_grid[2],
            self.memory_bytes() as f64 / 1e6,
            self.search.in_flight,
            K = self.lifted_modes,
            unit = self.unit,
            digits = digits,
            finer = finer,
        )?;
        if self.options.search.precision == Precision::Double {
            write!(f, "; in double precision")?;
        }
        if self.options.search.engine == EngineChoice::Gpu {
            write!(f, "; on a graphics processor")?;
        }
        if let Some(finer) = self.options.search.fine_rotations {
            write!(
                f,
                "; then about {:.0}% of {finer} finer rotations, about the best",
                100.0 * self.options.search.fine_share
            )?;
        }
        Ok(())
    }
}
