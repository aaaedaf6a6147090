// The reports that the tests open. `make.mjs` writes them once; the tests of all files then share them.

import path from "node:path";

const folder = process.env.REPORTS;
if (!folder) throw new Error("set REPORTS to the folder that test/make.mjs wrote");

/** The report of each kind. */
export function reports() {
  const of = (directory) => path.resolve(folder, directory, "report.html");
  const page = (name) => path.resolve(folder, `${name}.html`);
  return { collide: page("collide"), bareCollide: page("bare_collide"), obstacle: page("obstacle"), models: page("models"), run: of("run"), bare: of("bare"), ring: of("ring"), solids: of("solids"), ensemble: of("ensemble"), batch: of("batch"), tradeoff: of("tradeoff") };
}
