// Docks small examples with the program given, and writes a report of each kind into a folder:
//     node make.mjs KNOTDOCK FOLDER

import { execFileSync } from "node:child_process";
import { mkdirSync, readFileSync, rmSync, writeFileSync } from "node:fs";
import path from "node:path";

const [program, folder] = process.argv.slice(2).map((argument) => path.resolve(argument));
const root = path.resolve(import.meta.dirname, "../..");
const examples = path.join(root, "structures/examples");
rmSync(folder, { recursive: true, force: true });
mkdirSync(folder, { recursive: true });
const knotdock = (command, ...words) => execFileSync(program, [command, "--quiet", ...words], { cwd: folder, stdio: ["ignore", "ignore", "inherit"] });
const file = (name) => path.join(examples, name);
const pair = ["receptor", "ligand"].map((side) => file(`1ppe_${side}_unbound.pdb`));
const native = ["receptor", "ligand"].flatMap((side) => [`--native-${side}`, file(`1ppe_${side}_bound.pdb`)]);
const library = path.join(root, "viewer/node_modules/3dmol");
const few = ["--rotations", "300", "--sharp", "off"];

knotdock("dock", ...pair, ...native, "--rotations", "600", "--sharp", "off", "-o", "run");
knotdock("dock", ...pair, ...few, "-o", "bare");
knotdock("dock", file("4e43_molecule.pdb"), "--symmetry", "C2", "--rotations", "60", "-o", "ring");
// Two tetrahedra as meshes.
const tetrahedron = (size) => [[0, 0, 0], [size, 0, 0], [0, size, 0], [0, 0, size]].map((point) => `v ${point.join(" ")}\n`).join("") + "f 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\n";
writeFileSync(path.join(folder, "large.obj"), tetrahedron(10));
writeFileSync(path.join(folder, "small.obj"), tetrahedron(6));
knotdock("dock", "large.obj", "small.obj", "--rotations", "60", "--sample-grid", "2^12", "-o", "solids");
knotdock("obstacle", "large.obj", "small.obj", "--grid", "2^9", "--cells", "24", "--report", "obstacle.html", "--viewer", library);
const poses = [0, 5, 9, 20].map((x) => `1,0,0,0,${x},0,0\n`).join("");
writeFileSync(path.join(folder, "places.csv"), `qw,qx,qy,qz,tx,ty,tz\n${poses}`);
knotdock("collide", "large.obj", "small.obj", "--grid", "2^9", "--poses", "places.csv", "--report", "collide.html", "--viewer", library);
// The same ligand twice, as two models.
const atoms = readFileSync(pair[1], "utf8").split("\n").filter((line) => /^(ATOM|TER)/.test(line)).join("\n");
writeFileSync(path.join(folder, "models.pdb"), `MODEL        1\n${atoms}\nENDMDL\nMODEL        2\n${atoms}\nENDMDL\nEND\n`);
knotdock("dock", pair[0], "models.pdb", "--ligand-models", "all", ...few, "-o", "ensemble");
writeFileSync(path.join(folder, "pairs.csv"), `name,receptor,ligand\nfirst,${pair.join(",")}\nmissing,${pair[0]},nowhere.pdb\n`);
try {
  knotdock("batch", "pairs.csv", "-o", "batch", "--", ...few);
  throw new Error("a pair without its ligand should fail");
} catch (error) {
  if (error.status !== 2) throw error;
}
knotdock("tradeoff", ...pair, "--rotations", "60", "--parameters", "tolerance", "-o", "tradeoff");
knotdock("report", "run", "ring", "solids", "ensemble", "batch", "tradeoff", path.join("batch", "first"), "--viewer", library);
