//! Collisions held to obstacles.

use knotdock_scoring::se3::Pose;
use knotdock_structures::sampling::ball_tree::BallTree;

use super::tests::solid;
use super::{CollisionScene, Deadline, Verdict, Workspace};
use crate::geometry::bracket::Bracket;
use crate::geometry::obstacle::obstacle;

/// A translation lies in the obstacle where collide finds a hit, and only there: two ways to one question (eq. 29 and
/// 50), of 10,000 poses at 20 rotations, inner and outer balls alike.
#[test]
fn the_obstacle_agrees_with_the_verdicts() {
    let (block, other) = (
        solid(&[([1.0, 0.6, 0.4], false)], 8),
        solid(&[([0.7, 0.3, 0.9], false)], 8),
    );
    let [a, b] = [&block, &other].map(Bracket::from);
    let scene = CollisionScene::new([block, other], 0.0);
    let mut work = Workspace::new();
    let mut counts = [0; 3];
    for turn in 0..20 {
        let part = |by: f64| 2.0 * (f64::from(turn) * by).fract() - 1.0;
        let rotation = [0.3 + part(0.8191), part(0.671), part(0.5497), part(0.4503)];
        let turned = Pose::from_parts(rotation, [0.0; 3]);
        let found = obstacle(&a, &b, &turned, 0.0);
        let trees = [&found.inner, &found.outer].map(|balls| BallTree::new(balls));
        for step in 0..500 {
            let part = |by: f64| 2.2 * (2.0 * (f64::from(500 * turn + step) * by).fract() - 1.0);
            let place = [part(0.7548), part(0.5698), part(0.3333)];
            let pose = Pose {
                rotation: turned.rotation,
                translation: place.into(),
            };
            let relative = [0, 1, 2].map(|axis| place[axis] - found.origin[axis]);
            let [inner, outer] = [0, 1].map(|set| trees[set].distance(relative, f64::NEG_INFINITY));
            if inner.abs().min(outer.abs()) < 1e-9 {
                continue;
            }
            let expected = match (inner < 0.0, outer < 0.0) {
                (true, _) => Verdict::Hit,
                (false, true) => Verdict::Undecided,
                (false, false) => Verdict::Free,
            };
            let verdict = scene
                .verdict(&scene.motion(&pose), Deadline::NEVER, &mut work)
                .verdict;
            assert_eq!(verdict, expected, "{turn} {step}: {inner} {outer}");
            counts[verdict as usize] += 1;
        }
    }
    assert!(counts.iter().all(|&count| count > 300), "{counts:?}");
}
