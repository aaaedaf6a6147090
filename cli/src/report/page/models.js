const PLDDT = [[90, "#0053d6", "above 90"], [70, "#65cbf3", "70 to 90"], [50, "#ffdb13", "50 to 70"], [-Infinity, "#ff7d45", "below 50"]];

/** A report of predicted models: a row is a pair of chains of one. */
async function showModels(data) {
  let scene = null;
  let chosen = -1;
  const column = (name) => data.columns.findIndex((one) => one.name === name);
  const table = makeTable(byId("list-table"), { caption: data.caption, columns: data.columns, rows: data.rows, choose, empty: "No results" });
  filterByText(table, data);
  const showPae = paeMap(data);

  function choose(row) {
    chosen = row;
    table.mark(row);
    const value = (name) => data.rows[row][column(name)];
    const chains = chainsOf(data, row).map(({ name }) => name);
    byId("selected").textContent = `Selected: chains ${chains.join(" and ")} of ${value("file")}, ${value("trust")}.`;
    // The evidence has no names of files or chains.
    const parts = value("evidence").split("; ").map((part) => part.match(/^(\S+) (.*)$/s)).filter(Boolean);
    byId("evidence").replaceChildren(...parts.flatMap(([, name, text]) => [make("dt", {}, name), make("dd", {}, text)]));
    byId("scene").setAttribute("aria-label", `Chains ${chains.join(" and ")} of ${value("file")}, turned with the mouse or the arrow keys`);
    showPae(row);
    draw();
  }

  function draw() {
    if (!scene) return;
    const model = data.models[data.pairs[chosen].model];
    byId("no-structure").hidden = model.text !== null;
    const byPlddt = byId("colour-by").value === "plddt" && model.has_plddt;
    scene.show(data.pairs[chosen], byPlddt);
    const names = chainsOf(data, chosen).map(({ name }) => name);
    const entries = byPlddt ? PLDDT.map(([, colour, text]) => [colour, text]) : [[LIGANDS[0], `chain ${names[0]}`], [LIGANDS[1], `chain ${names[1]}`], [RECEPTOR, "other chains"]];
    byId("legend").replaceChildren(...legend(byPlddt || model.chains.length > 2 ? entries : entries.slice(0, 2)).children);
  }

  await withLibrary(["scene", "legend", "colour-by", "zoom-interface", "zoom-all"], () => {
    scene = modelScene(byId("scene"), data);
    byId("zoom-all").addEventListener("click", () => scene.whole());
    byId("zoom-interface").addEventListener("click", () => scene.toInterface());
    byId("colour-by").addEventListener("change", draw);
    byId("colour-by").closest("label").hidden = !data.models.some((model) => model.has_plddt);
    turnByKeys(byId("scene"), scene);
    if (chosen >= 0) draw();
  });
  if (data.rows.length > 0) choose(0);
  window.knotdock = { choose, picture: () => scene?.picture() };
}

/** Both chains of a row. */
function chainsOf(data, row) {
  const { model, chains } = data.pairs[row];
  return chains.map((chain) => data.models[model].chains[chain]);
}

/** The view of one model at a time. */
function modelScene(root, data) {
  const viewer = window.$3Dmol.createViewer(root, { backgroundColor: "white", antialias: true, preserveDrawingBuffer: true, disableFog: true });
  let shown = null;
  let interfaceAtoms = [];
  const fit = (selection) => {
    viewer.resize();
    viewer.zoomTo(selection);
    viewer.zoom(0.9 * Math.min(1, root.clientWidth / Math.max(root.clientHeight, 1)));
    viewer.render();
  };
  const picture = make("img", { alt: "The selected model" });
  root.append(picture);
  window.addEventListener("beforeprint", () => { picture.src = viewer.pngURI(); });
  window.addEventListener("resize", () => viewer.resize());
  return {
    show({ model: place, chains }, byPlddt) {
      const model = data.models[place];
      const isNew = shown !== place;
      if (isNew) viewer.removeAllModels();
      shown = place;
      if (model.text === null) { interfaceAtoms = []; viewer.render(); return; }
      if (isNew) viewer.addModel(model.text, model.format, { keepH: true, altLoc: "*", assignBonds: true });
      const atoms = viewer.selectedAtoms({});
      // Atoms are written chain by chain.
      const ends = model.chains.reduce((all, { atoms }) => [...all, (all.at(-1) ?? 0) + atoms], []);
      const chainOf = (atom) => ends.findIndex((end) => atom.index < end);
      const scale = atoms.every((atom) => atom.b <= 1) ? 100 : 1;
      const colour = byPlddt
        ? (atom) => PLDDT.find(([least]) => atom.b * scale >= least)[1]
        : (atom) => ({ [chains[0]]: LIGANDS[0], [chains[1]]: LIGANDS[1] })[chainOf(atom)] ?? RECEPTOR;
      viewer.setStyle({}, { cartoon: { colorfunc: colour, arrows: true } });
      viewer.setStyle({ hetflag: true }, { stick: { radius: 0.15, colorfunc: colour }, sphere: { radius: 0.35, colorfunc: colour } });
      const sides = chains.map((chain) => atoms.filter((atom) => chainOf(atom) === chain));
      interfaceAtoms = near(sides);
      if (isNew) fit({}); else viewer.render();
    },
    whole() { fit({}); },
    toInterface() { if (interfaceAtoms.length > 0) fit({ index: interfaceAtoms }); },
    picture: () => viewer.pngURI(),
    turn(angle, axis) { viewer.rotate(angle, axis); },
  };
}

/** Indices of the atoms of two sides that are within 5 Å of the other side, found by cells of that size. */
function near(sides) {
  const cell = (atom, [i, j, k] = [0, 0, 0]) => `${Math.floor(atom.x / 5) + i},${Math.floor(atom.y / 5) + j},${Math.floor(atom.z / 5) + k}`;
  const steps = [-1, 0, 1].flatMap((i) => [-1, 0, 1].flatMap((j) => [-1, 0, 1].map((k) => [i, j, k])));
  const grids = sides.map((side) => {
    const grid = new Map();
    for (const atom of side) grid.set(cell(atom), [...grid.get(cell(atom)) ?? [], atom]);
    return grid;
  });
  const touches = (atom, grid) => steps.some((step) => (grid.get(cell(atom, step)) ?? []).some((other) => (atom.x - other.x) ** 2 + (atom.y - other.y) ** 2 + (atom.z - other.z) ** 2 < 25));
  return sides.flatMap((side, place) => side.filter((atom) => touches(atom, grids[1 - place])).map((atom) => atom.index));
}

/** The map of PAE, whose cells are read with the mouse or the arrow keys; the function that draws a row's. */
function paeMap(data) {
  const canvas = byId("pae-map");
  let state = null;

  function draw() {
    const { side, cells, border, at } = state;
    const zoom = Math.max(1, Math.floor(480 / side));
    canvas.width = canvas.height = zoom * side;
    const context = canvas.getContext("2d");
    for (let row = 0; row < side; row += 1) {
      for (let column = 0; column < side; column += 1) {
        const dark = Math.min(1, cells[row * side + column] * data.step / 30);
        context.fillStyle = shade(dark);
        context.fillRect(zoom * column, zoom * row, zoom, zoom);
      }
    }
    context.fillStyle = "#000000";
    context.fillRect(zoom * border, 0, 1, canvas.height);
    context.fillRect(0, zoom * border, canvas.width, 1);
    if (!at) return;
    context.strokeStyle = "#d55e00";
    context.lineWidth = 2;
    context.strokeRect(zoom * at[1] - 2, zoom * at[0] - 2, zoom + 4, zoom + 4);
  }

  function point(at) {
    const { side, cells, names } = state;
    state.at = at.map((part) => Math.min(Math.max(part, 0), side - 1));
    draw();
    const [row, column] = state.at;
    const value = cells[row * side + column];
    byId("pae-value").textContent = `${names(row)} aligned, ${names(column)} scored: ${value === 255 ? "31.9 Å or more" : `${(value * data.step).toFixed(1)} Å`}`;
  }

  canvas.addEventListener("keydown", (event) => {
    const step = { ArrowUp: [-1, 0], ArrowDown: [1, 0], ArrowLeft: [0, -1], ArrowRight: [0, 1] }[event.key];
    if (!step || !state) return;
    const [row, column] = state.at ?? [-step[0], -step[1]];
    point([row + step[0], column + step[1]]);
    event.preventDefault();
  });
  canvas.addEventListener("pointermove", (event) => {
    if (!state) return;
    const { left, top, width } = canvas.getBoundingClientRect();
    point([event.clientY - top, event.clientX - left].map((part) => Math.floor(part / width * state.side)));
  });

  return (row) => {
    const { map, has_pae: hasPae } = data.pairs[row];
    const chains = chainsOf(data, row);
    canvas.hidden = map === null;
    byId("pae-value").textContent = "";
    byId("pae-cells").textContent = "";
    byId("no-pae").hidden = map !== null;
    byId("no-pae").textContent = hasPae ? "The report does not hold this map." : "The confidence files have no PAE.";
    state = null;
    if (map === null) return;
    const cells = Uint8Array.from(atob(map), (character) => character.charCodeAt(0));
    const side = Math.round(Math.sqrt(cells.length));
    const residues = chains.flatMap(({ name, numbers }) => numbers.map((number) => `${name || "_"}:${number}`));
    const first = (cell) => Math.floor(cell * residues.length / side);
    const names = (cell) => {
      const [from, to] = [residues[first(cell)], residues[first(cell + 1) - 1]];
      return from === to ? from : `${from} to ${to}`;
    };
    state = { side, cells, names, at: null, border: Math.round(chains[0].numbers.length * side / residues.length) };
    if (side < residues.length) byId("pae-cells").textContent = `Each cell is the mean of up to ${Math.ceil(residues.length / side)} by ${Math.ceil(residues.length / side)} residues.`;
    canvas.setAttribute("aria-label", `PAE of chains ${chains.map(({ name }) => name).join(" and ")}, read with the mouse or the arrow keys`);
    draw();
  };
}
