// One side of a docking: its files, what was read of them, the chains that are picked and the residues that are marked.

import { make } from "/report.js";
import { ask, textOf } from "/server.js";
import { View, nameOf } from "/view.js";

const KNOWN = /\.(pdb|ent|cif|mmcif|stl|obj|ply|off|csv|sph|yml)(\.gz)?$/i;

export class Side {
  /** `role` is receptor or ligand; `changed` is called when its request may have changed. */
  constructor(role, root, library, changed) {
    Object.assign(this, { role, changed, upload: null, files: [], chains: [], marks: new Map(), isMesh: false, serial: 0 });
    const file = (label, extra) => make("label", { class: "button" }, label, make("input", { type: "file", class: "hidden", ...extra, change: ({ target }) => { this.receive([...target.files]); target.value = ""; } }));
    this.drop = make("div", { class: "drop" }, make("p", {}, `Drop the ${role} here: a file, or the models of a folder`), file("Choose a file", { multiple: true }), " ", file("Choose a folder", { webkitdirectory: true }));
    this.read = make("p", { role: "status" });
    this.warnings = make("ul", { class: "warnings", hidden: true });
    this.picks = make("div", { class: "controls", role: "group", "aria-label": `Chains of the ${role}` });
    this.mode = "active";
    const mode = (name, label) => make("label", {}, make("input", { type: "radio", name: `${role}-mode`, value: name, checked: name === "active", change: () => { this.mode = name; } }), make("span", { class: `swatch ${name}` }), ` ${label}`);
    this.count = make("span", { class: "note" });
    const clear = make("button", { type: "button", click: () => { this.marks.clear(); this.paint(); } }, "Clear marks");
    this.marking = make("div", { class: "controls", role: "group", "aria-label": `Marks of the ${role}` }, "A click marks a residue as", mode("active", "active (thought to be in contact)"), mode("blocked", "blocked (not in contact)"), clear, this.count);
    this.sequence = make("div", { class: "sequence" });
    this.scene = make("div", { class: "scene", role: "img", "aria-label": `The ${role} in three dimensions` });
    this.report = make("pre");
    this.details = make("details", {}, make("summary", {}, "All that was read and dropped"), this.report);
    this.parts = [this.warnings, this.picks, this.marking, this.sequence, this.scene, this.details];
    root.append(this.drop, this.read, ...this.parts);
    this.view = new View(this.scene, library, (chain, number) => this.toggle(chain, number));
    this.dropped();
    this.show(false);
  }

  show(on) {
    for (const part of this.parts) part.hidden = !on;
    const isMolecule = on && !this.isMesh;
    for (const part of [this.picks, this.marking, this.sequence]) part.hidden = !isMolecule;
    this.warnings.hidden = this.warnings.childElementCount === 0;
  }

  dropped() {
    const over = (on) => (event) => { event.preventDefault(); this.drop.classList.toggle("over", on); };
    this.drop.addEventListener("dragover", over(true));
    this.drop.addEventListener("dragleave", over(false));
    this.drop.addEventListener("drop", async (event) => {
      over(false)(event);
      const entries = [...event.dataTransfer.items].map((item) => item.webkitGetAsEntry?.()).filter(Boolean);
      const files = entries.length > 0 ? (await Promise.all(entries.map(filesOf))).flat() : [...event.dataTransfer.files];
      this.receive(files);
    });
  }

  /** Sends files to the server; all but the first are further conformations. */
  async receive(files) {
    const known = files.filter(({ name }) => files.length === 1 || KNOWN.test(name)).sort((a, b) => placeOf(a).localeCompare(placeOf(b), "en", { numeric: true }));
    if (known.length === 0) {
      if (files.length > 0) this.read.textContent = "There is no structure and no mesh among these files.";
      return;
    }
    const serial = ++this.serial;
    this.clear();
    try {
      const { upload } = await ask("POST", "/api/uploads");
      const names = [];
      for (const file of known) {
        this.read.textContent = `Sending ${file.name} …`;
        // Samples of a predictor have one name in folders of different names.
        const { name } = await ask("PUT", `/api/uploads/${upload}/${encodeURIComponent(placeOf(file))}`, file, "application/octet-stream");
        names.push(name);
      }
      if (serial === this.serial) await this.load({ upload, files: names, chains: "" });
    } catch (error) {
      if (serial === this.serial) this.read.textContent = error.message;
    }
  }

  clear() {
    Object.assign(this, { upload: null, files: [], chains: [] });
    this.marks.clear();
    this.show(false);
    this.changed();
  }

  /** Shows an upload, with the chains and marks that an earlier run had of it. */
  async load({ upload, files, chains }, marked = {}) {
    const serial = ++this.serial;
    this.clear();
    this.read.textContent = `Reading ${files[0]} …`;
    try {
      const { result, error, warnings, text } = await ask("GET", `/api/inspect/${upload}/${encodeURIComponent(files[0])}`);
      if (serial !== this.serial) return;
      if (error) throw new Error([error.message, error.line ? `line ${error.line}` : null, error.remedy].filter(Boolean).join("; "));
      Object.assign(this, { upload, files, isMesh: result.chains === undefined });
      this.report.textContent = text ?? "";
      this.warnings.replaceChildren(...warnings.map((warning) => make("li", {}, warning)));
      const others = files.length > 1 ? `, and ${files.length - 1} more as conformations` : "";
      if (this.isMesh) this.read.textContent = `${files[0]}: a mesh${others}. ${text ?? ""}`;
      else {
        this.chains = result.chains.map(({ chain, residues }) => ({ name: nameOf(chain), residues }));
        const residues = this.chains.reduce((sum, chain) => sum + chain.residues.length, 0);
        this.read.textContent = `${files[0]}${others}: ${this.chains.length} ${this.chains.length === 1 ? "chain" : "chains"}, ${residues} residues, ${result.input.atoms} atoms are kept.`;
        const picked = new Set(chains.split(",").filter(Boolean).map((part) => part.split(":")[0]));
        this.fillChains(picked);
        this.fillSequence();
        this.markAll(marked.active, "active");
        this.markAll(marked.blocked, "blocked");
      }
      this.show(true);
      const format = /\.(cif|mmcif)(\.gz)?$/i.test(files[0]) ? "cif" : "pdb";
      await this.view.show(this.isMesh ? { surface: result.surface?.positions ? result.surface : null } : { text: await textOf(upload, files[0]), format });
      this.paint();
    } catch (error) {
      if (serial === this.serial) this.read.textContent = `${files[0]}: ${error.message}`;
    }
    this.changed();
  }

  fillChains(picked) {
    const box = ({ name, residues }) => make("label", {}, make("input", { type: "checkbox", value: name, checked: picked.size === 0 || picked.has(name), change: () => this.paint() }), ` ${name} (${residues.length})`);
    this.picks.replaceChildren("Chains", ...this.chains.map(box));
  }

  fillSequence() {
    this.sequence.replaceChildren(...this.chains.flatMap(({ name, residues }) => {
      const list = make("div", { class: "residues", role: "listbox", "aria-multiselectable": "true", "aria-label": `Residues of chain ${name}` });
      const option = ({ number, name: residue, letter }, at) => make("span", { role: "option", tabindex: at === 0 ? "0" : "-1", title: `${residue} ${number}`, "data-key": `${name}:${number}` }, letter);
      list.append(...residues.flatMap((residue, at) => (at % 10 === 9 ? [option(residue, at), " "] : [option(residue, at)])));
      list.addEventListener("click", ({ target }) => { if (target.dataset.key) this.toggleKey(target.dataset.key); });
      list.addEventListener("keydown", (event) => this.step(event, list));
      return [make("h3", {}, `Chain ${name}`), list];
    }));
  }

  /** Arrow keys go along a sequence, space and enter mark. */
  step(event, list) {
    const at = [...list.children].indexOf(event.target);
    if (event.key === " " || event.key === "Enter") this.toggleKey(event.target.dataset.key);
    else {
      const to = { ArrowRight: at + 1, ArrowLeft: at - 1, ArrowDown: at + 10, ArrowUp: at - 10, Home: 0, End: list.childElementCount - 1 }[event.key];
      const next = list.children[to];
      if (to === undefined) return;
      if (next) {
        event.target.tabIndex = -1;
        next.tabIndex = 0;
        next.focus();
      }
    }
    event.preventDefault();
  }

  toggle(chain, number) {
    this.toggleKey(`${chain}:${number}`);
  }

  toggleKey(key) {
    if (!this.chains.some(({ name, residues }) => residues.some(({ number }) => `${name}:${number}` === key))) return;
    if (this.marks.get(key) === this.mode) this.marks.delete(key);
    else this.marks.set(key, this.mode);
    this.paint();
  }

  /** Chains that are picked; all if none is left out. */
  picked() {
    const boxes = [...this.picks.querySelectorAll("input")];
    const names = boxes.filter((box) => box.checked).map((box) => box.value);
    return { names, all: names.length === boxes.length };
  }

  paint() {
    for (const element of this.sequence.querySelectorAll("[data-key]")) {
      const mark = this.marks.get(element.dataset.key);
      element.classList.toggle("active", mark === "active");
      element.classList.toggle("blocked", mark === "blocked");
      element.setAttribute("aria-selected", String(mark !== undefined));
      element.setAttribute("aria-label", `${element.title}${mark ? `, ${mark}` : ""}`);
    }
    const counts = ["active", "blocked"].map((mark) => `${[...this.marks.values()].filter((value) => value === mark).length} ${mark}`);
    this.count.textContent = counts.join(", ");
    if (this.isMesh || this.chains.length === 0) return;
    this.view.paint(new Set(this.picked().names), this.marks);
    this.changed();
  }

  /** Marks the residues of a selection as options write it. */
  markAll(selection, mark) {
    let chain = null;
    for (const part of (selection ?? "").split(",").filter(Boolean)) {
      const [, named, residues] = /^(?:([^:]+):)?(.*)$/.exec(part);
      chain = named ?? chain;
      const list = this.chains.find(({ name }) => name === chain)?.residues ?? [];
      const [first, last] = /^(-?\d+[A-Za-z]?)-(-?\d+[A-Za-z]?)$/.exec(residues)?.slice(1) ?? [residues, residues];
      const [from, to] = [first, last].map((wanted) => list.findIndex(({ number }) => number === wanted));
      if (from >= 0) for (const { number } of list.slice(from, to + 1)) this.marks.set(`${chain}:${number}`, mark);
    }
  }

  /** The marked residues as options write them: A:57,A:189-195. */
  selection(mark) {
    const names = new Set(this.picked().names);
    const parts = this.chains.filter(({ name }) => names.has(name)).flatMap(({ name, residues }) => {
      const runs = [];
      let open = false;
      for (const { number } of residues) {
        const isMarked = this.marks.get(`${name}:${number}`) === mark;
        if (isMarked && open) runs.at(-1).push(number);
        else if (isMarked) runs.push([number]);
        open = isMarked && !number.startsWith("-");
      }
      return runs.map((run) => `${name}:${run.length > 1 ? `${run[0]}-${run.at(-1)}` : run[0]}`);
    });
    return parts.join(",");
  }

  /** The side of a request, with its options; null without a file. */
  request() {
    if (this.upload === null) return null;
    const { names, all } = this.picked();
    const options = {};
    if (!this.isMesh) {
      for (const [mark, option] of [["active", "active"], ["blocked", "block"]]) {
        const selection = this.selection(mark);
        if (selection !== "") options[`${option}_${this.role}`] = selection;
      }
    }
    return { side: { upload: this.upload, files: this.files, chains: this.isMesh || all ? "" : names.join(",") }, options, isEmpty: !this.isMesh && names.length === 0 };
  }
}

/** The path of a file in the folder that was chosen or dropped; its name if it came alone. */
function placeOf(file) {
  const path = file.webkitRelativePath || file.droppedPath || file.name;
  return path.split("/").filter(Boolean).slice(path.includes("/") ? 1 : 0).join("_") || file.name;
}

/** All files of a dropped entry. */
async function filesOf(entry) {
  if (entry.isFile) {
    const file = await new Promise((done, failed) => entry.file(done, failed));
    // A path such as /folder/seed-1/model.cif; of a file that was dropped alone /model.cif.
    if (entry.fullPath.lastIndexOf("/") > 0) file.droppedPath = entry.fullPath.slice(1);
    return [file];
  }
  const reader = entry.createReader();
  const files = [];
  for (;;) {
    const entries = await new Promise((done, failed) => reader.readEntries(done, failed));
    if (entries.length === 0) return files;
    files.push(...(await Promise.all(entries.map(filesOf))).flat());
  }
}
