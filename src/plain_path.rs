//! Paths without `..` inside, as messages and records show them.

use std::path::{Component, Path, PathBuf};

/// The path with its folders as the system resolves them, if it has a `..` after a folder's name; any other as it is.
///
/// `a/../b` need not be `b`, for `a` may be a link: so the folder is looked up, and a path whose folder is not there
/// stays.
pub fn plain_path(path: &Path) -> PathBuf {
    let after_name = path
        .components()
        .skip_while(|part| !matches!(part, Component::Normal(_)));
    let has_parent = after_name
        .into_iter()
        .any(|part| part == Component::ParentDir);
    let resolved = || {
        let name = path.file_name()?;
        Some(path.parent()?.canonicalize().ok()?.join(name))
    };
    has_parent
        .then(resolved)
        .flatten()
        .unwrap_or_else(|| path.to_owned())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_parent_after_a_name_goes_and_other_paths_stay() {
        let folder = tempfile::tempdir().unwrap();
        let root = folder.path().canonicalize().unwrap();
        std::fs::create_dir_all(root.join("a/b")).unwrap();
        let plain = |path: &str| plain_path(&root.join(path));
        assert_eq!(plain("a/b/../c.pdb"), root.join("a/c.pdb"));
        assert_eq!(plain("a/../a/b/../../c.pdb"), root.join("c.pdb"));
        // A folder that is not there is left to the error that names it.
        assert_eq!(plain("x/../c.pdb"), root.join("x/../c.pdb"));
        for path in ["../c.pdb", "../../a/c.pdb", "c.pdb", "/a/c.pdb", ".."] {
            assert_eq!(plain_path(Path::new(path)), Path::new(path));
        }
        #[cfg(unix)]
        {
            std::os::unix::fs::symlink(root.join("a/b"), root.join("link")).unwrap();
            assert_eq!(plain("link/../c.pdb"), root.join("a/c.pdb"));
        }
    }
}
