//! Errors of the command line itself.

/// A command in which a negative number is the value of the option before it, so that its range can be reported.
pub fn with_negative_numbers(command: clap::Command) -> clap::Command {
    command.mut_args(|argument| {
        let takes_value = argument.get_action().takes_values();
        argument.allow_negative_numbers(takes_value)
    })
}

/// The message of an error, without the lines on usage.
pub fn message(error: &clap::Error) -> String {
    // clap's text is the message with usage lines; its first paragraph is the message.
    let text = error.render().to_string();
    let message = text.split("\n\n").next().unwrap_or(&text);
    message.trim_start_matches("error: ").trim().to_owned()
}
