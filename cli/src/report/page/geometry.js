/** The image of a point under a placement: qw, qx, qy, qz, tx, ty, tz. */
function apply([w, x, y, z, tx, ty, tz], [a, b, c]) {
  const [i, j, k] = [2 * (y * c - z * b), 2 * (z * a - x * c), 2 * (x * b - y * a)];
  return [a + w * i + y * k - z * j + tx, b + w * j + z * i - x * k + ty, c + w * k + x * j - y * i + tz];
}

/** Root mean square distance between the images of points under two placements. */
function distanceOf(points, one, other) {
  let sum = 0;
  for (const point of points) {
    const [p, q] = [apply(one, point), apply(other, point)];
    sum += (p[0] - q[0]) ** 2 + (p[1] - q[1]) ** 2 + (p[2] - q[2]) ** 2;
  }
  return Math.sqrt(sum / Math.max(points.length, 1));
}

/** Places of atoms in a PDB text, and their names. */
function pdbAtoms(text) {
  const lines = text.split("\n").filter((line) => line.startsWith("ATOM") || line.startsWith("HETATM"));
  return lines.map((line) => ({ line, name: line.slice(12, 16).trim(), at: [30, 38, 46].map((from) => Number(line.slice(from, from + 8))) }));
}

/** Atoms of a body, 0 or 1, that moved within it when a row was refined: their place in the file, and where they went. */
function movedAtoms(refined, body) {
  const flat = refined?.moved[body] ?? [];
  const atoms = new Map();
  for (let at = 0; at < flat.length; at += 4) atoms.set(flat[at], flat.slice(at + 1, at + 4));
  return atoms;
}

/** A complex as PDB: the receptor and the ligand once for each placement, with the chain names of complexes. */
function complexAsPdb(bodies, placements, refined, chains, remark) {
  const lines = [`REMARK 1 ${remark}`];
  const partners = ["receptor", "ligand", ...placements.slice(1).map((_, place) => `copy ${place + 3}`)];
  let serial = 0;
  partners.forEach((partner, place) => {
    const body = bodies[place === 0 ? 0 : 1];
    const written = new Map((chains ?? []).filter((chain) => chain.partner === partner).map((chain) => [chain.original, chain.written]));
    const moved = movedAtoms(refined, Math.min(place, 1));
    pdbAtoms(body.text).forEach((atom, index) => {
      const residue = body.residues[body.residue_of_atom[index]];
      const chain = written.get(residue?.[0]) ?? atom.line[21];
      const [x, y, z] = (place === 0 ? moved.get(index) ?? atom.at : apply(refined?.placed ?? placements[place - 1], moved.get(index) ?? atom.at)).map((part) => part.toFixed(3).padStart(8));
      serial += 1;
      lines.push(atom.line.slice(0, 6) + String(serial % 100000).padStart(5) + atom.line.slice(11, 21) + chain + atom.line.slice(22, 30) + x + y + z + atom.line.slice(54));
    });
    lines.push("TER");
  });
  return lines.concat("END", "").join("\n");
}
