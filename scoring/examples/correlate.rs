//! Correlates two knot sets: five balls around a hole, and one that fits into it. Lengths are in Å.
use knotdock_scoring::{Correlator, Options};
use knotdock_structures::Knots;
use nalgebra::UnitQuaternion;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let angles = (0..5).map(|i| f64::from(i) * 72f64.to_radians());
    let centers = angles.map(|angle| [6.0 * angle.cos(), 6.0 * angle.sin(), 0.0]);
    let receptor = Knots::new(centers.collect(), vec![1.7; 5])?;
    let ligand = Knots::new(vec![[0.0; 3]], vec![1.9])?;

    let mut correlator = Correlator::new(&receptor, &ligand, &Options::default())?;
    let best = correlator.correlate(&UnitQuaternion::identity())?.best();
    let [x, y, z] = best.pose.translation.into();
    println!("{:.1} at ({x:.1}, {y:.1}, {z:.1})", best.score);
    assert!(best.score > 0.0 && best.pose.translation.norm() < 3.0);
    Ok(())
}
