//! Documents name files that exist, and no file of tests is left out.

use std::fs;
use std::path::{Path, PathBuf};

/// Paths of the repository in a page: words in backticks that begin with one of its folders.
fn named_paths(page: &str) -> Vec<String> {
    let folders = [
        "src/",
        "cli/",
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

/// The pages for readers: those at the top, and the book in `docs`.
fn pages() -> Vec<PathBuf> {
    let root = Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/.."));
    let mut pages = vec![root.join("README.md"), root.join("CONTRIBUTING.md")];
    let mut folders = vec![root.join("docs")];
    while let Some(folder) = folders.pop() {
        for entry in fs::read_dir(folder).unwrap() {
            let path = entry.unwrap().path();
            if path.is_dir() {
                folders.push(path);
            } else if path.extension().is_some_and(|end| end == "md") {
                pages.push(path);
            }
        }
    }
    pages
}

/// Files move: a page that names one where it was sends its reader nowhere.
#[test]
fn files_that_pages_name_exist() {
    let root = Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/.."));
    let mut named = 0;
    for page in pages() {
        for path in named_paths(&fs::read_to_string(&page).unwrap()) {
            assert!(root.join(&path).exists(), "{}: {path}", page.display());
            named += 1;
        }
    }
    assert!(named > 30, "{named}");
}

/// What links of a page lead to: all but other sites.
fn links(page: &str) -> Vec<&str> {
    let targets = page.split("](").skip(1);
    let targets = targets.filter_map(|rest| rest.split_once(')'));
    let targets = targets.map(|(target, _)| target);
    targets
        .filter(|target| !target.contains("://") && !target.contains(char::is_whitespace))
        .collect()
}

/// Whether a page has a heading that an anchor leads to, by the names that GitHub and mdBook give headings.
fn has_anchor(page: &str, anchor: &str) -> bool {
    let headings = page.lines().filter(|line| line.starts_with('#'));
    let names = headings.map(|line| {
        let words = line.trim_start_matches('#').trim().to_lowercase();
        let kept = words.chars().filter_map(|c| match c {
            ' ' => Some('-'),
            '-' | '_' => Some(c),
            c => c.is_alphanumeric().then_some(c),
        });
        kept.collect::<String>()
    });
    names.into_iter().any(|name| name == anchor)
}

#[test]
fn links_of_pages_lead_somewhere() {
    let mut followed = 0;
    for page in pages() {
        let text = fs::read_to_string(&page).unwrap();
        for link in links(&text) {
            let (file, anchor) = link.split_once('#').unwrap_or((link, ""));
            let target = match file {
                "" => page.clone(),
                file => page.parent().unwrap().join(file),
            };
            let wrong = format!("{}: {link}", page.display());
            assert!(target.exists(), "{wrong}");
            if !anchor.is_empty() {
                let target = fs::read_to_string(&target).unwrap();
                assert!(has_anchor(&target, anchor), "{wrong}");
            }
            followed += 1;
        }
    }
    assert!(followed > 100, "{followed}");
}

/// The book has all pages, each once.
#[test]
fn every_page_of_the_book_is_in_its_contents() {
    let docs = Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/..")).join("docs");
    let contents = fs::read_to_string(docs.join("SUMMARY.md")).unwrap();
    let listed = links(&contents);
    for page in pages().iter().filter(|page| page.starts_with(&docs)) {
        let name = page.strip_prefix(&docs).unwrap().to_str().unwrap();
        let count = listed.iter().filter(|link| **link == name).count();
        assert!(name == "SUMMARY.md" || count == 1, "{name}: {count}");
    }
}

/// A file that no `mod` names is compiled by nobody, and its tests pass unrun.
#[test]
fn every_file_of_tests_is_a_module() {
    let root = Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/.."));
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
