//! PDB files as they come: each test says in a comment which file it stands for.

#![cfg(feature = "molecule")]

use std::io::Write;

use crate::pdb_text::{ATOM, Line, names, read_bytes, read_text, text};
use knotdock_structures::Error;
use knotdock_structures::molecule::{
    Format, InputSpec, Molecule, Partner, ReadOptions, complex_format, read, write_complex,
    write_renamed,
};

#[test]
fn records_that_break_pdbtbx_are_filtered_out() {
    // Free-form REMARK, short header, old DBREF and SEQADV, the dummy CRYST1 of NMR and model files, ANISOU without its
    // atom, a MASTER record that does not add up. Each alone makes pdbtbx 0.12 refuse or panic.
    let mut file = String::from(
        "HEADER    SHORT\nREMARK free text, no number\nREMARK\nDBREF  1ABC A\nSEQADV\nDBREF2 X\nSSBOND\nMODRES\n\
         CRYST1    0.000    0.000    0.000  90.00  90.00  90.00\nANISOU\nSEQRES\nMASTER\nUSER  x\n",
    );
    let first = file.lines().count() + 1;
    // Cut after the coordinates: no occupancy, no temperature factor, no element.
    file.push_str(&ATOM.text()[..54]);
    file.push('\n');
    // A segment name, a chain letter in the element column and a number in the charge column.
    let odd = Line {
        name: " N  ",
        ..ATOM
    }
    .text();
    file.push_str(&format!("{}      A    A115\n", &odd[..66]));
    let molecule = read_text(&file).unwrap();
    assert_eq!(names(&molecule), ["CA", "N"]);
    assert_eq!(molecule.atoms[0].line, first);
    assert_eq!(molecule.atoms[0].occupancy, 1.0);
    assert_eq!(molecule.atoms[0].b_factor, 0.0);
    assert_eq!(molecule.atoms[0].element, "C");
    assert_eq!(molecule.atoms[1].element, "N");
    let altered = &molecule.report.altered;
    assert_eq!(altered.elements_derived, 1);
    assert_eq!(altered.elements_corrected, 1);
    assert_eq!(altered.defaults_filled, 2);
}

#[test]
fn atoms_keep_file_order_and_true_lines() {
    // pdbtbx regroups by chain and residue: here residue 1 of A comes in two parts with B between.
    let lines = [
        Line {
            name: " N  ",
            x: 1.0,
            ..ATOM
        },
        Line {
            name: " N  ",
            chain: 'B',
            x: 2.0,
            ..ATOM
        },
        Line {
            name: " CA ",
            x: 3.0,
            ..ATOM
        },
    ];
    let molecule = read_text(&format!("REMARK\n{}", text(&lines))).unwrap();
    let found: Vec<_> = molecule
        .atoms
        .iter()
        .map(|a| (a.line, a.position[0]))
        .collect();
    assert_eq!(found, [(2, 1.0), (3, 2.0), (4, 3.0)]);
}

#[test]
fn only_the_first_model_is_read() {
    let atom = ATOM.text();
    let models = format!(
        "MODEL        1\n{atom}ENDMDL\nMODEL        2\n{atom}ENDMDL\nMODEL 3\n{atom}ENDMDL\nEND\n"
    );
    let molecule = read_text(&models).unwrap();
    assert_eq!(molecule.atoms.len(), 1);
    assert_eq!(molecule.report.altered.models_ignored, 2);
    // Trajectories by VMD have END between frames and no MODEL.
    let frames = format!("{atom}END\n{atom}END\n");
    assert_eq!(read_text(&frames).unwrap().report.altered.models_ignored, 1);
    // Complexes put together by hand have END between their parts, which are no models.
    let other = Line { chain: 'B', ..ATOM }.text();
    let parts = read_text(&format!("{atom}END\n{other}END\n")).unwrap();
    assert_eq!(parts.atoms.len(), 2);
    assert_eq!(parts.report.altered.models_ignored, 0);
}

/// An atom without a chain, of a segment.
fn of_segment(segid: &str, x: f64) -> String {
    let line = Line {
        chain: ' ',
        x,
        ..ATOM
    };
    format!("{}      {segid:<4}\n", &line.text()[..66])
}

/// CNS, HADDOCK and CHARMM leave the chain blank and name molecules by the segid: two of them were one chain, so that
/// neither could be selected or restrained.
#[test]
fn segids_are_chains_if_a_file_has_none() {
    let chains = |text: &str| -> Vec<String> {
        let molecule = read_text(text).unwrap();
        molecule.atoms.into_iter().map(|atom| atom.chain).collect()
    };
    let two = of_segment("A", 1.0) + &of_segment("PROB", 5.0);
    assert_eq!(chains(&two), ["A", "PROB"]);
    assert_eq!(
        read_text(&two).unwrap().report.altered.chains_from_segids,
        2
    );
    let picked = read_bytes("x.pdb", two.as_bytes(), ":PROB:1").unwrap();
    assert_eq!(picked.atoms[0].position[0], 5.0);
    // All or none, as far as the file goes: models that are not read count, too.
    let (mixed, atom) = (format!("{two}{}", ATOM.text()), of_segment("B", 9.0));
    assert_eq!(chains(&mixed), ["", "", "A"]);
    assert_eq!(chains(&(atom.clone() + &of_segment("", 1.0))), ["B", ""]);
    let models = format!("MODEL 1\n{atom}ENDMDL\nMODEL 2\n{}ENDMDL\n", ATOM.text());
    assert_eq!(chains(&models), [""]);
    // Parts of a complex with END between have different segids, and frames of a trajectory the same one.
    let parts = format!("{atom}END\n{}END\n", of_segment("C", 1.0));
    assert_eq!(chains(&parts), ["B", "C"]);
    assert_eq!(chains(&format!("{atom}END\n{atom}END\n")), ["B"]);
}

/// Segids of several letters stay whole in mmCIF. In PDB each gets a letter, which the remarks give.
#[test]
fn long_segids_are_written() {
    let text = of_segment("PROA", 1.0) + &of_segment("PROB", 5.0) + &of_segment("A", 9.0);
    let molecule = read_text(&text).unwrap();
    let written = |format: Format| {
        let mut bytes = Vec::new();
        write_renamed(&mut bytes, format, &molecule, &[]).unwrap();
        let name = format!("y.{}", format.extension());
        let again = read_bytes(&name, &bytes, "").unwrap();
        let chains: Vec<String> = again.atoms.into_iter().map(|atom| atom.chain).collect();
        (chains.join(" "), String::from_utf8(bytes).unwrap())
    };
    assert_eq!(written(Format::Mmcif).0, "PROA PROB A");
    let (chains, pdb) = written(Format::Pdb);
    assert_eq!(chains, "B C A");
    for remark in ["chain B was PROA", "chain C was PROB"] {
        assert!(pdb.contains(remark), "{pdb}");
    }
    assert_eq!(complex_format(&[&molecule, &molecule]), Format::Pdb);
    let mut bytes = Vec::new();
    let map = write_complex(&mut bytes, Format::Pdb, &[&molecule], &[]).unwrap();
    assert_eq!(map.written(Partner::Receptor, "PROB"), "C");
    let pdb = String::from_utf8(bytes).unwrap();
    assert!(pdb.contains("chain C is receptor chain PROB"), "{pdb}");
}

#[test]
fn residue_numbers_and_insertion_codes_are_the_files() {
    let mut lines = vec![
        Line { number: -5, ..ATOM },
        Line {
            number: 100,
            ..ATOM
        },
        Line {
            number: 100,
            insertion: 'A',
            ..ATOM
        },
        // Long loops of antibodies go on in small letters.
        Line {
            number: 100,
            insertion: 'a',
            ..ATOM
        },
        // pdbtbx adds 10,000 to every residue after this pair, other chains included.
        Line {
            number: 9999,
            ..ATOM
        },
        Line { number: 0, ..ATOM },
        Line {
            number: 1,
            chain: 'B',
            ..ATOM
        },
    ];
    lines.push(Line {
        number: 7,
        chain: 'b',
        ..ATOM
    });
    let molecule = read_text(&text(&lines)).unwrap();
    let found: Vec<_> = molecule
        .atoms
        .iter()
        .map(|a| (a.chain.as_str(), a.residue_number, a.insertion_code))
        .collect();
    let expected = [
        ("A", -5, None),
        ("A", 100, None),
        ("A", 100, Some('A')),
        ("A", 100, Some('a')),
        ("A", 9999, None),
        ("A", 0, None),
        ("B", 1, None),
        ("b", 7, None),
    ];
    assert_eq!(found, expected);
}

#[test]
fn bad_numbers_name_their_line() {
    let good = ATOM.text();
    for bad in ["     NaN", "     inf", "********", "        ", "  1.2.3 "] {
        let mut line = good.clone();
        line.replace_range(30..38, bad);
        let error = read_text(&format!("{good}{line}")).unwrap_err();
        assert_eq!(error.line(), Some(2));
        assert!(
            error.to_string().contains("x (columns 31-38) is '"),
            "{bad}: {error}"
        );
        assert!(error.file().is_some_and(|file| file.ends_with("x.pdb")));
        assert!(error.remedy().is_some());
    }
    // Printed with %8.3f at 1e6 Å: all three fields parse as numbers, and two of them are wrong.
    let shifted = format!("{}1000000.0001000000.0001000000.000  1.00\n", &good[..30]);
    let error = read_text(&shifted).unwrap_err();
    assert!(error.to_string().contains("mmCIF"), "{error}");
}

#[test]
fn what_is_no_structure_is_refused() {
    let missing = read(
        &InputSpec::whole("/no/such/file.pdb"),
        &ReadOptions::default(),
    );
    let says = |result: Result<Molecule, Error>, what: &str| {
        let error = result.unwrap_err();
        assert!(
            error.message().contains(what) && error.file().is_some(),
            "{error}"
        );
        error
    };
    says(missing, "no such file");
    let folder = tempfile::tempdir().unwrap();
    let directory = read(&InputSpec::whole(folder.path()), &ReadOptions::default());
    says(directory, "a directory");
    says(read_text("hello\n"), "not a structure");
    says(read_text(""), "not a structure");
    let picture = read_bytes("x.png", &[0x89, b'P', b'N', b'G', 0, 1], "");
    says(picture, "not a structure");
    says(read_text("HEADER    X\nEND\n"), "holds no atoms");
    let water = Line {
        residue: "HOH",
        name: " O  ",
        element: " O",
        ..ATOM
    }
    .text();
    says(
        read_text(&water),
        "no atom is left after what is not wanted is dropped (1 atoms)",
    );
    let cut = says(read_text(&ATOM.text()[..50]), "ends after 50 characters");
    assert_eq!(cut.line(), Some(1));
}

#[test]
fn gzip_is_detected_from_its_magic_bytes() {
    let mut encoder = flate2::write::GzEncoder::new(Vec::new(), flate2::Compression::default());
    encoder.write_all(ATOM.text().as_bytes()).unwrap();
    let packed = encoder.finish().unwrap();
    for name in ["x.pdb.gz", "x.ent", "x"] {
        let molecule = read_bytes(name, &packed, "").unwrap();
        assert!(molecule.report.compressed);
        assert_eq!(molecule.format, Format::Pdb);
    }
    // Two streams one after the other are one file (bgzip, cat).
    let doubled: Vec<u8> = [packed.clone(), packed.clone()].concat();
    assert_eq!(read_bytes("x.gz", &doubled, "").unwrap().atoms.len(), 2);
    let cut = read_bytes("x.pdb.gz", &packed[..packed.len() - 9], "");
    assert!(cut.unwrap_err().message().contains("cannot be unpacked"));
}

/// Found by a user: an archive of a structure was read as one, without the atom that its head ran into.
#[test]
fn archives_and_other_formats_are_refused_with_what_to_do() {
    let mut tar = vec![0; 512];
    tar[257..262].copy_from_slice(b"ustar");
    tar.extend(ATOM.text().as_bytes());
    let mut encoder = flate2::write::GzEncoder::new(Vec::new(), flate2::Compression::default());
    encoder.write_all(&tar).unwrap();
    let packed = encoder.finish().unwrap();
    let zip = [b"PK\x03\x04", ATOM.text().as_bytes()].concat();
    for (name, bytes, says) in [
        ("x.tar.gz", packed.as_slice(), "a tar archive"),
        ("x.pdb.gz", packed.as_slice(), "a tar archive"),
        ("x.tar", tar.as_slice(), "a tar archive"),
        ("x.zip", zip.as_slice(), "a zip archive"),
    ] {
        let error = read_bytes(name, bytes, "").unwrap_err();
        assert!(error.to_string().contains(says), "{name}: {error}");
        assert!(error.remedy().unwrap().contains("unpack it"));
    }
    for (name, text) in [
        (
            "x.sdf",
            "ligand\n  made by hand\n\n  1  0  0  0  0\n    0.0    0.0    0.0 C\nM  END\n",
        ),
        (
            "x.mol2",
            "@<TRIPOS>MOLECULE\nx\n@<TRIPOS>ATOM\n1 C 0.0 0.0 0.0 C.3\n",
        ),
        ("x.xyz", "1\n\nC 0.0 0.0 0.0\n"),
    ] {
        let error = read_bytes(name, text.as_bytes(), "").unwrap_err();
        assert!(
            error.to_string().contains("not a PDB or mmCIF file"),
            "{error}"
        );
        assert!(error.remedy().unwrap().contains("obabel"));
    }
    // A structure is one whatever its name.
    assert!(read_bytes("x.xyz", ATOM.text().as_bytes(), "").is_ok());
}

#[test]
fn bytes_that_are_not_utf8_stop_nothing_outside_the_atoms() {
    // Latin-1 in an author's name, as old files have it.
    let mut file = b"AUTHOR    J\xfcrgen\n".to_vec();
    file.extend(ATOM.text().as_bytes());
    assert_eq!(read_bytes("x.pdb", &file, "").unwrap().atoms.len(), 1);
    let mut inside = ATOM.text().into_bytes();
    inside[13] = 0xfc;
    let error = read_bytes("x.pdb", &inside, "").unwrap_err();
    assert_eq!(error.line(), Some(1));
    // A tab in the serial number, which is not used (seen in a published test file).
    let mut tab = ATOM.text().into_bytes();
    tab[7] = b'\t';
    assert!(read_bytes("x.pdb", &tab, "").is_ok());
}

/// Found by a review: programs that let the serial number grow to the left wrote records that were dropped without a
/// word.
#[test]
fn serial_numbers_may_grow_into_the_columns_before_theirs() {
    let wide = |record: &str| format!("{record}{}", &ATOM.text()[11..]);
    let records = ["ATOM  99999", "ATOM 100000", "ATOM1000000", "HETATM100000"];
    let file: String = records.map(|record| wide(&record[..11])).concat();
    let molecule = read_text(&file).unwrap();
    let hetero: Vec<bool> = molecule.atoms.iter().map(|atom| atom.hetero).collect();
    assert_eq!(hetero, [false, false, false, true]);
    // Without a sound record before them the file is known as PDB all the same.
    assert_eq!(
        read_bytes("x", wide("ATOM 100000").as_bytes(), "")
            .unwrap()
            .atoms
            .len(),
        1
    );
}

#[test]
fn more_atoms_than_serial_numbers() {
    // Serial numbers have five columns, and pdbtbx counts on by itself after 99,999.
    let lines: String = (0..100_003)
        .map(|index| {
            Line {
                number: index / 20 % 10_000,
                x: (index % 1000) as f64,
                ..ATOM
            }
            .text()
        })
        .collect();
    let molecule = read_text(&lines).unwrap();
    assert_eq!(molecule.atoms.len(), 100_003);
    assert_eq!(molecule.atoms[100_002].line, 100_003);
    assert_eq!(molecule.atoms[100_002].position[0], 2.0);
}
