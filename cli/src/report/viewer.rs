//! The library of the three-dimensional view: 3Dmol.js (Rego and Koes, Bioinformatics 31 (2015) 1322-1324), as npm has it.

use std::io::{self, Write as _};
use std::path::{Path, PathBuf};
use std::sync::OnceLock;

use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use clap::Args;
use flate2::Compression;
use flate2::write::GzEncoder;

use knotdock::bounded_read::read_bounded;
use knotdock::output::files::file_error;
use knotdock_structures::Error;

/// Address of the library, for reports of builds without it; the version is that of viewer/package-lock.json.
pub const ADDRESS: &str = "https://cdn.jsdelivr.net/npm/3dmol@2.5.5/build/3Dmol-min.js";
/// SHA-384 of the library, which a browser checks before it runs it.
pub const INTEGRITY: &str =
    "sha384-OsczYbldvrHgslr9fFp/i4GiLSeuw9l+QIlv99ITw8soOwXcoGeflFMLg+CU/X1d";

/// What stands in place of the view of a page without the library: nothing is loaded before the button is pressed.
pub(super) fn on_request(viewer: Option<&Viewer>) -> String {
    match viewer {
        Some(_) => String::new(),
        None => format!(
            "<p id=\"no-view\">This build has no three-dimensional view. <button type=\"button\" id=\"load-view\" \
             data-address=\"{ADDRESS}\" data-integrity=\"{INTEGRITY}\">Load it from cdn.jsdelivr.net</button> That \
             fetches 3Dmol.js and sends nothing of this page. Without a network, <code>knotdock report --viewer \
             DIR</code> puts the view into the page (<code>npm install 3dmol</code> fetches it).</p>"
        ),
    }
}

/// The place of the library.
#[derive(Args, Clone, Debug)]
pub struct ViewerArguments {
    /// Folder of npm's package 3dmol, for the three-dimensional view of the report [default: what the program was built
    /// with].
    #[arg(long, value_name = "DIR")]
    pub(super) viewer: Option<PathBuf>,
}

impl ViewerArguments {
    pub fn read(&self) -> Result<Option<Viewer>, Error> {
        match &self.viewer {
            Some(folder) => Viewer::read(folder).map(Some),
            None => Ok(Viewer::embedded().cloned()),
        }
    }
}

const MAX_BYTES: u64 = 4 << 20;

/// The library, packed, with its licence.
#[derive(Clone, Debug)]
pub struct Viewer {
    pub(super) packed: String,
    pub(super) licence: String,
}

impl Viewer {
    fn of(script: &str, licence: &str) -> Self {
        Self {
            packed: packed(script.as_bytes()),
            licence: licence.to_owned(),
        }
    }

    pub fn embedded() -> Option<&'static Self> {
        static EMBEDDED: OnceLock<Option<Viewer>> = OnceLock::new();
        EMBEDDED.get_or_init(embedded).as_ref()
    }

    /// The library as gzip.
    #[cfg(feature = "serve")]
    pub fn gzip(&self) -> Vec<u8> {
        // It was encoded here.
        STANDARD.decode(&self.packed).unwrap_or_default()
    }

    /// The library in the folder of npm's package.
    pub fn read(package: &Path) -> Result<Self, Error> {
        let text = |name: &str| {
            let path = package.join(name);
            let bytes = read_bounded(&path, MAX_BYTES).and_then(|bytes| {
                String::from_utf8(bytes).map_err(|error| io::Error::other(error.utf8_error()))
            });
            bytes.map_err(|source| {
                file_error::refused(
                    &path,
                    format!("cannot read {}: {source}", path.display()),
                    "name the folder of npm's package 3dmol: `npm install 3dmol` puts it into node_modules/3dmol",
                )
            })
        };
        Ok(Self::of(&text("build/3Dmol-min.js")?, &text("LICENSE")?))
    }
}

#[cfg(feature = "viewer")]
fn embedded() -> Option<Viewer> {
    let script = include_str!(concat!(
        env!("CARGO_MANIFEST_DIR"),
        "/../viewer/node_modules/3dmol/build/3Dmol-min.js"
    ));
    let licence = include_str!(concat!(
        env!("CARGO_MANIFEST_DIR"),
        "/../viewer/node_modules/3dmol/LICENSE"
    ));
    Some(Viewer::of(script, licence))
}

#[cfg(not(feature = "viewer"))]
fn embedded() -> Option<Viewer> {
    None
}

/// Level of compression: some 7% larger than at the usual 6, in half the time.
const LEVEL: u32 = 4;

/// Bytes as gzip in base64.
pub(super) fn packed(bytes: &[u8]) -> String {
    let mut encoder = GzEncoder::new(Vec::new(), Compression::new(LEVEL));
    let written = encoder.write_all(bytes).and_then(|()| encoder.finish());
    match written {
        Ok(bytes) => STANDARD.encode(bytes),
        Err(error) => unreachable!("writing to memory fails: {error}"),
    }
}
