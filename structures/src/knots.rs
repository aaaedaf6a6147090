//! Knots: a solid as a countable set of balls, held as parallel arrays.

use crate::vector::bounds;

/// A set of weighted balls: sum_i c_i of a bump of radius r_i about x_i (B&I section 2.2).
///
/// The arrays have the same length; labels may be absent altogether. Weights are real: the affinity function with its
/// complex weights (B&I eq. 51) is a type of the scoring crate. Further effects act on the labels.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Knots {
    /// Ball centres x_i, in Å (or the mesh's unit).
    pub centers: Vec<[f64; 3]>,
    /// Ball radii r_i > 0, in the unit of `centers`.
    pub radii: Vec<f64>,
    /// Dimensionless weights c_i.
    pub weights: Vec<f64>,
    /// Weights of the same balls grown by the offset, for the product kernel; empty if `weights` serve them too.
    pub skin_weights: Vec<f64>,
    /// Charges in units of the elementary charge e, one per knot; empty if the knots carry none (a mesh).
    pub charges: Vec<f64>,
    /// Contact types, one per knot, `None` for a knot of no known type; empty if the knots carry none.
    pub contact_types: Vec<Option<u8>>,
    /// Kinds of atoms ([`crate::molecule::atom_kinds`]), one per knot, `None` for a knot of no known kind; empty if
    /// the knots carry none.
    pub atom_kinds: Vec<Option<u8>>,
}

/// Why a set of knots was refused.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[error("{0}")]
pub struct KnotsError(String);

impl Knots {
    /// Knots of unit weight.
    ///
    /// # Errors
    /// [`KnotsError`] when the set is empty, the lengths differ, or a number is not usable.
    pub fn new(centers: Vec<[f64; 3]>, radii: Vec<f64>) -> Result<Self, KnotsError> {
        let weights = vec![1.0; centers.len()];
        Self::with_weights(centers, radii, weights)
    }

    /// Knots with the given weights.
    ///
    /// # Errors
    /// As [`Knots::new`].
    pub fn with_weights(
        centers: Vec<[f64; 3]>,
        radii: Vec<f64>,
        weights: Vec<f64>,
    ) -> Result<Self, KnotsError> {
        let knots = Self {
            centers,
            radii,
            weights,
            ..Self::default()
        };
        knots.checked()
    }

    /// The same knots with charges (e) and contact types, either of which may be empty.
    ///
    /// # Errors
    /// [`KnotsError`] when there are labels but not one per knot, or a charge is not finite.
    pub fn with_labels(
        self,
        charges: Vec<f64>,
        contact_types: Vec<Option<u8>>,
    ) -> Result<Self, KnotsError> {
        let knots = Self {
            charges,
            contact_types,
            ..self
        };
        knots.checked()
    }

    /// The same knots with weights for the balls grown by the offset, one per knot, or none.
    ///
    /// Grown balls overlap more than the balls do: weights that add up to one in the solid add up to more in its skin.
    ///
    /// # Errors
    /// [`KnotsError`] when there are weights but not one per knot, or one is not finite.
    pub fn with_skin_weights(self, skin_weights: Vec<f64>) -> Result<Self, KnotsError> {
        let knots = Self {
            skin_weights,
            ..self
        };
        knots.checked()
    }

    /// The same knots with kinds of atoms, which may be empty.
    ///
    /// # Errors
    /// [`KnotsError`] when there are kinds but not one per knot.
    pub fn with_atom_kinds(self, atom_kinds: Vec<Option<u8>>) -> Result<Self, KnotsError> {
        Self { atom_kinds, ..self }.checked()
    }

    fn checked(self) -> Result<Self, KnotsError> {
        self.check().map(|()| self)
    }

    /// Checks what every user of knots relies on: equal lengths, at least one ball, finite numbers, radii above zero.
    ///
    /// # Errors
    /// The first fault found, as a [`KnotsError`].
    pub fn check(&self) -> Result<(), KnotsError> {
        let refuse = |message| Err(KnotsError(message));
        let [centers, radii, weights] = [self.centers.len(), self.radii.len(), self.weights.len()];
        if centers != radii || centers != weights {
            return refuse(format!(
                "{centers} centres, {radii} radii and {weights} weights: the three must be equally many"
            ));
        }
        if centers == 0 {
            return refuse("there are no knots; at least one ball is needed".to_owned());
        }
        let numbers = self.radii.iter().zip(&self.weights);
        for (index, (center, (radius, weight))) in self.centers.iter().zip(numbers).enumerate() {
            if !center.iter().all(|c| c.is_finite()) {
                return refuse(format!(
                    "knot {index} has centre {center:?}; coordinates must be finite"
                ));
            }
            if !(radius.is_finite() && *radius > 0.0) {
                return refuse(format!(
                    "knot {index} has radius {radius}; radii must be finite and above zero"
                ));
            }
            if !weight.is_finite() {
                return refuse(format!("knot {index} has a weight that is not finite"));
            }
        }
        if let Some(index) = self.skin_weights.iter().position(|one| !one.is_finite()) {
            return refuse(format!("knot {index} has a weight that is not finite"));
        }
        let labels = [
            ("skin weights", self.skin_weights.len()),
            ("charges", self.charges.len()),
            ("contact types", self.contact_types.len()),
            ("atom kinds", self.atom_kinds.len()),
        ];
        if let Some((name, labels)) = labels.into_iter().find(|(_, n)| ![0, centers].contains(n)) {
            return refuse(format!(
                "{labels} {name} for {centers} knots; there must be one per knot, or none at all"
            ));
        }
        match self
            .charges
            .iter()
            .enumerate()
            .find(|(_, charge)| !charge.is_finite())
        {
            Some((index, charge)) => refuse(format!(
                "knot {index} has charge {charge}; charges must be finite"
            )),
            None => Ok(()),
        }
    }

    /// Number of knots.
    pub fn len(&self) -> usize {
        self.centers.len()
    }

    /// Whether there are no knots.
    pub fn is_empty(&self) -> bool {
        self.centers.is_empty()
    }

    /// Smallest and largest centre coordinate per axis, in Å.
    pub fn bounds(&self) -> ([f64; 3], [f64; 3]) {
        bounds(self.centers.iter().copied())
    }

    /// The distinct radii in rising order, and the index of each knot's radius among them.
    pub fn radius_classes(&self) -> (Vec<f64>, Vec<usize>) {
        let mut distinct = self.radii.clone();
        distinct.sort_by(f64::total_cmp);
        distinct.dedup();
        let class = self
            .radii
            .iter()
            .map(|radius| distinct.partition_point(|other| other < radius))
            .collect();
        (distinct, class)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn refuses_what_cannot_be_scored() {
        let one = vec![[0.0; 3]];
        let refused = |centers: Vec<[f64; 3]>, radii: Vec<f64>, why: &str| {
            let error = Knots::new(centers, radii).unwrap_err();
            assert!(error.to_string().contains(why), "{error}");
        };
        refused(vec![], vec![], "no knots");
        for radius in [0.0, -1.0, f64::NAN, f64::INFINITY] {
            refused(one.clone(), vec![radius], "knot 0 has radius");
        }
        refused(vec![[0.0, f64::NAN, 0.0]], vec![1.0], "knot 0 has centre");
        refused(one, vec![1.0, 2.0], "1 centres, 2 radii and 1 weights");
    }

    #[test]
    fn radius_classes_are_sorted_and_point_back() {
        let knots = Knots::new(vec![[0.0; 3]; 4], vec![1.9, 1.5, 1.9, 1.7]).unwrap();
        let (radii, class) = knots.radius_classes();
        assert_eq!(radii, [1.5, 1.7, 1.9]);
        assert_eq!(class, [2, 0, 2, 1]);
    }
}
