// The report of predicted models: its table, view and map of PAE.

import assert from "node:assert/strict";
import { after, test } from "node:test";
import { end, open } from "./browser.mjs";
import { reports } from "./reports.mjs";

after(end);

const report = reports().models;

test("keys choose a row, which is shown with its evidence", async () => {
  const { page, faults, close } = await open(report);
  try {
    const picture = () => page.evaluate(() => window.knotdock.picture());
    const selected = () => page.locator("#selected").textContent();
    assert.match(await selected(), /chains < and & of .*_0_unrelaxed_model_1\.pdb, uncertain/);
    assert.deepEqual(await page.locator("#evidence dt").allTextContents(), ["confidence", "agreement", "coordinates"]);
    const first = await picture();
    await page.focus("tbody tr.choice");
    await page.keyboard.press("End");
    assert.match(await selected(), /_2_unrelaxed/);
    assert.match(await page.locator("#evidence dd").nth(2).textContent(), /contradict/);
    assert.notEqual(await picture(), first);
    await page.keyboard.press("Home");
    assert.equal(await picture(), first);
    const header = await page.locator("thead th").allTextContents();
    for (const name of ["trust", "ipsae", "agreement", "dockq"]) assert.ok(header.some((text) => text.startsWith(name)), name);
    assert.deepEqual(faults, []);
  } finally {
    await close();
  }
});

test("arrow keys and the mouse read the map of PAE", async () => {
  const { page, close } = await open(report);
  try {
    const value = () => page.locator("#pae-value").textContent();
    await page.focus("#pae-map");
    await page.keyboard.press("ArrowDown");
    assert.equal(await value(), "<:16 aligned, <:16 scored: 1.0 Å");
    await page.keyboard.press("ArrowRight");
    assert.equal(await value(), "<:16 aligned, <:17 scored: 1.0 Å");
    const { x, y, width } = await page.locator("#pae-map").boundingBox();
    await page.mouse.move(x + width - 2, y + 2);
    assert.match(await value(), /^<:\d+ aligned, &:\d+ scored: 4\.0 Å$/);
    await page.mouse.move(x + 2, y + width - 2);
    assert.match(await value(), /^&:\d+ aligned, <:\d+ scored: 6\.0 Å$/);
    const colours = await page.locator("#pae-map").evaluate((canvas) => [[2, 2], [canvas.width - 3, 2]].map(([x, y]) => [...canvas.getContext("2d").getImageData(x, y, 1, 1).data].join()));
    assert.notEqual(colours[0], colours[1]);
  } finally {
    await close();
  }
});

test("the model is coloured by chain or by pLDDT, and zooms to the interface", async () => {
  const { page, faults, close } = await open(report);
  try {
    const picture = () => page.evaluate(() => window.knotdock.picture());
    const byChain = await picture();
    assert.deepEqual(await page.locator("#legend li").allTextContents(), ["chain <", "chain &"]);
    await page.selectOption("#colour-by", "plddt");
    assert.notEqual(await picture(), byChain);
    assert.equal(await page.locator("#legend li").count(), 4);
    await page.selectOption("#colour-by", "chain");
    assert.equal(await picture(), byChain);
    await page.click("#zoom-interface");
    assert.notEqual(await picture(), byChain);
    await page.click("#zoom-all");
    await page.focus("#scene");
    const before = await picture();
    await page.keyboard.press("ArrowLeft");
    assert.notEqual(await picture(), before);
    assert.deepEqual(faults, []);
  } finally {
    await close();
  }
});

test("names of files and chains are text", async () => {
  const { page, close } = await open(report);
  try {
    assert.equal(await page.evaluate(() => window.hacked), undefined);
    assert.equal(await page.locator("img[src=x]").count(), 0);
    assert.match(await page.locator("#summary").textContent(), /<img src=x onerror=hacked=1>/);
    assert.match(await page.locator("#list-table").textContent(), /<img src=x onerror=hacked=1>/);
  } finally {
    await close();
  }
});
