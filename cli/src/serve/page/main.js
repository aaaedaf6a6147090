// The page to dock from: two sides, settings, and the runs.

import { byId, make } from "/report.js";
import { ask } from "/server.js";
import { Side } from "/side.js";
import { followRuns } from "/runs.js";

// Options that the sides give by their marks.
const OF_SIDES = ["active_receptor", "active_ligand", "block_receptor", "block_ligand"];

const setup = await ask("GET", "/api/setup");
byId("place").textContent = `Runs are folders in ${setup.folder}. knotdock ${setup.version}`;

const sides = Object.fromEntries(["receptor", "ligand"].map((role) => [role, new Side(role, byId(role), setup.library, changed)]));
const fields = fillOptions();
fillPresets();
changed();

function fillPresets() {
  const choice = ({ name, about }) => make("label", {}, make("input", { type: "radio", name: "preset", value: name, checked: name === "default" }), ` ${name}: ${about[0].toLowerCase()}${about.slice(1)}`);
  byId("presets").append(...setup.presets.map(choice));
}

/** A field for each option, by group; `fields` maps names to elements. */
function fillOptions() {
  const all = new Map();
  const groups = Map.groupBy(setup.options.filter(({ name }) => !OF_SIDES.includes(name)), ({ group }) => group);
  for (const [group, options] of groups) {
    const rows = options.map(({ name, long, is_flag: isFlag, choices, value, help, default: byDefault, is_weight: isWeight }) => {
      const field = isFlag ? make("input", { type: "checkbox" })
        : choices ? make("select", {}, make("option", { value: "" }, `${byDefault ?? "none"} (default)`), ...choices.filter((choice) => choice !== byDefault).map((choice) => make("option", {}, choice)))
          : make("input", { type: "text", placeholder: byDefault ?? value, autocomplete: "off", spellcheck: "false" });
      field.addEventListener("change", changed);
      all.set(name, field);
      return make("label", { "data-words": `${long} ${help}`.toLowerCase() }, make("span", {}, isWeight ? name : `--${long}`), field, make("span", { class: "note" }, help.split("\n\n")[0]));
    });
    byId("options").append(make("details", {}, make("summary", {}, group), ...rows));
  }
  byId("find").addEventListener("input", ({ target }) => {
    const wanted = target.value.trim().toLowerCase();
    for (const group of byId("options").children) {
      const rows = [...group.querySelectorAll("label")];
      for (const row of rows) row.hidden = !row.dataset.words.includes(wanted);
      group.hidden = rows.every((row) => row.hidden);
      group.open = wanted !== "" && !group.hidden;
    }
  });
  return all;
}

function valueOf(field) {
  return field.type === "checkbox" ? (field.checked ? "true" : "") : field.value.trim();
}

function givenOptions() {
  return Object.fromEntries([...fields].map(([name, field]) => [name, valueOf(field)]).filter(([, value]) => value !== ""));
}

/** The request of the form, or a sentence on what it lacks. */
function request() {
  const options = givenOptions();
  const [receptor, ligand] = ["receptor", "ligand"].map((role) => sides[role].request());
  const isRing = options.symmetry !== undefined;
  if (receptor === null) return { lack: "Drop a receptor." };
  if (ligand === null && !isRing) return { lack: "Drop a ligand, or set --symmetry for a ring of copies of the receptor." };
  if ([receptor, isRing ? null : ligand].some((side) => side?.isEmpty)) return { lack: "Pick a chain of each side." };
  const preset = document.querySelector("[name=preset]:checked").value;
  return {
    receptor: receptor.side,
    ligand: isRing ? null : ligand.side,
    preset: preset === "default" ? null : preset,
    options: { ...options, ...receptor.options, ...(isRing ? {} : ligand.options) },
  };
}

function changed() {
  const count = Object.keys(givenOptions()).length;
  byId("changed").textContent = count > 0 ? `(${count} changed)` : "";
  const { lack } = request();
  byId("start").disabled = lack !== undefined;
  byId("hint").textContent = lack ?? "";
}

byId("start").addEventListener("click", async () => {
  byId("start").disabled = true;
  byId("fault").textContent = "";
  try {
    const { run } = await ask("POST", "/api/runs", JSON.stringify(request()));
    byId("news").textContent = `${run} is in the queue.`;
  } catch (error) {
    byId("fault").textContent = error.message;
  }
  changed();
});

/** Fills the form with an earlier request. */
async function repeat({ receptor, ligand, preset, options }) {
  document.querySelector(`[name=preset][value="${CSS.escape(preset ?? "default")}"]`).checked = true;
  for (const [name, field] of fields) {
    if (field.type === "checkbox") field.checked = options[name] === "true";
    else field.value = options[name] ?? "";
  }
  byId("new").scrollIntoView();
  byId("new-heading").tabIndex = -1;
  byId("new-heading").focus();
  const marked = (role) => ({ active: options[`active_${role}`], blocked: options[`block_${role}`] });
  await Promise.all([sides.receptor.load(receptor, marked("receptor")), ligand ? sides.ligand.load(ligand, marked("ligand")) : sides.ligand.clear()]);
  changed();
}

followRuns(repeat);
// For tests of the page.
window.knotdock = { sides };
