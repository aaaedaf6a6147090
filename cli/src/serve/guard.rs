//! Who may ask: this machine's own pages, and with `--host` those who have the link.
//!
//! A page of another site may send requests to this server from its user's browser, and a name that it controls may
//! resolve to this machine (DNS rebinding). So requests must name the host and the origin of this server; with a token they
//! must bring it.

use std::net::{IpAddr, SocketAddr};

use axum::extract::{Request, State};
use axum::http::header::{self, HeaderMap, HeaderName, HeaderValue};
use axum::http::{Method, StatusCode};
use axum::middleware::Next;
use axum::response::{Html, IntoResponse, Response};
use std::sync::Arc;

use super::Server;
use super::api::Refusal;
use crate::report::LIBRARY_ADDRESS;
use knotdock::output::files::checksum::sha256;
use knotdock_structures::Error;

pub struct Guard {
    /// The name that `--host` gives.
    name: Option<String>,
    port: u16,
    token: Option<String>,
}

const TOKEN_BYTES: usize = 16;

impl Guard {
    /// A guard; `host` is that of `--host`.
    pub fn new(host: Option<&str>, address: SocketAddr) -> Result<Self, Error> {
        let mut bytes = [0; TOKEN_BYTES];
        getrandom::fill(&mut bytes).map_err(Error::machine)?;
        let token = bytes.iter().map(|byte| format!("{byte:02x}")).collect();
        Ok(Self {
            name: host.map(str::to_ascii_lowercase),
            port: address.port(),
            token: host.is_some().then_some(token),
        })
    }

    /// The link to the page at a host.
    pub fn link(&self, host: &str) -> String {
        let host = match host.parse::<IpAddr>() {
            Ok(IpAddr::V6(address)) => format!("[{address}]"),
            _ => host.to_owned(),
        };
        let base = format!("http://{host}:{}/", self.port);
        match &self.token {
            Some(token) => format!("{base}?token={token}"),
            None => base,
        }
    }

    /// The cookie's name: cookies of a host are those of all its ports.
    fn cookie(&self) -> String {
        format!("knotdock_{}", self.port)
    }

    fn check(&self, request: &Request) -> Result<(), Refusal> {
        let headers = request.headers();
        let host = text(headers, header::HOST).unwrap_or_default();
        if !self.is_own_host(host) {
            let message = "requests to this host name are refused";
            return Err(Refusal::new(StatusCode::MISDIRECTED_REQUEST, message));
        }
        let is_foreign = match headers.get(header::ORIGIN) {
            Some(origin) => origin.as_bytes() != format!("http://{host}").as_bytes(),
            None => false,
        };
        // Links lead here from anywhere; a page shows nothing to the one that it was called from.
        let is_link = request.method() == Method::GET
            && text(headers, HeaderName::from_static("sec-fetch-mode")) == Some("navigate");
        let site = text(headers, HeaderName::from_static("sec-fetch-site"));
        let is_within = matches!(site, None | Some("same-origin" | "none"));
        if is_foreign || !(is_within || is_link) {
            let message = "requests of pages from elsewhere are refused";
            return Err(Refusal::new(StatusCode::FORBIDDEN, message));
        }
        match &self.token {
            Some(token) if !has_cookie(headers, &self.cookie(), token) => {
                let message = "open the link that `knotdock serve` printed";
                Err(Refusal::new(StatusCode::UNAUTHORIZED, message))
            }
            _ => Ok(()),
        }
    }

    /// Whether a `Host` header names this server: by an address of the machine, which no other site's name is, or by the
    /// name of `--host`.
    fn is_own_host(&self, host: &str) -> bool {
        let host = host.to_ascii_lowercase();
        let name = match host.strip_suffix(&format!(":{}", self.port)) {
            Some(name) => name,
            None if self.port == 80 => &host,
            None => return false,
        };
        let address = name
            .strip_prefix('[')
            .and_then(|name| name.strip_suffix(']'));
        let address = address.unwrap_or(name).parse::<IpAddr>();
        match (address, &self.name) {
            (Ok(address), None) => address.is_loopback(),
            (Ok(_), Some(_)) => true,
            (Err(_), given) => name == "localhost" || given.as_deref() == Some(name),
        }
    }

    /// The answer to a link with the token: a page that goes on to the first one, with the cookie.
    fn admitted(&self, request: &Request) -> Option<Response> {
        let token = self.token.as_deref()?;
        let given = request.uri().query()?.strip_prefix("token=")?;
        let host = text(request.headers(), header::HOST)?;
        if request.uri().path() != "/" || !is_same(given, token) || !self.is_own_host(host) {
            return None;
        }
        let cookie = format!(
            "{}={token}; HttpOnly; SameSite=Strict; Path=/",
            self.cookie()
        );
        // A redirection would not bring the cookie if the link was clicked on in another site.
        let page = Html(
            "<!DOCTYPE html><meta http-equiv=\"refresh\" content=\"0;url=/\"><title>knotdock</title>",
        );
        Some(([(header::SET_COOKIE, cookie)], page).into_response())
    }
}

fn text(headers: &HeaderMap, name: HeaderName) -> Option<&str> {
    headers.get(name)?.to_str().ok()
}

/// Whether two secrets are the same, in a time that does not depend on where they differ.
fn is_same(one: &str, other: &str) -> bool {
    sha256(one.as_bytes()) == sha256(other.as_bytes())
}

fn has_cookie(headers: &HeaderMap, name: &str, value: &str) -> bool {
    let all = headers.get_all(header::COOKIE).iter();
    let pairs = all.filter_map(|cookies| cookies.to_str().ok());
    let mut pairs = pairs.flat_map(|cookies| cookies.split(';'));
    pairs.any(|pair| {
        let found = pair.trim().split_once('=');
        found.is_some_and(|(found, text)| found == name && is_same(text, value))
    })
}

/// Security policy of the page: scripts are those of this server and, on request, the library of the view.
fn page_policy() -> String {
    format!(
        "default-src 'none'; script-src 'self' {LIBRARY_ADDRESS}; style-src 'self'; img-src 'self' data: blob:; connect-src \
         'self'; worker-src blob:; frame-ancestors 'none'; base-uri 'none'; form-action 'none'"
    )
}

/// Lets a request through, or refuses it; answers get the headers that keep other sites from them.
pub async fn guard(State(server): State<Arc<Server>>, request: Request, next: Next) -> Response {
    let mut response = match server.guard.admitted(&request) {
        Some(response) => response,
        None => match server.guard.check(&request) {
            Ok(()) => next.run(request).await,
            Err(refusal) => refusal.into_response(),
        },
    };
    let headers = response.headers_mut();
    let fixed = [
        (header::X_CONTENT_TYPE_OPTIONS, "nosniff"),
        (header::X_FRAME_OPTIONS, "DENY"),
        (header::REFERRER_POLICY, "no-referrer"),
        (header::CACHE_CONTROL, "no-store"),
        (
            HeaderName::from_static("cross-origin-resource-policy"),
            "same-origin",
        ),
        (
            HeaderName::from_static("cross-origin-opener-policy"),
            "same-origin",
        ),
    ];
    for (name, value) in fixed {
        headers.insert(name, HeaderValue::from_static(value));
    }
    if !headers.contains_key(header::CONTENT_SECURITY_POLICY)
        && let Ok(policy) = HeaderValue::try_from(page_policy())
    {
        headers.insert(header::CONTENT_SECURITY_POLICY, policy);
    }
    response
}
