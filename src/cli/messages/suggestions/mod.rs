//! Suggestions for words that other programs of the field use and this one does not: `--restraints`, `--cores`, `rmsd`.
//!
//! clap suggests what is spelled alike, which for these words is often something else (`--cores`: `--poses`).

mod words;

use crate::options::option_named;
use clap::builder::StyledStr;
use clap::error::{ContextKind, ContextValue, ErrorKind};
use words::{COMMANDS, OPTIONS, Suggestion};

/// The name in a word such as `--n_cores=4`.
fn name_of(word: &str) -> &str {
    let word = word.trim_start_matches('-');
    word.split('=').next().unwrap_or(word)
}

/// What to use instead of a word that is no option or command.
fn find(suggestions: &[Suggestion], word: &str) -> Option<&'static str> {
    let word = name_of(word).to_lowercase().replace('_', "-");
    let known = |one: &&Suggestion| one.words.contains(&word.as_str());
    suggestions.iter().find(known).map(|one| one.instead)
}

/// What to use instead of a word that is no option of the command line.
fn instead_of_option(word: &str) -> Option<String> {
    let of_files = option_named(&name_of(word).replace('-', "_")).filter(|one| one.is_of_files());
    if let Some(option) = of_files {
        let (table, name) = (option.subject(), option.name());
        return Some(format!(
            "weights and potentials are set by `--config {table}.{name}=VALUE`, or by a file with `{name} = VALUE` \
             under [{table}]: `--config FILE`"
        ));
    }
    find(&OPTIONS, word).map(str::to_owned)
}

/// What to use instead of a word that is no command.
fn instead_of_command(word: &str) -> Option<String> {
    find(&COMMANDS, word).map(str::to_owned)
}

/// What to do about a word that is not UTF-8.
pub const UTF_8: &str = "rename the file, or link to it by a name in UTF-8";

/// What to do about one file that `knotdock dock` gets: a ring of copies needs no other.
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

/// What to do about an error of the command line, where the field's word for something is at fault or one that is
/// spelled alike.
pub fn suggested(error: &clap::Error) -> Option<String> {
    let text = |kind| match error.get(kind) {
        Some(ContextValue::String(text)) => Some(text.as_str()),
        _ => None,
    };
    let alike = |kind| match error.get(kind) {
        Some(ContextValue::String(one)) => Some(format!("is `{one}` meant?")),
        Some(ContextValue::Strings(some)) => some.first().map(|one| format!("is `{one}` meant?")),
        _ => None,
    };
    match error.kind() {
        ErrorKind::UnknownArgument => text(ContextKind::InvalidArg)
            .and_then(instead_of_option)
            .or_else(|| alike(ContextKind::SuggestedArg)),
        ErrorKind::InvalidSubcommand => text(ContextKind::InvalidSubcommand)
            .and_then(instead_of_command)
            .or_else(|| alike(ContextKind::SuggestedSubcommand)),
        ErrorKind::InvalidValue => alike(ContextKind::SuggestedValue),
        ErrorKind::InvalidUtf8 => Some(UTF_8.to_owned()),
        ErrorKind::MissingRequiredArgument => instead_of_ligand(error),
        _ => None,
    }
}

/// The error with the field's word explained, in place of what is spelled alike.
pub fn explained(mut error: clap::Error) -> clap::Error {
    if let Some(instead) = suggested(&error)
        && error.kind() == ErrorKind::MissingRequiredArgument
    {
        let tips = vec![StyledStr::from(instead)];
        error.insert(ContextKind::Suggested, ContextValue::StyledStrs(tips));
        return error;
    }
    type Instead = fn(&str) -> Option<String>;
    let (find, kind): (Instead, _) = match error.kind() {
        ErrorKind::UnknownArgument => (instead_of_option, ContextKind::InvalidArg),
        ErrorKind::InvalidSubcommand => (instead_of_command, ContextKind::InvalidSubcommand),
        _ => return error,
    };
    let found = match error.get(kind) {
        Some(ContextValue::String(word)) => find(word),
        _ => None,
    };
    if let Some(instead) = found {
        // The usage line shows what is spelled alike, too.
        for alike in [
            ContextKind::SuggestedArg,
            ContextKind::SuggestedSubcommand,
            ContextKind::Usage,
        ] {
            error.remove(alike);
        }
        let tips = vec![StyledStr::from(instead)];
        error.insert(ContextKind::Suggested, ContextValue::StyledStrs(tips));
    }
    error
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Options and commands that a suggestion names, in backquotes.
    fn named(text: &str) -> Vec<String> {
        let quoted = text.split('`').skip(1).step_by(2);
        let words = quoted.flat_map(str::split_whitespace);
        words.map(str::to_owned).collect()
    }

    #[test]
    fn what_is_suggested_exists_and_no_word_of_ours_is_explained_away() {
        use clap::CommandFactory;
        let cli = crate::cli::Cli::command();
        let commands: Vec<&str> = cli.get_subcommands().map(clap::Command::get_name).collect();
        let dock = cli.find_subcommand("dock").unwrap();
        let options: Vec<String> = dock
            .get_arguments()
            .flat_map(|option| {
                let short = option.get_short().map(|letter| format!("-{letter}"));
                let long = option.get_long().map(|name| format!("--{name}"));
                [short, long].into_iter().flatten()
            })
            .collect();
        for one in OPTIONS.iter().chain(&COMMANDS) {
            let words = named(one.instead);
            for word in &words {
                let general = word.starts_with("--...") || word == "--rank" || word == "--pose";
                assert!(
                    !word.starts_with('-') || general || options.contains(word),
                    "{word}"
                );
            }
            for pair in words.windows(2).filter(|pair| pair[0] == "knotdock") {
                assert!(commands.contains(&pair[1].as_str()), "{}", pair[1]);
            }
        }
        for word in OPTIONS.iter().flat_map(|one| one.words) {
            let ours = [format!("--{word}"), format!("-{word}")];
            assert!(!ours.iter().any(|ours| options.contains(ours)), "{word}");
        }
        for word in COMMANDS.iter().flat_map(|one| one.words) {
            assert!(!commands.contains(word), "{word}");
        }
    }

    #[test]
    fn no_word_has_two_suggestions() {
        for suggestions in [&OPTIONS[..], &COMMANDS[..]] {
            let mut words: Vec<&str> = suggestions
                .iter()
                .flat_map(|one| one.words)
                .copied()
                .collect();
            let count = words.len();
            words.sort_unstable();
            words.dedup();
            assert_eq!(words.len(), count);
        }
    }

    #[test]
    fn words_are_found_however_they_are_spelled() {
        for word in ["--ncores", "--NCORES", "--n_cores", "--ncores=4"] {
            assert_eq!(find(&OPTIONS, word), Some("use `--threads N`"), "{word}");
        }
        assert_eq!(find(&OPTIONS, "--no-such-thing"), None);
    }
}
