//! Times of a run's stages and effects, which `--verbose` shows.

use crate::tables::report::align;
use knotdock::dock::outcome::DockOutcome;

/// A line a stage, with its time on the clock and of all processors, and a line an effect, with its part of a rotation.
pub fn timings_text(outcome: &DockOutcome) -> String {
    let mut stages = vec![["stage", "wall s", "CPU s"].map(str::to_owned).to_vec()];
    stages.extend(outcome.timing.iter().map(|stage| {
        let cpu = stage.cpu_seconds;
        vec![
            stage.name.to_owned(),
            format!("{:.3}", stage.wall_seconds),
            cpu.map_or_else(|| "-".to_owned(), |seconds| format!("{seconds:.3}")),
        ]
    }));
    let mut effects = vec![
        ["effect", "functions", "ms a rotation"]
            .map(str::to_owned)
            .to_vec(),
    ];
    effects.extend(outcome.effects.iter().map(|cost| {
        vec![
            cost.effect.to_string(),
            format!("{:.1}", cost.functions),
            format!("{:.3}", cost.milliseconds_per_rotation),
        ]
    }));
    format!("{}\n\n{}", align(&stages), align(&effects))
}
