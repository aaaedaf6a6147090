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
const collide = ["large.obj", "small.obj", "--grid", "2^9", "--poses", "places.csv", "--report"];
knotdock("collide", ...collide, "collide.html", "--viewer", library);
knotdock("collide", ...collide, "bare_collide.html");
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
// Models of three seeds, of which the last is out of place, under names that would run as scripts.
const bound = ["receptor", "ligand"].map((side) => readFileSync(file(`1ppe_${side}_bound.pdb`), "utf8").split("\n").filter((line) => line.startsWith("ATOM")));
const parts = bound.map((lines) => lines.map((line) => ({ line, number: Number(line.slice(22, 26)) })));
const residues = parts.map((atoms) => new Set(atoms.map(({ line }) => line.slice(21, 27))).size);
mkdirSync(path.join(folder, "predicted"));
[0, 0.3, 12].forEach((shift, seed) => {
  const name = `<img src=x onerror=hacked=1>_${seed}`;
  const atoms = parts.flatMap((atoms, side) => atoms.map(({ line, number }) => {
    const x = (Number(line.slice(30, 38)) + side * shift).toFixed(3).padStart(8);
    return `${line.slice(0, 21)}${"<&"[side]}${line.slice(22, 30)}${x}${line.slice(38, 60)}${(45 + 10 * (number % 6)).toFixed(2).padStart(6)}${line.slice(66)}\n`;
  }));
  writeFileSync(path.join(folder, "predicted", `${name}_unrelaxed_model_1.pdb`), atoms.join(""));
  const side = (residue) => residue < residues[0] ? 0 : 1;
  const pae = Array.from({ length: residues[0] + residues[1] }, (_, i) => Array.from({ length: residues[0] + residues[1] }, (_, j) => side(i) === side(j) ? 1 : side(i) === 0 ? 4 : 6));
  writeFileSync(path.join(folder, "predicted", `${name}_scores_model_1.json`), JSON.stringify({ pae, iptm: 0.85 - 0.1 * seed, ptm: 0.8 }));
});
knotdock("models", "predicted", "--native", path.join("predicted", "<img src=x onerror=hacked=1>_0_unrelaxed_model_1.pdb"), "--report", "models.html", "--viewer", library);
knotdock("report", "run", "ring", "solids", "ensemble", "batch", "tradeoff", path.join("batch", "first"), "--viewer", library);
