//! Shards of a batch: the same tables however many there are, wherever they are docked and however often they are ended.

use std::collections::BTreeMap;
use std::fs::{self, File};
use std::io::Read;
use std::path::Path;
use std::process::Output;

use assert_cmd::cargo::cargo_bin_cmd;
use flate2::read::MultiGzDecoder;
use knotdock::output::files::lock::Lock;

use super::{Row, batch, place, write_pairs};
use crate::program::succeed;

/// Five pairs, of which the third has no file.
const FIVE: &str = "name,receptor,ligand,native_receptor,native_ligand\n\
                    a,helices_receptor.pdb,helices_ligand.pdb,helices_receptor.pdb,helices_ligand.pdb\n\
                    b,charged_helices_receptor.pdb,charged_helices_ligand.pdb,,\n\
                    c,late.pdb,helices_ligand.pdb,,\n\
                    d,helices_ligand.pdb,helices_receptor.pdb,,\n\
                    e,charged_helices_ligand.pdb,charged_helices_receptor.pdb,,\n";
/// What the folder of a batch, or of a shard, holds where poses are kept.
const FILES: [&str; 4] = ["attempts.csv", "batch.json", "poses.csv.gz", "results.csv"];
const DOCK: &str = "-- --rotations 24 --poses 40 --write-top 2 --raw";
/// Options that take hardly any time.
const SHORT: &str = "-- --rotations 4 --poses 5 --effects shape --threads 1";

/// Docks all shards of a batch into a directory.
fn dock_shards(folder: &Path, out: &str, count: usize, words: &str, dock: &str) {
    for index in (1..=count).rev() {
        let call = format!(
            "batch in/pairs.csv -o {out} --shard {index}/{count} --failures-ok {words} {dock}"
        );
        let output = batch(folder, &call);
        assert!(output.status.success(), "{output:?}");
    }
}

fn merge(folder: &Path, words: &str) -> Output {
    batch(folder, &format!("merge {words}"))
}

/// The tables of a batch.
fn tables(folder: &Path, out: &str) -> [Vec<u8>; 2] {
    ["results.csv", "poses.csv.gz"].map(|name| fs::read(folder.join(out).join(name)).unwrap())
}

fn unpacked(packed: &[u8]) -> String {
    let mut text = String::new();
    MultiGzDecoder::new(packed)
        .read_to_string(&mut text)
        .unwrap();
    text
}

/// Names in a folder, in order.
fn names(folder: &Path) -> Vec<String> {
    let entries = fs::read_dir(folder).unwrap();
    let names = entries.map(|entry| entry.unwrap().file_name().into_string().unwrap());
    let mut names: Vec<String> = names.collect();
    names.sort();
    names
}

fn rows(text: &str) -> Vec<Row> {
    let rows = csv::Reader::from_reader(text.as_bytes()).into_deserialize();
    rows.map(Result::unwrap).collect()
}

#[test]
fn any_number_of_shards_makes_the_same_tables_as_single_runs() {
    let folder = place();
    let root = folder.path();
    write_pairs(root, FIVE);
    let plain = batch(root, &format!("batch in/pairs.csv -o plain {DOCK}"));
    assert_eq!(plain.status.code(), Some(2));
    for count in [1, 2, 5, 7] {
        let out = format!("by_{count}");
        dock_shards(root, &out, count, "--keep table --rows 7", DOCK);
        assert!(merge(root, &out).status.success());
    }
    let [results, poses] = tables(root, "by_1");
    assert_eq!(fs::read(root.join("plain/results.csv")).unwrap(), results);
    for count in [2, 5, 7] {
        assert!(
            tables(root, &format!("by_{count}")) == [results.clone(), poses.clone()],
            "{count}"
        );
    }
    // Without --shard the batch has the same tables, and needs no merge.
    let whole = batch(
        root,
        &format!("batch in/pairs.csv -o whole --keep table --rows 7 --failures-ok -j 2 {DOCK}"),
    );
    assert!(whole.status.success());
    assert!(tables(root, "whole") == [results.clone(), poses.clone()]);
    assert_eq!(names(&root.join("whole")), FILES);
    let refused = merge(root, "whole");
    assert_eq!(refused.status.code(), Some(2), "{refused:?}");
    // Nothing is left for a pair but its rows, and the table of a shard is one of a batch.
    assert_eq!(
        names(&root.join("by_2")),
        ["poses.csv.gz", "results.csv", "shards"]
    );
    let shard = root.join("by_2/shards/0002-of-0002");
    assert_eq!(names(&shard), FILES);
    let of_shard = fs::read_to_string(shard.join("results.csv")).unwrap();
    let all = String::from_utf8(results).unwrap();
    let of_all: Vec<&str> = all
        .lines()
        .enumerate()
        .filter(|(row, _)| row % 2 == 0)
        .map(|(_, line)| line)
        .collect();
    assert_eq!(of_shard.lines().collect::<Vec<_>>(), of_all);

    let mut of_pair: BTreeMap<String, Vec<Row>> = BTreeMap::new();
    for row in rows(&unpacked(&poses)) {
        of_pair.entry(row["name"].clone()).or_default().push(row);
    }
    assert_eq!(of_pair.keys().collect::<Vec<_>>(), ["a", "b", "d", "e"]);
    for (name, kept) in of_pair {
        let run = fs::read_to_string(root.join("plain").join(&name).join("poses.csv")).unwrap();
        let run = rows(&run);
        assert_eq!(kept.len(), run.len().min(7));
        for (row, expected) in kept.iter().zip(&run) {
            for (column, field) in expected {
                assert_eq!(&row[column], field, "{name} {column}");
            }
            assert_eq!(row["irmsd"].is_empty(), name != "a");
        }
    }
}

/// What is kept beside the tables, and that a shard's files may grow on another disk.
#[test]
fn more_is_kept_where_it_is_asked_for() {
    let folder = place();
    let root = folder.path();
    write_pairs(root, FIVE);
    dock_shards(root, "none", 2, "--keep none --scratch near", DOCK);
    assert!(merge(root, "none").status.success());
    assert!(!root.join("none/poses.csv.gz").exists());
    assert_eq!(fs::read_dir(root.join("near")).unwrap().count(), 0);
    dock_shards(root, "top", 2, "--keep top", DOCK);
    dock_shards(root, "all", 2, "--keep all", DOCK);
    for out in ["top", "all"] {
        assert!(merge(root, out).status.success());
        let [one, other] =
            [out, "none"].map(|out| fs::read(root.join(out).join("results.csv")).unwrap());
        assert_eq!(one, other);
    }
    let complexes = |path: &str| fs::read(root.join(path)).unwrap();
    for name in ["rank_0001.pdb", "rank_0002.pdb"] {
        let [top, all] = [format!("top/a/{name}"), format!("all/a/top/{name}")];
        assert_eq!(complexes(&top), complexes(&all));
    }
    assert_eq!(fs::read_dir(root.join("top/a")).unwrap().count(), 2);
    assert!(!root.join("top/c").exists());
}

/// A shard that is ended at any change of the disk, or whose disk is full then, goes on: no pair is lost or there twice.
#[test]
fn a_shard_that_is_ended_anywhere_goes_on() {
    let folder = place();
    let root = folder.path();
    write_pairs(root, FIVE);
    fs::create_dir(root.join("near")).unwrap();
    dock_shards(root, "whole", 2, "--keep table --rows 3", SHORT);
    assert!(merge(root, "whole").status.success());
    let expected = tables(root, "whole");
    let shard = |out: &str, fault: &str| {
        let call = format!(
            "batch in/pairs.csv -o {out} --shard 1/2 --keep table --rows 3 --failures-ok --scratch near {SHORT}"
        );
        let mut command = cargo_bin_cmd!("knotdock");
        command.current_dir(root).args(call.split(' '));
        if fault == "log" {
            command.env("KNOTDOCK_FAULT_LOG", root.join("log"));
        } else if !fault.is_empty() {
            command.env("KNOTDOCK_FAULT", fault);
        }
        command.output().unwrap()
    };
    assert!(shard("logged", "log").status.success());
    let log = fs::read_to_string(root.join("log")).unwrap();
    let mut points = Vec::new();
    for (point, line) in (1..).zip(log.lines()) {
        // Where files are opened, grow, and come into their places.
        let kind = line.split('\t').next().unwrap();
        if ["open", "append", "rename"].contains(&kind) {
            points.push(point);
        }
    }
    // Three pairs: each was started, and has a row; two have poses; the tables have their first lines. All in two
    // halves.
    assert_eq!(log.matches("append").count(), 2 * (3 + 3 + 2 + 2));
    for (number, point) in points.iter().enumerate() {
        let (out, kind) = (
            format!("ended_{point}"),
            if number % 2 == 0 { "kill" } else { "fail" },
        );
        let ended = shard(&out, &format!("{kind} {point}"));
        if kind == "kill" {
            assert_eq!(ended.status.code(), Some(137));
        }
        let again = shard(&out, "");
        assert!(again.status.success(), "{kind} {point}: {again:?}");
        copy_shard(root, "whole/shards/0002-of-0002", &out);
        let merged = merge(root, &out);
        assert!(merged.status.success(), "{kind} {point}: {merged:?}");
        assert!(tables(root, &out) == expected, "{kind} {point}");
    }
}

/// Copies a shard's folder into the directory of another batch.
fn copy_shard(root: &Path, from: &str, out: &str) {
    let from = root.join(from);
    let to = root
        .join(out)
        .join("shards")
        .join(from.file_name().unwrap());
    fs::create_dir_all(&to).unwrap();
    for entry in fs::read_dir(&from).unwrap() {
        let path = entry.unwrap().path();
        fs::copy(&path, to.join(path.file_name().unwrap())).unwrap();
    }
}

/// A failed pair is docked again on request, and counts once; damaged poses are made anew.
#[test]
fn failed_and_damaged_pairs_are_docked_again() {
    let folder = place();
    let root = folder.path();
    write_pairs(root, FIVE);
    let call = format!("batch in/pairs.csv -o out --keep table --rows 3 {DOCK}");
    assert_eq!(batch(root, &call).status.code(), Some(2));
    fs::copy(
        root.join("in/helices_receptor.pdb"),
        root.join("in/late.pdb"),
    )
    .unwrap();
    // The failure stands, and nothing is done again.
    let second = batch(root, &call);
    assert_eq!(second.status.code(), Some(2));
    assert!(String::from_utf8_lossy(&second.stdout).contains("5 pairs were done before"));
    let again = call.replace("--rows 3", "--rows 3 --retry-failed");
    let third = batch(root, &again);
    assert!(third.status.success(), "{third:?}");
    let expected = tables(root, "out");
    let status: Vec<String> = rows(&String::from_utf8(expected[0].clone()).unwrap())
        .into_iter()
        .map(|row| row["status"].clone())
        .collect();
    assert_eq!(status, ["done"; 5]);

    let poses = root.join("out/poses.csv.gz");
    let mut bytes = fs::read(&poses).unwrap();
    let middle = bytes.len() / 2;
    bytes[middle] ^= 0x55;
    fs::write(&poses, bytes).unwrap();
    let mended = batch(root, &call);
    assert!(mended.status.success());
    assert!(String::from_utf8_lossy(&mended.stderr).contains("had incomplete poses"));
    assert!(tables(root, "out") == expected);
}

#[test]
fn a_pair_has_its_time_and_its_attempts() {
    let folder = place();
    let root = folder.path();
    write_pairs(root, &FIVE.replace("late.pdb", "helices_receptor.pdb"));
    let call = format!("batch in/pairs.csv -o short --keep table --time-limit 1us {DOCK}");
    let output = batch(root, &call);
    assert_eq!(output.status.code(), Some(1));
    let results = fs::read_to_string(root.join("short/results.csv")).unwrap();
    assert_eq!(
        results
            .matches("longer than its limit of 0.000001 s")
            .count(),
        5
    );

    // Found under way ten times, the second pair is given up; the others are docked.
    let shard = "batch in/pairs.csv -o ended --shard 1/1 --keep table --failures-ok";
    let none = batch(root, &format!("{shard} --time-limit 1us {DOCK}"));
    assert!(none.status.success());
    let files = root.join("ended/shards/0001-of-0001");
    let head = fs::read_to_string(files.join("results.csv")).unwrap();
    fs::write(
        files.join("results.csv"),
        format!("{}\n", head.lines().next().unwrap()),
    )
    .unwrap();
    fs::write(files.join("attempts.csv"), "b\n".repeat(10) + "d\nd").unwrap();
    let output = batch(root, &format!("{shard} {DOCK}"));
    assert!(output.status.success(), "{output:?}");
    succeed(root, ["merge", "ended"]);
    let found = rows(&fs::read_to_string(root.join("ended/results.csv")).unwrap());
    let failed: Vec<&Row> = found
        .iter()
        .filter(|row| row["status"] == "failed")
        .collect();
    assert_eq!(failed.len(), 1);
    assert_eq!(failed[0]["name"], "b");
    assert!(failed[0]["error"].contains("ended 10 times"));
}

#[test]
fn what_does_not_belong_together_is_refused() {
    let folder = place();
    let root = folder.path();
    write_pairs(root, FIVE);
    let refused = |words: &str, expected: &str| {
        let output = batch(root, words);
        let said = String::from_utf8_lossy(&output.stderr).into_owned();
        assert_eq!(output.status.code(), Some(2), "{words}: {said}");
        assert!(said.contains(expected), "{words}: {said}");
        assert!(
            said.contains("help: ") || said.contains("Usage") || said.contains("--help"),
            "{words}: {said}"
        );
    };
    for shard in ["0/2", "3/2", "2", "a/b"] {
        refused(
            &format!("batch in/pairs.csv -o out --shard {shard}"),
            "write I/N",
        );
    }
    refused("batch in/pairs.csv -o out --rows 0", "or `all`");
    refused("batch in/pairs.csv -o out --scratch near", "need shards");
    refused("batch in/pairs.csv -o out --rows 5", "does not keep");
    refused(
        "batch in/pairs.csv -o out --keep none --rows all",
        "does not keep",
    );
    refused("merge in", "no shards");
    let shard = |words: &str| {
        format!("batch in/pairs.csv -o out --keep table --failures-ok {words} {DOCK}")
    };
    assert!(batch(root, &shard("--shard 1/2")).status.success());
    refused("merge out", "2 of 2 ");
    succeed(root, ["merge", "out", "--partial"]);
    // Other rows, a lock that is held, another number of shards, the same shard twice.
    refused(&shard("--shard 1/2 --rows 9"), "other options");
    let held = Lock::take(&root.join("out/shards/0001-of-0002/.knotdock-lock")).unwrap();
    refused(&shard("--shard 1/2"), "another command is writing");
    drop(held);
    assert!(batch(root, &shard("--shard 3/3")).status.success());
    refused("merge out --partial", "other pairs or options");
    fs::remove_dir_all(root.join("out/shards/0003-of-0003")).unwrap();
    refused("merge out out -o both", "shard 1/2 is in");
    refused("merge out in", "it is not known where");
    // A directory of shards is that of no other batch.
    refused("batch in/pairs.csv -o out --keep table", "not empty");
    // Files that differ stay unless they may go.
    let merged = tables(root, "out");
    for name in ["results.csv", "poses.csv.gz"] {
        fs::write(root.join("out").join(name), "mine").unwrap();
        refused("merge out --partial", "--force");
        assert_eq!(fs::read(root.join("out").join(name)).unwrap(), b"mine");
        succeed(root, ["merge", "out", "--partial", "--force"]);
        assert!(tables(root, "out") == merged, "{name}");
        // What is there already is no reason to refuse.
        succeed(root, ["merge", "out", "--partial"]);
    }
    fs::create_dir_all(root.join("mine/shards/0001-of-0002")).unwrap();
    let mine = root.join("mine/shards/0001-of-0002/poses.csv.gz");
    fs::write(&mine, "mine").unwrap();
    refused(
        &shard("--shard 1/2").replace("-o out", "-o mine"),
        "not empty",
    );
    assert_eq!(fs::read(&mine).unwrap(), b"mine");
    // Nor does a shard go where something else is.
    fs::create_dir(root.join("other")).unwrap();
    fs::write(root.join("other/notes.txt"), "mine").unwrap();
    refused(
        &shard("--shard 1/2").replace("-o out", "-o other"),
        "not empty",
    );
    assert_eq!(names(&root.join("other")), ["notes.txt"]);
    // A shard that is not done.
    assert!(batch(root, &shard("--shard 2/2")).status.success());
    let results = root.join("out/shards/0002-of-0002/results.csv");
    let text = fs::read_to_string(&results).unwrap();
    let cut = text.trim_end().rfind('\n').unwrap() + 1;
    File::options()
        .write(true)
        .open(&results)
        .unwrap()
        .set_len(cut as u64)
        .unwrap();
    refused("merge out", "4 of 5 ");
}

/// What is missing is named by ranges, however much it is.
#[test]
fn missing_shards_and_pairs_are_named_by_ranges() {
    let folder = place();
    let root = folder.path();
    // No pair has files, so that all of them fail at once.
    let pairs: String = (1..=24)
        .map(|pair| format!("p{pair},late.pdb,late.pdb\n"))
        .collect();
    write_pairs(root, &format!("name,receptor,ligand\n{pairs}"));
    let dock = |index: usize| {
        let call = format!(
            "batch in/pairs.csv -o out --shard {index}/8 --keep none --failures-ok {SHORT}"
        );
        assert!(batch(root, &call).status.success());
    };
    let missing = || {
        let output = merge(root, "out");
        assert_eq!(output.status.code(), Some(2), "{output:?}");
        String::from_utf8(output.stderr).unwrap()
    };
    for index in [1, 4] {
        dock(index);
    }
    let said = missing();
    assert!(said.contains("2-3, 5-8 of 8"), "{said}");
    for index in [2, 3, 5, 6, 7, 8] {
        dock(index);
    }
    // The fourth shard has pairs 4, 12 and 20; the first of them stays.
    let results = root.join("out/shards/0004-of-0008/results.csv");
    let text = fs::read_to_string(&results).unwrap();
    let kept: String = text.split_inclusive('\n').take(2).collect();
    fs::write(&results, kept).unwrap();
    let said = missing();
    assert!(said.contains("12, 20 of 24"), "{said}");
}
