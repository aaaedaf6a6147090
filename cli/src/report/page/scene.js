const RECEPTOR = "#bfbfbf";
const LIGANDS = ["#e69f00", "#56b4e9", "#009e73", "#cc79a7", "#0072b2", "#d55e00", "#f0e442"];
const KNOWN = "#cc79a7";
const BLOCKED = "#000000";
const OVERLAY = "#009e73";
// Corners that a mesh of flat triangles may have.
const MOST_FLAT = 60000;

/** A shade from white to blue for a share from 0 to 1. */
function shade(share) {
  const part = (low, high) => Math.round(low + (high - low) * share).toString(16).padStart(2, "0");
  return `#${part(240, 0)}${part(240, 70)}${part(240, 150)}`;
}

/** The three-dimensional view: `show(row)` and `style(choices)` change what is seen. */
function makeScene(root, data) {
  const library = window.$3Dmol;
  const viewer = library.createViewer(root, { backgroundColor: "white", antialias: true, preserveDrawingBuffer: true, disableFog: true });
  const isMesh = data.bodies[0].format === "mesh";
  const copies = Math.max(1, data.placed[0]?.length ?? 1);
  const choices = { sticks: false, known: true, overlay: false, colour: "partner" };
  let row = 0;
  const models = isMesh ? [] : [0, ...Array(copies).fill(1)].map((body) => {
    const { text, format } = data.bodies[body];
    const model = viewer.addModel(text, format, { keepH: true, altLoc: "*", assignBonds: true });
    const atoms = model.selectedAtoms({});
    return { model, body, atoms, start: atoms.map((atom) => [atom.x, atom.y, atom.z]) };
  });
  let shapes = [];
  let lines = [];
  let drawn = null;

  // Meshes may be of any size: the view is made for some 50 units, about the origin.
  const frame = isMesh ? frameOf(data.bodies.map((body) => body.positions ?? []).find((positions) => positions.length > 0) ?? [0, 0, 0]) : null;
  const bounds = isMesh ? viewer.addModel() : null;

  function place() {
    const placements = data.placed[row] ?? [];
    if (isMesh) {
      shapes.forEach((shape) => viewer.removeShape(shape));
      const bodies = [null, ...placements].map((placement, index) => [data.bodies[index === 0 ? 0 : 1], placement, index]).filter(([body]) => body.positions?.length > 0);
      shapes = bodies.map(([body, placement, index]) => surface(vertices(body, placement), body.triangles, index === 0 ? RECEPTOR : LIGANDS[0], index === 0 ? 0.75 : 1));
      // What is zoomed to are atoms; these are not drawn.
      bounds.removeAtoms(bounds.selectedAtoms({}));
      bounds.addAtoms(bodies.flatMap(([body, placement]) => vertices(body, placement)).map(({ x, y, z }, serial) => ({ elem: "H", x, y, z, serial, bonds: [], bondOrder: [], properties: {} })));
      bounds.setStyle({}, { hidden: true });
      return;
    }
    const refined = data.refined[row];
    models.forEach(({ atoms, body, start }, place) => {
      const moved = movedAtoms(refined, body);
      const placement = place === 0 ? null : refined?.placed ?? placements[place - 1];
      atoms.forEach((atom, index) => {
        const at = moved.get(index) ?? start[index];
        [atom.x, atom.y, atom.z] = placement ? apply(placement, at) : at;
      });
    });
  }

  /** Vertices of a mesh where a placement puts it, in the frame of the view. */
  function vertices(body, placement) {
    const points = [];
    for (let at = 0; at < body.positions.length; at += 3) {
      const point = body.positions.slice(at, at + 3);
      const [x, y, z] = (placement ? apply(placement, point) : point).map((part, axis) => (part - frame.middle[axis]) * frame.scale);
      points.push({ x, y, z });
    }
    return points;
  }

  function surface(points, corners, color, opacity) {
    // Small meshes are made of flat triangles, each with corners of its own; large ones look smooth.
    const isFlat = corners.length <= MOST_FLAT;
    const vertexArr = isFlat ? corners.map((corner) => points[corner]) : points;
    const triangles = isFlat ? corners.map((_, place) => place) : corners;
    const normalArr = vertexArr.map(() => ({ x: 0, y: 0, z: 0 }));
    for (let at = 0; at < triangles.length; at += 3) {
      const three = triangles.slice(at, at + 3);
      const [a, b, c] = three.map((corner) => vertexArr[corner]);
      const [u, v] = [b, c].map((end) => [end.x - a.x, end.y - a.y, end.z - a.z]);
      const normal = { x: u[1] * v[2] - u[2] * v[1], y: u[2] * v[0] - u[0] * v[2], z: u[0] * v[1] - u[1] * v[0] };
      for (const corner of three) for (const axis of ["x", "y", "z"]) normalArr[corner][axis] += normal[axis];
    }
    return viewer.addCustom({ vertexArr, normalArr, faceArr: triangles, color, opacity });
  }

  /** The known complex that the pose is measured by, as tubes. */
  function overlay() {
    const wanted = choices.overlay ? data.overlay.traces[data.overlay.of_row[row]] : [];
    if (wanted === drawn) return;
    lines.forEach((line) => viewer.removeShape(line));
    // The receptor's is thin: it hardly differs from that of the run.
    lines = wanted.flatMap((side, place) => side.map((flat) => viewer.addCurve({ points: pointsOf(flat), radius: [0.12, 0.4][place], smooth: 4, color: OVERLAY })));
    drawn = wanted;
  }

  function paint() {
    if (isMesh) return;
    overlay();
    models.forEach(({ model, body, atoms }, index) => {
      const { residue_of_atom: residueOf, active, blocked } = data.bodies[body];
      const share = choices.colour === "consensus" ? (atom) => shade((data.shares[body][residueOf[atom.index]] ?? 0) / Math.max(data.counted, 1)) : null;
      const plain = index === 0 ? RECEPTOR : LIGANDS[(index - 1) % LIGANDS.length];
      const colour = share ? { colorfunc: share } : { color: plain };
      model.setStyle({}, { cartoon: { ...colour, arrows: true } });
      // What has no cartoon: cofactors, and chains of CA atoms too short for one.
      model.setStyle({ hetflag: true }, { stick: { radius: 0.15, ...colour }, sphere: { radius: 0.35, ...colour } });
      const of = (residues) => { const set = new Set(residues); return atoms.filter((atom) => set.has(residueOf[atom.index])).map((atom) => atom.index); };
      if (choices.sticks) {
        const side = index === 0 ? 0 : 1;
        const touching = pairsOf(data, row).map((pair) => pair[side]);
        model.setStyle({ index: of(touching) }, { stick: { radius: 0.18, colorscheme: { prop: "elem", map: { C: plain, N: "#3050f8", O: "#ff0d0d", S: "#d5b000" } } } }, true);
      }
      if (choices.known) {
        for (const [residues, color] of [[active, KNOWN], [blocked, BLOCKED]]) {
          if (residues.length > 0) model.setStyle({ index: of(residues) }, { stick: { radius: 0.3, color } }, true);
        }
      }
    });
  }

  function interfaceAtoms() {
    return models.map(({ body, model }, index) => {
      const side = index === 0 ? 0 : 1;
      const touching = new Set(pairsOf(data, row).map((pair) => pair[side]));
      const { residue_of_atom: residueOf } = data.bodies[body];
      return { model, index: residueOf.flatMap((residue, atom) => touching.has(residue) ? [atom] : []) };
    });
  }

  /** Brings all into view. What is zoomed to fits into the height but for its corners, which stand nearer. */
  function fit() {
    viewer.resize();
    viewer.zoomTo();
    viewer.zoom(0.9 * Math.min(1, root.clientWidth / Math.max(root.clientHeight, 1)));
    viewer.render();
  }

  place();
  paint();
  fit();
  // Prints cannot show the canvas of the graphics card.
  const picture = make("img", { alt: "The selected pose" });
  root.append(picture);
  window.addEventListener("beforeprint", () => { picture.src = viewer.pngURI(); });
  window.addEventListener("resize", () => viewer.resize());
  return {
    // A mesh may go anywhere from one row to the next; molecules stay about the receptor.
    show(next) { row = next; place(); paint(); if (isMesh) fit(); else viewer.render(); },
    style(changed) { Object.assign(choices, changed); paint(); viewer.render(); },
    whole() { fit(); },
    toInterface() {
      const chosen = interfaceAtoms().filter(({ index }) => index.length > 0);
      if (chosen.length > 0) viewer.zoomTo({ or: chosen.map(({ model, index }) => ({ model: model.getID?.() ?? model.id, index })) }, 300);
      viewer.render();
    },
    picture: () => viewer.pngURI(),
    /** Calls `draw` while the view has a quarter of its width and height, which no frame shows. */
    small(draw) {
      const { clientWidth, clientHeight } = root;
      Object.assign(root.style, { width: `${clientWidth / 4}px`, height: `${clientHeight / 4}px` });
      viewer.resize();
      draw();
      Object.assign(root.style, { width: "", height: "" });
      viewer.resize();
    },
    turn(angle, axis) { viewer.rotate(angle, axis); },
  };
}

/** Calls `act` once an element has a size: none has in a hidden tab or cell. */
function onceSized(element, act) {
  const isSized = () => element.clientWidth > 0 && element.clientHeight > 0;
  if (isSized()) act();
  else new ResizeObserver((_, watcher) => { if (isSized()) { watcher.disconnect(); act(); } }).observe(element);
}

/**
 * Calls `makeView` once the library of the view is there and the view has a size: at once if the page holds it, else when
 * its button is pressed.
 */
async function withLibrary(ids, makeView) {
  const show = () => onceSized(byId("scene"), makeView);
  const hide = (on) => ids.map(byId).forEach((element) => { (element.closest("label") ?? element).hidden = on; });
  const script = await unpacked("viewer");
  if (script !== null) {
    // A script element runs what it is given, in this page and before it is left.
    document.head.append(make("script", {}, script));
    return show();
  }
  hide(true);
  byId("load-view")?.addEventListener("click", ({ target }) => {
    target.disabled = true;
    const { address, integrity } = target.dataset;
    const failed = () => { target.replaceWith("It could not be loaded: there is no network, or the file is not the one that this page expects."); };
    const loaded = () => { byId("no-view").remove(); hide(false); show(); };
    document.head.append(make("script", { src: address, integrity, crossorigin: "anonymous", load: loaded, error: failed }));
  });
}

/** Lets the arrow keys turn the view. */
function turnByKeys(element, scene) {
  element.addEventListener("keydown", (event) => {
    const turn = { ArrowLeft: [-10, "y"], ArrowRight: [10, "y"], ArrowUp: [-10, "x"], ArrowDown: [10, "x"] }[event.key];
    if (!turn) return;
    scene.turn(...turn);
    event.preventDefault();
  });
}

/** Middle of some points, and the factor that brings them to the size of a protein. */
function frameOf(positions) {
  const [low, high] = [[Infinity, Infinity, Infinity], [-Infinity, -Infinity, -Infinity]];
  positions.forEach((part, at) => { low[at % 3] = Math.min(low[at % 3], part); high[at % 3] = Math.max(high[at % 3], part); });
  const size = Math.max(...high.map((part, axis) => part - low[axis]));
  return { middle: low.map((part, axis) => (part + high[axis]) / 2), scale: size > 0 && Number.isFinite(size) ? 50 / size : 1 };
}

/** Points of a flat list. */
function pointsOf(flat) {
  return flat.flatMap((x, at) => at % 3 === 0 ? [{ x, y: flat[at + 1], z: flat[at + 2] }] : []);
}

/** Pairs of residues in contact in a row: [receptor, ligand, distance in Å, hydrogen bonds, salt bridge]. */
function pairsOf(data, row) {
  const flat = (data.contacts?.[row] || "").split(" ").filter(Boolean).map(Number);
  const pairs = [];
  for (let at = 0; at < flat.length; at += 5) pairs.push([flat[at], flat[at + 1], flat[at + 2] / 100, flat[at + 3], flat[at + 4]]);
  return pairs;
}
