//! Effect `shape`: complementarity of the two skins, the correlation of B&I.
//!
//! Shape is no pair term with labels and a class matrix: its kernel depends on the radii of both knots
//! ([`crate::kernel`]).

use super::EffectDefinition;

/// Definition of the effect.
pub(super) const EFFECT: EffectDefinition = EffectDefinition {
    id: "shape",
    of_meshes: "always on",
    components: 2.0,
    lacks: |_| None,
    reason: |_| "always on".to_owned(),
    term: |_, _, _| None,
};
