//! The server of `knotdock serve` under attack: each test is one way in.

use std::fs;
use std::io::{BufRead, BufReader, Read, Write};
use std::net::TcpStream;
use std::path::Path;
use std::process::{Child, Command, Stdio};
use std::time::Duration;

use assert_cmd::cargo::cargo_bin;
use serde_json::{Value, json};
use tempfile::TempDir;

use crate::program;

/// A server, which ends with it.
struct Server {
    process: Child,
    folder: TempDir,
    /// What follows `http://`: host, port and query.
    link: String,
    host: String,
}

struct Answer {
    status: u16,
    head: String,
    body: String,
}

impl Answer {
    fn json(&self) -> Value {
        serde_json::from_str(&self.body).unwrap()
    }

    /// The value of a header; empty without one.
    fn header(&self, name: &str) -> &str {
        let mut lines = self.head.lines().filter_map(|line| line.split_once(": "));
        lines
            .find(|(found, _)| found.eq_ignore_ascii_case(name))
            .map_or("", |(_, value)| value)
    }
}

impl Server {
    fn start(words: &[&str]) -> Self {
        let folder = tempfile::tempdir().unwrap();
        let mut process = Command::new(cargo_bin!("knotdock"))
            .args(["serve", "--port", "0", "--no-browser", "--json", "--folder"])
            .arg(folder.path().join("runs"))
            .args(words)
            .stdout(Stdio::piped())
            .stderr(Stdio::null())
            .spawn()
            .unwrap();
        let mut line = String::new();
        let output = process.stdout.as_mut().unwrap();
        BufReader::new(output).read_line(&mut line).unwrap();
        let object: Value = serde_json::from_str(&line).unwrap();
        let link = object["link"].as_str().unwrap();
        let link = link.strip_prefix("http://").unwrap().to_owned();
        let host = link.split('/').next().unwrap().to_owned();
        Self {
            process,
            folder,
            link,
            host,
        }
    }

    fn runs(&self) -> std::path::PathBuf {
        self.folder.path().join("runs")
    }

    /// Sends a request with these headers besides `Host`, which they may replace.
    fn send(&self, method: &str, address: &str, headers: &[(&str, &str)], body: &[u8]) -> Answer {
        let port = self.host.rsplit(':').next().unwrap();
        let mut stream = TcpStream::connect(format!("127.0.0.1:{port}")).unwrap();
        stream
            .set_read_timeout(Some(Duration::from_secs(60)))
            .unwrap();
        let mut head = format!(
            "{method} {address} HTTP/1.1\r\nConnection: close\r\nContent-Length: {}\r\n",
            body.len()
        );
        if !headers.iter().any(|(name, _)| *name == "Host") {
            head += &format!("Host: {}\r\n", self.host);
        }
        for (name, value) in headers {
            head += &format!("{name}: {value}\r\n");
        }
        stream.write_all(format!("{head}\r\n").as_bytes()).unwrap();
        // A server that refuses a large body does not read it to its end.
        let _ = stream.write_all(body);
        let mut bytes = Vec::new();
        let _ = stream.read_to_end(&mut bytes);
        let text = String::from_utf8_lossy(&bytes).into_owned();
        let (head, body) = text
            .split_once("\r\n\r\n")
            .unwrap_or_else(|| panic!("{address}: {text}"));
        let status = head.split(' ').nth(1).unwrap().parse().unwrap();
        Answer {
            status,
            head: head.to_owned(),
            body: body.to_owned(),
        }
    }

    fn get(&self, address: &str) -> Answer {
        self.send("GET", address, &[], b"")
    }

    fn post(&self, address: &str, object: &Value) -> Answer {
        let kind = [("Content-Type", "application/json")];
        self.send("POST", address, &kind, object.to_string().as_bytes())
    }

    /// A request for a run of two small files, as the page sends it.
    fn request(&self) -> Value {
        let upload = self.send("POST", "/api/uploads", &[], b"").json()["upload"].clone();
        let side = |name: &str| {
            let atom =
                "ATOM      1  CA  ALA A   1       0.000   0.000   0.000  1.00  0.00           C\n";
            let address = format!("/api/uploads/{}/{name}", upload.as_str().unwrap());
            assert_eq!(self.send("PUT", &address, &[], atom.as_bytes()).status, 200);
            json!({ "upload": upload, "files": [name], "chains": "" })
        };
        json!({ "receptor": side("r.pdb"), "ligand": side("l.pdb"), "preset": null, "options": {} })
    }
}

impl Drop for Server {
    fn drop(&mut self) {
        let _ = self.process.kill();
        let _ = self.process.wait();
    }
}

/// A name of another site that resolves to this machine is refused (DNS rebinding), for pages and for data.
#[test]
fn foreign_hosts_are_refused() {
    let server = Server::start(&[]);
    let port = server.host.rsplit(':').next().unwrap().to_owned();
    let hosts = [
        "evil.example",
        "127.0.0.1",
        "127.0.0.1:1",
        "192.0.2.7",
        "localhost.evil.example",
        "",
    ];
    for host in hosts {
        let with_port = format!("{host}:{port}");
        for host in [host, &with_port] {
            let is_own = host == format!("127.0.0.1:{port}");
            for address in ["/", "/api/runs", "/main.js"] {
                let status = server.send("GET", address, &[("Host", host)], b"").status;
                assert_eq!(status == 200, is_own, "{host}{address}: {status}");
            }
        }
    }
    for host in ["localhost", "LOCALHOST", "[::1]", "127.0.0.2"] {
        let host = format!("{host}:{port}");
        assert_eq!(
            server.send("GET", "/", &[("Host", &host)], b"").status,
            200,
            "{host}"
        );
    }
}

/// Pages of other sites can neither post nor read; links to the page work.
#[test]
fn foreign_origins_are_refused() {
    let server = Server::start(&[]);
    let own = format!("http://{}", server.host);
    let other_port = format!("http://127.0.0.1:{}", 1);
    for (origin, wanted) in [
        (own.as_str(), 200),
        ("http://evil.example", 403),
        ("null", 403),
        (&other_port, 403),
        ("http://127.0.0.1", 403),
    ] {
        for (method, address) in [("POST", "/api/uploads"), ("GET", "/api/runs")] {
            let status = server
                .send(method, address, &[("Origin", origin)], b"")
                .status;
            assert_eq!(status, wanted, "{method} {address} from {origin}");
        }
    }
    let from = |site: &str, mode: &str, method: &str, address: &str| {
        let headers = [("Sec-Fetch-Site", site), ("Sec-Fetch-Mode", mode)];
        server.send(method, address, &headers, b"").status
    };
    assert_eq!(from("cross-site", "no-cors", "GET", "/api/runs"), 403);
    assert_eq!(from("same-site", "cors", "GET", "/api/events"), 403);
    assert_eq!(from("cross-site", "navigate", "POST", "/api/uploads"), 403);
    assert_eq!(from("cross-site", "navigate", "GET", "/"), 200);
    assert_eq!(from("same-origin", "cors", "GET", "/api/runs"), 200);
}

/// Every answer, refusals included, has the headers that keep it from other sites.
#[test]
fn answers_are_closed_to_other_sites() {
    let server = Server::start(&[]);
    for answer in [
        server.get("/"),
        server.get("/nothing"),
        server.send("GET", "/", &[("Host", "evil.example")], b""),
    ] {
        let policy = answer.header("content-security-policy");
        assert!(
            policy.starts_with("default-src 'none'; script-src 'self' "),
            "{policy}"
        );
        assert!(
            !policy.contains("unsafe") && policy.contains("frame-ancestors 'none'"),
            "{policy}"
        );
        assert_eq!(answer.header("x-content-type-options"), "nosniff");
        assert_eq!(answer.header("cross-origin-resource-policy"), "same-origin");
        assert_eq!(answer.header("access-control-allow-origin"), "");
    }
}

/// With --host nothing is answered without the token, which a cookie brings that no script reads and no other site sends.
#[test]
fn a_host_that_is_given_needs_the_token() {
    let server = Server::start(&["--host", "127.0.0.1"]);
    let (_, token) = server.link.split_once("?token=").unwrap();
    assert_eq!(token.len(), 32);
    for address in [
        "/",
        "/main.js",
        "/api/runs",
        "/api/events",
        "/?token=",
        "/?token=0",
        "/api/runs?token=0",
    ] {
        assert_eq!(server.get(address).status, 401, "{address}");
    }
    assert_eq!(server.get(&format!("/api/runs?token={token}")).status, 401);
    let evil = [("Host", "evil.example")];
    assert_eq!(
        server
            .send("GET", &format!("/?token={token}"), &evil, b"")
            .status,
        421
    );
    let admitted = server.get(&format!("/?token={token}"));
    assert_eq!(admitted.status, 200);
    let cookie = admitted.header("set-cookie");
    assert!(cookie.contains("; HttpOnly; SameSite=Strict"), "{cookie}");
    let pair = cookie.split(';').next().unwrap();
    for (cookie, wanted) in [
        (pair.to_owned(), 200),
        (format!("other=1; {pair}"), 200),
        (format!("{pair}0"), 401),
        (pair[..pair.len() - 1].to_owned(), 401),
        (format!("x{pair}"), 401),
        (token.to_owned(), 401),
    ] {
        let status = server
            .send("GET", "/api/runs", &[("Cookie", &cookie)], b"")
            .status;
        assert_eq!(status, wanted, "{cookie}");
    }
}

/// No address leads out of the folder, or to the server's own files.
#[test]
fn no_path_leads_out_of_the_folder() {
    let server = Server::start(&[]);
    let runs = server.runs();
    fs::write(server.folder.path().join("secret.txt"), "secret").unwrap();
    fs::write(
        server.folder.path().join("secret.json"),
        "{\"state\":\"failed\"}",
    )
    .unwrap();
    fs::create_dir(runs.join("run")).unwrap();
    fs::write(runs.join("run/run.json"), "{}").unwrap();
    fs::write(runs.join("run/poses.csv"), "score\n").unwrap();
    assert_eq!(server.get("/runs/run/poses.csv").body, "score\n");
    #[cfg(unix)]
    {
        std::os::unix::fs::symlink(server.folder.path(), runs.join("link")).unwrap();
        std::os::unix::fs::symlink(
            server.folder.path().join("secret.txt"),
            runs.join("run/link.txt"),
        )
        .unwrap();
        let input = runs.join("serve/inputs/0001");
        fs::create_dir(&input).unwrap();
        std::os::unix::fs::symlink(server.folder.path().join("secret.txt"), input.join("a.pdb"))
            .unwrap();
    }
    let secret = server.folder.path().join("secret.txt");
    let absolute = secret.display().to_string().replace('/', "%2f");
    let addresses = [
        "/runs/run/../../secret.txt",
        "/runs/run/..%2f..%2fsecret.txt",
        "/runs/run/%2e%2e/%2e%2e/secret.txt",
        "/runs/..%2f/secret.txt",
        "/runs/%2e%2e/secret.txt",
        "/runs/./run/../../secret.txt",
        "/runs/serve/lock",
        "/runs/serve/jobs",
        "/runs/link/secret.txt",
        "/runs/run/link.txt",
        "/runs/run/%00",
        "/api/uploads/0001/a.pdb",
        "/api/inspect/0001/a.pdb",
        "/api/uploads/..%2f..%2f../secret.txt",
        "/api/uploads/0001/..%2f..%2f..%2f..%2fsecret.txt",
        "/api/inspect/..%2f..%2f../secret.txt",
        &format!("/runs/run/{absolute}"),
        &format!("/api/uploads/0001/{absolute}"),
        "//etc/passwd",
        "/main.js/../../secret.txt",
    ];
    for address in addresses {
        let answer = server.get(address);
        assert_eq!(answer.status, 404, "{address}: {}", answer.body);
    }
    for (method, address) in [
        ("DELETE", "/api/runs/..%2f..%2f..%2fsecret"),
        ("POST", "/api/runs/..%2f..%2f..%2fsecret/again"),
        ("POST", "/api/runs/..%2f..%2f..%2fsecret/cancel"),
    ] {
        assert_eq!(
            server.send(method, address, &[], b"").status,
            409,
            "{address}"
        );
    }
    assert!(server.folder.path().join("secret.json").exists());
}

/// Names of uploads are names, and never paths or options.
#[test]
fn names_of_uploads_are_no_paths() {
    let server = Server::start(&[]);
    server.send("POST", "/api/uploads", &[], b"");
    for (name, kept) in [
        ("..%2f..%2f..%2fescaped.pdb", "escaped.pdb"),
        ("%2fetc%2fa.pdb", "etc_a.pdb"),
        ("--output=x.pdb", "output_x.pdb"),
        (
            "%3Cimg%20src=x%20onerror=alert(1)%3E.pdb",
            "img_src_x_onerror_alert_1__.pdb",
        ),
        ("a%0d%0aSet-Cookie:%20b.pdb", "a__Set-Cookie__b.pdb"),
    ] {
        let answer = server.send("PUT", &format!("/api/uploads/0001/{name}"), &[], b"END\n");
        assert_eq!(answer.json(), json!({ "name": kept }), "{name}");
        assert!(
            server.runs().join("serve/inputs/0001").join(kept).is_file(),
            "{name}"
        );
    }
    for name in ["run.sh", "pdb", ".pdb", "a.pdb%00.sh", "%2e%2e"] {
        let status = server
            .send("PUT", &format!("/api/uploads/0001/{name}"), &[], b"x")
            .status;
        assert!([404, 415].contains(&status), "{name}: {status}");
    }
    for upload in [
        "0002",
        "..",
        "%2e%2e",
        "..%2finputs%2f0001",
        "0001%2f..%2f..",
    ] {
        let status = server
            .send("PUT", &format!("/api/uploads/{upload}/a.pdb"), &[], b"x")
            .status;
        assert_eq!(status, 404, "{upload}");
    }
    // Nothing replaces a file that a run may have read.
    assert_eq!(
        server
            .send("PUT", "/api/uploads/0001/escaped.pdb", &[], b"x")
            .status,
        409
    );
}

/// An upload has at most 200 MB and 100 files; what is refused leaves nothing.
#[test]
fn uploads_have_limits() {
    let server = Server::start(&[]);
    server.send("POST", "/api/uploads", &[], b"");
    server.send("POST", "/api/uploads", &[], b"");
    for number in 0..100 {
        let address = format!("/api/uploads/0001/{number}.pdb");
        assert_eq!(server.send("PUT", &address, &[], b"END\n").status, 200);
    }
    assert_eq!(
        server
            .send("PUT", "/api/uploads/0001/100.pdb", &[], b"END\n")
            .status,
        413
    );
    let large = vec![b' '; 101 << 20];
    assert_eq!(
        server
            .send("PUT", "/api/uploads/0002/a.pdb", &[], &large)
            .status,
        200
    );
    assert_eq!(
        server
            .send("PUT", "/api/uploads/0002/b.pdb", &[], &large)
            .status,
        413
    );
    let names = |upload: &str| {
        let entries = fs::read_dir(server.runs().join("serve/inputs").join(upload)).unwrap();
        entries.count()
    };
    assert_eq!((names("0001"), names("0002")), (100, 1));
}

/// Requests hold options of the registry that name no files, and files of uploads; nothing else reaches a command line.
#[test]
fn requests_cannot_name_files_or_other_options() {
    let server = Server::start(&[]);
    let request = server.request();
    let with = |change: &dyn Fn(&mut Value)| {
        let mut request = request.clone();
        change(&mut request);
        server.post("/api/runs", &request)
    };
    for name in [
        "output",
        "force",
        "rerun",
        "config",
        "native",
        "restraints",
        "interface_receptor",
        "receptor_also",
        "",
        "x --output",
        "json",
    ] {
        let answer = with(&|request| request["options"][name] = json!("/etc/passwd"));
        assert_eq!(answer.status, 422, "{name}: {}", answer.body);
    }
    for chains in ["/../../../etc/passwd:A", "..\\x"] {
        assert_eq!(
            with(&|request| request["receptor"]["chains"] = json!(chains)).status,
            422,
            "{chains}"
        );
    }
    for file in [
        "../../../secret.txt",
        "/etc/passwd",
        "none.pdb",
        "",
        "--help",
    ] {
        assert_eq!(
            with(&|request| request["ligand"]["files"] = json!([file])).status,
            422,
            "{file}"
        );
    }
    for upload in ["..", "", "../..", "/"] {
        assert_eq!(
            with(&|request| request["receptor"]["upload"] = json!(upload)).status,
            422,
            "{upload}"
        );
    }
    assert_eq!(
        with(&|request| request["preset"] = json!("/etc/passwd")).status,
        422
    );
    assert_eq!(with(&|request| request["more"] = json!(1)).status, 422);
    assert_eq!(server.get("/api/runs").json(), json!([]));
    // A value that looks like options is a value, which the program refuses.
    let answer = with(&|request| request["options"]["rotations"] = json!("1 --output=/tmp/x"));
    let run = answer.json()["run"].as_str().unwrap().to_owned();
    let failed = |server: &Server| {
        let runs = server.get("/api/runs").json();
        (runs[0]["state"] == "failed").then(|| {
            runs[0]["job"]["error"]["message"]
                .as_str()
                .unwrap()
                .to_owned()
        })
    };
    let mut tries = 0..200;
    let message = loop {
        if let Some(message) = failed(&server) {
            break message;
        }
        assert!(tries.next().is_some(), "the run does not end");
        std::thread::sleep(Duration::from_millis(100));
    };
    assert!(message.contains("rotations"), "{message}");
    assert_eq!(
        server
            .send("DELETE", &format!("/api/runs/{run}"), &[], b"")
            .status,
        200
    );
    assert_eq!(server.get("/api/runs").json(), json!([]));
}

/// A report that was written over, or a file that only looks like one, runs no script with the server's rights.
#[test]
fn reports_are_in_a_sandbox_and_other_files_are_saved() {
    let server = Server::start(&[]);
    let run = server.runs().join("run");
    fs::create_dir_all(run.join("top")).unwrap();
    for name in ["run.json", "report.html", "top/evil.html", "evil.svg"] {
        fs::write(run.join(name), "<script>fetch('/api/runs')</script>").unwrap();
    }
    let report = server.get("/runs/run/report.html");
    let policy = report.header("content-security-policy");
    assert!(
        policy.starts_with("sandbox ") && !policy.contains("allow-same-origin"),
        "{policy}"
    );
    for name in ["top/evil.html", "evil.svg", "run.json"] {
        let answer = server.get(&format!("/runs/run/{name}"));
        assert!(
            answer
                .header("content-disposition")
                .starts_with("attachment"),
            "{name}"
        );
        assert_eq!(
            answer.header("content-type"),
            "application/octet-stream",
            "{name}"
        );
    }
    // A record that is none leaves the run in the list.
    assert_eq!(server.get("/api/runs").json()[0]["name"], "run");
}

/// One folder has one server, and a port that is taken is reported.
#[test]
fn a_folder_or_port_in_use_is_refused() {
    let server = Server::start(&[]);
    let error = program::refused(
        server.folder.path(),
        ["serve", "--folder", "runs", "--port", "0", "--no-browser"],
    );
    assert!(
        error["remedy"]
            .as_str()
            .unwrap()
            .contains("another `knotdock serve`"),
        "{error}"
    );
    let port = server.host.rsplit(':').next().unwrap();
    let error = program::refused(
        server.folder.path(),
        [
            "serve",
            "--folder",
            "others",
            "--port",
            port,
            "--no-browser",
        ],
    );
    assert!(error["message"].as_str().unwrap().contains(port), "{error}");
}

/// A command under --events ends when its standard input does, and leaves nothing.
#[test]
fn a_child_ends_with_its_server() {
    let folder = tempfile::tempdir().unwrap();
    let file = |side: &str| {
        Path::new(env!("CARGO_MANIFEST_DIR"))
            .join(format!("../structures/examples/1ppe_{side}_unbound.pdb"))
    };
    let mut child = Command::new(cargo_bin!("knotdock"))
        .current_dir(folder.path())
        .arg("dock")
        .args([file("receptor"), file("ligand")])
        .args(["--rotations", "50000", "--output", "run", "--events"])
        .stdin(Stdio::piped())
        .stdout(Stdio::piped())
        .stderr(Stdio::null())
        .spawn()
        .unwrap();
    let mut lines = BufReader::new(child.stdout.take().unwrap()).lines();
    let event =
        |line: std::io::Result<String>| serde_json::from_str::<Value>(&line.unwrap()).unwrap();
    let mut events = lines.by_ref().map(event);
    events
        .find(|event| event["done"].is_u64())
        .expect("steps of the search");
    drop(child.stdin.take());
    let last = events.last().unwrap();
    assert!(
        last["error"]["message"]
            .as_str()
            .unwrap()
            .contains("interrupted"),
        "{last}"
    );
    assert_eq!(child.wait().unwrap().code(), Some(1));
    assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 0);
}
