//! Signals that end the program, Ctrl-C first: they leave a line, so that nobody wonders what became of a run.
//!
//! The handler makes its line of constants and writes it past all buffers, for it may have stopped a thread anywhere.
//! Then the signal ends the program as it would have without it.

#[cfg(unix)]
use crate::system_limits::{wants_json, write_past_buffers};

/// Has the program say that it was ended, by Ctrl-C or by `kill`. A signal that is ignored, as by `nohup`, stays so.
#[cfg(unix)]
pub fn report_end() {
    for signal in [libc::SIGINT, libc::SIGTERM] {
        // SAFETY: the structures are valid for the calls, and the handler calls async-signal-safe functions alone.
        unsafe {
            let mut action: libc::sigaction = std::mem::zeroed();
            if libc::sigaction(signal, std::ptr::null(), &mut action) != 0
                || action.sa_sigaction != libc::SIG_DFL
            {
                continue;
            }
            action.sa_sigaction = say_and_end as extern "C" fn(libc::c_int) as libc::sighandler_t;
            // The default comes back before the handler runs.
            action.sa_flags = libc::SA_RESETHAND;
            libc::sigaction(signal, &action, std::ptr::null_mut());
        }
    }
}

/// Nothing is to be done: other systems end the program by themselves.
#[cfg(not(unix))]
pub fn report_end() {}

/// The lines, and the object where one is wanted; then the signal again.
#[cfg(unix)]
extern "C" fn say_and_end(signal: libc::c_int) {
    // The line of a progress bar may stand before it.
    const LINES: &[u8] = b"\nerror: the command was interrupted: a run that was not finished has no results, pairs of a batch that were finished have theirs\n  help: give the command again; a batch goes on where it was\n";
    const OBJECT: &[u8] = b"{\"error\":{\"file\":null,\"line\":null,\"message\":\"the command was interrupted\",\"remedy\":\"give the command again; a batch goes on where it was\"}}\n";
    if wants_json() {
        write_past_buffers(1, OBJECT);
    }
    write_past_buffers(2, LINES);
    // SAFETY: the disposition is the default again, so that the signal ends the process when the handler returns.
    unsafe {
        libc::raise(signal);
    }
}
