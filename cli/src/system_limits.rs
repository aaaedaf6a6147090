//! The system's limits. A run that meets one ends with a message, a JSON object if requested, and exit code 1.
//!
//! Memory: where the system has none, Rust's standard library ends a program by SIGABRT. A failed allocation can
//! neither unwind nor allocate, so the message is made on the stack, written past all buffers, and the process ends
//! without further ado. What a run has staged by then, the next run clears away.
//!
//! Size of files (`ulimit -f`): the system ends a program that writes past it by SIGXFSZ. If that is ignored, the
//! write fails, and is reported like that to a full disk.

use std::alloc::{GlobalAlloc, Layout, System};
use std::io::Write;
use std::sync::atomic::{AtomicBool, Ordering};

/// The system's allocator, which ends the process with a message where there is no memory.
pub struct ReportingAllocator;

/// Whether the object of a failure is wanted on standard output.
static JSON: AtomicBool = AtomicBool::new(false);

/// Whether a failure is being reported: by the first thread that has no memory.
static REPORTED: AtomicBool = AtomicBool::new(false);

/// Whether the object of another failure was written: there is one object.
static HAS_OBJECT: AtomicBool = AtomicBool::new(false);

/// The error, and its remedy.
const MESSAGE: &str = "the system has no memory left";
const REMEDY: &str = "allow the program more memory (`ulimit -v`, or the limit of its container), or less to its work: \
                      by --memory or a coarser --resolution, of a sampled mesh by a coarser --grid";

/// Has a lack of memory reported as a JSON object, too.
pub fn report_as_json() {
    JSON.store(true, Ordering::Relaxed);
}

/// Whether failures are reported as JSON objects, too.
pub(crate) fn wants_json() -> bool {
    JSON.load(Ordering::Relaxed)
}

/// Has a lack of memory after this, as while the program ends, reported no more.
pub(crate) fn object_is_written() {
    HAS_OBJECT.store(true, Ordering::Relaxed);
}

/// Has writing past the limit on file sizes fail, not end the process.
pub fn fail_at_file_size() {
    #[cfg(unix)]
    // SAFETY: no handler is installed that could be run; other signals keep their dispositions.
    unsafe {
        libc::signal(libc::SIGXFSZ, libc::SIG_IGN);
    }
}

// SAFETY: every request goes to the system's allocator as it is, and what that returns is returned, but for null.
unsafe impl GlobalAlloc for ReportingAllocator {
    #[inline]
    unsafe fn alloc(&self, layout: Layout) -> *mut u8 {
        // SAFETY: the caller's promises are those that are needed.
        some(unsafe { System.alloc(layout) }, layout.size())
    }

    #[inline]
    unsafe fn alloc_zeroed(&self, layout: Layout) -> *mut u8 {
        // SAFETY: as above.
        some(unsafe { System.alloc_zeroed(layout) }, layout.size())
    }

    #[inline]
    unsafe fn realloc(&self, pointer: *mut u8, layout: Layout, size: usize) -> *mut u8 {
        // SAFETY: as above; the pointer came from the system's allocator.
        some(unsafe { System.realloc(pointer, layout, size) }, size)
    }

    #[inline]
    unsafe fn dealloc(&self, pointer: *mut u8, layout: Layout) {
        // SAFETY: as above.
        unsafe { System.dealloc(pointer, layout) }
    }
}

/// The pointer, unless it is null.
#[inline]
fn some(pointer: *mut u8, bytes: usize) -> *mut u8 {
    if pointer.is_null() {
        out_of_memory(bytes);
    }
    pointer
}

/// Reports the lack of memory and ends the process with exit code 1, without allocations and locks.
#[cold]
#[inline(never)]
fn out_of_memory(bytes: usize) -> ! {
    if REPORTED.swap(true, Ordering::Relaxed) {
        // Another thread is about to end the process.
        loop {
            std::hint::spin_loop();
        }
    }
    if HAS_OBJECT.load(Ordering::Relaxed) {
        end()
    }
    let mut text = [0u8; 1024];
    if wants_json() {
        let object = filled(&mut text, |text| {
            writeln!(
                text,
                r#"{{"error":{{"file":null,"line":null,"message":"{MESSAGE}: {bytes} bytes were refused","remedy":"{REMEDY}"}}}}"#
            )
        });
        write_past_buffers(1, object);
    }
    let lines = filled(&mut text, |text| {
        writeln!(
            text,
            "error: {MESSAGE}: {bytes} bytes were refused\n  help: {REMEDY}"
        )
    });
    write_past_buffers(2, lines);
    end()
}

/// What `write` writes into a buffer.
fn filled(buffer: &mut [u8], write: impl FnOnce(&mut &mut [u8]) -> std::io::Result<()>) -> &[u8] {
    let length = buffer.len();
    let mut rest = &mut *buffer;
    // The text is shorter than the buffer; were it not, what fits would stand.
    let _ = write(&mut rest);
    let written = length - rest.len();
    &buffer[..written]
}

/// Writes to a file descriptor of the process.
#[cfg(unix)]
pub(crate) fn write_past_buffers(descriptor: i32, mut text: &[u8]) {
    while !text.is_empty() {
        // SAFETY: the text is readable over its whole length.
        let written = unsafe { libc::write(descriptor, text.as_ptr().cast(), text.len()) };
        match usize::try_from(written) {
            Ok(written) if written > 0 => text = text.get(written..).unwrap_or_default(),
            // Nobody is there to read it.
            _ => return,
        }
    }
}

#[cfg(not(unix))]
fn write_past_buffers(_: i32, _: &[u8]) {}

/// Ends the process without flushing, which may need memory or a lock.
#[cfg(unix)]
fn end() -> ! {
    // SAFETY: ends the process at once; nothing runs afterwards.
    unsafe { libc::_exit(1) }
}

/// Ends the process.
#[cfg(not(unix))]
fn end() -> ! {
    std::process::abort()
}

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
    // The line of a progress bar may be before it.
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

#[cfg(test)]
mod tests {
    use super::*;

    /// The object is JSON as it stands, for it is written without the crate that makes other objects.
    #[test]
    fn the_words_need_no_escapes() {
        for words in [MESSAGE, REMEDY] {
            let escaped = serde_json::to_string(words).unwrap();
            assert_eq!(escaped, format!("\"{words}\""));
        }
        assert!(2 * REMEDY.len() < 1024 - 200);
    }

    #[test]
    fn a_text_is_cut_at_the_end_of_its_buffer() {
        let mut buffer = [0; 8];
        assert_eq!(filled(&mut buffer, |text| write!(text, "{}", 123)), b"123");
        let long = filled(&mut buffer, |text| write!(text, "0123456789"));
        assert_eq!(long, b"01234567");
    }
}
