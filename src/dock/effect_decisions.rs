//! Decisions which effects of the search are on, and why.

use crate::options::DockOptions;
use crate::options::effect_choice::EffectChoice;
use crate::options::refused;
use knotdock_scoring::terms::effect::{Effect, EffectInputs};
use knotdock_structures::Error;
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

/// The refusal of a requested effect for which the inputs lack data.
fn unscored(effect: Effect, reason: &str) -> Error {
    let message = format!("the effect {effect} cannot be scored: {reason}");
    Error::input(message).help(match effect {
        Effect::Restraint => {
            "leave out the options that name residues to block or attract, and restraint of --effects"
        }
        _ => "leave it out of --effects, or let auto choose what the inputs call for",
    })
}

/// One decision for each effect between two molecules, in the order of [`Effect::ALL`].
///
/// # Errors
/// [`Error`] when an effect is requested that the inputs lack something for, and when residues are named
/// without the effect that scores them.
pub(super) fn of_molecules(
    inputs: &EffectInputs,
    options: &DockOptions,
) -> Result<Vec<Decision>, Error> {
    if requested(Effect::Restraint, options) == Some(false) && options.restraints.names_residues() {
        let value = String::from(options.kernel.effects.clone());
        let bound = "auto or name restraint too, since residues are blocked or active";
        return Err(refused("effects", &value, bound));
    }
    let decide = |effect: Effect| {
        let definition = effect.definition();
        let (on, reason) = match (requested(effect, options), (definition.lacks)(inputs)) {
            (Some(false), _) => (false, "not requested".to_owned()),
            (Some(true), Some(reason)) => return Err(unscored(effect, &reason)),
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
/// [`Error`] when another effect is requested.
pub(super) fn of_meshes(options: &DockOptions) -> Result<Vec<Decision>, Error> {
    let decide = |effect: Effect| {
        let on = effect == Effect::Shape;
        let reason = effect.definition().of_meshes.to_owned();
        let names_residues = effect == Effect::Restraint && options.restraints.names_residues();
        if !on && (names_residues || requested(effect, options) == Some(true)) {
            return Err(unscored(effect, &reason));
        }
        Ok(Decision { effect, on, reason })
    };
    Effect::ALL.into_iter().map(decide).collect()
}
