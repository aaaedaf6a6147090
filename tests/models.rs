//! `knotdock models`: confidence files of each program beside made structures, whose scores are closed forms, and the
//! structures that mislead a reader.

use std::fs;
use std::path::Path;

use serde_json::{Value, json};

use crate::dock_run::run::run;
use crate::fuzz::seeds::{npy, npz};
use crate::program::refused;

/// An atom: name, residue, chain, number, position in Å.
type MadeAtom = (&'static str, &'static str, &'static str, usize, [f64; 3]);

/// Residues of each chain.
const LENGTHS: [usize; 2] = [60, 30];

/// Two strands at a distance of 7 Å: each residue of the second one touches the one opposite. Residue 3 of the first is
/// phosphorylated, behind the second are a ligand and an ion.
fn atoms([first, second]: [&'static str; 2], with_ligands: bool) -> Vec<MadeAtom> {
    let mut atoms = Vec::new();
    for (chain, length, height) in [(first, LENGTHS[0], 0.0), (second, LENGTHS[1], 7.0)] {
        for number in 1..=length {
            let x = 4.0 * number as f64;
            let is_modified = with_ligands && chain == first && number == 3;
            let residue = if is_modified { "TPO" } else { "ALA" };
            // The oxygens of both strands point at each other.
            let mut add = |name, dx, dz| {
                let along = if name == "O" {
                    1.3 - 2.6 * height / 7.0
                } else {
                    0.0
                };
                atoms.push((name, residue, chain, number, [x + dx, height + along, dz]));
            };
            add("N", -1.2, 0.9);
            add("CA", 0.0, 1.5);
            add("C", 1.2, 0.9);
            add("O", 1.2, 0.9);
            add("CB", 0.0, 0.0);
            if is_modified {
                add("P", 0.0, -1.6);
            }
        }
    }
    if with_ligands {
        let ligand = |name, x| (name, "ATP", "L", 1, [x, 60.0, 0.0]);
        atoms.extend([ligand("PA", 0.0), ligand("C1'", 1.6), ligand("C3'", 3.1)]);
        atoms.push(("MG", "MG", "ion", 1, [0.0, 80.0, 0.0]));
    }
    atoms
}

/// Tokens of such atoms as (chain, residue).
fn tokens(atoms: &[MadeAtom]) -> Vec<(&'static str, usize)> {
    let is_token = |atom: &&MadeAtom| atom.1 != "ALA" || atom.0 == "N";
    atoms
        .iter()
        .filter(is_token)
        .map(|atom| (atom.2, atom.3))
        .collect()
}

fn element(atom: &MadeAtom) -> &'static str {
    match atom.0 {
        "MG" => "MG",
        name => &name[..1],
    }
}

/// pLDDT of the residues of each chain: 90 and 70, with one that differs.
fn plddt(atom: &MadeAtom) -> f64 {
    match (atom.2, atom.3) {
        (_, 60) => 50.0,
        ("H1" | "A", _) => 90.0,
        _ => 70.0,
    }
}

fn mmcif(atoms: &[MadeAtom]) -> String {
    let mut text = "data_x\nloop_\n".to_owned();
    for item in "group_PDB id type_symbol label_atom_id label_alt_id label_comp_id label_asym_id label_entity_id \
                 label_seq_id Cartn_x Cartn_y Cartn_z occupancy B_iso_or_equiv auth_seq_id auth_asym_id \
                 pdbx_PDB_model_num"
        .split_whitespace()
    {
        text += &format!("_atom_site.{item}\n");
    }
    for (at, atom) in atoms.iter().enumerate() {
        let (name, residue, chain, number, [x, y, z]) = atom;
        let group = if *residue == "ALA" { "ATOM" } else { "HETATM" };
        text += &format!(
            "{group} {} {} \"{name}\" . {residue} {chain} 1 {number} {x:.3} {y:.3} {z:.3} 1.00 {:.2} {number} {chain} 1\n",
            at + 1,
            element(atom),
            plddt(atom)
        );
    }
    text + "#\n"
}

fn pdb(atoms: &[MadeAtom]) -> String {
    let line = |(at, atom): (usize, &MadeAtom)| {
        let (name, residue, chain, number, [x, y, z]) = atom;
        format!(
            "ATOM  {:>5}  {name:<3} {residue} {chain}{number:>4}    {x:8.3}{y:8.3}{z:8.3}  1.00{:6.2}          {:>2}\n",
            at + 1,
            plddt(atom),
            element(atom)
        )
    };
    atoms.iter().enumerate().map(line).collect()
}

/// A PAE of 4 Å with the first chain aligned and the second scored, and of 6 Å the other way.
///
/// It is 1 Å within a chain, and 30 Å for tokens that are no residue.
fn pae(atoms: &[MadeAtom], chains: [&str; 2]) -> Vec<Vec<f32>> {
    let tokens: Vec<MadeAtom> = {
        let is_token = |atom: &&MadeAtom| atom.1 != "ALA" || atom.0 == "N";
        atoms.iter().filter(is_token).copied().collect()
    };
    let side = |token: &MadeAtom| {
        let is_residue = token.1 == "ALA" || token.0 == "CA";
        chains
            .iter()
            .position(|chain| *chain == token.2)
            .filter(|_| is_residue)
    };
    let error = |a: &MadeAtom, b: &MadeAtom| match (side(a), side(b)) {
        (Some(0), Some(1)) => 4.0,
        (Some(1), Some(0)) => 6.0,
        (Some(_), Some(_)) => 1.0,
        _ => 30.0,
    };
    let row = |a: &MadeAtom| tokens.iter().map(|b| error(a, b)).collect();
    tokens.iter().map(row).collect()
}

/// The scores of such a PAE.
fn expected() -> Value {
    let d0 = |count: f64| 1.24 * (count - 15.0).cbrt() - 1.8;
    let share = |error: f64, d0: f64| 1.0 / (1.0 + (error / d0) * (error / d0));
    let pdockq2 = |error: f64| {
        let x = 80.0 * share(error, 10.0);
        1.31 / (1.0 + (-0.075 * (x - 84.733)).exp()) + 0.005
    };
    let x = 80.0 * 30.0_f64.log10();
    json!({
        "ipsae_12": share(4.0, d0(30.0)), "ipsae_21": share(6.0, d0(60.0)), "ipsae": share(6.0, d0(60.0)),
        "pdockq": 0.724 / (1.0 + (-0.052 * (x - 152.611)).exp()) + 0.018,
        "pdockq2_12": pdockq2(4.0), "pdockq2_21": pdockq2(6.0), "pdockq2": pdockq2(4.0),
        "lis_12": 8.0 / 12.0, "lis_21": 0.5, "lis": 7.0 / 12.0,
        "interface_pae": 5.0, "interface_plddt": 80.0,
    })
}

fn models(folder: &Path, words: &str) -> Vec<Value> {
    let text = run(folder, &format!("models {words} --json"));
    let object: Value = serde_json::from_str(&text).unwrap();
    object["models"].as_array().unwrap().clone()
}

/// The only pair of a model, whose scores must be [`expected`].
fn rated_pair(model: &Value) -> &Value {
    let pairs = model["pairs"].as_array().unwrap();
    assert_eq!(pairs.len(), 1, "{model}");
    for (name, value) in expected().as_object().unwrap() {
        let (found, value) = (pairs[0][name].as_f64().unwrap(), value.as_f64().unwrap());
        assert!((found - value).abs() < 1e-9, "{name}: {found} {value}");
    }
    &pairs[0]
}

fn write(folder: &Path, name: &str, content: impl AsRef<[u8]>) {
    fs::write(folder.join(name), content).unwrap();
}

/// AlphaFold 3's server, with chains that are not named A and B, a modified residue of one token per atom, a ligand and
/// an ion.
#[test]
fn alphafold_models_have_tokens_of_atoms() {
    let folder = tempfile::tempdir().unwrap();
    let atoms = atoms(["H1", "X"], true);
    write(folder.path(), "fold_x_model_0.cif", mmcif(&atoms));
    let tokens = tokens(&atoms);
    let full = json!({
        "atom_plddts": atoms.iter().map(plddt).collect::<Vec<f64>>(),
        "contact_probs": [[1.0]],
        "pae": pae(&atoms, ["H1", "X"]),
        "token_chain_ids": tokens.iter().map(|token| token.0).collect::<Vec<&str>>(),
        "token_res_ids": tokens.iter().map(|token| token.1).collect::<Vec<usize>>(),
    });
    write(folder.path(), "fold_x_full_data_0.json", full.to_string());
    let mut iptm = vec![vec![json!(null); 4]; 4];
    (iptm[0][1], iptm[1][0]) = (json!(0.31), json!(0.36));
    let summary =
        json!({ "chain_pair_iptm": iptm, "iptm": 0.5, "ptm": 0.7, "ranking_score": 0.62 });
    write(
        folder.path(),
        "fold_x_summary_confidences_0.json",
        summary.to_string(),
    );
    let found = models(folder.path(), "fold_x_model_0.cif -o models.csv");
    let pair = rated_pair(&found[0]);
    assert_eq!(
        (&pair["chain_1"], &pair["chain_2"]),
        (&json!("H1"), &json!("X"))
    );
    assert_eq!(
        (&pair["iptm"], &found[0]["model_iptm"]),
        (&json!(0.36), &json!(0.5))
    );
    assert_eq!(found[0]["program"], "alphafold3");
    assert_eq!(found[0]["confidence_files"].as_array().unwrap().len(), 2);
    let mut table = csv::Reader::from_path(folder.path().join("models.csv")).unwrap();
    let header = table.headers().unwrap().clone();
    let rows: Vec<csv::StringRecord> = table.records().map(Result::unwrap).collect();
    assert_eq!(rows.len(), 1);
    for (name, field) in header
        .iter()
        .zip(&rows[0])
        .skip(6)
        .filter(|(name, _)| !name.starts_with("chain_") && !pair[*name].is_string())
    {
        let value = pair[name]
            .as_f64()
            .map(|value| value.to_string())
            .unwrap_or_default();
        assert_eq!(
            field.parse::<f64>().ok(),
            value.parse::<f64>().ok(),
            "{name}"
        );
    }
    // The cut-off is the user's.
    let strict = models(folder.path(), "fold_x_model_0.cif --pae-cutoff 5");
    assert_eq!(strict[0]["pairs"][0]["ipsae_21"], 0.0);
    // Tokens of another chain.
    let other = full.to_string().replacen("\"X\"", "\"Y\"", 1);
    write(folder.path(), "other.json", other);
    let error = refused(
        folder.path(),
        ["models", "fold_x_model_0.cif", "--confidence", "other.json"],
    );
    let message = error["message"].as_str().unwrap();
    assert!(
        message.contains("is of Y:1, and that of the structure of X:1"),
        "{message}"
    );
}

/// Boltz: arrays of NumPy, pLDDT from 0 to 1, ipTM that depends on the direction.
#[test]
fn boltz_models_have_arrays() {
    let folder = tempfile::tempdir().unwrap();
    let atoms = atoms(["A", "B"], true);
    write(folder.path(), "x_model_0.cif", mmcif(&atoms));
    let errors = pae(&atoms, ["A", "B"]);
    let count = errors.len();
    let errors = npy(&format!("({count}, {count})"), &errors.concat());
    write(folder.path(), "pae_x_model_0.npz", npz("pae", &errors));
    let is_token = |atom: &&MadeAtom| atom.1 != "ALA" || atom.0 == "N";
    let shares: Vec<f32> = atoms
        .iter()
        .filter(is_token)
        .map(|atom| plddt(atom) as f32 / 100.0)
        .collect();
    write(
        folder.path(),
        "plddt_x_model_0.npz",
        npz("plddt", &npy(&format!("({count},)"), &shares)),
    );
    let chains = |second: f64| json!({ "0": 0.9, "1": second, "2": 0.1, "3": 0.1 });
    let summary = json!({
        "confidence_score": 0.8, "ptm": 0.7, "iptm": 0.6, "complex_plddt": 0.8,
        "pair_chains_iptm": { "0": chains(0.25), "1": { "0": 0.75, "1": 0.9 }, "2": {}, "3": {} },
    });
    write(
        folder.path(),
        "confidence_x_model_0.json",
        summary.to_string(),
    );
    let found = models(folder.path(), "x_model_0.cif");
    let pair = rated_pair(&found[0]);
    assert_eq!(
        (&pair["iptm"], &found[0]["ranking_score"]),
        (&json!(0.75), &json!(0.8))
    );
    assert_eq!(found[0]["program"], "boltz");
    let mean = found[0]["model_plddt"].as_f64().unwrap();
    assert!(
        (mean - (59.0 * 90.0 + 50.0 + 30.0 * 70.0) / 90.0).abs() < 1e-5,
        "{mean}"
    );
}

/// Several seeds of ColabFold and one of Chai, whose scores have no PAE, in one folder; a model whose confidence is torn
/// fails alone.
#[test]
fn folders_hold_models_of_several_seeds() {
    let folder = tempfile::tempdir().unwrap();
    let atoms = atoms(["A", "B"], false);
    for seed in ["009", "010"] {
        write(
            folder.path(),
            &format!("x_unrelaxed_rank_001_seed_{seed}.pdb"),
            pdb(&atoms),
        );
        let residues = atoms.iter().filter(|atom| atom.0 == "CA").map(plddt);
        let scores = json!({
            "plddt": residues.collect::<Vec<f64>>(), "max_pae": 31.75, "pae": pae(&atoms, ["A", "B"]),
            "ptm": 0.5, "iptm": 0.25,
        });
        write(
            folder.path(),
            &format!("x_scores_rank_001_seed_{seed}.json"),
            scores.to_string(),
        );
    }
    write(folder.path(), "template.pdb", "no model");
    write(folder.path(), "pred.model_idx_0.cif", mmcif(&atoms));
    let iptm = npy("(1, 2, 2)", &[0.9, 0.5, 0.625, 0.9]);
    write(
        folder.path(),
        "scores.model_idx_0.npz",
        npz("per_chain_pair_iptm", &iptm),
    );
    let found = models(folder.path(), ".");
    let names = [
        "pred.model_idx_0.cif",
        "x_unrelaxed_rank_001_seed_009.pdb",
        "x_unrelaxed_rank_001_seed_010.pdb",
    ];
    for (model, name) in found.iter().zip(names) {
        assert!(model["file"].as_str().unwrap().ends_with(name), "{model}");
    }
    assert_eq!(found.len(), 3);
    assert_eq!(found[0]["pairs"][0]["iptm"], 0.625);
    assert!(found[0]["pairs"][0]["ipsae"].is_null());
    // Without ipTM of pairs, that of the whole is the pair's if there are two chains.
    assert_eq!(rated_pair(&found[2])["iptm"], 0.25);
    for pair in found.iter().map(|model| &model["pairs"][0]) {
        assert_eq!(
            (&pair["agreement"], &pair["cluster_size"]),
            (&json!(1.0), &json!(3))
        );
        // Three models agree too easily to support the interface.
        let evidence = pair["evidence"].as_str().unwrap();
        assert!(
            evidence.contains("agreement open (1.00 of 3 models)"),
            "{evidence}"
        );
        assert_ne!(pair["trust"], "likely");
    }
    // The system has the word of the model of the highest ipTM.
    let text = run(folder.path(), "models .");
    let evidence = found[0]["pairs"][0]["evidence"].as_str().unwrap();
    let line = text
        .lines()
        .find(|line| line.starts_with("Chains A B, "))
        .unwrap();
    assert!(
        line.contains("by ./pred.model_idx_0.cif (highest ipTM): ") && line.contains(evidence),
        "{line}"
    );
    write(
        folder.path(),
        "x_scores_rank_001_seed_009.json",
        "{\"pae\": [[1, 2]]}",
    );
    let output = assert_cmd::cargo::cargo_bin_cmd!("knotdock")
        .current_dir(folder.path())
        .args(["models", ".", "--json"])
        .output()
        .unwrap();
    assert_eq!(output.status.code(), Some(2));
    let object: Value = serde_json::from_slice(&output.stdout).unwrap();
    assert_eq!(object["models"].as_array().unwrap().len(), 2);
    let message = String::from_utf8_lossy(&output.stderr);
    assert!(
        message.contains("the PAE is not square") && message.contains("009.json"),
        "{message}"
    );
}

/// Without confidence files, the coordinates alone are described; they are those of `knotdock interface`.
#[test]
fn structures_without_confidence_have_coordinates() {
    let folder = tempfile::tempdir().unwrap();
    write(
        folder.path(),
        "x.pdb",
        pdb(&atoms(["A", "B"], false)).replace(" 90.00 ", " 10.00 "),
    );
    let found = models(folder.path(), "x.pdb");
    let pair = &found[0]["pairs"][0];
    let interface: Value = serde_json::from_str(&run(
        folder.path(),
        "interface x.pdb --config kernel.resolution=16 --json",
    ))
    .unwrap();
    for name in [
        "contacts",
        "hydrogen_bonds",
        "salt_bridges",
        "clashes",
        "buried_area",
        "shape_complementarity",
    ] {
        assert_eq!(pair[name], interface["complexes"][0][name], "{name}");
    }
    assert!(pair["contacts"].as_u64().unwrap() > 0);
    let evidence = pair["evidence"].as_str().unwrap();
    assert!(
        evidence.starts_with("confidence unknown; agreement unknown (one model); coordinates"),
        "{evidence}"
    );
    assert_ne!(pair["trust"], "likely");
    for name in ["iptm", "ipsae", "pdockq", "pdockq2", "lis", "interface_pae"] {
        assert!(pair[name].is_null(), "{name}");
    }
    assert!(found[0]["program"].is_null());
}

/// Confidence of another model, of another structure, and for several structures.
#[test]
fn confidence_of_other_models_is_refused() {
    let folder = tempfile::tempdir().unwrap();
    let atoms = atoms(["A", "B"], false);
    write(folder.path(), "x.pdb", pdb(&atoms));
    write(folder.path(), "y.pdb", pdb(&atoms));
    write(folder.path(), "single.pdb", pdb(&atoms[..300]));
    let refusal = |words: &[&str]| {
        let words = [&["models"], words].concat();
        let error = refused(folder.path(), words);
        error["message"].as_str().unwrap().to_owned()
    };
    write(folder.path(), "small.json", "{\"pae\": [[1, 2], [3, 4]]}");
    let message = refusal(&["x.pdb", "--confidence", "small.json"]);
    assert!(
        message.contains("has 2 tokens with a PAE, and the structure has 90 tokens"),
        "{message}"
    );
    let plddt = json!({ "plddt": vec![40.0; 90] });
    write(folder.path(), "other.json", plddt.to_string());
    let message = refusal(&["x.pdb", "--confidence", "other.json"]);
    assert!(
        message.contains("differs from that of the B column by"),
        "{message}"
    );
    write(folder.path(), "nan.json", "{\"pae\": [[NaN]]}");
    assert!(refusal(&["x.pdb", "--confidence", "nan.json"]).contains("no confidences"));
    assert!(refusal(&["x.pdb", "y.pdb", "--confidence", "other.json"]).contains("2 are given"));
    assert!(refusal(&["single.pdb"]).contains("there is no pair of chains"));
}

/// A structure of the example complex, 1PPE.
fn example(name: &str) -> String {
    let folder = Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/..")).join("structures/examples");
    fs::read_to_string(folder.join(name)).unwrap()
}

/// Atoms under another chain name, shifted along x by some Å.
fn moved(text: &str, chain: &str, shift: f64) -> String {
    let line = |line: &str| {
        let x: f64 = line[30..38].trim().parse().unwrap();
        format!(
            "{}{chain}{}{:8.3}{}\n",
            &line[..21],
            &line[22..30],
            x + shift,
            &line[38..]
        )
    };
    let atoms = text.lines().filter(|line| line.starts_with("ATOM"));
    atoms.map(line).collect()
}

/// With a known complex, models have the figures of `knotdock evaluate`, whatever their chains are called; pairs of chains
/// that it does not have stay without.
#[test]
fn models_are_measured_against_a_known_complex() {
    let folder = tempfile::tempdir().unwrap();
    let sides = ["receptor", "ligand"].map(|side| example(&format!("1ppe_{side}_bound.pdb")));
    let [receptor, ligand] = &sides;
    write(
        folder.path(),
        "native.pdb",
        moved(receptor, "E", 0.0) + &moved(ligand, "I", 0.0),
    );
    // The ligand comes first, and is out of place.
    let pair = moved(ligand, "X", 1.5) + &moved(receptor, "Y", 0.0);
    write(folder.path(), "pair.pdb", &pair);
    let found = models(folder.path(), "pair.pdb --native native.pdb -o pair.csv");
    let measured = &found[0]["pairs"][0];
    let evaluated: Value = serde_json::from_str(&run(
        folder.path(),
        "evaluate pair.pdb --native native.pdb --json",
    ))
    .unwrap();
    let columns = [
        "irmsd",
        "lrmsd",
        "fnat",
        "dockq",
        "capri",
        "interface_share",
    ];
    for name in columns.iter().chain(&["native_chains"]) {
        assert_eq!(measured[name], evaluated["complexes"][0][name], "{name}");
    }
    let dockq = measured["dockq"].as_f64().unwrap();
    assert!(0.3 < dockq && dockq < 0.95, "{dockq}");
    assert_eq!(measured["native_chains"], "X:I,Y:E");
    let table = fs::read_to_string(folder.path().join("pair.csv")).unwrap();
    assert!(
        table
            .lines()
            .next()
            .unwrap()
            .ends_with("dockq,capri,interface_share,native_chains")
    );
    // Without a known complex there are no such columns.
    assert!(
        models(folder.path(), "pair.pdb")[0]["pairs"][0]
            .get("dockq")
            .is_none()
    );
    let third = moved(&pdb(&atoms(["Z", "z"], false)[..150]), "Z", 0.0);
    write(folder.path(), "three.pdb", pair + &third);
    let found = models(folder.path(), "three.pdb --native native.pdb");
    let pairs = found[0]["pairs"].as_array().unwrap();
    assert_eq!(pairs.len(), 3);
    assert_eq!(pairs[0]["dockq"].as_f64(), Some(dockq));
    assert!(pairs[1]["dockq"].is_null() && pairs[2]["capri"].is_null());
    // A known complex of other proteins.
    write(folder.path(), "made.pdb", pdb(&atoms(["A", "B"], false)));
    refused(
        folder.path(),
        ["models", "made.pdb", "--native", "native.pdb"],
    );
}

/// A report holds no name unescaped, and is written only over a file that may be replaced.
#[test]
fn reports_of_models_hold_names_as_text() {
    let folder = tempfile::tempdir().unwrap();
    let atoms = atoms(["A", "B"], false);
    let name = "<img src=x>.pdb";
    write(folder.path(), name, pdb(&atoms));
    let words = ["models", name, "--report", "report.html"];
    let write_report = |more: &[&str]| {
        let mut command = assert_cmd::cargo::cargo_bin_cmd!("knotdock");
        command
            .current_dir(folder.path())
            .args(words)
            .args(more)
            .assert()
    };
    write_report(&[]).success();
    let page = fs::read_to_string(folder.path().join("report.html")).unwrap();
    assert!(page.contains("Content-Security-Policy") && !page.contains("<img src=x>"));
    write_report(&[]).code(2);
    write_report(&["--force"]).success();
    // The same bytes again.
    assert_eq!(
        page,
        fs::read_to_string(folder.path().join("report.html")).unwrap()
    );
}
