/** What a residue is called: A:57 HIS. */
function residueName(body, place) {
  const [chain, number, name] = body.residues[place];
  return `${chain || "_"}:${number} ${name}`;
}

/** Names of the terms that a chart has colours for, the largest first, then the rest together. */
function shownTerms(data, column) {
  const size = (name) => data.rows.slice(0, 50).reduce((sum, row) => sum + Math.abs(row[column(name)] ?? 0), 0);
  const terms = data.terms.map((name) => [name, size(name)]).filter(([, sum]) => sum > 0).sort((one, other) => other[1] - one[1]).map(([name]) => name);
  return [terms.slice(0, COLOURS.length), terms.slice(COLOURS.length)];
}

/** The parts of a row's score, by their columns. */
function partsOf(data, column, row, [shown, others]) {
  const value = (name) => data.rows[row][column(name)] ?? 0;
  const parts = Object.fromEntries(shown.map((name) => [name, value(name)]));
  if (others.length > 0) parts["other terms"] = others.reduce((sum, name) => sum + value(name), 0);
  return parts;
}

function drawTerms(data, column, row, choose) {
  const terms = shownTerms(data, column);
  const best = data.rows.slice(0, 10).map((_, place) => place);
  const bars = [...new Set([...best, row])].map((place) => ({
    label: `rank ${data.rows[place][column("rank")]}`, chosen: place === row, parts: partsOf(data, column, place, terms), choose: () => choose(place),
  }));
  if (bars.length > 0) stackedBars(byId("terms"), bars, Object.keys(bars[0].parts));
}

function drawDistribution(data, column, row) {
  const scores = data.rows.map((fields) => fields[column("score")]).filter((value) => typeof value === "number");
  histogram(byId("distribution"), scores, data.rows[row][column("score")], "score");
}

/** The axes that a funnel may have: distances from the known complex, and from the selected pose. */
function funnelAxes(data, column) {
  const known = [["irmsd", "irmsd from the known complex, Å"], ["lrmsd", "lrmsd from the known complex, Å"], ["dockq", "dockq"]];
  const own = data.placed[0]?.length > 0 ? [["selected", "RMSD from the selected pose, Å"]] : [];
  return [...known.filter(([name]) => column(name) >= 0), ...own];
}

function drawFunnel(data, column, row, axis, name, points, choose) {
  const distance = axis === "selected"
    ? (place) => data.placed[place][0] && data.placed[row][0] ? distanceOf(points, data.placed[place][0], data.placed[row][0]) : null
    : (place) => data.rows[place][column(axis)];
  const drawn = data.rows.map((fields, place) => ({ x: distance(place), y: fields[column("score")], row: place, rank: fields[column("rank")] }));
  scatter(byId("funnel"), drawn.filter(({ x, y }) => typeof x === "number" && typeof y === "number"), [name, "score"], row, choose);
}

/** The figures of a cluster, which are hidden if there are none. */
function drawCluster(figures, isMesh) {
  const unit = isMesh ? "" : ", Å";
  const names = [["poses", 0], ["best score", 1], ["mean score", 1], ["standard deviation of scores", 1], [`mean RMSD from the best${unit}`, 2], [`largest RMSD${unit}`, 2]];
  // Meshes may have any unit.
  const shown = (value, digits) => shownNumber(isMesh && digits === 2 && value !== null ? String(value) : value, digits);
  byId("of-cluster").hidden = !figures;
  if (figures) byId("cluster").replaceChildren(...names.map(([name, digits], place) => make("div", {}, make("dt", {}, name), make("dd", {}, shown(figures[place], digits)))));
}

const INTERFACE_COLUMNS = [
  { name: "residue", digits: null }, { name: "touches", digits: null }, { name: "distance, Å", digits: 2 },
  { name: "hydrogen bonds", digits: 0 }, { name: "salt bridge", digits: null },
].map((column) => ({ ...column, help: "", main: true }));

function interfaceRows(data, row) {
  return pairsOf(data, row).map(([first, second, distance, bonds, bridge]) => [
    residueName(data.bodies[0], first), residueName(data.bodies[1], second), distance, bonds, bridge ? "yes" : null,
  ]);
}

function drawMap(data, row, sides) {
  const names = data.bodies.map((body) => body.residues.map((_, place) => residueName(body, place)));
  contactMap(byId("map"), pairsOf(data, row).map(([first, second, distance]) => [first, second, distance]), names, sides);
}

/** A table a side: residues that the best clusters touch, the most touched first. */
function drawConsensus(data, sides) {
  byId("counted").textContent = data.counted;
  sides.forEach((side, place) => {
    const touched = data.shares[place].map((clusters, residue) => [residue, clusters]).filter(([, clusters]) => clusters > 0);
    touched.sort((one, other) => other[1] - one[1] || one[0] - other[0]);
    makeTable(byId(`consensus-${place}`), {
      caption: `Residues of the ${side}`,
      columns: [["residue", null], ["clusters", 0], ["share", 2]].map(([name, digits]) => ({ name, digits, help: "", main: true })),
      rows: touched.map(([residue, clusters]) => [residueName(data.bodies[place], residue), clusters, clusters / Math.max(data.counted, 1)]),
      empty: "No residue is touched",
    });
  });
}
