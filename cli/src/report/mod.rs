//! Reports: one HTML file in which results are looked at, offline.
//!
//! A report holds all that it shows and sends no requests: its security policy forbids them. Data of the scripts (table,
//! charts, view) are packed: JSON, gzip, base64. Sentences are plain HTML, and read without JavaScript.

mod clusters;
mod columns;
mod html;
mod lists;
mod models;
mod run;
mod run_cost;
mod run_words;
mod shown;
mod solids;
mod viewer;

pub use clusters::{figures, figures_of};
pub use html::view_page;
pub use knotdock::output::run_contacts::MAX_ROWS;
pub use lists::DirectoryKind;
pub use models::{ModelsReport, ShownModels};
pub use run::RunReport;
pub use shown::solid as shown_surface;
pub use solids::SolidsReport;
#[cfg(feature = "serve")]
pub use viewer::{ADDRESS as LIBRARY_ADDRESS, INTEGRITY as LIBRARY_INTEGRITY};
pub use viewer::{Viewer, ViewerArguments};
