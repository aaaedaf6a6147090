// Clicks through the report of a docked pair: KNOTDOCK is the program, REPORTS a folder to write to.

import assert from "node:assert/strict";
import { readFileSync } from "node:fs";
import { after, before, test } from "node:test";
import { end, open } from "./browser.mjs";
import { reports } from "./reports.mjs";

let report;
let shown;
before(async () => {
  report = reports().run;
  shown = await open(report);
});
after(end);

const text = (selector) => shown.page.locator(selector).innerText();
const rows = () => shown.page.locator("#pose-table tbody tr");

/** The view as it is now, kept in the page; its number, and how many colours it has. */
async function pixels() {
  return shown.page.evaluate(async () => {
    const image = new Image();
    image.src = window.knotdock.picture();
    await image.decode();
    const canvas = document.createElement("canvas");
    [canvas.width, canvas.height] = [image.width, image.height];
    const context = canvas.getContext("2d");
    context.drawImage(image, 0, 0);
    const data = new Uint32Array(context.getImageData(0, 0, image.width, image.height).data.buffer);
    window.pictures = [...(window.pictures ?? []), data];
    return { number: window.pictures.length - 1, colours: new Set(data).size };
  });
}

/** Pixels in which two pictures differ. */
const differing = (one, other) => shown.page.evaluate(([one, other]) => {
  const [a, b] = [window.pictures[one], window.pictures[other]];
  return a.reduce((count, pixel, place) => count + (pixel !== b[place]), 0);
}, [one.number, other.number]);

/** Pixels of a picture in the colour of the known complex, in any light. */
const greens = (picture) => shown.page.evaluate((number) => window.pictures[number].reduce((count, pixel) => {
  const [red, green, blue] = [pixel & 255, (pixel >> 8) & 255, (pixel >> 16) & 255];
  return count + (green > 1.3 * blue && green > 3 * red);
}, 0), picture.number);

test("the view shows the selected pose, and another where another is selected", async () => {
  const first = await pixels();
  assert.ok(first.colours > 100, `only ${first.colours} colours`);
  await rows().nth(4).click();
  assert.match(await text("#selected"), /^Selected: rank 5,/);
  const fifth = await pixels();
  assert.ok(await differing(first, fifth) > 200);
  await rows().nth(0).click();
  // The same pose is the same picture: nothing of the other stays.
  assert.equal(await differing(first, await pixels()), 0);
});

test("the keyboard selects rows and turns the view", async () => {
  await rows().nth(0).click();
  await shown.page.keyboard.press("ArrowDown");
  await shown.page.keyboard.press("ArrowDown");
  assert.match(await text("#selected"), /^Selected: rank 3,/);
  assert.equal(await shown.page.locator("[aria-selected=true]").getAttribute("data-row"), "2");
  await shown.page.keyboard.press("End");
  assert.match(await text("#pose-table .pager [role=status]"), /of \d+$/);
  await shown.page.keyboard.press("Home");
  assert.match(await text("#selected"), /^Selected: rank 1,/);
  const before = await pixels();
  await shown.page.locator("#scene").focus();
  await shown.page.keyboard.press("ArrowRight");
  assert.ok(await differing(before, await pixels()) > 200);
  await shown.page.keyboard.press("ArrowLeft");
});

test("filters leave the rows that pass, and can be cleared", async () => {
  const status = () => text("#pose-table .pager [role=status]");
  const all = Number((await status()).match(/of (\d+)$/)[1]);
  await shown.page.fill("#filter-score", "2600");
  const some = Number((await status()).match(/of (\d+) that pass/)[1]);
  assert.ok(some > 0 && some < all, `${some} of ${all}`);
  for (const score of await rows().locator("td:nth-child(2)").allInnerTexts()) assert.ok(Number(score) >= 2600, score);
  await shown.page.fill("#filter-score", "");
  await shown.page.selectOption("#filter-class", "acceptable");
  for (const name of await rows().locator("td:nth-child(8)").allInnerTexts()) assert.ok(["acceptable", "medium", "high"].includes(name), name);
  await shown.page.selectOption("#filter-class", "");
  // The catalytic histidine of trypsin: most good poses of an inhibitor touch it, and not all poses do.
  await shown.page.fill("#filter-residue", "A:57");
  const touching = Number((await status()).match(/of (\d+) that pass/)[1]);
  assert.ok(touching > 0 && touching < all, `${touching} of ${all}`);
  await shown.page.fill("#filter-residue", "A:9999");
  assert.match(await status(), /^No row passes the filters/);
  await shown.page.click("#filters button[type=reset]");
  await shown.page.waitForFunction((all) => document.querySelector("#pose-table .pager [role=status]").textContent.endsWith(`of ${all}`), all);
});

test("columns sort both ways, and all can be shown", async () => {
  const column = async () => (await rows().locator("td:nth-child(3)").allInnerTexts()).map(Number);
  const size = shown.page.locator("#pose-table th button", { hasText: "cluster_size" });
  await size.click();
  const falling = await column();
  assert.deepEqual(falling, [...falling].sort((one, other) => other - one));
  await size.click();
  const rising = await column();
  assert.deepEqual(rising, [...rising].sort((one, other) => one - other));
  assert.equal(await shown.page.locator("th[aria-sort=ascending]").count(), 1);
  const few = await shown.page.locator("#pose-table th").count();
  await shown.page.check("#all-columns");
  const many = await shown.page.locator("#pose-table th").count();
  assert.ok(many > few, `${many} columns`);
  const header = readFileSync(report.replace("report.html", "poses.csv"), "utf8").split("\n")[0];
  assert.equal(many, header.split(",").length);
  await shown.page.uncheck("#all-columns");
  await shown.page.locator("#pose-table th button", { hasText: "rank" }).click();
});

test("a point of the funnel selects its pose, and the axis can change", async () => {
  const point = shown.page.locator('#funnel circle[data-row="7"]');
  await point.dispatchEvent("click");
  assert.match(await text("#selected"), /^Selected: rank 8,/);
  await shown.page.selectOption("#funnel-axis", "selected");
  const label = await shown.page.locator("#funnel svg").getAttribute("aria-label");
  // A pose is no distance from itself.
  assert.match(label, /RMSD from the selected pose, Å\. The selected one: 0\.00/);
  await shown.page.selectOption("#funnel-axis", "irmsd");
});

test("the interface table lists the contacts that the map shows", async () => {
  await rows().nth(0).click();
  const said = Number((await text("#selected")).match(/(\d+) pairs of residues/)[1]);
  assert.equal(await shown.page.locator("#map rect[fill-opacity]").count(), said);
  assert.match(await text("#interface-table .pager [role=status]"), new RegExp(`of ${said}$`));
});

test("sticks, known residues and consensus colours change the view", async () => {
  const plain = await pixels();
  for (const [on, off] of [
    [() => shown.page.check("#show-sticks"), () => shown.page.uncheck("#show-sticks")],
    [() => shown.page.uncheck("#show-known"), () => shown.page.check("#show-known")],
    [() => shown.page.selectOption("#colour-by", "consensus"), () => shown.page.selectOption("#colour-by", "partner")],
  ]) {
    await on();
    assert.ok(await differing(plain, await pixels()) > 20);
    await off();
    assert.equal(await differing(plain, await pixels()), 0);
  }
});

test("the known complex is drawn over the pose, and goes again", async () => {
  const plain = await pixels();
  const legend = () => text("#legend");
  assert.doesNotMatch(await legend(), /known complex/);
  await shown.page.check("#show-overlay");
  assert.match(await legend(), /known complex/);
  const first = await pixels();
  assert.ok(await greens(first) > 200 + await greens(plain));
  // It stays where it is while the ligand moves.
  await rows().nth(4).click();
  const fifth = await pixels();
  assert.ok(await greens(fifth) > 200 && await differing(first, fifth) > 200);
  await rows().nth(0).click();
  assert.equal(await differing(first, await pixels()), 0);
  await shown.page.uncheck("#show-overlay");
  assert.equal(await differing(plain, await pixels()), 0);
});

test("the figures of the selected pose's cluster agree with the table", async () => {
  const read = async () => Object.fromEntries(await shown.page.locator("#cluster div").evaluateAll((all) => all.map((one) => [...one.children].map((part) => part.textContent))));
  for (const row of [0, 4]) {
    await rows().nth(row).click();
    const found = await read();
    const size = Number(await rows().nth(row).locator("td:nth-child(3)").innerText());
    assert.equal(Number(found.poses), size);
    const [best, mean, spread] = ["best score", "mean score", "standard deviation of scores"].map((name) => Number(found[name]));
    assert.ok(size === 1 ? best === mean && spread === 0 : best > mean && spread > 0, JSON.stringify(found));
    // The score of a cluster is at least that of its best pose.
    assert.ok(best <= 1.01 * Number(await rows().nth(row).locator("td:nth-child(2)").innerText()));
    const [near, far] = ["mean RMSD from the best, Å", "largest RMSD, Å"].map((name) => Number(found[name]));
    assert.ok(size === 1 || (near > 0 && near <= far && far <= 5), JSON.stringify(found));
  }
  await rows().nth(0).click();
});

test("the saved complex is that of the run", async () => {
  await rows().nth(1).click();
  const [saved] = await Promise.all([shown.page.waitForEvent("download"), shown.page.click("#download")]);
  const atoms = (path) => readFileSync(path, "utf8").split("\n").filter((line) => /^(ATOM|HETATM)/.test(line));
  const own = atoms(await saved.path());
  const written = atoms(report.replace("report.html", "top/rank_0002.pdb"));
  assert.equal(own.length, written.length);
  own.forEach((line, place) => {
    assert.equal(line.slice(12, 30), written[place].slice(12, 30));
    for (const from of [30, 38, 46]) {
      // Placements have seven digits, and both files three decimals.
      const [one, other] = [line, written[place]].map((text) => Number(text.slice(from, from + 8)));
      assert.ok(Math.abs(one - other) < 0.0025, `${line}\n${written[place]}`);
    }
  });
});

test("the ten best clusters have small pictures, and are saved as the models of one file", async () => {
  const pictures = shown.page.locator("#best button");
  assert.equal(await pictures.count(), 10);
  await pictures.nth(3).click();
  assert.match(await text("#selected"), /^Selected: rank 4,/);
  await rows().nth(0).click();
  const [saved] = await Promise.all([shown.page.waitForEvent("download"), shown.page.click("#download-best")]);
  const models = readFileSync(await saved.path(), "utf8").split(/^MODEL.*$/m).slice(1);
  assert.equal(models.length, 10);
  const atoms = models.map((model) => model.split("\n").filter((line) => /^(ATOM|HETATM)/.test(line)));
  for (const model of atoms) assert.equal(model.length, atoms[0].length);
  assert.equal(new Set(atoms.map((model) => model.at(-1))).size, 10);
});

test("the summary says what the best clusters touch, and what to do next", async () => {
  const words = await text("#summary");
  assert.match(words, /Of the best \d+ clusters, most touch A:57 HIS/);
  assert.match(words, /knotdock dock .*--active-receptor/s);
});

test("every control has a name, and pictures say what they show", async () => {
  const nameless = await shown.page.evaluate(() => [...document.querySelectorAll("button, input, select, svg, [role=img], img")]
    .filter((one) => !(one.getAttribute("aria-label") || one.getAttribute("alt") || one.labels?.length || one.textContent.trim()))
    .map((one) => one.outerHTML.slice(0, 80)));
  assert.deepEqual(nameless, []);
  assert.equal(await shown.page.locator("html").getAttribute("lang"), "en");
});

test("nothing goes to the console or the network", () => {
  assert.deepEqual(shown.faults, []);
  assert.deepEqual(shown.requests, [shown.address]);
});
