//! Cn: copies of one molecule about an axis.

use super::*;

/// Trypsin with the inhibitor of its neighbour in a ring of two: each then holds the other's inhibitor, as the
/// complex has it, and no fit is as good.
#[test]
fn a_ring_that_is_known_to_fit_is_found_first() {
    let folder = tempfile::tempdir().unwrap();
    let [trypsin, inhibitor] =
        ["receptor_bound", "ligand_bound"].map(|name| molecule(&example(name)));
    let (pair, from) = (symmetry("C2"), center(&trypsin));
    let out = (center(&inhibitor) - from).normalize();
    // An axis behind the inhibitor, so far that its images stand clear of each other.
    let axis = Unit::new_normalize(out.cross(&Vector3::new(0.3, 0.5, -0.8)));
    let point = center(&inhibitor) + 14.0 * out;
    let rotation = pair.rotation(&axis);
    let known = Pose {
        rotation,
        translation: point - rotation * point,
    };
    let mut both = trypsin.clone();
    let neighbours = inhibitor.map_positions(|position| known.inverse().apply(position));
    both.atoms.extend(neighbours.atoms);
    let path = folder.path().join("both.pdb");
    let mut file = fs::File::create(&path).unwrap();
    write_molecule(&mut file, Format::Pdb, &both, &[]).unwrap();

    let options =
        "dock both.pdb --symmetry C2 --rotations 100 --poses 100 --effects shape -o run --quiet";
    succeed(folder.path(), options.split(' '));
    let rows = rows(&folder.path().join("run"));
    // The first pose of the ring is the one with the fewest contacts of termini.
    assert!(rmsd(&both, &pose(&rows[0]), &known) < 1.5);
    assert!(number(&rows[0], "search_score") > 1.2 * number(&rows[1], "search_score"));
}

/// Docks a small protein into rings of shape alone; the run's object and rows.
fn small(folder: &Path, symmetry: &str, more: &[&str]) -> (Value, Vec<Row>) {
    let molecule = example("ligand_unbound");
    let mut arguments = vec!["dock", &molecule, "--symmetry", symmetry, "-o", "run"];
    arguments.extend(["--rotations", "40", "--poses", "60", "--effects", "shape"]);
    arguments.extend(["--write-top", "2", "--force", "--json"]);
    arguments.extend(more);
    let output = succeed(folder, arguments);
    (
        serde_json::from_slice(&output.stdout).unwrap(),
        rows(&folder.join("run")),
    )
}

/// Radius of gyration of a molecule's atoms, Å.
fn gyration(molecule: &Molecule) -> f64 {
    let count = molecule.atoms.len() as f64;
    let positions = || {
        molecule
            .atoms
            .iter()
            .map(|atom| Vector3::from(atom.position))
    };
    let middle = positions().sum::<Vector3<f64>>() / count;
    (positions()
        .map(|x| (x - middle).norm_squared())
        .sum::<f64>()
        / count)
        .sqrt()
}

/// Every row closes into a ring and repeats no better one of its cluster, and its parts are the exact sums of
/// neighbours and of the others at the printed pose.
#[test]
fn rows_are_rings_and_score_as_their_pairs_do() {
    let folder = tempfile::tempdir().unwrap();
    let file = example("ligand_unbound");
    let mut alphas = molecule(&file);
    alphas.atoms.retain(|atom| atom.name == "CA");
    let scorer = scorer_of_shape(&molecule(&file));
    let score = |pose: &Pose| scorer.score(pose).score;
    for name in ["C2", "C3", "C4", "C5"] {
        let (reported, rows) = small(folder.path(), name, &["--no-cluster", "--diagnostics"]);
        assert_eq!(reported["run"]["options"]["search"]["symmetry"], name);
        assert_eq!(reported["run"]["options"]["search"]["rotations"], 40);
        assert!(rows.len() > 20);
        for row in &rows {
            assert!(symmetry(name).ring(&pose(row)).is_some(), "{name}");
        }
        // A turn of a copy by twice the axes' covering radius, about its middle, and a shift by the grid's spacing.
        let plan = &reported["run"]["plan"];
        let turn = 2.0
            * plan["covering_radius_degrees"]
                .as_f64()
                .unwrap()
                .to_radians();
        let step = plan["spacing"]
            .as_f64()
            .unwrap()
            .hypot(gyration(&alphas) * (4.0 / 3.0 * (1.0 - turn.cos())).sqrt());
        for (index, row) in rows.iter().enumerate() {
            let of_cluster =
                |other: &&Row| other["cluster"] == row["cluster"] && other["refined"] == "true";
            for better in rows[..index].iter().filter(of_cluster) {
                let distance = |pose: Pose| rmsd(&alphas, &self::pose(better), &pose);
                let distance = distance(pose(row)).min(distance(pose(row).inverse()));
                assert!(distance > step, "{name}: {distance} of {step} Å");
            }
        }
        for row in &rows[..3] {
            let pose = pose(row);
            let close = |a: f64, b: f64| (a - b).abs() < 1e-6 * b.abs().max(1.0);
            let own = number(row, "search_score");
            assert!(close(score(&pose), own));
            let others = match name {
                "C4" => 0.5 * score(&pose.after(&pose)),
                "C5" => score(&pose.after(&pose)),
                _ => {
                    assert_eq!(row["other_copies"], "");
                    0.0
                }
            };
            if !row["other_copies"].is_empty() {
                assert!(close(number(row, "other_copies"), others), "{name}");
            }
            let flexible = number(row, "unresolved") + number(row, "termini");
            let ranked = own + others + flexible;
            assert!(close(number(row, "pose_score"), ranked), "{name}");
        }
    }
}

/// The files hold every copy, each where the pose takes the one before it; they are the same for any number of
/// threads, from the record, and written later.
#[test]
fn all_copies_are_written_and_runs_repeat() {
    let folder = tempfile::tempdir().unwrap();
    let at = |path: &str| folder.path().join(path);
    let (reported, rows) = small(folder.path(), "C5", &["--threads", "1"]);
    let first = fs::read(at("run/top/rank_0002.pdb")).unwrap();
    let table = fs::read(at("run/poses.csv")).unwrap();
    let ring = molecule(at("run/top/rank_0002.pdb").to_str().unwrap());
    let atoms = molecule(&example("ligand_unbound")).atoms.len();
    assert_eq!(ring.atoms.len(), 5 * atoms);
    let pose = pose(&rows[1]);
    let places: Vec<[f64; 3]> = ring.atoms.iter().map(|atom| atom.position).collect();
    for copy in 0..5 {
        let next = (copy + 1) % 5;
        for atom in 0..atoms {
            let image = pose.apply(places[copy * atoms + atom]);
            let there = places[next * atoms + atom];
            let off = Vector3::from(image) - Vector3::from(there);
            assert!(off.norm() < 3e-3, "copy {copy}, atom {atom}: {off}");
        }
    }
    let partners: Vec<&Value> = reported["run"]["chains"]
        .as_array()
        .unwrap()
        .iter()
        .collect();
    let names: Vec<&str> = partners
        .iter()
        .map(|c| c["partner"].as_str().unwrap())
        .collect();
    assert_eq!(names, ["receptor", "ligand", "copy 3", "copy 4", "copy 5"]);

    small(folder.path(), "C5", &["--threads", "2"]);
    assert_eq!(fs::read(at("run/poses.csv")).unwrap(), table);
    assert_eq!(fs::read(at("run/top/rank_0002.pdb")).unwrap(), first);
    succeed(
        folder.path(),
        "dock --rerun run/run.json -o again --quiet".split(' '),
    );
    assert_eq!(fs::read(at("again/poses.csv")).unwrap(), table);
    succeed(
        folder.path(),
        "export run --rank 2 -o later --quiet".split(' '),
    );
    assert_eq!(fs::read(at("later/rank_0002.pdb")).unwrap(), first);

    // A pose from elsewhere forms no ring.
    let text = String::from_utf8(table).unwrap();
    let row = text.lines().nth(1).unwrap();
    let mut fields: Vec<&str> = row.split(',').collect();
    let header = text.lines().next().unwrap();
    let shift = header.split(',').position(|name| name == "tz").unwrap();
    fields[shift] = "99";
    fs::write(at("run/poses.csv"), text.replace(row, &fields.join(","))).unwrap();
    let reported = refused(folder.path(), "export run --rank 1 -o never");
    assert!(!at("never").exists());
    assert!(reported.contains("no ring of C5"));
}

/// Residues that are named are those of every copy, and poses that touch them rank first.
#[test]
fn residues_are_named_for_all_copies() {
    let folder = tempfile::tempdir().unwrap();
    let (reported, rows) = small(folder.path(), "C3", &["--no-cluster"]);
    assert!(reported["run"]["options"]["restraints"]["active_ligand"].is_null());
    assert!(rows.iter().all(|row| row["active_residues"].is_empty()));
    let molecule = example("ligand_unbound");
    let options = "--rotations 40 --poses 60 --effects shape,restraint --active-receptor B:5,B:29 \
        --block-receptor B:20 -o run --force --json";
    let mut arguments = vec!["dock", &molecule, "--symmetry", "C3"];
    arguments.extend(options.split(' '));
    let output = succeed(folder.path(), arguments);
    let reported: Value = serde_json::from_slice(&output.stdout).unwrap();
    for (side, other) in [
        ("active_receptor", "active_ligand"),
        ("block_receptor", "block_ligand"),
    ] {
        let options = &reported["run"]["options"]["restraints"];
        assert!(!options[side].is_null());
        assert_eq!(options[side], options[other]);
    }
    // Two residues on either side: each that touches earns a quarter of the weight.
    let rows = self::rows(&folder.path().join("run"));
    let earned = |row: &Row| number(row, "active_residues");
    assert!(earned(&rows[0]) >= 1000.0);
    assert!(rows.iter().all(|row| earned(row) % 500.0 == 0.0));
}

/// A batch takes rings beside pairs.
#[test]
fn a_batch_holds_rings_too() {
    let folder = tempfile::tempdir().unwrap();
    fs::copy(example("ligand_unbound"), folder.path().join("a.pdb")).unwrap();
    let table = "receptor,ligand,symmetry\na.pdb,,C3\na.pdb,a.pdb,\n";
    fs::write(folder.path().join("pairs.csv"), table).unwrap();
    succeed(
        folder.path(),
        "batch pairs.csv -o runs --quiet -- --rotations 12 --effects shape".split(' '),
    );
    let ring = rows(&folder.path().join("runs/a_C3"));
    assert!(symmetry("C3").ring(&pose(&ring[0])).is_some());
    let pair = rows(&folder.path().join("runs/a_a"));
    assert!(symmetry("C3").ring(&pose(&pair[0])).is_none());

    // All of them may be rings of one kind.
    fs::write(folder.path().join("rings.csv"), "receptor,ligand\na.pdb,\n").unwrap();
    succeed(
        folder.path(),
        "batch rings.csv -o rings --quiet -- --symmetry C3 --rotations 12 --effects shape"
            .split(' '),
    );
    assert_eq!(rows(&folder.path().join("rings/a_C3")), ring);
}

#[test]
fn what_no_ring_can_have_is_refused() {
    let folder = tempfile::tempdir().unwrap();
    fs::copy(example("ligand_unbound"), folder.path().join("a.pdb")).unwrap();
    let bunny = concat!(
        concat!(env!("CARGO_MANIFEST_DIR"), "/.."),
        "/structures/examples/bunny.obj"
    );
    fs::copy(bunny, folder.path().join("a.obj")).unwrap();
    for (options, said) in [
        ("a.pdb a.pdb --symmetry C2", "LIGAND is given too"),
        ("a.pdb --symmetry T", "no symmetry"),
        ("a.pdb --symmetry C1", "no symmetry"),
        ("a.pdb --symmetry C3 --rotations 12deg", "axes"),
        ("a.pdb --symmetry C3 --budget 5s", "cannot be used with"),
        ("a.pdb --symmetry C3 --accuracy 0.1", "cannot be used with"),
        (
            "a.pdb --symmetry C3 --active-ligand B:5",
            "--active-ligand is B:5; it must be the receptor's",
        ),
        ("a.pdb --symmetry C3 --refine 5", "refine is 5"),
        (
            "a.pdb --symmetry C3 --fine-rotations 9000",
            "fine-rotations is 9000",
        ),
        ("a.pdb --symmetry C3 --engine gpu", "engine is gpu"),
        ("a.obj --symmetry C3", "this is a mesh"),
        ("a.pdb", "LIGAND"),
    ] {
        let reported = refused(folder.path(), &format!("dock {options}"));
        assert!(reported.contains(said), "{options}: {reported}");
    }
}

/// The example ring, with all effects that it calls for and a ninth of the default's axes: the dimer is the first row.
#[test]
fn the_example_s_dimer_is_put_together_again() {
    let folder = tempfile::tempdir().unwrap();
    let file = |name: &str| {
        let root = concat!(env!("CARGO_MANIFEST_DIR"), "/..");
        format!("{root}/structures/examples/4e43_{name}.pdb")
    };
    let (one, dimer) = (file("molecule"), file("dimer"));
    let mut arguments = vec!["dock", &one, "--symmetry", "C2", "--native", &dimer];
    arguments.extend([
        "--rotations",
        "100",
        "--poses",
        "100",
        "-o",
        "run",
        "--json",
    ]);
    let output = succeed(folder.path(), arguments);
    let reported: Value = serde_json::from_slice(&output.stdout).unwrap();
    assert!(reported["best"][0]["irmsd"].as_f64().unwrap() < 1.0);
    let on = |effect: &Value| effect["on"] == true;
    let effects = reported["run"]["effects"].as_array().unwrap();
    assert_eq!(effects.iter().filter(|effect| on(effect)).count(), 3);
    let words = String::from_utf8(output.stderr).unwrap();
    assert!(words.contains("Each copy of C2") && words.contains("100 axes of C2"));
}
