//! Files that hold something else than a structure in PDB or mmCIF: archives, other compressions, other formats of
//! molecules.
//!
//! An archive may begin like a structure: a tar of PDB files has their records in it, and between them what no reader
//! should see.

use std::path::Path;

/// Something else than a structure, in words, and what to do with it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Foreign {
    pub(crate) what: &'static str,
    pub(crate) remedy: &'static str,
}

/// Where a tar has its magic bytes (POSIX.1-1988, ustar).
const USTAR: usize = 257;

const UNPACK: &str =
    "unpack it and give one of its structure files, .pdb or .cif, plain or gzip-compressed";
const GUNZIP: &str = "unpack it, and give the structure file plain or gzip-compressed";
const CONVERT: &str =
    "give a PDB or mmCIF file: Open Babel converts it, as in `obabel FILE -O OUT.pdb`";
const TOPOLOGY: &str = "give a PDB or mmCIF file: GROMACS writes one by `gmx editconf -f IN.gro -o OUT.pdb`, other programs alike";
const TABLE: &str =
    "give a PDB or mmCIF file: the archive has every entry in mmCIF, and gemmi and PyMOL convert";

/// First bytes of archives and compressions.
const MAGIC: [(&[u8], &str, &str); 7] = [
    (b"PK\x03\x04", "a zip archive", UNPACK),
    (b"7z\xbc\xaf\x27\x1c", "a 7z archive", UNPACK),
    (b"Rar!\x1a\x07", "a rar archive", UNPACK),
    (b"BZh", "compressed by bzip2", GUNZIP),
    (b"\xfd7zXZ\x00", "compressed by xz", GUNZIP),
    (b"\x28\xb5\x2f\xfd", "compressed by zstd", GUNZIP),
    (b"\x1f\x9d", "compressed by compress", GUNZIP),
];

/// Names of other formats, by their endings.
const ENDINGS: [(&str, &str, &str); 18] = [
    ("sdf", "an SDF file of small molecules", CONVERT),
    ("sd", "an SDF file of small molecules", CONVERT),
    ("mol", "a MOL file of a small molecule", CONVERT),
    ("mol2", "a MOL2 file", CONVERT),
    ("xyz", "an XYZ file", CONVERT),
    ("smi", "a SMILES file", CONVERT),
    ("cml", "a CML file", CONVERT),
    ("mae", "a Maestro file", CONVERT),
    ("maegz", "a Maestro file", CONVERT),
    ("gro", "a GROMACS file", TOPOLOGY),
    ("crd", "a coordinate file of a force field", TOPOLOGY),
    ("psf", "a topology of a force field", TOPOLOGY),
    ("prmtop", "a topology of a force field", TOPOLOGY),
    ("xtc", "a trajectory", TOPOLOGY),
    ("dcd", "a trajectory", TOPOLOGY),
    ("bcif", "a BinaryCIF file", TABLE),
    ("mmtf", "an MMTF file", TABLE),
    ("pdbml", "a PDBML file", TABLE),
];

/// What bytes are, packed or unpacked, that are an archive's or of another compression than gzip.
pub(crate) fn archive(bytes: &[u8]) -> Option<Foreign> {
    if bytes.get(USTAR..USTAR + 5) == Some(b"ustar") {
        let what = "a tar archive";
        return Some(Foreign {
            what,
            remedy: UNPACK,
        });
    }
    let found = MAGIC.iter().find(|(magic, ..)| bytes.starts_with(magic));
    found.map(|&(_, what, remedy)| Foreign { what, remedy })
}

/// Kind of a file that holds no structure, by its name.
pub(crate) fn by_name(path: &Path) -> Option<Foreign> {
    let name = path.file_name()?.to_str()?.to_ascii_lowercase();
    let name = name.strip_suffix(".gz").unwrap_or(&name);
    let ending = name.rsplit_once('.')?.1;
    let found = ENDINGS.iter().find(|(known, ..)| *known == ending);
    found.map(|&(_, what, remedy)| Foreign { what, remedy })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn archives_are_known_by_their_first_bytes() {
        let mut tar = vec![0; 512];
        tar[USTAR..USTAR + 5].copy_from_slice(b"ustar");
        assert_eq!(archive(&tar).map(|it| it.what), Some("a tar archive"));
        assert_eq!(
            archive(b"PK\x03\x04...").map(|it| it.what),
            Some("a zip archive")
        );
        assert_eq!(archive(b"BZh91").map(|it| it.remedy), Some(GUNZIP));
        assert_eq!(archive(b"ATOM      1"), None);
        assert_eq!(archive(b""), None);
    }

    #[test]
    fn other_formats_are_known_by_their_names() {
        for name in ["x.sdf", "x.MOL2", "a.b.xyz.gz"] {
            assert_eq!(
                by_name(Path::new(name)).map(|it| it.remedy),
                Some(CONVERT),
                "{name}"
            );
        }
        for name in ["x.pdb", "x", "x.txt", "sdf"] {
            assert_eq!(by_name(Path::new(name)), None, "{name}");
        }
    }
}
