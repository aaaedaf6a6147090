//! Decisions which effects of the search are on, and why.

use crate::error::SearchError;
use crate::options::DockOptions;
use crate::options::effect_choice::EffectChoice;
use knotdock_scoring::terms::effect::{Effect, EffectInputs};
use serde::Serialize;

/// Whether an effect is on, and why.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Decision {
    /// The effect.
    pub effect: Effect,
    /// Whether it is on.
    pub on: bool,
    /// Why.
    pub reason: String,
}

/// Whether the options request an effect; `None` where the inputs decide.
fn requested(effect: Effect, options: &DockOptions) -> Option<bool> {
    match &options.kernel.effects {
        EffectChoice::Auto => None,
        EffectChoice::Only(effects) => Some(effects.contains(&effect)),
    }
}

/// One decision for each effect between two molecules, in the order of [`Effect::ALL`].
///
/// # Errors
/// [`SearchError`] when an effect is requested that the inputs lack something for, and when residues are named
/// without the effect that scores them.
pub(super) fn of_molecules(
    inputs: &EffectInputs,
    options: &DockOptions,
) -> Result<Vec<Decision>, SearchError> {
    if requested(Effect::Restraint, options) == Some(false) && options.restraints.names_residues() {
        return Err(SearchError::Option {
            name: "effects",
            value: options.kernel.effects.clone().into(),
            bound: "auto or name restraint too, since residues are blocked or active".to_owned(),
        });
    }
    let decide = |effect: Effect| {
        let definition = effect.definition();
        let (on, reason) = match (requested(effect, options), (definition.lacks)(inputs)) {
            (Some(false), _) => (false, "not requested".to_owned()),
            (Some(true), Some(reason)) => return Err(SearchError::Effect { effect, reason }),
            (None, Some(reason)) => (false, reason),
            (_, None) => (true, (definition.reason)(inputs)),
        };
        Ok(Decision { effect, on, reason })
    };
    Effect::ALL.into_iter().map(decide).collect()
}

/// The decisions of two meshes, which shape alone scores.
///
/// # Errors
/// [`SearchError`] when another effect is requested.
pub(super) fn of_meshes(options: &DockOptions) -> Result<Vec<Decision>, SearchError> {
    let decide = |effect: Effect| {
        let on = effect == Effect::Shape;
        let reason = effect.definition().of_meshes.to_owned();
        let names_residues = effect == Effect::Restraint && options.restraints.names_residues();
        if !on && (names_residues || requested(effect, options) == Some(true)) {
            return Err(SearchError::Effect { effect, reason });
        }
        Ok(Decision { effect, on, reason })
    };
    Effect::ALL.into_iter().map(decide).collect()
}
