// The run that is going on, those that wait, and the list of all.

import { byId, make } from "/report.js";
import { ask, duration, words } from "/server.js";

const STATES = { waiting: "waits", running: "running", done: "done", failed: "failed", cancelled: "cancelled", interrupted: "interrupted: the server ended while it ran" };

/** Follows the queue. `repeat(job)` fills the form with an earlier request. */
export function followRuns(repeat) {
  const events = new EventSource("/api/events");
  let changes = null;
  let before = null;
  events.addEventListener("message", ({ data }) => {
    const queue = JSON.parse(data);
    showRunning(queue);
    if (queue.changes === changes) return;
    changes = queue.changes;
    const ended = before !== null && queue.running?.run !== before ? before : null;
    before = queue.running?.run ?? null;
    list(repeat, ended);
  });
  // The browser connects again by itself; the server may be a new one by then.
  events.addEventListener("error", () => { changes = null; byId("now-stage").textContent = "The server does not answer. This page goes on when it does."; });
}

function showRunning({ running, waiting }) {
  byId("now").hidden = running === null;
  byId("now-waiting").textContent = waiting.length > 0 ? `Waiting: ${waiting.join(", ")}` : "";
  if (running === null) return;
  const { run, stage, done, total, seconds, stage_seconds_left: left } = running;
  byId("now-run").textContent = run;
  const text = stage === "" ? "Reading and planning" : `${stage[0].toUpperCase()}${stage.slice(1)}`;
  // Read out only when it changes.
  if (byId("now-stage").textContent !== text) byId("now-stage").textContent = text;
  const bar = byId("now-bar");
  if (total > 0) { bar.max = total; bar.value = done; } else bar.removeAttribute("value");
  byId("now-left").textContent = `${duration(seconds)} gone${left === null || left === undefined ? "" : `, about ${duration(left)} left in this stage`}`;
  byId("now-cancel").onclick = () => act("POST", run, "/cancel");
}

async function act(method, run, what) {
  try {
    await ask(method, `/api/runs/${encodeURIComponent(run)}${what}`);
    byId("news").textContent = "";
  } catch (error) {
    byId("news").textContent = error.message;
  }
}

async function list(repeat, ended) {
  let runs;
  try {
    runs = await ask("GET", "/api/runs");
  } catch (error) {
    byId("news").textContent = error.message;
    return;
  }
  byId("runs").replaceChildren(...runs.map((run) => item(run, repeat)));
  if (runs.length === 0) byId("runs").append(make("li", {}, "The folder holds no run yet."));
  const over = runs.find(({ name }) => name === ended);
  if (over) {
    const link = over.state === "done" ? [" ", report(over, "Open its report")] : [];
    byId("news").replaceChildren(`${ended}: ${STATES[over.state]}.`, ...link);
  }
}

const address = (run, path) => `/runs/${encodeURIComponent(run)}/${path.split("/").map(encodeURIComponent).join("/")}`;

function report(run, label) {
  return make("a", { href: address(run.name, "report.html"), target: "_blank", rel: "noopener" }, label);
}

function item(run, repeat) {
  const { name, state, sides, settings, best, files = [], job, command } = run;
  const button = (label, click) => make("button", { type: "button", "aria-label": `${label}: ${name}`, click }, label);
  const controls = [];
  if (files.includes("report.html")) controls.push(report(run, "Open the report"));
  if (["waiting", "running"].includes(state)) controls.push(button("Cancel", () => act("POST", name, "/cancel")));
  if (["failed", "cancelled", "interrupted"].includes(state)) {
    controls.push(button("Start again", () => act("POST", name, "/again")), button("Remove from the list", () => act("DELETE", name, "")));
  }
  if (job) controls.push(button("Repeat with changes", () => repeat(job.request)));
  const about = sides ?? (job ? [job.request.receptor, job.request.ligand].filter(Boolean).map(({ files: [file], chains }) => `${file}${chains ? `:${chains}` : ""}`) : []);
  const lines = [make("p", {}, about.join(" and "))];
  const { preset, options = {} } = job?.request ?? {};
  const chosen = settings ?? [...(preset ? [`preset ${preset}`] : []), ...Object.entries(options).map(([option, value]) => `${option.replaceAll("_", "-")} ${value}`)];
  lines.push(make("p", { class: "note" }, chosen.length > 0 ? `Settings: ${chosen.join("; ")}` : "Default settings"));
  if (typeof best?.score === "number") lines.push(make("p", {}, `Best score ${best.score.toFixed(1)}${best.cluster_size ? `, a cluster of ${best.cluster_size}` : ""}`));
  if (state === "failed") lines.push(make("p", { class: "warnings" }, words(job?.error)));
  if (job?.warnings.length > 0) lines.push(make("ul", { class: "warnings" }, ...job.warnings.map((warning) => make("li", {}, warning))));
  const saved = files.filter((file) => file !== "report.html");
  const link = (file) => make("li", {}, make("a", { href: address(name, file), download: true }, file));
  if (saved.length > 0) lines.push(make("details", {}, make("summary", {}, "Files: complexes, table, scripts for PyMOL and ChimeraX"), make("ul", {}, ...saved.map(link))));
  if (command) lines.push(make("details", {}, make("summary", {}, "Command line"), make("p", { class: "note" }, "In the folder of the runs:"), make("pre", {}, command)));
  return make("li", { "data-run": name, "data-state": state }, make("h3", {}, name, " ", make("span", { class: `state ${state}` }, STATES[state])), make("p", { class: "controls" }, ...controls), ...lines);
}
