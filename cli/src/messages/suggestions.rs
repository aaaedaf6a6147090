//! Remedies for errors of the command line: those that clap suggests, and a few that it cannot know.

use clap::builder::StyledStr;
use clap::error::{ContextKind, ContextValue, ErrorKind};

use knotdock::options::option_named;

/// Remedy for a word that is not UTF-8.
pub const UTF_8: &str = "rename the file, or link to it by a name in UTF-8";

/// How to set an option that only files of options have, by a word such as `--contact-weight=4`.
fn instead_of_option(word: &str) -> Option<String> {
    let word = word.trim_start_matches('-');
    let name = word.split('=').next().unwrap_or(word).replace('-', "_");
    let option = option_named(&name).filter(|option| option.is_of_files())?;
    let (table, name) = (option.subject(), option.name());
    Some(format!(
        "weights and potentials are set by `--config {table}.{name}=VALUE`, or by a file with `{name} = VALUE` under \
         [{table}]: `--config FILE`"
    ))
}

/// Remedy for `knotdock dock` with one file: a second one, or a ring of copies.
fn instead_of_ligand(error: &clap::Error) -> Option<String> {
    let Some(ContextValue::Strings(missing)) = error.get(ContextKind::InvalidArg) else {
        return None;
    };
    let Some(ContextValue::StyledStr(usage)) = error.get(ContextKind::Usage) else {
        return None;
    };
    let is_ligand = missing.iter().any(|name| name.contains("LIGAND"))
        && !missing.iter().any(|name| name.contains("RECEPTOR"));
    let is_dock = usage.to_string().contains(" dock ");
    (is_ligand && is_dock).then(|| {
        "give the molecule that moves as the second file, or `--symmetry C2` (C3, D2 ...) for a ring of copies of the \
         first"
            .to_owned()
    })
}

/// A remedy that clap does not know.
fn own(error: &clap::Error) -> Option<String> {
    match (error.kind(), error.get(ContextKind::InvalidArg)) {
        (ErrorKind::UnknownArgument, Some(ContextValue::String(word))) => instead_of_option(word),
        (ErrorKind::MissingRequiredArgument, _) => instead_of_ligand(error),
        _ => None,
    }
}

/// The remedy for an error of the command line, if one is known.
pub fn suggested(error: &clap::Error) -> Option<String> {
    let kind = match error.kind() {
        ErrorKind::UnknownArgument => ContextKind::SuggestedArg,
        ErrorKind::InvalidSubcommand => ContextKind::SuggestedSubcommand,
        ErrorKind::InvalidValue => ContextKind::SuggestedValue,
        ErrorKind::InvalidUtf8 => return Some(UTF_8.to_owned()),
        _ => return own(error),
    };
    let alike = match error.get(kind) {
        Some(ContextValue::String(one)) => Some(one),
        Some(ContextValue::Strings(some)) => some.first(),
        _ => None,
    };
    own(error).or_else(|| alike.map(|one| format!("is `{one}` meant?")))
}

/// The error with a remedy that clap does not know, if there is one, in place of clap's own.
pub fn explained(mut error: clap::Error) -> clap::Error {
    if let Some(remedy) = own(&error) {
        if error.kind() == ErrorKind::UnknownArgument {
            // clap suggests another option that is spelled alike, in the usage line too.
            error.remove(ContextKind::SuggestedArg);
            error.remove(ContextKind::Usage);
        }
        let tips = vec![StyledStr::from(remedy)];
        error.insert(ContextKind::Suggested, ContextValue::StyledStrs(tips));
    }
    error
}

/// The message of a wrong command line, without the lines on usage.
pub fn first_paragraph(error: &clap::Error) -> String {
    // clap's text is the message with usage lines; its first paragraph is the message.
    let text = error.render().to_string();
    let message = text.split("\n\n").next().unwrap_or(&text);
    message.trim_start_matches("error: ").trim().to_owned()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn options_of_files_are_found_however_they_are_spelled() {
        for word in ["--contact-weight", "--contact_weight", "--contact-weight=4"] {
            let remedy = instead_of_option(word).unwrap();
            assert!(
                remedy.contains("`--config terms.contact_weight=VALUE`"),
                "{word}"
            );
        }
        assert_eq!(instead_of_option("--rotations"), None);
        assert_eq!(instead_of_option("--no-such-thing"), None);
    }
}
