//! Reports: one HTML file in which results are looked at, offline.
//!
//! A report holds all that it shows and asks no network: its security policy forbids requests. What JavaScript shows (the
//! table, the charts, the view) is packed: JSON, then gzip, then base64. What is said in words is plain HTML, and reads
//! without JavaScript.
//!
//! | file | what |
//! |---|---|
//! | `contacts` | residues in contact in each pose, and where the best clusters gather |
//! | `columns` | what the columns of `poses.csv` are called, and how many digits are shown |
//! | `run` | the report of a run |
//! | `run_data` | the parts of a run's report, and the data of its scripts |
//! | `run_words`, `run_cost` | its sections that are words |
//! | `lists` | reports that are tables: of batches, ensembles and sweeps |
//! | `solids` | reports of collisions and of results of solids |
//! | `shown` | fields, placements and surfaces, as scripts read them |
//! | `html` | the page itself: sections, scripts, seal |
//! | `viewer` | the library of the three-dimensional view, if there is one; bytes as the page holds them |
//! | `page/` | style and scripts |

mod columns;
mod html;
mod lists;
mod run;
mod run_cost;
mod run_data;
mod run_words;
mod shown;
mod solids;
mod viewer;

pub use knotdock::output::run_contacts::{MAX_ROWS, RunContacts};
pub use lists::Listed;
pub use run_data::{ReportBodies, RunReport};
pub use solids::SolidsReport;
pub use viewer::Viewer;
