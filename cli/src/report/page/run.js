// Clusters that are shown and saved together.
const BEST = 10;
const CLASSES = ["incorrect", "acceptable", "medium", "high"];

/** The report of a run. */
async function showRun(data) {
  const column = (name) => data.columns.findIndex((one) => one.name === name);
  const isMesh = data.bodies[0].format === "mesh";
  const { sides } = data;
  const show = (selector, on) => document.querySelectorAll(selector).forEach((element) => { element.hidden = !on; });
  show(".of-molecules", !isMesh);
  show(".of-native", column("capri") >= 0);
  show(".of-overlay", data.overlay !== undefined);
  show(".of-known", !isMesh && data.bodies.some((body) => body.active.length + body.blocked.length > 0));
  const clusters = data.rows.map((row) => row[column("cluster")] ?? null);
  show(".of-clusters", new Set(clusters).size < clusters.length);
  let chosen = -1;
  let scene = null;

  const table = makeTable(byId("pose-table"), { caption: "Ranked poses. Choose a row to see it.", columns: data.columns, rows: data.rows, choose });
  const pairs = isMesh ? null : makeTable(byId("interface-table"), { caption: "Pairs of residues in contact", columns: INTERFACE_COLUMNS, rows: [], empty: "No residues touch" });
  if (!isMesh) drawConsensus(data, sides);
  const axes = funnelAxes(data, column);
  const axis = byId("funnel-axis");
  axis.replaceChildren(...axes.map(([name, label]) => make("option", { value: name }, label)));
  const points = isMesh ? corners(data.bodies[1].positions ?? []) : caAtoms(data.bodies[1]);

  function drawFunnelOf(row) {
    const found = axes.find(([name]) => name === axis.value);
    if (found) drawFunnel(data, column, row, ...found, points, choose);
  }

  function choose(row) {
    chosen = row;
    table.mark(row);
    scene?.show(row);
    drawTerms(data, column, row, choose);
    drawDistribution(data, column, row);
    drawFunnelOf(row);
    drawCluster(data.clusters?.[clusters[row] - 1], isMesh);
    const rank = data.rows[row][column("rank")];
    let words = `Selected: rank ${rank}, score ${shownNumber(data.rows[row][column("score")], 1)}`;
    if (column("dockq") >= 0) words += `, DockQ ${shownNumber(data.rows[row][column("dockq")], 2)} (${data.rows[row][column("capri")]})`;
    if (!isMesh) {
      drawMap(data, row, sides);
      const found = interfaceRows(data, row);
      pairs.replace(found);
      words += `; ${found.length} pairs of residues in contact`;
    }
    byId("selected").textContent = words + ".";
    byId("scene").setAttribute("aria-label", `The pose of rank ${rank}, turned with the mouse or the arrow keys`);
  }

  function filter() {
    const least = byId("filter-score").value === "" ? -Infinity : Number(byId("filter-score").value);
    const least_class = CLASSES.indexOf(byId("filter-class").value);
    const wanted = byId("filter-residue").value.trim();
    const touched = wanted && !isMesh ? matching(data.bodies, wanted) : null;
    const firsts = firstsOf(clusters);
    table.filter((row) => {
      const fields = data.rows[row];
      return (fields[column("score")] ?? -Infinity) >= least
        && (least_class < 0 || CLASSES.indexOf(fields[column("capri")]) >= least_class)
        && (!byId("filter-first").checked || firsts[row])
        && (touched === null || pairsOf(data, row).some(([first, second]) => touched[0].has(first) || touched[1].has(second)));
    });
  }

  const filters = byId("filters");
  filters.addEventListener("input", filter);
  filters.addEventListener("submit", (event) => event.preventDefault());
  filters.addEventListener("reset", () => setTimeout(() => { filter(); table.showAll(false); }));
  byId("all-columns").addEventListener("change", (event) => table.showAll(event.target.checked));
  axis.addEventListener("change", () => drawFunnelOf(chosen));
  byId("download").addEventListener("click", () => download(data, [chosen], column));
  byId("download-best").addEventListener("click", () => download(data, bestRows(clusters), column));
  const cannot = data.bodies.some((body) => body.format !== "pdb");
  if (cannot && !isMesh) for (const id of ["download", "download-best"]) set(byId(id), { disabled: true, title: "PDB cannot hold these molecules; `knotdock export` writes mmCIF" });

  await withLibrary(["scene", "legend", "zoom-all", "zoom-interface", "show-sticks", "show-known", "show-overlay", "colour-by"], () => {
    if (data.rows.length === 0) return;
    scene = makeScene(byId("scene"), data);
    wire(scene, data, isMesh);
    scene.small(() => drawBest(scene, data, bestRows(clusters), column, choose));
    scene.show(Math.max(chosen, 0));
  });
  if (data.rows.length > 0) choose(0);
  window.knotdock = { choose, picture: () => scene?.picture() };
}

/** Whether each row is the first of its cluster. */
function firstsOf(clusters) {
  const seen = new Set();
  return clusters.map((cluster) => { const is = cluster === null || !seen.has(cluster); seen.add(cluster); return is; });
}

/** The first rows of the best clusters. */
function bestRows(clusters) {
  return firstsOf(clusters).flatMap((is, row) => is ? [row] : []).slice(0, BEST);
}

/** Small pictures of some rows, each of which selects its row. */
function drawBest(scene, data, rows, column, choose) {
  byId("best").replaceChildren(...rows.map((row) => {
    scene.show(row);
    const rank = data.rows[row][column("rank")];
    const picture = make("img", { src: scene.picture(), alt: `Rank ${rank}` });
    return make("button", { type: "button", click: () => choose(row) }, picture, make("span", { "aria-hidden": "true" }, String(rank)));
  }));
}

/** Connects the controls of the view. */
function wire(scene, data, isMesh) {
  const on = (id, event, act) => byId(id).addEventListener(event, act);
  on("show-sticks", "change", (event) => scene.style({ sticks: event.target.checked }));
  on("show-known", "change", (event) => scene.style({ known: event.target.checked }));
  on("show-overlay", "change", (event) => { scene.style({ overlay: event.target.checked }); drawLegend(data, isMesh); });
  on("colour-by", "change", (event) => { scene.style({ colour: event.target.value }); drawLegend(data, isMesh); });
  on("zoom-interface", "click", () => scene.toInterface());
  on("zoom-all", "click", () => scene.whole());
  turnByKeys(byId("scene"), scene);
  drawLegend(data, isMesh);
}

function drawLegend(data, isMesh) {
  const entries = byId("colour-by").value === "consensus"
    ? [[shade(0), "touched by no cluster"], [shade(0.5), "by half"], [shade(1), `by all ${data.counted}`]]
    : [[RECEPTOR, data.sides[0]], ...LIGANDS.slice(0, isMesh ? 1 : data.placed[0].length).map((colour) => [colour, data.sides[1]])];
  if (!isMesh && data.bodies.some((body) => body.active.length > 0)) entries.push([KNOWN, "active residues"]);
  if (!isMesh && data.bodies.some((body) => body.blocked.length > 0)) entries.push([BLOCKED, "blocked residues"]);
  if (byId("show-overlay").checked) entries.push([OVERLAY, "known complex"]);
  byId("legend").replaceChildren(...legend(entries).children);
}

/** CA atoms of a molecule that came as PDB, else none; of a molecule without any, all atoms. */
function caAtoms(body) {
  if (body.format !== "pdb") return [];
  const atoms = pdbAtoms(body.text);
  const traces = atoms.filter((atom) => atom.name === "CA");
  return (traces.length > 0 ? traces : atoms).map((atom) => atom.at);
}

/** Up to some 500 vertices of a mesh. */
function corners(positions) {
  const points = [];
  const step = 3 * Math.max(1, Math.floor(positions.length / 1500));
  for (let at = 0; at + 2 < positions.length; at += step) points.push(positions.slice(at, at + 3));
  return points;
}

/** Residues of either side that a text such as A:57, A or 57 means. */
function matching(bodies, wanted) {
  const [chain, number] = wanted.includes(":") ? wanted.split(":") : [null, wanted];
  return bodies.map((body) => new Set(body.residues.flatMap(([ownChain, ownNumber], place) => {
    const is = chain === null
      ? ownNumber === number || ownChain === number
      : (chain === "_" ? ownChain === "" : ownChain === chain) && (number === "" || ownNumber === number);
    return is ? [place] : [];
  })));
}

/** Saves the complexes of rows as one PDB file, of several rows with a model each. */
function download(data, rows, column) {
  const ranks = rows.map((row) => data.rows[row][column("rank")]);
  const texts = rows.map((row, place) => complexAsPdb(data.bodies, data.placed[row], data.refined[row], data.chains, `knotdock, rank ${ranks[place]}, from a report`));
  const models = texts.map((text, place) => `MODEL     ${String(place + 1).padStart(4)}\n${text.replace(/END\n$/, "ENDMDL\n")}`);
  const [text, name] = rows.length === 1 ? [texts[0], `rank_${String(ranks[0]).padStart(4, "0")}`] : [`${models.join("")}END\n`, "best"];
  const link = make("a", { href: URL.createObjectURL(new Blob([text], { type: "chemical/x-pdb" })), download: `${name}.pdb` });
  link.click();
  URL.revokeObjectURL(link.href);
}
