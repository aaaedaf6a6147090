//! How the command line is read, so that what is wrong with it can be reported.

/// A command in which a negative number is the value of the option before it, so that its range can be reported.
pub fn with_negative_numbers(command: clap::Command) -> clap::Command {
    command.mut_args(|argument| {
        let takes_value = argument.get_action().takes_values();
        argument.allow_negative_numbers(takes_value)
    })
}
