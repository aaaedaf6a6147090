//! Knots: a solid as a countable set of balls, held as parallel arrays.

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
    /// Weights of the same balls grown by the offset, for the product kernel; empty where `weights` serve them too.
    pub skin_weights: Vec<f64>,
    /// Charges in units of the elementary charge e, one a knot; empty where the knots carry none (a mesh).
    pub charges: Vec<f64>,
    /// Contact types, one a knot, `None` for a knot of no known type; empty where the knots carry none.
    pub contact_types: Vec<Option<u8>>,
    /// Kinds of atoms ([`crate::molecule::atom_kinds`]), one a knot, `None` for a knot of no known kind; empty where
    /// the knots carry none.
    pub atom_kinds: Vec<Option<u8>>,
}

/// Why a set of knots was refused.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum KnotsError {
    /// The set has no ball at all.
    #[error("there are no knots; at least one ball is needed")]
    Empty,
    /// The parallel arrays differ in length.
    #[error(
        "{centers} centres, {radii} radii and {weights} weights: the three must be equally many"
    )]
    Lengths {
        /// Number of centres given.
        centers: usize,
        /// Number of radii given.
        radii: usize,
        /// Number of weights given.
        weights: usize,
    },
    /// A radius is zero, negative, NaN or infinite.
    #[error("knot {index} has radius {radius}; radii must be finite and above zero")]
    Radius {
        /// Index of the offending knot.
        index: usize,
        /// Its radius.
        radius: f64,
    },
    /// A coordinate is NaN or infinite.
    #[error("knot {index} has centre {center:?}; coordinates must be finite")]
    Center {
        /// Index of the offending knot.
        index: usize,
        /// Its centre.
        center: [f64; 3],
    },
    /// A weight is NaN or infinite.
    #[error("knot {index} has a weight that is not finite")]
    Weight {
        /// Index of the offending knot.
        index: usize,
    },
    /// A charge is NaN or infinite.
    #[error("knot {index} has charge {charge}; charges must be finite")]
    Charge {
        /// Index of the offending knot.
        index: usize,
        /// Its charge in e.
        charge: f64,
    },
    /// There are labels, but not one a knot.
    #[error("{labels} {name} for {knots} knots; there must be one a knot, or none at all")]
    Labels {
        /// Which labels.
        name: &'static str,
        /// How many of them were given.
        labels: usize,
        /// Number of knots.
        knots: usize,
    },
}

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
            skin_weights: Vec::new(),
            charges: Vec::new(),
            contact_types: Vec::new(),
            atom_kinds: Vec::new(),
        };
        knots.check()?;
        Ok(knots)
    }

    /// The same knots with charges (e) and contact types, either of which may be empty.
    ///
    /// # Errors
    /// [`KnotsError`] when there are labels but not one a knot, or a charge is not finite.
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
        knots.check()?;
        Ok(knots)
    }

    /// The same knots with weights for the balls grown by the offset, one a knot, or none.
    ///
    /// Grown balls overlap more than the balls do: weights that add up to one in the solid add up to more in its skin.
    ///
    /// # Errors
    /// [`KnotsError`] when there are weights but not one a knot, or one is not finite.
    pub fn with_skin_weights(self, skin_weights: Vec<f64>) -> Result<Self, KnotsError> {
        let knots = Self {
            skin_weights,
            ..self
        };
        knots.check()?;
        Ok(knots)
    }

    /// The same knots with kinds of atoms, which may be empty.
    ///
    /// # Errors
    /// [`KnotsError`] when there are kinds but not one a knot.
    pub fn with_atom_kinds(self, atom_kinds: Vec<Option<u8>>) -> Result<Self, KnotsError> {
        let knots = Self { atom_kinds, ..self };
        knots.check()?;
        Ok(knots)
    }

    /// Checks what every user of knots relies on: equal lengths, at least one ball, finite numbers, radii above zero.
    ///
    /// # Errors
    /// The first fault found, as a [`KnotsError`].
    pub fn check(&self) -> Result<(), KnotsError> {
        if self.centers.len() != self.radii.len() || self.centers.len() != self.weights.len() {
            return Err(KnotsError::Lengths {
                centers: self.centers.len(),
                radii: self.radii.len(),
                weights: self.weights.len(),
            });
        }
        if self.centers.is_empty() {
            return Err(KnotsError::Empty);
        }
        for (index, ((&center, &radius), weight)) in self
            .centers
            .iter()
            .zip(&self.radii)
            .zip(&self.weights)
            .enumerate()
        {
            if !center.iter().all(|c| c.is_finite()) {
                return Err(KnotsError::Center { index, center });
            }
            if !(radius.is_finite() && radius > 0.0) {
                return Err(KnotsError::Radius { index, radius });
            }
            if !weight.is_finite() {
                return Err(KnotsError::Weight { index });
            }
        }
        if let Some(index) = self
            .skin_weights
            .iter()
            .position(|weight| !weight.is_finite())
        {
            return Err(KnotsError::Weight { index });
        }
        let labels = [
            ("skin weights", self.skin_weights.len()),
            ("charges", self.charges.len()),
            ("contact types", self.contact_types.len()),
            ("atom kinds", self.atom_kinds.len()),
        ];
        for (name, labels) in labels {
            if labels != 0 && labels != self.len() {
                let knots = self.len();
                return Err(KnotsError::Labels {
                    name,
                    labels,
                    knots,
                });
            }
        }
        match self.charges.iter().position(|charge| !charge.is_finite()) {
            Some(index) => Err(KnotsError::Charge {
                index,
                charge: self.charges[index],
            }),
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
        let mut low = [f64::INFINITY; 3];
        let mut high = [f64::NEG_INFINITY; 3];
        for center in &self.centers {
            for axis in 0..3 {
                low[axis] = low[axis].min(center[axis]);
                high[axis] = high[axis].max(center[axis]);
            }
        }
        (low, high)
    }

    /// The distinct radii in rising order, and for each knot the index of its own among them.
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
        assert_eq!(Knots::new(vec![], vec![]), Err(KnotsError::Empty));
        for radius in [0.0, -1.0, f64::NAN, f64::INFINITY] {
            assert!(matches!(
                Knots::new(one.clone(), vec![radius]),
                Err(KnotsError::Radius { index: 0, .. })
            ));
        }
        assert!(matches!(
            Knots::new(vec![[0.0, f64::NAN, 0.0]], vec![1.0]),
            Err(KnotsError::Center { index: 0, .. })
        ));
        assert!(matches!(
            Knots::new(one, vec![1.0, 2.0]),
            Err(KnotsError::Lengths { .. })
        ));
    }

    #[test]
    fn radius_classes_are_sorted_and_point_back() {
        let knots = Knots::new(vec![[0.0; 3]; 4], vec![1.9, 1.5, 1.9, 1.7]).unwrap();
        let (radii, class) = knots.radius_classes();
        assert_eq!(radii, [1.5, 1.7, 1.9]);
        assert_eq!(class, [2, 0, 2, 1]);
    }
}
