//! Sound inputs of every reader, small so that a change is likely to hit something that matters.

use std::io::Write;

use super::readers::Reader;

impl Reader {
    /// Sound inputs, small so that a change is likely to hit something that matters.
    pub fn seeds(self) -> Vec<Vec<u8>> {
        let texts: Vec<String> = match self {
            Self::Pdb => vec![pdb(), MODELS.to_owned()],
            Self::Mmcif => vec![mmcif(), SINGLE.to_owned()],
            Self::Gzip => {
                return vec![
                    gzip(&pdb()),
                    gzip(&mmcif()),
                    [gzip("REMARK\n"), gzip(&pdb())].concat(),
                ];
            }
            Self::Stl => {
                return vec![
                    STL.as_bytes().to_vec(),
                    binary_stl(),
                    STL.replace('\n', " ").into_bytes(),
                    uncounted_stl(),
                ];
            }
            Self::Obj => vec![
                OBJ.to_owned(),
                "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf -4 -2 -3\nf 1/1 2/2 4/4\n\
                 f 1//1 4//4 3//3\nf 2 3 4\n"
                    .to_owned(),
            ],
            Self::Ply => {
                return vec![
                    PLY.as_bytes().to_vec(),
                    binary_ply(true),
                    binary_ply(false),
                    STRIPS.as_bytes().to_vec(),
                ];
            }
            Self::Off => vec![
                OFF.to_owned(),
                format!("# a comment\n{OFF}"),
                WRAPPED_OFF.to_owned(),
            ],
            Self::Poses => vec![
                "rank,score,qw,qx,qy,qz,tx,ty,tz,note\n1,10.5,1,0,0,0,0.5,-1,2e1,\"a, b\"\n\
                 2,9,0.5,0.5,0.5,0.5,1,2,3,\n3,8,0,0,0,1,4,5,6,c\n"
                    .to_owned(),
            ],
            Self::Run => vec![RUN.to_owned()],
            Self::Contact => vec![
                include_str!("../../scoring/src/terms/effect/contact_potential.csv").to_owned(),
            ],
            Self::FineContact => vec![
                include_str!("../../scoring/src/terms/pose/fine_contact_potential.csv").to_owned(),
            ],
            Self::AtomPair => vec![
                include_str!("../../scoring/src/terms/pose/atom_pair_potential.csv").to_owned(),
            ],
            Self::Pairs => vec![PAIRS.to_owned()],
            Self::Confidence => {
                return vec![
                    ALPHAFOLD.as_bytes().to_vec(),
                    BOLTZ.as_bytes().to_vec(),
                    gzip(ALPHAFOLD),
                    npy("(1, 2, 2)", &[0.5, 9.0, 8.0, 0.25]),
                    npz("plddt", &npy("(3,)", &[0.5, 0.75, 1.0])),
                ];
            }
        };
        texts.into_iter().map(String::into_bytes).collect()
    }
}

/// A table of pairs with all that it may have.
const PAIRS: &str = "name,receptor,ligand,native,rotations\n# of spring\nfirst,a.pdb,\"b.cif.gz:H,L\",,\n\n\
    ,c.pdb,d.pdb,e.pdb,1200\n";

/// Confidence of a model with the entries of AlphaFold 3 and of its summary.
const ALPHAFOLD: &str = r#"{"atom_plddts": [90.5, 50], "contact_probs": [[1, 0], [0, 1]], "pae": [[0.5, 9], [8, 0.2]],
    "token_chain_ids": ["A", "B"], "token_res_ids": [1, -1], "chain_pair_iptm": [[0.9, null], [0.4, 0.8]],
    "iptm": 0.5, "ptm": 0.6, "ranking_score": -99.0, "has_clash": 1.0}"#;

/// The summary of Boltz, and entries under the names of ColabFold.
const BOLTZ: &str = r#"{"confidence_score": 0.7, "plddt": [0.5, 1], "predicted_aligned_error": [[3]],
    "pair_chains_iptm": {"0": {"0": 0.9, "1": 0.3}, "1": {"1": 0.8, "0": 0.4}}, "pairwise_iptm": {"A-B": 0.25}}"#;

/// A `.npy` file of NumPy.
pub fn npy(shape: &str, values: &[f32]) -> Vec<u8> {
    let header = format!("{{'descr': '<f4', 'fortran_order': False, 'shape': {shape}, }}\n");
    let length = (header.len() as u16).to_le_bytes();
    let mut bytes = [b"\x93NUMPY\x01\0".as_slice(), &length, header.as_bytes()].concat();
    bytes.extend(values.iter().flat_map(|value| value.to_le_bytes()));
    bytes
}

/// A `.npz` file of one array, as `numpy.savez` writes it: a zip whose file is not packed.
pub fn npz(name: &str, array: &[u8]) -> Vec<u8> {
    let name = format!("{name}.npy");
    let mut sum = flate2::Crc::new();
    sum.update(array);
    let size = (array.len() as u32).to_le_bytes();
    // Version, flags, method, time, date, checksum, both sizes, lengths of the name and of further fields.
    let entry = [
        [20, 0, 0, 0, 0, 0, 0, 0, 0x21, 0].as_slice(),
        &sum.sum().to_le_bytes(),
        &size,
        &size,
        &(name.len() as u32).to_le_bytes(),
    ]
    .concat();
    let mut bytes = [b"PK\x03\x04".as_slice(), &entry, name.as_bytes(), array].concat();
    let start = (bytes.len() as u32).to_le_bytes();
    bytes.extend(
        [
            b"PK\x01\x02\x14\0".as_slice(),
            &entry,
            &[0; 14],
            name.as_bytes(),
        ]
        .concat(),
    );
    let length = bytes.len() as u32 - u32::from_le_bytes(start);
    let counts = [0, 0, 0, 0, 1, 0, 1, 0];
    bytes.extend(
        [
            b"PK\x05\x06".as_slice(),
            &counts,
            &length.to_le_bytes(),
            &start,
            &[0; 2],
        ]
        .concat(),
    );
    bytes
}

fn gzip(text: &str) -> Vec<u8> {
    let mut packed = flate2::write::GzEncoder::new(Vec::new(), flate2::Compression::fast());
    packed.write_all(text.as_bytes()).unwrap();
    packed.finish().unwrap()
}

/// Alternate locations, an insertion code, a modified residue, hydrogens, water, an ion, an additive, a nucleotide,
/// odd columns.
fn pdb() -> String {
    "\
     HEADER    SEED
EXPDTA    THEORETICAL MODEL
REMARK 350 BIOMOLECULE: 1
REMARK 350 APPLY THE FOLLOWING TO CHAINS: A,
REMARK 350                    AND CHAINS: B
REMARK 350   BIOMT1   1  1.000000  0.000000  0.000000        0.00000
REMARK 350   BIOMT2   1  0.000000  1.000000  0.000000        0.00000
REMARK 350   BIOMT3   1  0.000000  0.000000  1.000000        0.00000
REMARK 350   BIOMT1   2 -1.000000  0.000000  0.000000        0.00000
REMARK 350   BIOMT2   2  0.000000 -1.000000  0.000000        0.00000
REMARK 350   BIOMT3   2  0.000000  0.000000  1.000000        5.00000
ATOM      1  N   ALA A   1      11.104   6.134  -6.504  1.00 10.00           N
ATOM      2  CA AALA A   1      11.639   6.071  -5.147  0.60 10.00           C
ATOM      3  CA BALA A   1      11.739   6.171  -5.247  0.40 10.00           C
ATOM      4  C   ALA A   1      10.630   5.360  -4.262  1.00 10.00
ATOM      5  HA  ALA A   1      12.500   5.400  -5.100  1.00 10.00           H
ATOM      6  O   GLY A   1A     10.600   4.130  -4.200  1.00 10.00           O
HETATM    7 SE   MSE A   2       9.800   6.100  -3.600  1.00 10.00          SE
ATOM      8  P    DA B9999       5.000   5.000   5.000  1.00 10.00           P1-
ATOM      9  CB  LYS BA000       6.000   5.000   5.000
HETATM   10 ZN    ZN A 101       0.000   0.000   0.000  1.00 10.00          ZN2+
HETATM   11  O   HOH A 201       3.000   3.000   3.000  1.00 10.00           O
HETATM   12  C1  GOL A 301       4.000   3.000   3.000  1.00 10.00           C
TER
END
"
    .to_owned()
}

const MODELS: &str = "\
MODEL        1
ATOM      1  CA  GLY A   1       1.000   2.000   3.000  1.00 20.00           C
ENDMDL
MODEL        2
ATOM      1  CA  GLY A   1       1.500   2.000   3.000  1.00 20.00           C
HETATM    2 CL    CL A   2       9.500   2.000   3.000  1.00 20.00          CL
ENDMDL
END
";

fn mmcif() -> String {
    "\
     data_SEED
_entry.id 'SEED'
_struct.title
;a text
field
;
_ma_qa_metric.name pLDDT
loop_
_pdbx_struct_assembly_gen.assembly_id
_pdbx_struct_assembly_gen.oper_expression
_pdbx_struct_assembly_gen.asym_id_list
1 1 A
1 '(1)(1-1)'
;B,
C
;
_pdbx_struct_oper_list.id 1
_pdbx_struct_oper_list.matrix[1][1] 1
_pdbx_struct_oper_list.matrix[1][2] 0
_pdbx_struct_oper_list.matrix[1][3] 0
_pdbx_struct_oper_list.matrix[2][1] 0
_pdbx_struct_oper_list.matrix[2][2] 1
_pdbx_struct_oper_list.matrix[2][3] 0
_pdbx_struct_oper_list.matrix[3][1] 0
_pdbx_struct_oper_list.matrix[3][2] 0
_pdbx_struct_oper_list.matrix[3][3] 1
_pdbx_struct_oper_list.vector[1] 0
_pdbx_struct_oper_list.vector[2] 0
_pdbx_struct_oper_list.vector[3] 2.5
loop_
_atom_site.group_PDB
_atom_site.id
_atom_site.type_symbol
_atom_site.label_atom_id
_atom_site.label_alt_id
_atom_site.label_comp_id
_atom_site.label_asym_id
_atom_site.label_seq_id
_atom_site.pdbx_PDB_ins_code
_atom_site.Cartn_x
_atom_site.Cartn_y
_atom_site.Cartn_z
_atom_site.occupancy
_atom_site.B_iso_or_equiv
_atom_site.auth_seq_id
_atom_site.auth_asym_id
_atom_site.pdbx_PDB_model_num
ATOM 1 N N . ALA A 1 ? 11.104 6.134 -6.504 1.00 10.00 1 A 1
ATOM 2 C CA A ALA A 1 ? 11.639 6.071 -5.147(3) 0.60 10.00 1 A 1
ATOM 3 C CA B ALA A 1 ? 11.739 6.171 -5.247 0.40 10.00 1 A 1
ATOM 4 O \"O5'\" . DA B 1 X 10.630 5.360 -4.262 1.00 10.00 -7 'B b' 1
HETATM 5 ZN ZN . ZN C . ? 0 0 0 . ? 101 A 1
ATOM 6 H H . ALA A 1 ? 11.0 6.9 -6.5 1.00 10.00 1 A 1
ATOM 7 N N . ALA A 1 ? 12.104 6.134 -6.504 1.00 10.00 1 A 2
# done
"
    .to_owned()
}

const SINGLE: &str = "data_ONE\n_atom_site.id 1\n_atom_site.type_symbol C\n_atom_site.label_atom_id CA\n\
    _atom_site.label_comp_id GLY\n\
_atom_site.label_asym_id A\n_atom_site.label_seq_id 1\n_atom_site.Cartn_x 1.5\n_atom_site.Cartn_y 2\n\
_atom_site.Cartn_z -3e0\n";

/// A tetrahedron in each format.
const STL: &str = "\
solid seed
facet normal 0 0 -1
 outer loop
  vertex 0 0 0
  vertex 0 1 0
  vertex 1 0 0
 endloop
endfacet
facet normal 0 -1 0
 outer loop
  vertex 0 0 0
  vertex 1 0 0
  vertex 0 0 1
 endloop
endfacet
facet normal -1 0 0
 outer loop
  vertex 0 0 0
  vertex 0 0 1
  vertex 0 1 0
 endloop
endfacet
facet normal 1 1 1
 outer loop
  vertex 1 0 0
  vertex 0 1 0
  vertex 0 0 1
 endloop
endfacet
endsolid seed
";

const OBJ: &str = "# seed\no a\nv 0 0 0 1.0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nvt 0 0\nvn 0 0 1\nusemtl none\nf 1 3 2\n\
    f 1/1 2/1 4/1\nf 1//1 4//1 3//1\nf 2/1/1 3/1/1 4/1/1\n";

const PLY: &str = "\
ply
format ascii 1.0
comment seed
element vertex 4
property float x
property float y
property float z
element face 4
property list uchar int vertex_indices
end_header
0 0 0
1 0 0
0 1 0
0 0 1
3 0 2 1
3 0 1 3
3 0 3 2
3 1 2 3
";

const OFF: &str =
    "OFF\n4 4 6\n0 0 0\n1 0 0\n0 1 0\n0 0 1\n3 0 2 1\n3 0 1 3 255 0 0\n3 0 3 2\n3 1 2 3\n";

const STRIPS: &str = "\
ply
format ascii 1.0
element vertex 4
property float x
property float y
property float z
property float nx
element tristrips 1
property list int float vertex_index
end_header

0 0 0 nan
1 0 0 nan
0 1 0 nan
0 0 1 nan
9 0 2 1 3 0 2 -1 0 1
";

const WRAPPED_OFF: &str = "noff4 4\n6 0 0 0 1 0\n0 1 0 0 1 0 0\n\
    0 1 0 1 0 0 0 0 1 1 0 0 3 0 2 1 3 0 1 3 3 0 3 2 3 1\n2 3\n";

const CORNERS: [[f32; 3]; 4] = [[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
const FACES: [[i32; 3]; 4] = [[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]];

fn binary_stl() -> Vec<u8> {
    let mut bytes = b"binary seed".to_vec();
    bytes.resize(80, 0);
    bytes.extend(4u32.to_le_bytes());
    for face in FACES {
        bytes.extend([0; 12]);
        for corner in face.map(|index| CORNERS[index as usize]) {
            bytes.extend(corner.iter().flat_map(|x| x.to_le_bytes()));
        }
        bytes.extend([0; 2]);
    }
    bytes
}

/// As written to a pipe: the header counts no triangle.
fn uncounted_stl() -> Vec<u8> {
    let mut bytes = binary_stl();
    bytes[80..84].fill(0);
    bytes
}

fn binary_ply(little: bool) -> Vec<u8> {
    let order = if little { "little" } else { "big" };
    let mut bytes = PLY
        .split("end_header")
        .next()
        .unwrap_or("")
        .to_owned()
        .into_bytes();
    bytes = String::from_utf8(bytes)
        .unwrap()
        .replace("ascii", &format!("binary_{order}_endian"))
        .into_bytes();
    bytes.extend(b"end_header\n");
    for x in CORNERS.into_iter().flatten() {
        bytes.extend(if little {
            x.to_le_bytes()
        } else {
            x.to_be_bytes()
        });
    }
    for face in FACES {
        bytes.push(3);
        for index in face {
            bytes.extend(if little {
                index.to_le_bytes()
            } else {
                index.to_be_bytes()
            });
        }
    }
    bytes
}

const RUN: &str = r#"{
 "schema": 3, "program": "knotdock", "version": "0.1.0", "commit": "unknown", "cpu_features": "x86_64",
 "inputs": {
  "receptor": {"path": "/a/receptor.pdb", "chains": ["A"], "sha256": "00", "atoms": 1, "report": {}},
  "ligand": {"path": "/a/ligand.pdb", "chains": null, "sha256": "00", "atoms": 1, "report": {}},
  "native": {"complex": {"path": "/a/native.pdb", "chains": null, "sha256": "00"}}
 },
 "options": {
  "input": {"waters": "keep", "hetatm": "no-additives", "drop_residue": [], "hydrogens": "drop", "altloc": "B", "model": 2, "assembly": null, "min_plddt": null},
  "sampling": {"sample_grid": "64^3", "sample_weights": null},
  "kernel": {"effects": "auto", "lambda": 9.0, "offset": 2.2, "alpha": 2.0, "resolution": 4.5, "pass_length": null, "spacing": null, "tolerance": 0.01},
  "terms": {"core_weight": 1.0, "electrostatics_weight": 24.0, "contact_weight": 2.0, "restraint_weight": 1.0, "contact_potential": null, "fine_contact_weight": 2.0, "fine_contact_potential": null, "atom_pair_weight": 1.0, "relaxed_weight": 3.0, "active_weight": 2000.0, "atom_pair_potential": null, "unresolved_weight": 3.0, "termini_weight": 2.0, "violation_weight": 400.0, "interface_weight": 60.0, "membrane_weight": 50.0, "ph": 7.0},
  "restraints": {"antibody": "cdrs", "block_receptor": "A:2", "block_ligand": null, "active_receptor": null, "active_ligand": null, "restraints": null, "restraints_need": "100%", "tbl_bounds": "widened", "crosslink": null, "interface_receptor": null, "interface_ligand": null, "membrane": null, "peptidase_weight": 500.0},
  "search": {"rotations": 100, "fine_rotations": null, "fine_share": 0.05, "precision": "single", "engine": "cpu", "per_rotation": 3, "poses": 2000, "refine": null, "symmetry": null},
  "ranking": {"cluster_radius": 5.0, "no_cluster": false},
  "output": {"write_top": 10, "diagnostics": false},
  "stopped": null
 },
 "plan": {}, "timing": {}, "machine": {}
}
"#;
