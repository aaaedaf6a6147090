//! Dn: two rings of n copies face to face.

use super::*;
use knotdock_scoring::symmetry::RingAxis;
use nalgebra::UnitQuaternion;
use std::f64::consts::{PI, TAU};

/// A turn about an axis through a point.
fn turn(axis: &Unit<Vector3<f64>>, angle: f64, point: Vector3<f64>) -> Pose {
    Pose::about(UnitQuaternion::from_axis_angle(axis, angle), point, point)
}

/// Copies of a molecule at some poses, each with its own chain names.
fn copies(molecule: &Molecule, poses: &[Pose]) -> Molecule {
    let copy = |(pose, names): (&Pose, [char; 2])| {
        let mut copy = molecule.map_positions(|position| pose.apply(position));
        let first = copy.atoms[0].chain.clone();
        for atom in &mut copy.atoms {
            atom.chain = names[usize::from(atom.chain != first)].to_string();
        }
        copy.atoms
    };
    let names = [['A', 'B'], ['C', 'D'], ['E', 'F'], ['G', 'H']];
    let atoms = poses.iter().zip(names).flat_map(copy).collect();
    Molecule::new(atoms, Format::Pdb)
}

/// A ring of three trypsins, each with the inhibitor that one of a second ring binds: face to face they hold each
/// other's, and nothing fits as well.
#[test]
fn two_rings_that_are_known_to_fit_are_found_first() {
    let folder = tempfile::tempdir().unwrap();
    let [trypsin, inhibitor] =
        ["receptor_bound", "ligand_bound"].map(|name| molecule(&example(name)));
    let out = (center(&inhibitor) - center(&trypsin)).normalize();
    // As in the ring of two, half a turn about an axis behind the inhibitor takes one molecule to the other; the
    // ring's own axis crosses it far aside.
    let across = Unit::new_normalize(out.cross(&Vector3::new(0.3, 0.5, -0.8)));
    let behind = center(&inhibitor) + 14.0 * out;
    let half = turn(&across, PI, behind);
    let mut both = trypsin.clone();
    let partner = inhibitor.map_positions(|position| half.inverse().apply(position));
    both.atoms.extend(partner.atoms);
    let (axis, crossing) = (Unit::new_normalize(out), behind + 40.0 * *across);
    let turns = [0.0, 1.0, 2.0].map(|third| turn(&axis, third * TAU / 3.0, crossing));
    let ring = copies(&both, &turns);
    let mut file = fs::File::create(folder.path().join("ring.pdb")).unwrap();
    write_molecule(&mut file, Format::Pdb, &ring, &[]).unwrap();

    let options = "dock ring.pdb --symmetry D3 --rotations 24 --effects shape -o run --quiet";
    succeed(folder.path(), options.split(' '));
    let rows = rows(&folder.path().join("run"));
    let off = turns.map(|turn| rmsd(&ring, &pose(&rows[0]), &half.after(&turn)));
    assert!(
        off.into_iter().fold(f64::INFINITY, f64::min) < 1.0,
        "{off:?}"
    );
    assert!(number(&rows[0], "search_score") > 1.2 * number(&rows[1], "search_score"));
}

/// From a single molecule in two steps. Every row is half a turn about an axis that crosses the ring's at a right
/// angle, and scores as such a pair does. The files hold both rings. Results are the same for any number of threads,
/// and from the record.
#[test]
fn rows_lay_two_rings_face_to_face() {
    let folder = tempfile::tempdir().unwrap();
    let at = |path: &str| folder.path().join(path);
    let one = example("ligand_unbound");
    let small = "--effects shape --write-top 1 --quiet";
    let first = format!("dock {one} --symmetry C3 --rotations 40 --poses 60 -o ring {small}");
    succeed(folder.path(), first.split(' '));
    let file = "ring/top/rank_0001.pdb";
    let second =
        format!("dock {file} --symmetry D3 --rotations 12 --no-cluster --diagnostics {small}");
    let with = |more: &str| succeed(folder.path(), format!("{second} {more}").split(' '));
    with("--threads 1 -o run");
    let table = fs::read(at("run/poses.csv")).unwrap();
    let complex = fs::read(at("run/top/rank_0001.pdb")).unwrap();

    let ring = molecule(at(file).to_str().unwrap());
    let axis = RingAxis::of(&ring.copies(3).unwrap()).unwrap();
    let third = axis.turns().next().unwrap();
    let distance = |a: &Pose, b: &Pose| a.angle_to(b) + (a.translation - b.translation).norm();
    let rows = rows(&at("run"));
    assert!(rows.len() > 10);
    for row in &rows {
        let pose = pose(row);
        assert!(symmetry("D3").ring(&pose).is_some());
        // Across the axis: it turns the ring's own turns about.
        let turned = pose.after(&third).after(&pose);
        assert!(distance(&turned, &third.inverse()) < 1e-6);
        assert_eq!(
            (row["other_copies"].as_str(), row["refined"].as_str()),
            ("", "true")
        );
    }
    let exact = scorer_of_shape(&ring).score(&pose(&rows[0])).score;
    let own = number(&rows[0], "search_score");
    assert!((exact - own).abs() < 1e-6 * own.abs());

    let whole = molecule(at("run/top/rank_0001.pdb").to_str().unwrap());
    assert_eq!(whole.atoms.len(), 2 * ring.atoms.len());
    for (atom, image) in ring.atoms.iter().zip(&whole.atoms[ring.atoms.len()..]) {
        let off =
            Vector3::from(pose(&rows[0]).apply(atom.position)) - Vector3::from(image.position);
        assert!(off.norm() < 3e-3);
    }
    with("--threads 2 -o run --force");
    assert_eq!(fs::read(at("run/poses.csv")).unwrap(), table);
    assert_eq!(fs::read(at("run/top/rank_0001.pdb")).unwrap(), complex);
    let again = "dock --rerun run/run.json -o again --quiet";
    succeed(folder.path(), again.split(' '));
    assert_eq!(fs::read(at("again/poses.csv")).unwrap(), table);
}

#[test]
fn what_is_no_ring_has_no_second_one() {
    let folder = tempfile::tempdir().unwrap();
    fs::copy(example("ligand_unbound"), folder.path().join("a.pdb")).unwrap();
    let dimer = concat!(
        concat!(env!("CARGO_MANIFEST_DIR"), "/.."),
        "/structures/examples/4e43_dimer.pdb"
    );
    fs::copy(dimer, folder.path().join("dimer.pdb")).unwrap();
    // A copy that is moved and not turned.
    let one = molecule(&example("ligand_unbound"));
    let aside = Pose {
        translation: Vector3::new(40.0, 0.0, 0.0),
        ..Pose::identity()
    };
    let mut file = fs::File::create(folder.path().join("row.pdb")).unwrap();
    let row = copies(&one, &[Pose::identity(), aside]);
    write_molecule(&mut file, Format::Pdb, &row, &[]).unwrap();
    for (options, said) in [
        ("a.pdb --symmetry D2", "1 in all, make no 2 copies"),
        ("dimer.pdb --symmetry D3", "2 in all, make no 3 copies"),
        ("row.pdb --symmetry D2", "by 180 degrees"),
        ("a.pdb --symmetry D1", "no symmetry"),
        ("dimer.pdb --symmetry D2 --engine gpu", "engine is gpu"),
    ] {
        let reported = refused(folder.path(), &format!("dock {options}"));
        assert!(reported.contains(said), "{options}: {reported}");
    }
    let reported = refused(folder.path(), "dock a.pdb --symmetry D2 -o never");
    for part in ["a.pdb", "--symmetry C2 first"] {
        assert!(reported.contains(part), "{reported}");
    }
    assert!(!folder.path().join("never").exists());
}
