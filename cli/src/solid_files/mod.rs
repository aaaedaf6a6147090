//! Files of solids: balls, pictures, surfaces and volume grids.

pub mod balls;
pub mod sample_picture;
pub mod surfaces;
pub mod volume_grids;

use std::path::{Path, PathBuf};

use knotdock::output::files::whole_file::{StagedFile, is_stream};
use knotdock_structures::Error;

/// The format of the file of an option, by the ending of its name. `formats` lists endings, in small letters.
pub fn format_of<T: Copy>(
    option: &str,
    path: &Path,
    formats: &[(&'static str, T)],
) -> Result<T, Error> {
    let ending = path.extension().unwrap_or_default().to_string_lossy();
    let format = formats
        .iter()
        .find(|(name, _)| ending.eq_ignore_ascii_case(name));
    format.map(|(_, format)| *format).ok_or_else(|| {
        let endings: Vec<String> = formats
            .iter()
            .map(|(ending, _)| format!(".{ending}"))
            .collect();
        let endings = match &endings[..] {
            [others @ .., last] if !others.is_empty() => {
                format!("{} or {last}", others.join(", "))
            }
            _ => endings.concat(),
        };
        Error::input(format!("--{option} writes {endings} files"))
            .at(path)
            .help(format!("end the name with {endings}"))
    })
}

/// Checks that a picture is named .svg, unless it is a pipe or a device.
pub fn check_picture(path: &Path) -> Result<(), Error> {
    match is_stream(path) {
        true => Ok(()),
        false => format_of("picture", path, &[("svg", ())]),
    }
}

/// Writes a text beside its place.
pub fn write_text(path: &Path, text: &str) -> Result<StagedFile, Error> {
    StagedFile::write(path, |file| file.write_all(text.as_bytes()))
}

/// Puts files into their places once all of them are written, and returns their names.
pub fn place_all(staged: Vec<(StagedFile, &PathBuf)>) -> Result<Vec<String>, Error> {
    let mut names = Vec::with_capacity(staged.len());
    for (file, path) in staged {
        file.place()?;
        names.push(path.display().to_string());
    }
    Ok(names)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn formats_go_by_the_ending() {
        let formats = [("mrc", 1), ("map", 1), ("nrrd", 2)];
        let format = |name: &str| format_of("volume-grid", Path::new(name), &formats);
        assert_eq!(format("a.MRC"), Ok(1));
        assert_eq!(format("a.b.nrrd"), Ok(2));
        for name in ["a.vti", "a", "mrc"] {
            let error = format(name).unwrap_err();
            assert_eq!(error.file(), Some(Path::new(name)));
            assert!(error.message().contains("--volume-grid writes .mrc"));
            assert!(
                error
                    .remedy()
                    .is_some_and(|remedy| remedy.contains(".nrrd"))
            );
        }
    }
}
