//! Times of a run's stages and effects, which `--verbose` shows.

use crate::tables::report::text_table;
use knotdock::dock::outcome::DockOutcome;

/// A line a stage, with its time on the clock and of all processors, and a line an effect, with its part of a rotation.
pub fn timings_text(outcome: &DockOutcome) -> String {
    let stages = outcome.timing.iter().map(|stage| {
        let cpu = stage.cpu_seconds;
        vec![
            stage.name.to_owned(),
            format!("{:.3}", stage.wall_seconds),
            cpu.map_or_else(|| "-".to_owned(), |seconds| format!("{seconds:.3}")),
        ]
    });
    let effects = outcome.effects.iter().map(|cost| {
        vec![
            cost.effect.to_string(),
            format!("{:.1}", cost.functions),
            format!("{:.3}", cost.milliseconds_per_rotation),
        ]
    });
    let stages = text_table("stage|wall s|CPU s", stages);
    let effects = text_table("effect|functions|ms a rotation", effects);
    format!("{stages}\n\n{effects}")
}
