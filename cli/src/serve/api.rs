//! Addresses of the server: the page, its requests and the files of uploads and runs.

use std::convert::Infallible;
use std::fs;
use std::path::Path as FilePath;
use std::sync::Arc;
use std::time::Duration;

use axum::extract::{Path, Request, State};
use axum::http::{HeaderName, StatusCode, header};
use axum::middleware::from_fn_with_state;
use axum::response::sse::{Event, KeepAlive, Sse};
use axum::response::{IntoResponse, Response};
use axum::routing::{get, post, put};
use axum::{Json, Router};
use futures_util::Stream;
use futures_util::stream::unfold;
use serde_json::{Value, json};
use tokio::time::timeout;

use super::Server;
use super::folder::INPUTS;
use super::guard::guard;
use super::request::RunRequest;
use super::{jobs, listing};
use crate::messages::console::failure_json;
use crate::report::{LIBRARY_ADDRESS, LIBRARY_INTEGRITY, Viewer};
use knotdock::options::definition::{Form, Scope};
use knotdock::options::{Preset, definitions};
use knotdock::output::records::program::VERSION_WITH_COMMIT;
use knotdock_structures::Error;

/// The page's own files: address, kind and content.
const PAGE: [(&str, &str, &str); 8] = [
    ("/", HTML, include_str!("page/index.html")),
    (
        "/style.css",
        "text/css",
        concat!(
            include_str!("../report/page/style.css"),
            include_str!("page/style.css")
        ),
    ),
    // Elements and scenes as reports have them, as a module.
    (
        "/report.js",
        SCRIPT,
        concat!(
            include_str!("../report/page/packed.js"),
            include_str!("../report/page/geometry.js"),
            include_str!("../report/page/scene.js"),
            "export { byId, make, makeScene };\n"
        ),
    ),
    ("/main.js", SCRIPT, include_str!("page/main.js")),
    ("/server.js", SCRIPT, include_str!("page/server.js")),
    ("/side.js", SCRIPT, include_str!("page/side.js")),
    ("/view.js", SCRIPT, include_str!("page/view.js")),
    ("/runs.js", SCRIPT, include_str!("page/runs.js")),
];
const HTML: &str = "text/html; charset=utf-8";
const SCRIPT: &str = "text/javascript; charset=utf-8";

/// A refusal of a request, as the program's failures in JSON.
#[derive(Debug)]
pub struct Refusal {
    status: StatusCode,
    error: Value,
}

impl Refusal {
    pub fn new(status: StatusCode, message: impl ToString) -> Self {
        Self {
            status,
            error: json!({ "error": { "message": message.to_string() } }),
        }
    }

    fn missing() -> Self {
        Self::new(StatusCode::NOT_FOUND, "there is nothing at this address")
    }
}

impl From<Error> for Refusal {
    fn from(error: Error) -> Self {
        Self {
            status: match error.exit_code() {
                2 => StatusCode::UNPROCESSABLE_ENTITY,
                _ => StatusCode::INTERNAL_SERVER_ERROR,
            },
            error: failure_json(&error),
        }
    }
}

impl IntoResponse for Refusal {
    fn into_response(self) -> Response {
        (self.status, Json(self.error)).into_response()
    }
}

type Shared = State<Arc<Server>>;
type Answer<T> = Result<T, Refusal>;

pub fn router(server: Arc<Server>) -> Router {
    let mut router = Router::new();
    for (address, kind, content) in PAGE {
        router = router.route(address, get(([(header::CONTENT_TYPE, kind)], content)));
    }
    router
        .route("/3Dmol.js", get(library))
        .route("/api/setup", get(setup))
        .route("/api/events", get(events))
        .route("/api/uploads", post(new_upload))
        .route("/api/uploads/{upload}/{name}", put(receive).get(uploaded))
        .route("/api/inspect/{upload}/{name}", get(inspect))
        .route("/api/runs", get(runs).post(start))
        .route("/api/runs/{run}", axum::routing::delete(forget))
        .route("/api/runs/{run}/cancel", post(cancel))
        .route("/api/runs/{run}/again", post(again))
        .route("/runs/{run}/{*path}", get(result))
        .fallback(|| async { Refusal::missing() })
        .layer(from_fn_with_state(Arc::clone(&server), guard))
        .with_state(server)
}

/// The library of the view, if this build has it.
async fn library() -> Answer<Response> {
    let packed = Viewer::embedded()
        .map(Viewer::gzip)
        .ok_or_else(Refusal::missing)?;
    let headers = [
        (header::CONTENT_TYPE, SCRIPT),
        (header::CONTENT_ENCODING, "gzip"),
    ];
    Ok((headers, packed).into_response())
}

/// Presets, options and addresses for the page's forms.
async fn setup(State(server): Shared) -> Json<Value> {
    let presets = Preset::ALL.map(|preset| json!({ "name": preset.name, "about": preset.about }));
    let options = definitions()
        .iter()
        .filter(|option| option.form() != Form::File);
    let options = options.map(|option| {
        json!({
            "name": option.name(),
            "long": option.long(),
            "group": option.heading(),
            "for": match option.scope() {
                Scope::Both => "both",
                Scope::Molecules => "molecules",
                Scope::Meshes => "meshes",
            },
            "is_flag": option.form() == Form::Flag,
            "choices": (option.form() == Form::Choice).then(|| option.value_name().split('|').collect::<Vec<_>>()),
            "value": option.value_name(),
            "help": option.help(),
            "default": option.default_text(),
            "is_weight": option.is_of_files(),
        })
    });
    Json(json!({
        "version": VERSION_WITH_COMMIT,
        "folder": server.folder.root(),
        "presets": presets,
        "options": options.collect::<Vec<_>>(),
        "library": match Viewer::embedded() {
            Some(_) => json!({ "address": "/3Dmol.js" }),
            None => json!({ "address": LIBRARY_ADDRESS, "integrity": LIBRARY_INTEGRITY }),
        },
    }))
}

/// The state of the queue, and again whenever it changes.
async fn events(State(server): Shared) -> Sse<impl Stream<Item = Result<Event, Infallible>>> {
    let stream = unfold(
        (server.jobs.watch(), true),
        |(mut watched, is_first)| async move {
            if !is_first {
                watched.changed().await.ok()?;
            }
            let shown = watched.borrow_and_update().to_string();
            Some((Ok(Event::default().data(shown)), (watched, false)))
        },
    );
    Sse::new(stream).keep_alive(KeepAlive::new().interval(Duration::from_secs(30)))
}

async fn new_upload(State(server): Shared) -> Answer<Json<Value>> {
    Ok(Json(json!({ "upload": server.folder.new_upload()? })))
}

async fn receive(
    State(server): Shared,
    Path((upload, name)): Path<(String, String)>,
    request: Request,
) -> Answer<Json<Value>> {
    let body = request.into_body().into_data_stream();
    let name = server.folder.receive(&upload, &name, body).await?;
    Ok(Json(json!({ "name": name })))
}

async fn uploaded(
    State(server): Shared,
    Path((upload, name)): Path<(String, String)>,
) -> Answer<Response> {
    let path = server
        .folder
        .input(&upload, &name)
        .ok_or_else(Refusal::missing)?;
    sent(&path)
}

/// Time that reading a structure may take.
const READING: Duration = Duration::from_secs(120);

/// The report of `knotdock inspect` on a file of an upload.
async fn inspect(
    State(server): Shared,
    Path((upload, name)): Path<(String, String)>,
) -> Answer<Json<Value>> {
    server
        .folder
        .input(&upload, &name)
        .ok_or_else(Refusal::missing)?;
    let words = ["inspect".to_owned(), format!("{INPUTS}/{upload}/{name}")];
    let mut child = jobs::command(&server, &words)
        .spawn()
        .map_err(Error::machine)?;
    // Its input is open while it reads.
    let input = child.stdin.take();
    let output = timeout(READING, child.wait_with_output()).await;
    drop(input);
    let Ok(output) = output else {
        let message = "reading the structure takes too long";
        return Err(Refusal::new(StatusCode::UNPROCESSABLE_ENTITY, message));
    };
    Ok(Json(listing::inspected(
        &output.map_err(Error::machine)?.stdout,
    )))
}

async fn runs(State(server): Shared) -> Answer<Json<Value>> {
    Ok(Json(listing::all(&server.folder)?))
}

async fn start(State(server): Shared, Json(request): Json<RunRequest>) -> Answer<Json<Value>> {
    let run = server.jobs.add(&server.folder, request)?;
    Ok(Json(json!({ "run": run })))
}

async fn cancel(State(server): Shared, Path(run): Path<String>) -> Answer<Json<Value>> {
    done(server.jobs.cancel(&server.folder, &run)?)
}

async fn again(State(server): Shared, Path(run): Path<String>) -> Answer<Json<Value>> {
    done(server.jobs.again(&server.folder, &run)?)
}

async fn forget(State(server): Shared, Path(run): Path<String>) -> Answer<Json<Value>> {
    done(server.jobs.forget(&server.folder, &run))
}

fn done(was_there: bool) -> Answer<Json<Value>> {
    match was_there {
        true => Ok(Json(json!({}))),
        false => Err(Refusal::new(
            StatusCode::CONFLICT,
            "there is no such run for this now",
        )),
    }
}

async fn result(
    State(server): Shared,
    Path((run, path)): Path<(String, String)>,
) -> Answer<Response> {
    let path = server
        .folder
        .run_file(&run, &path)
        .ok_or_else(Refusal::missing)?;
    sent(&path)
}

/// Security policy of reports, in addition to their own: their scripts have no access to this server.
const REPORT_POLICY: &str = "sandbox allow-scripts allow-downloads allow-popups allow-modals";

/// A file: a report as a page, any other to be saved.
fn sent(path: &FilePath) -> Answer<Response> {
    let content = fs::read(path).map_err(|_| Refusal::missing())?;
    let name = path.file_name().unwrap_or_default().to_string_lossy();
    if name == "report.html" {
        let headers = [
            (header::CONTENT_TYPE, HTML),
            (header::CONTENT_SECURITY_POLICY, REPORT_POLICY),
        ];
        return Ok((headers, content).into_response());
    }
    // Names of runs and uploads are plain, and others are given without what a header cannot hold.
    let name: String = name
        .chars()
        .filter(|c| c.is_ascii_alphanumeric() || "._-".contains(*c))
        .collect();
    let headers: [(HeaderName, String); 2] = [
        (header::CONTENT_TYPE, "application/octet-stream".to_owned()),
        (
            header::CONTENT_DISPOSITION,
            format!("attachment; filename=\"{name}\""),
        ),
    ];
    Ok((headers, content).into_response())
}
