//! Documents name files that exist, and no file of tests is left out.

use std::fs;
use std::path::Path;

/// Paths of the repository in a page: words in backticks that begin with one of its folders.
fn named_paths(page: &str) -> Vec<String> {
    let folders = [
        "src/",
        "structures/",
        "scoring/",
        "scripts/",
        "tests/",
        "benches/",
        "docs/",
    ];
    let words = page.split('`').skip(1).step_by(2);
    let words = words.flat_map(str::split_whitespace);
    words
        .filter(|word| folders.iter().any(|folder| word.starts_with(folder)))
        .filter(|word| !word.contains(['*', '<', '{', '[', '$', ':']))
        .map(|word| word.trim_end_matches([',', '.', ';']).to_owned())
        .collect()
}

/// Files move: a page that names one where it was sends its reader nowhere.
#[test]
fn files_that_pages_name_exist() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let mut pages = vec![root.join("README.md"), root.join("CONTRIBUTING.md")];
    let docs = fs::read_dir(root.join("docs")).unwrap();
    pages.extend(docs.map(|entry| entry.unwrap().path()));
    let mut named = 0;
    for page in pages
        .iter()
        .filter(|page| page.extension().is_some_and(|end| end == "md"))
    {
        for path in named_paths(&fs::read_to_string(page).unwrap()) {
            assert!(root.join(&path).exists(), "{}: {path}", page.display());
            named += 1;
        }
    }
    assert!(named > 30, "{named}");
}

/// A file that no `mod` names is compiled by nobody, and its tests pass unrun.
#[test]
fn every_file_of_tests_is_a_module() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    for folder in ["tests", "scoring/tests", "structures/tests"] {
        let main = fs::read_to_string(root.join(folder).join("main.rs")).unwrap();
        for entry in fs::read_dir(root.join(folder)).unwrap() {
            let path = entry.unwrap().path();
            let holds_code = path.extension().is_some_and(|end| end == "rs")
                || path.join("mod.rs").exists()
                || path.join("main.rs").exists();
            let name = path.file_stem().unwrap().to_str().unwrap();
            if holds_code && name != "main" {
                assert!(
                    main.lines().any(|line| line == format!("mod {name};")),
                    "{}",
                    path.display()
                );
            }
        }
    }
}
