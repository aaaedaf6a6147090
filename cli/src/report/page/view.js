/** A view alone: of two meshes (`bodies`, `placed`), of `balls` (x, y, z, radius), or of a structure's `text`. */
async function showView(data) {
  await withLibrary([], () => {
    const scene = data.bodies ? makeScene(byId("scene"), data) : sceneOf(byId("scene"), data);
    turnByKeys(byId("scene"), scene);
    window.knotdock = scene;
  });
}

function sceneOf(root, data) {
  const viewer = window.$3Dmol.createViewer(root, { backgroundColor: "white", antialias: true, preserveDrawingBuffer: true, disableFog: true });
  if (data.balls) addBalls(viewer, data.balls);
  else addStructure(viewer, data);
  viewer.zoomTo();
  viewer.zoom(0.9 * Math.min(1, root.clientWidth / Math.max(root.clientHeight, 1)));
  viewer.render();
  window.addEventListener("resize", () => viewer.resize());
  return { picture: () => viewer.pngURI(), turn(angle, axis) { viewer.rotate(angle, axis); } };
}

/**
 * A structure: `sides` are lists of chains, each with its own colour, by default the chains one by one; `sticks` shows
 * residues near another side.
 */
function addStructure(viewer, { text, sides, sticks }) {
  const model = viewer.addModel(text, text.startsWith("data_") ? "cif" : "pdb", { keepH: true, altLoc: "*", assignBonds: true });
  const chains = new Set(model.selectedAtoms({}).map((atom) => atom.chain));
  (sides?.length > 0 ? sides : [...chains].map((chain) => [chain])).forEach((chain, side) => {
    const color = side === 0 ? RECEPTOR : LIGANDS[(side - 1) % LIGANDS.length];
    viewer.setStyle({ chain }, { cartoon: { color, arrows: true } });
    viewer.setStyle({ chain, hetflag: true }, { stick: { radius: 0.15, color }, sphere: { radius: 0.35, color } });
    const others = sticks ? sides.flatMap((chains, other) => other === side ? [] : chains) : [];
    if (others.length === 0) return;
    const near = { chain, byres: true, within: { distance: 5, sel: { chain: others } } };
    viewer.addStyle(near, { stick: { radius: 0.18, colorscheme: { prop: "elem", map: { C: color, N: "#3050f8", O: "#ff0d0d", S: "#d5b000" } } } });
  });
}

function addBalls(viewer, balls) {
  // The view is made for some 50 units, about the origin.
  const { middle, scale } = frameOf(balls.flatMap((ball) => ball.slice(0, 3)));
  viewer.addModel().addAtoms(balls.map(([x, y, z, radius], serial) => {
    const [a, b, c] = [x, y, z].map((part, axis) => (part - middle[axis]) * scale);
    return { elem: "C", x: a, y: b, z: c, serial, bonds: [], bondOrder: [], properties: {}, style: { sphere: { radius: radius * scale, color: LIGANDS[0] } } };
  }));
}
