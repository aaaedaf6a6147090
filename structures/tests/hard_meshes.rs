//! Hard shapes, each with the expected result.

#![cfg(feature = "mesh")]

use std::f64::consts::PI;

use crate::solids::{Surface, cuboid, sphere};
use knotdock_structures::mesh::{MeshFormat, MeshReport, Solid, parse};
use knotdock_structures::sampling::decomposition::DecompositionOptions;
use knotdock_structures::sampling::hausdorff::{Fit, HausdorffMeter};
use knotdock_structures::sampling::{BallSet, Method, SampleError, SetName, knots, sample};

/// What was made of a shape, and how it fits, lengths as shares of eps.
struct Sampled {
    report: MeshReport,
    solid: Solid,
    sets: Vec<BallSet>,
    fits: Vec<Fit>,
    inside_nodes: usize,
    added: usize,
    volume: f64,
}

fn sampled(surface: &Surface, per_axis: usize) -> Sampled {
    let (mesh, report) = surface.mesh();
    let solid = Solid::new(&mesh).unwrap();
    let sampling = sample(
        &solid,
        per_axis,
        Method::BehandishIlies(DecompositionOptions::default()),
    )
    .unwrap();
    let meter = HausdorffMeter::new(&solid, &sampling.field);
    let epsilon = sampling.field.grid.epsilon();
    let volume = meter.volume() * solid.frame().unit.powi(3);
    let fits = sampling
        .sets
        .iter()
        .map(|set| {
            let mut fit = meter.measure(&set.balls);
            for length in [
                &mut fit.hausdorff_inward,
                &mut fit.hausdorff_outward,
                &mut fit.outward_bound,
            ] {
                *length /= epsilon;
            }
            fit
        })
        .collect();
    let covering = sampling.covering.unwrap();
    Sampled {
        report,
        solid,
        sets: sampling.sets,
        fits,
        inside_nodes: sampling.inside_nodes,
        added: covering.surface_balls + covering.interior_balls,
        volume,
    }
}

/// The bounds that hold for every closed mesh.
fn check(sampled: &Sampled) {
    assert!(sampled.report.is_closed());
    for (set, fit) in sampled.sets.iter().zip(&sampled.fits) {
        assert!(fit.hausdorff_inward <= 1.0, "{:?} {fit:?}", set.name);
        assert!(fit.outward_bound <= 1.0 + 1e-9, "{:?} {fit:?}", set.name);
        assert!(
            set.name != SetName::A1 || fit.outward_bound < 1e-9,
            "{fit:?}"
        );
        assert!(
            set.name != SetName::A2 || fit.hausdorff_inward == 0.0,
            "{fit:?}"
        );
    }
}

/// 1000 by 1 by 1: fifteen spacings to a side of the grid would each be 67 wide, so no node need be inside.
#[test]
fn a_needle() {
    let needle = sampled(&cuboid([0.0; 3], [1000.0, 1.0, 1.0]), 16);
    check(&needle);
    assert_eq!(needle.inside_nodes, 0, "nodes stand beside the axis");
    assert_eq!(needle.added, needle.sets[0].balls.len());
    // No ball is thicker than the needle, and some are as thick.
    assert!((8..200).contains(&needle.added), "{}", needle.added);
    let unit = needle.solid.frame().unit;
    for ball in &needle.sets[0].balls {
        assert!(
            ball.radius > 0.0 && ball.radius * unit <= 0.5 + 1e-9,
            "{}",
            ball.radius * unit
        );
    }
    // With nodes on the axis the same bounds hold.
    check(&sampled(&cuboid([0.0; 3], [1000.0, 1.0, 1.0]), 17));
}

#[test]
fn a_plate() {
    let plate = sampled(&cuboid([0.0; 3], [100.0, 80.0, 0.01]), 12);
    check(&plate);
    assert_eq!(plate.inside_nodes, 0);
    assert!((plate.report.volume - 80.0).abs() < 1e-9);
}

/// A wall of a thousandth of the radius: no node in it, and every ball no thicker than it.
#[test]
fn a_thin_shell() {
    let surface = sphere([0.0; 3], 1.0, 30).and(&sphere([0.0; 3], 0.99, 30).inverted());
    let shell = sampled(&surface, 14);
    check(&shell);
    assert_eq!(shell.report.parts, 2);
    let unit = shell.solid.frame().unit;
    for ball in &shell.sets[0].balls {
        assert!(ball.radius * unit <= 0.005 + 1e-9);
        assert!(shell.solid.is_inside(ball.center));
    }
    // The cavity stays empty: its middle is far from every ball, A2's too.
    assert!(!shell.solid.is_inside([0.0; 3]));
    for ball in shell.sets.iter().flat_map(|set| &set.balls) {
        let away = ball.center.iter().map(|v| v * v).sum::<f64>().sqrt();
        assert!(away - ball.radius > 0.3 * ball.radius);
    }
}

#[test]
fn two_touching_parts() {
    // At a face, along an edge, and at a corner.
    for shift in [[1.0, 0.0, 0.0], [1.0, 1.0, 0.0], [1.0, 1.0, 1.0]] {
        let pair = cuboid([0.0; 3], [1.0; 3]).and(&cuboid(shift, shift.map(|v| v + 1.0)));
        let pair = sampled(&pair, 15);
        assert!((pair.report.volume - 2.0).abs() < 1e-12);
        assert!((pair.volume - 2.0).abs() < 0.15, "{}", pair.volume);
        check(&pair);
    }
}

#[test]
fn a_cavity_stays_empty() {
    let cavity = sampled(
        &cuboid([-1.0; 3], [1.0; 3]).and(&cuboid([-0.5; 3], [0.5; 3]).inverted()),
        21,
    );
    check(&cavity);
    assert!(cavity.report.is_sound() && cavity.report.parts == 2);
    assert!((cavity.report.volume - 7.0).abs() < 1e-12);
    assert!((cavity.volume - 7.0).abs() < 0.4, "{}", cavity.volume);
    assert!(!cavity.solid.is_inside([0.0; 3]));
}

/// Far from the origin: 1e6 away, written with all digits of a double, a ball is sampled as at home.
#[test]
fn coordinates_at_a_million() {
    let at_home = sphere([0.0; 3], 1.0, 16);
    let far_off = at_home.clone().mapped(|p| p.map(|v| v + 1e6));
    let (mesh, _) = parse(far_off.ply_text().as_bytes(), MeshFormat::Ply).unwrap();
    let solid = Solid::new(&mesh).unwrap();
    let sampling = sample(
        &solid,
        16,
        Method::BehandishIlies(DecompositionOptions::default()),
    )
    .unwrap();
    // Rounding to 1e-10 breaks ties between symmetric nodes another way, so counts may differ; the bounds do not.
    assert_eq!(sampling.inside_nodes, sampled(&at_home, 16).inside_nodes);
    check(&sampled(&far_off, 16));
    let knots = knots(solid.frame(), &sampling.sets[0].balls, None).unwrap();
    for (center, radius) in knots.centers.iter().zip(&knots.radii) {
        let away = center.iter().map(|v| (v - 1e6).powi(2)).sum::<f64>().sqrt();
        assert!(away + radius <= 1.0 + 1e-8);
    }
}

/// A mesh 1e-6 across, and one 1e6: the same bits as at size one but for the power of two between the units.
#[test]
fn very_small_and_very_large() {
    let one = sampled(&sphere([0.0; 3], 1.0, 12), 12);
    for scale in [2f64.powi(-20), 2f64.powi(20)] {
        let other = sampled(
            &sphere([0.0; 3], 1.0, 12).mapped(|p| p.map(|v| v * scale)),
            12,
        );
        check(&other);
        for (a, b) in one.sets.iter().zip(&other.sets) {
            assert_eq!(a.balls, b.balls);
        }
    }
    check(&sampled(&sphere([0.0; 3], 1e-6, 12), 12));
}

/// A ball without its cap: warned of, and sampled up to where the winding number falls to one half.
#[test]
fn an_open_mesh() {
    let ball = sphere([0.0; 3], 1.0, 24);
    let mut open = ball.clone();
    open.triangles.retain(|t| {
        t.iter()
            .any(|&corner| ball.positions[corner as usize][2] < 0.85)
    });
    let open = sampled(&open, 20);
    assert!(!open.report.is_closed() && open.report.open_edges > 0);
    assert!(open.report.missing_share > 0.01 && open.report.missing_share < 0.2);
    assert!(open.report.warnings()[0].contains("not closed"));
    assert!(
        (open.volume / (4.0 / 3.0 * PI) - 1.0).abs() < 0.1,
        "{}",
        open.volume
    );
    // The radius is the distance to the triangles, so balls may bulge through the hole, by no more than it is wide.
    let frame = open.solid.frame();
    for ball in &open.sets[0].balls {
        let center = frame.outward(ball.center);
        let reach = center.iter().map(|v| v * v).sum::<f64>().sqrt() + ball.radius * frame.unit;
        assert!(reach < 1.0 + 0.55, "{reach}");
    }
}

#[test]
fn an_inverted_mesh_is_the_solid_turned_right() {
    let surface = sphere([0.0; 3], 1.0, 12);
    let right = sampled(&surface, 12);
    let inverted = sampled(&surface.inverted(), 12);
    check(&inverted);
    assert_eq!(inverted.report.inverted_parts, 1);
    assert!(!inverted.report.is_sound() && inverted.report.is_closed());
    assert!((inverted.report.volume - right.report.volume).abs() < 1e-12);
    assert_eq!(inverted.inside_nodes, right.inside_nodes);
}

/// Two balls that cross: their union. parry's inside test by pseudo-normals calls points of one ball near the other's
/// wall within it outside; a winding number does not.
#[test]
fn a_mesh_that_intersects_itself() {
    let (a, b) = (sphere([0.0; 3], 1.0, 20), sphere([1.0, 0.0, 0.0], 1.0, 20));
    let crossed = sampled(&a.and(&b), 24);
    check(&crossed);
    assert!(crossed.report.is_sound());
    // Two balls less the lens, the polyhedra being a little smaller.
    let union = 2.0 * 4.0 / 3.0 * PI - 5.0 * PI / 12.0;
    assert!(
        (crossed.volume / union - 1.0).abs() < 0.03,
        "{} {union}",
        crossed.volume
    );
    let at = |x: f64| crossed.solid.frame().inward([x, 0.01, 0.02]);
    assert!(
        crossed.solid.is_inside(at(0.05))
            && crossed.solid.is_inside(at(0.5))
            && crossed.solid.is_inside(at(-0.05))
    );
}

#[test]
fn degenerate_triangles_do_not_change_the_solid() {
    let clean = cuboid([0.0; 3], [1.0; 3]);
    let mut dirty = clean.clone();
    dirty.positions.extend([[0.3, 0.3, 0.0], [0.5, 0.5, 0.0]]);
    dirty
        .triangles
        .extend([[0, 8, 9], [9, 8, 0], [1, 1, 2], [3, 3, 3]]);
    let [clean, dirty] = [clean, dirty].map(|surface| sampled(&surface, 10));
    assert_eq!(dirty.report.degenerate_triangles, 4);
    for (a, b) in clean.sets.iter().zip(&dirty.sets) {
        assert_eq!(a.balls, b.balls);
    }
}

/// A curved sheet: nine tenths of the closed surface are missing, and only a sliver on its hollow side has a winding
/// number above one half. If no ball fits at all, the error says so.
#[test]
fn a_sheet_has_next_to_no_inside() {
    let ball = sphere([0.0; 3], 1.0, 40);
    let mut sheet = ball.clone();
    sheet.triangles.retain(|t| {
        t.iter()
            .all(|&corner| ball.positions[corner as usize][2] > 0.98)
    });
    let (mesh, report) = sheet.mesh();
    assert!(!report.is_closed() && report.missing_share > 0.9);
    let solid = Solid::new(&mesh).unwrap();
    for method in [Method::WellerZachmann, Method::Octree, Method::Voxels] {
        assert_eq!(
            sample(&solid, 8, method).err(),
            Some(SampleError::NothingInside)
        );
    }
    if let Ok(sampling) = sample(
        &solid,
        8,
        Method::BehandishIlies(DecompositionOptions::default()),
    ) {
        for ball in &sampling.sets[0].balls {
            assert!(solid.winding_number(ball.center) > 0.5 && ball.radius < 0.03);
        }
    }
}

/// A million triangles, by `cargo test -p knotdock-structures --test all hard_meshes -- --ignored --nocapture`.
#[test]
#[ignore = "a million triangles take a while"]
fn a_million_triangles() {
    let rings = 500;
    let surface = sphere([0.0; 3], 1.0, rings).mapped(|[x, y, z]| {
        let bump = 1.0 + 0.05 * (9.0 * x).sin() * (7.0 * y).sin() * (8.0 * z).cos();
        [bump * x, bump * y, bump * z]
    });
    let bytes = surface.stl_binary();
    let start = std::time::Instant::now();
    let (mesh, report) = parse(&bytes, MeshFormat::Stl).unwrap();
    println!("{report}; read in {:.2} s", start.elapsed().as_secs_f64());
    assert!(report.triangles > 990_000 && report.is_sound());
    let solid = Solid::new(&mesh).unwrap();
    println!("solid after {:.2} s", start.elapsed().as_secs_f64());
    let sampling = sample(
        &solid,
        64,
        Method::BehandishIlies(DecompositionOptions::default()),
    )
    .unwrap();
    println!(
        "sampled after {:.2} s: {:?}",
        start.elapsed().as_secs_f64(),
        sampling.steps
    );
    let meter = HausdorffMeter::new(&solid, &sampling.field);
    for set in &sampling.sets {
        let fit = meter.measure(&set.balls);
        println!("{:?}: {} balls, {fit:?}", set.name, set.balls.len());
        let epsilon = sampling.field.grid.epsilon();
        assert!(fit.hausdorff_inward <= epsilon && fit.outward_bound <= epsilon * (1.0 + 1e-12));
    }
    println!("judged after {:.2} s", start.elapsed().as_secs_f64());
    if let Ok(status) = std::fs::read_to_string("/proc/self/status") {
        let peak = status.lines().find(|line| line.starts_with("VmHWM"));
        println!("peak memory {}", peak.unwrap_or_default());
    }
}

/// Which of n shells like an onion's bound the solid took a look at every two of them: 25,000 took hours. More than some
/// 2,000 are refused at once.
#[test]
fn shells_within_shells_are_read_or_refused() {
    let onion = |shells: u32| {
        let shell = |number: u32| {
            let edge = 1.0 + f64::from(number);
            cuboid([-edge; 3], [edge; 3])
        };
        (1..shells).fold(shell(0), |all, number| all.and(&shell(number)))
    };
    let (_, report) = onion(200).mesh();
    assert_eq!(report.nested_parts, 199);
    let error = parse(onion(2500).obj().as_bytes(), MeshFormat::Obj).unwrap_err();
    assert!(
        error.to_string().contains("2500 closed surfaces"),
        "{error}"
    );
}
