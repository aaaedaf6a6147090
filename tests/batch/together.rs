//! Chains that stay together, and pairs that are docked at the same time.

use std::fs;

use serde_json::Value;

use super::{OPTIONS, batch, place, write_pairs};

/// Many antibodies against one antigen: the chains of each stay together and in order, whatever the antigen's are
/// called, and the record says which is which.
#[test]
fn heavy_and_light_chains_stay_together() {
    let folder = place();
    let inputs = folder.path().join("in");
    let atoms = |name: &str, chain: char, shift: f64| -> String {
        let text = fs::read_to_string(inputs.join(name)).unwrap();
        let atoms = text.lines().filter(|line| line.starts_with("ATOM"));
        let moved = atoms.map(|line| {
            let x = shift + line[30..38].trim().parse::<f64>().unwrap();
            format!(
                "{}{chain}{}{x:8.3}{}\n",
                &line[..21],
                &line[22..30],
                &line[38..]
            )
        });
        moved.collect()
    };
    let antibody = atoms("helices_ligand.pdb", 'H', 0.0) + &atoms("helices_ligand.pdb", 'L', 12.0);
    fs::write(inputs.join("antibody.pdb"), antibody).unwrap();
    for chain in ['A', 'H'] {
        let antigen = atoms("helices_receptor.pdb", chain, 0.0);
        fs::write(inputs.join(format!("antigen_{chain}.pdb")), antigen).unwrap();
    }
    write_pairs(
        folder.path(),
        "name,receptor,ligand\nplain,antigen_A.pdb,\"antibody.pdb:H,L\"\nshared,antigen_H.pdb,\"antibody.pdb:H,L\"\n",
    );
    let output = batch(
        folder.path(),
        &format!("batch in/pairs.csv -o out {OPTIONS} --rotations 12"),
    );
    assert!(output.status.success(), "{output:?}");
    for (name, expected) in [("plain", ["A", "H", "L"]), ("shared", ["H", "A", "L"])] {
        let run = folder.path().join("out").join(name);
        let complex = fs::read_to_string(run.join("top/rank_0001.pdb")).unwrap();
        let mut chains: Vec<&str> = complex
            .lines()
            .filter(|line| line.starts_with("ATOM"))
            .map(|line| &line[21..22])
            .collect();
        // Chains that were mixed would be listed again.
        chains.dedup();
        assert_eq!(chains, expected, "{name}");
        let record: Value =
            serde_json::from_slice(&fs::read(run.join("run.json")).unwrap()).unwrap();
        let of_ligand: Vec<(&str, &str)> = record["chains"]
            .as_array()
            .unwrap()
            .iter()
            .filter(|chain| chain["partner"] == "ligand")
            .map(|chain| {
                (
                    chain["original"].as_str().unwrap(),
                    chain["written"].as_str().unwrap(),
                )
            })
            .collect();
        assert_eq!(of_ligand, [("H", expected[1]), ("L", expected[2])]);
    }
}

/// Pairs that are docked at the same time leave the same bytes as one after another, and each has its own processor
/// time.
#[test]
fn pairs_at_the_same_time_are_as_by_themselves() {
    let folder = place();
    let rows: String = (0..6)
        .map(|row| {
            let case = ["helices", "charged_helices"][row % 2];
            format!(
                "p{row},{case}_receptor.pdb,{case}_ligand.pdb,{}\n",
                24 + 12 * row
            )
        })
        .collect();
    write_pairs(
        folder.path(),
        &format!("name,receptor,ligand,rotations\n{rows}"),
    );
    for (out, threads) in [("one", 1), ("out", 3)] {
        let words = format!("batch in/pairs.csv -o {out} -j {threads} -- --poses 60 --write-top 1");
        let output = batch(folder.path(), &words);
        assert!(output.status.success(), "{output:?}");
    }
    let read = |path: String| fs::read(folder.path().join(path)).unwrap();
    assert_eq!(
        read("one/results.csv".into()),
        read("out/results.csv".into())
    );
    let mut on_one_thread = 0;
    for row in 0..6 {
        for file in ["poses.csv", "top/rank_0001.pdb"] {
            let path = format!("p{row}/{file}");
            assert_eq!(
                read(format!("one/{path}")),
                read(format!("out/{path}")),
                "{path}"
            );
        }
        let record: Value = serde_json::from_slice(&read(format!("out/p{row}/run.json"))).unwrap();
        let time = |name: &str| -> f64 {
            let stages = record["timing"]["stages"].as_array().unwrap().iter();
            stages.map(|stage| stage[name].as_f64().unwrap()).sum()
        };
        if record["machine"]["threads"] == 1 {
            on_one_thread += 1;
            // The clock of a busy machine runs on, that of the thread does not.
            assert!(time("cpu_seconds") <= time("wall_seconds") + 0.1);
        }
    }
    assert!(on_one_thread >= 3, "{on_one_thread}");
}
