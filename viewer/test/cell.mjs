// Opens pages, each with the output of a notebook's cell, and checks that its view appears, though the cell may be hidden
// at first: an isolated frame that asks nothing of the network and reports nothing to the console.
//     node cell.mjs PAGE...

import assert from "node:assert/strict";
import { pathToFileURL } from "node:url";
import { end, newPage } from "./browser.mjs";

for (const name of process.argv.slice(2)) {
  const { page, faults, requests, close } = await newPage();
  const address = pathToFileURL(name).href;
  await page.goto(address);
  const frame = page.frames()[1];
  // Frames that nobody sees are not drawn, so they are not asked each time that they are.
  await frame.waitForFunction(() => window.$3Dmol !== undefined, null, { timeout: 20000, polling: 100 });
  await page.evaluate(() => document.querySelectorAll("[hidden]").forEach((cell) => { cell.hidden = false; }));
  await frame.waitForFunction(() => window.knotdock !== undefined, null, { timeout: 20000 });
  const colours = await frame.evaluate(async () => {
    const image = new Image();
    image.src = window.knotdock.picture();
    await image.decode();
    const canvas = document.createElement("canvas");
    [canvas.width, canvas.height] = [image.width, image.height];
    const context = canvas.getContext("2d");
    context.drawImage(image, 0, 0);
    return new Set(new Uint32Array(context.getImageData(0, 0, image.width, image.height).data.buffer)).size;
  });
  assert.ok(colours > 20, `${name}: ${colours} colours`);
  assert.deepEqual([faults, requests.filter((request) => request !== "about:srcdoc")], [[], [address]], name);
  await close();
}
await end();
