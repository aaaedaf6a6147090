//! Many pairs in one call: the files of each, the effect of a failure, and the work that a second call repeats.

mod hostile;
mod shards;
mod together;

use knotdock::output::files::lock::Lock;
use std::collections::BTreeMap;
use std::fs;
use std::path::Path;
use std::process::Output;

use crate::program::succeed;
use assert_cmd::cargo::cargo_bin_cmd;
use serde_json::Value;

/// A folder `in` with two small pairs, each with a table of both.
fn place() -> tempfile::TempDir {
    let folder = tempfile::tempdir().unwrap();
    let inputs = folder.path().join("in");
    fs::create_dir(&inputs).unwrap();
    let cases =
        Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/..")).join("tests/scoring_table/cases");
    for case in ["helices", "charged_helices"] {
        for side in ["receptor", "ligand"] {
            let name = format!("{case}_{side}.pdb");
            fs::copy(cases.join(&name), inputs.join(&name)).unwrap();
        }
    }
    folder
}

fn write_pairs(folder: &Path, text: &str) {
    fs::write(folder.join("in/pairs.csv"), text).unwrap();
}

fn batch(folder: &Path, words: &str) -> Output {
    cargo_bin_cmd!("knotdock")
        .current_dir(folder)
        .args(words.split(' '))
        .output()
        .unwrap()
}

type Row = BTreeMap<String, String>;

fn results(folder: &Path) -> Vec<Row> {
    let mut reader = csv::Reader::from_path(folder.join("out/results.csv")).unwrap();
    reader.deserialize().map(Result::unwrap).collect()
}

const TWO: &str = "name,receptor,ligand,rotations\n\
                   first,helices_receptor.pdb,helices_ligand.pdb,\n\
                   ,charged_helices_receptor.pdb,charged_helices_ligand.pdb,36\n";
const OPTIONS: &str = "-- --poses 60 --write-top 1 --threads 1";

#[test]
fn each_pair_is_docked_as_by_itself() {
    let folder = place();
    // One option for all, another by a column.
    let table = TWO.replace("pdb,\n", "pdb,24\n");
    write_pairs(folder.path(), &table);
    let output = batch(
        folder.path(),
        &format!("batch in/pairs.csv -o out {OPTIONS}"),
    );
    assert!(output.status.success(), "{output:?}");
    let rows = results(folder.path());
    let second = "charged_helices_receptor_charged_helices_ligand";
    assert_eq!([&rows[0]["name"], &rows[1]["name"]], ["first", second]);
    for (case, name, rotations, row) in [
        ("helices", "first", 24, &rows[0]),
        ("charged_helices", second, 36, &rows[1]),
    ] {
        let alone = format!(
            "dock in/{case}_receptor.pdb in/{case}_ligand.pdb --rotations {rotations} --poses 60 --write-top 1 --raw \
             --threads 1 -o {case}"
        );
        succeed(folder.path(), alone.split(' '));
        for file in ["poses.csv", "top/rank_0001.pdb"] {
            let [one, other] = [format!("out/{name}"), case.to_owned()]
                .map(|run| fs::read(folder.path().join(run).join(file)).unwrap());
            assert_eq!(one, other, "{case} {file}");
        }
        let poses = folder.path().join(case).join("poses.csv");
        let best: Row = csv::Reader::from_path(poses)
            .unwrap()
            .deserialize()
            .next()
            .unwrap()
            .unwrap();
        assert_eq!(
            (row["status"].as_str(), row["error"].as_str()),
            ("done", "")
        );
        for column in ["score", "pose_score", "z_score", "cluster_size"] {
            assert_eq!(row[column], best[column], "{column}");
        }
        assert_eq!(row["dockq"], "");
    }
}

#[test]
fn a_failure_costs_no_other_pair_and_a_second_call_only_what_is_left() {
    let folder = place();
    let missing = TWO.replace("first,helices_receptor.pdb", "first,late.pdb");
    write_pairs(folder.path(), &missing);
    let call = format!("batch in/pairs.csv -o out {OPTIONS}");
    let first = batch(folder.path(), &call);
    assert_eq!(first.status.code(), Some(2));
    let reported = String::from_utf8_lossy(&first.stderr);
    assert!(
        reported.contains("[1/2] first failed") && reported.contains("late.pdb"),
        "{reported}"
    );
    let status = |rows: &[Row]| {
        rows.iter()
            .map(|row| row["status"].clone())
            .collect::<Vec<_>>()
    };
    let rows = results(folder.path());
    assert_eq!(status(&rows), ["failed", "done"]);
    assert!(rows[0]["error"].contains("late.pdb") && rows[0]["score"].is_empty());
    let record = folder
        .path()
        .join("out")
        .join(&rows[1]["name"])
        .join("run.json");
    let before = fs::read(&record).unwrap();

    // The file comes; the other pair's run, with its times, stays as it was.
    fs::copy(
        folder.path().join("in/helices_receptor.pdb"),
        folder.path().join("in/late.pdb"),
    )
    .unwrap();
    let call = call.replace("--threads 1", "--threads 2");
    let second = batch(folder.path(), &call.replace("batch", "batch --json"));
    assert!(second.status.success());
    let object: Value = serde_json::from_slice(&second.stdout).unwrap();
    let states: Vec<&Value> = object["pairs"]
        .as_array()
        .unwrap()
        .iter()
        .map(|pair| &pair["status"])
        .collect();
    assert_eq!(states, ["docked", "kept"]);
    assert_eq!(fs::read(&record).unwrap(), before);
    let again = results(folder.path());
    assert_eq!(status(&again), ["done", "done"]);
    assert_eq!(again[1], rows[1]);

    // Other options, or an input that changed, are no reason to lose a run.
    let other = format!("{call} --lambda 8");
    assert_eq!(batch(folder.path(), &other).status.code(), Some(2));
    assert_eq!(status(&results(folder.path())), ["failed", "failed"]);
    assert_eq!(fs::read(&record).unwrap(), before);
    let forced = batch(folder.path(), &format!("{other} --force"));
    assert!(forced.status.success(), "{forced:?}");
    let replaced = fs::read(&record).unwrap();
    assert_ne!(replaced, before);
    // A finished run with the requested options is kept, forced or not.
    assert!(
        batch(folder.path(), &format!("{other} --force"))
            .status
            .success()
    );
    assert_eq!(fs::read(&record).unwrap(), replaced);
    let input = folder.path().join("in/late.pdb");
    let text = fs::read_to_string(&input).unwrap();
    fs::write(&input, format!("REMARK  99\n{text}")).unwrap();
    assert_eq!(batch(folder.path(), &other).status.code(), Some(2));
    assert_eq!(status(&results(folder.path())), ["failed", "done"]);
}

/// Columns name options, files among them are looked for beside the table, and a known complex shows in the results.
#[test]
fn a_known_complex_is_measured_against() {
    let folder = place();
    let native = folder.path().join("in/native.pdb");
    fs::copy(folder.path().join("in/helices_ligand.pdb"), &native).unwrap();
    let table = "name,receptor,ligand,native_receptor,native_ligand,active_receptor\n\
                 a,helices_receptor.pdb,helices_ligand.pdb,helices_receptor.pdb,native.pdb,A:5\n";
    write_pairs(folder.path(), table);
    let output = batch(
        folder.path(),
        &format!("batch in/pairs.csv -o out --json {OPTIONS} --rotations 48"),
    );
    assert!(output.status.success(), "{output:?}");
    let object: Value = serde_json::from_slice(&output.stdout).unwrap();
    let keys = |value: &Value| {
        let mut keys: Vec<String> = value.as_object().unwrap().keys().cloned().collect();
        keys.sort();
        keys.join(" ")
    };
    assert_eq!(keys(&object), "directory pairs results");
    assert_eq!(
        keys(&object["pairs"][0]),
        "best directory error first_acceptable_rank name status"
    );
    let row = &results(folder.path())[0];
    let best = &object["pairs"][0]["best"];
    for column in ["score", "irmsd", "lrmsd", "fnat", "dockq"] {
        assert_eq!(best[column].as_f64(), row[column].parse().ok(), "{column}");
    }
    assert_eq!(best["capri"], row["capri"].as_str());
    let record = fs::read(folder.path().join("out/a/run.json")).unwrap();
    let record: Value = serde_json::from_slice(&record).unwrap();
    assert_eq!(record["options"]["restraints"]["active_receptor"], "A:5");

    // Another known complex is another run, and so is a table of poses that is gone.
    let again = format!("batch in/pairs.csv -o out {OPTIONS} --rotations 48");
    assert!(batch(folder.path(), &again).status.success());
    // A table that names another one is another batch, whatever that file holds.
    write_pairs(
        folder.path(),
        &table.replace(",native.pdb,", ",helices_ligand.pdb,"),
    );
    let refused = batch(folder.path(), &again);
    assert_eq!(refused.status.code(), Some(2));
    let said = String::from_utf8_lossy(&refused.stderr);
    assert!(said.contains("1 (a)"), "{said}");
    write_pairs(folder.path(), table);
    let text = fs::read_to_string(&native).unwrap();
    fs::write(&native, format!("REMARK  99\n{text}")).unwrap();
    assert_eq!(batch(folder.path(), &again).status.code(), Some(2));
    fs::write(&native, text).unwrap();
    assert!(batch(folder.path(), &again).status.success());
    fs::remove_file(folder.path().join("out/a/poses.csv")).unwrap();
    assert_eq!(batch(folder.path(), &again).status.code(), Some(2));
    assert!(
        batch(folder.path(), &format!("{again} --force"))
            .status
            .success()
    );
    assert!(folder.path().join("out/a/poses.csv").exists());

    // One that cannot be read is nothing done.
    fs::write(folder.path().join("out/a/poses.csv"), "rank,qw\n").unwrap();
    assert_eq!(batch(folder.path(), &again).status.code(), Some(2));
    assert_eq!(results(folder.path())[0]["status"], "failed");
}

/// Columns may be spelled as options are, and files that they name are beside the table in either spelling.
#[test]
fn columns_are_spelled_with_either_line() {
    let folder = place();
    let sides = ["helices_receptor.pdb", "helices_ligand.pdb"].join(",");
    let table = format!("name,receptor,ligand,native-receptor,native-ligand\na,{sides},{sides}\n");
    write_pairs(folder.path(), &table);
    let words = format!("batch in/pairs.csv -o out {OPTIONS} --rotations 24");
    let output = batch(folder.path(), &words);
    assert!(output.status.success(), "{output:?}");
    assert_eq!(results(folder.path())[0]["status"], "done");
    let poses = fs::read_to_string(folder.path().join("out/a/poses.csv")).unwrap();
    assert!(poses.lines().next().unwrap().contains("irmsd"));
}

#[test]
fn a_table_that_is_none_is_refused_before_anything_runs() {
    let folder = place();
    let pair = "helices_receptor.pdb,helices_ligand.pdb";
    for (table, options, line, said) in [
        (
            "receptor\na.pdb\n".to_owned(),
            "",
            Some(1),
            "no column `ligand`",
        ),
        (
            format!("receptor,ligand,rotation\n{pair},5\n"),
            "",
            Some(2),
            "--rotation",
        ),
        (
            format!("receptor,ligand,rotations\n{pair},x\n"),
            "",
            Some(2),
            "'x'",
        ),
        (
            format!("receptor,ligand,output\n{pair},x\n"),
            "",
            Some(2),
            "`output`",
        ),
        (
            format!("receptor,ligand,rotations\n{pair},5\n"),
            "-- --rotations 6",
            Some(2),
            "multiple times",
        ),
        (
            format!("receptor,ligand\n{pair}\n{pair}\n"),
            "",
            Some(3),
            "on line 2",
        ),
        (
            format!("name,receptor,ligand\n../x,{pair}\n"),
            "",
            Some(2),
            "'../x'",
        ),
    ] {
        write_pairs(folder.path(), &table);
        let words = format!("batch in/pairs.csv -o out --json {options}");
        let output = batch(folder.path(), words.trim_end());
        assert_eq!(output.status.code(), Some(2), "{table}");
        let object: Value = serde_json::from_slice(&output.stdout).unwrap();
        let error = &object["error"];
        let message = error["message"].as_str().unwrap();
        assert!(message.contains(said), "{message}");
        assert_eq!(error["line"].as_u64(), line, "{table}");
        assert!(error["file"].as_str().unwrap().ends_with("pairs.csv"));
        assert!(!error["remedy"].as_str().unwrap().is_empty());
        assert!(!folder.path().join("out").exists(), "{table}");
    }
    // For an option of the whole batch the error says where it goes.
    write_pairs(folder.path(), &format!("receptor,ligand\n{pair}\n"));
    for word in ["--quiet", "--json"] {
        let words = format!("batch in/pairs.csv -o out --json -- --rotations 6 {word}");
        let output = batch(folder.path(), &words);
        assert_eq!(output.status.code(), Some(2));
        let object: Value = serde_json::from_slice(&output.stdout).unwrap();
        let remedy = object["error"]["remedy"].as_str().unwrap();
        assert!(remedy.starts_with(&format!("put {word} before `--`")));
        assert!(!folder.path().join("out").exists());
    }
    // Nor is a directory of somebody else's taken.
    write_pairs(folder.path(), &format!("receptor,ligand\n{pair}\n"));
    fs::create_dir(folder.path().join("out")).unwrap();
    fs::write(folder.path().join("out/results.csv"), "mine\n").unwrap();
    let output = batch(folder.path(), "batch in/pairs.csv -o out");
    assert_eq!(output.status.code(), Some(2));
    let said = String::from_utf8_lossy(&output.stderr);
    assert!(said.contains("not empty"), "{said}");
    assert_eq!(
        fs::read_to_string(folder.path().join("out/results.csv")).unwrap(),
        "mine\n"
    );
    assert_eq!(fs::read_dir(folder.path().join("out")).unwrap().count(), 1);
}

/// The table beside the example does what README says.
#[test]
fn the_example_s_table_is_docked() {
    let folder = tempfile::tempdir().unwrap();
    let table =
        Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/..")).join("structures/examples/pairs.csv");
    let words = format!(
        "batch {} -o out -- --rotations 24 --poses 40",
        table.display()
    );
    let output = batch(folder.path(), &words);
    assert!(output.status.success(), "{output:?}");
    let rows = results(folder.path());
    assert_eq!((rows.len(), rows[0]["name"].as_str()), (1, "1PPE"));
    assert!((0.0..=1.0).contains(&rows[0]["dockq"].parse::<f64>().unwrap()));
}

/// Found by an audit: what came after -- was blamed on the table's second line, and `--help` printed a comment of the
/// source.
#[test]
fn what_is_wrong_after_the_dashes_is_not_the_table_s_fault() {
    let folder = place();
    write_pairs(folder.path(), "receptor,ligand\nreceptor.pdb,ligand.pdb\n");
    for (words, expected) in [
        ("--frob", "unexpected argument '--frob'"),
        ("--rotations 0", "invalid value '0'"),
        ("--help", "--help cannot come after --"),
        ("--lambda -1", "invalid value '-1' for '--lambda"),
        ("extra.pdb", "files cannot come after --"),
        ("--budget 5s --rotations 5", "cannot be used with"),
        ("--rerun run.json", "--rerun cannot come after --"),
        ("-o elsewhere", "--output cannot come after --"),
    ] {
        let output = batch(
            folder.path(),
            &format!("batch in/pairs.csv -o out -- {words}"),
        );
        assert_eq!(output.status.code(), Some(2), "{words}");
        let reported = String::from_utf8(output.stderr).unwrap();
        assert!(
            reported.contains(expected) && !reported.contains("line 2"),
            "{reported}"
        );
    }
}

/// Found by a user: two batches into one folder each wrote results.csv without the other's rows, and the last one
/// stood.
#[test]
fn a_directory_has_one_batch() {
    let folder = place();
    let table = |rows: &str| write_pairs(folder.path(), &format!("name;Receptor;Ligand\n{rows}"));
    let call = format!("batch in/pairs.csv -o out {OPTIONS} --rotations 12");
    let refused = || {
        let output = batch(folder.path(), &call);
        assert_eq!(output.status.code(), Some(2));
        String::from_utf8_lossy(&output.stderr).into_owned()
    };
    table("first;helices_receptor.pdb;helices_ligand.pdb\n");
    let out = folder.path().join("out");
    fs::create_dir(&out).unwrap();
    let held = Lock::take(&out.join(".knotdock-lock")).unwrap();
    let said = refused();
    assert!(said.contains("another command is writing"), "{said}");
    assert_eq!(fs::read_dir(&out).unwrap().count(), 1, "the lock");
    drop(held);
    assert!(batch(folder.path(), &call).status.success());
    assert!(!out.join(".knotdock-lock").exists());
    let first = fs::read(out.join("results.csv")).unwrap();

    table("second;charged_helices_receptor.pdb;charged_helices_ligand.pdb\n");
    let said = refused();
    assert!(said.contains("1 (second)"), "{said}");
    assert!(!out.join("second").exists());
    assert_eq!(fs::read(out.join("results.csv")).unwrap(), first);
}

/// A column of an unknown name was refused with a list of nothing.
#[test]
fn a_misspelled_column_or_option_is_refused_with_a_remedy() {
    let folder = place();
    write_pairs(
        folder.path(),
        "receptor,ligand,rotatoins\nhelices_receptor.pdb,helices_ligand.pdb,24\n",
    );
    let refused = batch(folder.path(), "batch in/pairs.csv -o out");
    let reported = String::from_utf8_lossy(&refused.stderr);
    assert_eq!(refused.status.code(), Some(2));
    for part in ["line 2", "is `--rotations` meant?"] {
        assert!(reported.contains(part), "{part}: {reported}");
    }
    for (option, remedy) in [
        ("--rotatoins=24", "is `--rotations` meant?"),
        ("--contact-weight=2", "--config terms.contact_weight=VALUE"),
    ] {
        let words = format!("batch in/pairs.csv -o out -- {option}");
        let refused = batch(folder.path(), &words);
        let reported = String::from_utf8_lossy(&refused.stderr);
        assert_eq!(refused.status.code(), Some(2));
        assert!(reported.contains(remedy), "{reported}");
    }
}
