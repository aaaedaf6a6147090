// The view of one side in three dimensions: 3Dmol.js, whose library is loaded once.

import { make, makeScene } from "/report.js";

const PLAIN = "#bfbfbf";
const FADED = 0.25;
const COLOURS = { active: "#8a2c66", blocked: "#000000" };

let loading = null;

/** Loads the library; from its public address only if this build lacks it and someone presses the button. */
function load({ address, integrity }) {
  loading ??= new Promise((loaded, failed) => {
    document.head.append(make("script", { src: address, integrity: integrity ?? null, crossorigin: integrity ? "anonymous" : null, load: loaded, error: () => failed(new Error("The view could not be loaded.")) }));
  });
  return loading;
}

/** The view in an element. `pick(chain, number)` is called for a residue that is clicked. */
export class View {
  constructor(root, library, pick) {
    Object.assign(this, { root, library, pick, viewer: null });
  }

  async show(content) {
    this.content = content;
    if (this.library.integrity && !loading) {
      const button = make("button", { type: "button", click: () => { load(this.library).catch(() => {}); document.dispatchEvent(new Event("view-loads")); } }, "Load the view from cdn.jsdelivr.net");
      this.root.replaceChildren(make("p", { class: "note" }, "This build has no view in three dimensions. ", button));
      document.addEventListener("view-loads", () => this.draw(), { once: true });
      return;
    }
    await this.draw();
  }

  async draw() {
    try {
      await load(this.library);
    } catch (error) {
      this.root.replaceChildren(make("p", { class: "note" }, error.message));
      return;
    }
    this.root.replaceChildren();
    const { text, format, surface } = this.content;
    if (surface) makeScene(this.root, { bodies: [{ format: "mesh", ...surface }], placed: [] });
    else if (text !== undefined) {
      this.viewer = window.$3Dmol.createViewer(this.root, { backgroundColor: "white", antialias: true, disableFog: true });
      this.model = this.viewer.addModel(text, format, { keepH: false, assignBonds: true });
      this.viewer.setClickable({}, true, (atom) => this.pick(nameOf(atom.chain), `${atom.resi}${(atom.icode ?? "").trim()}`));
      this.paint();
      this.viewer.zoomTo();
      this.viewer.render();
    }
    this.root.dataset.drawn = "true";
  }

  /** Shows which chains are picked, and the marks: maps of `chain:number` to a colour's name. */
  paint(picked = this.picked ?? null, marks = this.marks ?? new Map()) {
    Object.assign(this, { picked, marks });
    if (!this.viewer || !this.model) return;
    const isPicked = ({ chain }) => picked === null || picked.has(nameOf(chain));
    this.model.setStyle({}, { cartoon: { color: PLAIN, opacity: FADED } });
    this.model.setStyle({ predicate: isPicked }, { cartoon: { color: PLAIN } });
    this.model.setStyle({ hetflag: true }, { stick: { radius: 0.15, color: PLAIN } });
    const marked = (wanted) => ({ chain, resi, icode }) => marks.get(`${nameOf(chain)}:${resi}${(icode ?? "").trim()}`) === wanted;
    for (const [mark, color] of Object.entries(COLOURS)) {
      this.model.setStyle({ predicate: marked(mark) }, { cartoon: { color }, stick: { radius: 0.3, color } });
    }
    this.viewer.render();
  }
}

/** A chain's name as options write it. */
export function nameOf(chain) {
  return (chain ?? "").trim() || "_";
}
