//! Inputs and their results: chains, radii, sizes, formats, complexes.

use std::collections::BTreeSet;
use std::fs;

use assert_cmd::cargo::cargo_bin_cmd;
use serde_json::Value;

use super::run::*;

#[test]
fn the_same_chain_on_both_sides_docks() {
    let folder = place();
    run(
        folder.path(),
        "dock receptor.pdb:A receptor.pdb:A --rotations 20 --write-top 1 -o run --quiet",
    );
    let text = fs::read_to_string(folder.path().join("run/top/rank_0001.pdb")).unwrap();
    let chains: BTreeSet<&str> = text
        .lines()
        .filter(|line| line.starts_with("ATOM"))
        .map(|line| &line[21..22])
        .collect();
    assert_eq!(
        chains.len(),
        2,
        "receptor and ligand need names of their own"
    );
}

#[test]
fn a_zero_radius_is_refused_by_the_search() {
    use knotdock::dock::plan::plan;
    use knotdock::options::DockOptions;
    use knotdock_structures::molecule::{InputSpec, ReadOptions, read};
    let folder = place();
    let receptor = folder.path().join("receptor.pdb");
    let mut molecule = read(&InputSpec::whole(receptor), &ReadOptions::default()).unwrap();
    let whole = molecule.clone();
    for radius in [0.0, -1.0, f64::NAN, f64::INFINITY] {
        molecule.atoms[3].radius = radius;
        for (receptor, ligand) in [(&molecule, &whole), (&whole, &molecule)] {
            let error = plan(receptor, ligand, &DockOptions::default())
                .err()
                .unwrap();
            assert!(error.to_string().contains("radius"), "{error}");
        }
    }
}

#[test]
fn complexes_hold_the_receptor_as_it_was_and_the_ligand_in_its_place() {
    let folder = place();
    run(
        folder.path(),
        "dock receptor.pdb ligand.pdb --rotations 40 --no-cluster --write-top 2 --raw -o run --quiet",
    );
    let run_folder = folder.path().join("run");
    run(folder.path(), "export run --rank 2,4-5 -o more --quiet");
    assert_eq!(
        fs::read(folder.path().join("more/rank_0002.pdb")).unwrap(),
        fs::read(run_folder.join("top/rank_0002.pdb")).unwrap(),
        "the same complex whoever writes it"
    );
    let row = &rows(&run_folder)[3];
    let quaternion = ["qw", "qx", "qy", "qz"].map(|part| number(row, part));
    let translation = ["tx", "ty", "tz"].map(|part| number(row, part));
    let pose = knotdock_scoring::se3::Pose::from_parts(quaternion, translation);
    let complex = positions(&fs::read_to_string(folder.path().join("more/rank_0004.pdb")).unwrap());
    let receptor = positions(&crate::molecules::receptor());
    let ligand = positions(&crate::molecules::ligand());
    assert_eq!(complex.len(), receptor.len() + ligand.len());
    assert_eq!(complex[..receptor.len()], receptor);
    for (placed, original) in complex[receptor.len()..].iter().zip(&ligand) {
        let expected = pose.apply(*original);
        for axis in 0..3 {
            assert!(
                (placed[axis] - expected[axis]).abs() < 6e-4,
                "PDB keeps three decimals"
            );
        }
    }
    // A file that is there stays, but for the run's own.
    run(folder.path(), "export run --rank 2 --quiet");
    run(folder.path(), "export run --rank 4 -o more --force --quiet");
    let ligand = folder.path().join("rank_0002.pdb");
    fs::write(&ligand, crate::molecules::ligand()).unwrap();
    run(
        folder.path(),
        "dock receptor.pdb rank_0002.pdb --rotations 5 --no-cluster -o other --quiet",
    );
    // The same complex once more is no matter; one that someone has edited is.
    run(folder.path(), "export run --rank 2 -o more --quiet");
    run(folder.path(), "export run --rank 1-3 --quiet");
    for edited in [
        "more/rank_0002.pdb",
        "run/top/rank_0001.pdb",
        "run/top/rank_0003.pdb",
    ] {
        fs::write(folder.path().join(edited), "edited").unwrap();
    }
    for (arguments, reason) in [
        ("run --rank 99999", "no rank 99999"),
        ("run --rank 2 -o more", "is not what would be written"),
        ("run --rank 1", "is not what would be written"),
        ("run --rank 3", "is not what would be written"),
        ("other --rank 2 -o . --force", "one of the input files"),
    ] {
        let failed = cargo_bin_cmd!("knotdock")
            .current_dir(folder.path())
            .arg("export")
            .args(arguments.split(' '))
            .assert()
            .code(2);
        let reported = String::from_utf8_lossy(&failed.get_output().stderr).into_owned();
        assert!(reported.contains(reason), "{reported}");
    }
    run(folder.path(), "export run --rank 2 -o more --force --quiet");
    assert_eq!(
        fs::read(folder.path().join("more/rank_0002.pdb")).unwrap(),
        fs::read(run_folder.join("top/rank_0002.pdb")).unwrap(),
    );
    let kept = fs::read_to_string(&ligand).unwrap();
    assert_eq!(kept, crate::molecules::ligand());
}

fn positions(pdb: &str) -> Vec<[f64; 3]> {
    pdb.lines()
        .filter(|line| line.starts_with("ATOM"))
        .map(|line| [30, 38, 46].map(|start| line[start..start + 8].trim().parse().unwrap()))
        .collect()
}

#[test]
fn too_little_memory_is_refused_before_the_search_with_a_spacing_that_fits() {
    let folder = place();
    let attempt = |memory: &str, spacing: &str| {
        let output = cargo_bin_cmd!("knotdock")
            .current_dir(folder.path())
            .args(["dock", "receptor.pdb", "ligand.pdb", "--rotations", "20"])
            // Most of the memory is the grid's, not the program's.
            .args(["--precision", "double"])
            .args([
                "--write-top",
                "0",
                "-o",
                "run",
                "--json",
                "--memory",
                memory,
            ])
            .args(spacing.split_whitespace())
            .output()
            .unwrap();
        let object: Value = serde_json::from_slice(&output.stdout).unwrap();
        (output.status.code(), object)
    };
    let (code, reported) = attempt("1M", "");
    assert_eq!(code, Some(2));
    assert!(!folder.path().join("run").exists());
    let message = reported["error"]["message"].as_str().unwrap();
    let (needed, _) = message.split_once(" MB of memory").unwrap();
    let needed: u64 = needed.rsplit(' ').next().unwrap().parse().unwrap();
    // What is named has a megabyte and a half and 2% to spare at most, and no process takes less than 17 MB.
    let too_little = (needed * 900_000).to_string();
    let (code, reported) = attempt(&too_little, "");
    assert_eq!(code, Some(2), "{reported}");
    let remedy = reported["error"]["remedy"].as_str().unwrap();
    let coarser = remedy.strip_prefix("use ").unwrap();
    let coarser = coarser.split(',').next().unwrap();
    assert!(coarser.starts_with("--spacing "), "{remedy}");
    let (code, reported) = attempt(&too_little, coarser);
    assert_eq!(code, Some(0), "{reported}");
    // A coarser grid under the same resolution would fit as well, and its scores would be off by far more than was
    // requested. How coarse the grid must be depends on what the process holds on this machine, and with it the error.
    let tolerance = reported["run"]["options"]["kernel"]["tolerance"]
        .as_f64()
        .unwrap();
    assert!(
        reported["run"]["error"]["rms"].as_f64().unwrap() < 3.0 * tolerance,
        "{reported}"
    );
}

#[test]
fn mmcif_and_gzip_go_in_and_mmcif_comes_out() {
    use knotdock_structures::molecule::{Format, InputSpec, ReadOptions, read, write_molecule};
    use std::io::Write;
    let folder = place();
    let of = |name: &str| {
        let input = InputSpec::whole(folder.path().join(name));
        read(&input, &ReadOptions::default()).unwrap()
    };
    let mut text = Vec::new();
    write_molecule(&mut text, Format::Mmcif, &of("ligand.pdb"), &[]).unwrap();
    let file = fs::File::create(folder.path().join("ligand.cif.gz")).unwrap();
    let mut packed = flate2::write::GzEncoder::new(file, flate2::Compression::fast());
    packed.write_all(&text).unwrap();
    packed.finish().unwrap();
    let dock = "--rotations 20 --write-top 1 --quiet -o";
    run(
        folder.path(),
        &format!("dock receptor.pdb ligand.pdb {dock} pdb"),
    );
    run(
        folder.path(),
        &format!("dock receptor.pdb ligand.cif.gz {dock} cif"),
    );
    assert_eq!(
        fs::read(folder.path().join("pdb/poses.csv")).unwrap(),
        fs::read(folder.path().join("cif/poses.csv")).unwrap(),
        "the format of a file is no part of the answer"
    );
    assert!(!folder.path().join("cif/top/rank_0001.pdb").exists());
    let complex = of("cif/top/rank_0001.cif");
    let same = of("pdb/top/rank_0001.pdb");
    assert_eq!(complex.atoms.len(), same.atoms.len());
    for (a, b) in complex.atoms.iter().zip(&same.atoms) {
        assert_eq!((&a.name, a.residue_number), (&b.name, b.residue_number));
    }
}

/// Found by an audit: a grid too coarse for its resolution was reported by a figure among others, or by an infinite
/// one.
#[test]
fn scores_that_are_off_by_more_than_was_requested_are_warned_of() {
    let folder = place();
    let reported = |options: &str| {
        let output = cargo_bin_cmd!("knotdock")
            .current_dir(folder.path())
            .args(["dock", "receptor.pdb", "ligand.pdb", "--rotations", "20"])
            .args(["--write-top", "0", "-o", "run", "--force"])
            .args(options.split_whitespace())
            .output()
            .unwrap();
        assert!(output.status.success());
        let words = |bytes| String::from_utf8(bytes).unwrap();
        (words(output.stdout), words(output.stderr))
    };
    let (_, warned) = reported("--spacing 6");
    assert!(warned.contains("the fast path was off by"), "{warned}");
    let (report, warned) = reported("--spacing 60");
    assert!(warned.contains("nothing fits"), "{warned}");
    assert!(!report.contains("inf"), "{report}");
    let (_, warned) = reported("--tolerance 1e-2 --resolution 6 --spacing 1.5");
    assert!(!warned.contains("warning: the fast path"), "{warned}");
}
