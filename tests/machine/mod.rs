//! The program at the limits of the machine: threads, memory, sizes of files, and names that stand for no file.
//!
//! Limits are set by `ulimit` of the shell, so that they hold for the program alone. A check that the machine at hand
//! does not allow says `NOT RUN` in its output.

#[cfg(unix)]
mod limits;
#[cfg(unix)]
mod place;
#[cfg(unix)]
mod reading;
#[cfg(target_os = "linux")]
mod threads;
