//! Products: the files that a command puts into its directory.

use std::path::{Component, Path};

use super::seal::{BEGINNING, REPORT};

/// Files that a command puts into its directory.
#[derive(Debug, PartialEq, Eq)]
pub struct Product {
    /// The file that says which program wrote the others, and their checksums as `files`.
    pub(super) record: &'static str,
    /// The other files, each with what it begins with, where that shows whose it is.
    pub(super) files: &'static [(&'static str, &'static str)],
    /// A folder of complexes, named by their ranks.
    pub(super) folder: Option<&'static str>,
    /// Records of other products with files of the same names: they cannot share a directory.
    pub(super) not_beside: &'static [&'static str],
}

/// Files of `knotdock dock`.
pub const RUN: Product = Product {
    record: "run.json",
    files: &[
        ("poses.csv", "rank,score,cluster,"),
        ("view.pml", "# The best poses in PyMOL"),
        ("view.cxc", "# The best poses in ChimeraX"),
        ("interface.csv", "side,chain,residue,"),
        (REPORT, BEGINNING),
    ],
    folder: Some("top"),
    not_beside: &["ensemble.json"],
};

/// Files of `knotdock dock` of several conformations, beside the folder of their runs.
pub const ENSEMBLE: Product = Product {
    record: "ensemble.json",
    not_beside: &["run.json"],
    ..RUN
};

/// Files of `knotdock tradeoff`.
pub const TRADEOFF: Product = Product {
    record: "tradeoff.json",
    files: &[
        ("tradeoff.csv", "setting,parameter,"),
        ("tradeoff.svg", "<svg width="),
        (REPORT, BEGINNING),
    ],
    folder: None,
    not_beside: &[],
};

/// The file in a folder of complexes that lists those which were exported later, with their checksums as `files`.
pub const EXPORTED: &str = "exported.json";

impl Product {
    /// The names of its entries in the directory.
    pub(super) fn entries(&self) -> impl Iterator<Item = &'static str> {
        let files = self.files.iter().map(|(name, _)| *name);
        self.folder.into_iter().chain(files).chain([self.record])
    }

    /// Whether a file of this path from the directory may be one of these.
    pub(super) fn may_hold(&self, path: &Path) -> bool {
        let names: Option<Vec<&str>> = path
            .components()
            .map(|part| match part {
                Component::Normal(name) => name.to_str(),
                _ => None,
            })
            .collect();
        match names.as_deref() {
            Some([name]) => *name == self.record || self.files.iter().any(|(file, _)| file == name),
            Some([folder, name]) => {
                Some(*folder) == self.folder && (*name == EXPORTED || is_complex(name))
            }
            _ => false,
        }
    }
}

/// Whether a name is that of a complex of some rank, or of many complexes in one file.
fn is_complex(name: &str) -> bool {
    if ["ensemble.pdb", "ensemble.cif"].contains(&name) {
        return true;
    }
    let rest = name
        .strip_prefix("rank_")
        .and_then(|rest| rest.split_once('.'));
    rest.is_some_and(|(rank, ending)| {
        !rank.is_empty()
            && rank.bytes().all(|digit| digit.is_ascii_digit())
            && ["pdb", "cif", "obj"].contains(&ending)
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A record may be tampered with: no name in it leads out of the directory.
    #[test]
    fn only_files_of_its_names_are_a_products() {
        for (path, expected) in [
            ("poses.csv", true),
            ("run.json", true),
            ("top/rank_0001.pdb", true),
            ("top/rank_12345.cif", true),
            ("top/exported.json", true),
            ("top/notes.txt", false),
            ("top/rank_x.pdb", false),
            ("top/../../thesis.pdb", false),
            ("../poses.csv", false),
            ("/poses.csv", false),
            ("notes.txt", false),
            ("", false),
        ] {
            assert_eq!(RUN.may_hold(Path::new(path)), expected, "{path}");
        }
    }
}
