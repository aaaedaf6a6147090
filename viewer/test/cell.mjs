// Opens pages, each with the output of a notebook's cell, and checks that its view appears: an isolated frame that asks
// nothing of the network and reports nothing to the console.
//     node cell.mjs PAGE...

import assert from "node:assert/strict";
import { chromium } from "playwright-core";
import { pathToFileURL } from "node:url";
import { ARGUMENTS, EXECUTABLE } from "./browser.mjs";

const browser = await chromium.launch({ executablePath: EXECUTABLE, args: ARGUMENTS });
for (const name of process.argv.slice(2)) {
  const page = await browser.newPage({ viewport: { width: 900, height: 700 } });
  const faults = [];
  page.on("console", (message) => { if (["error", "warning"].includes(message.type())) faults.push(message.text()); });
  page.on("pageerror", (error) => faults.push(String(error)));
  page.on("request", (request) => { if (!/^(data|blob|about):/.test(request.url())) faults.push(request.url()); });
  const address = pathToFileURL(name).href;
  await page.goto(address);
  const frame = page.frames()[1];
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
  assert.deepEqual(faults, [address], name);
  if (process.env.PICTURES) await page.screenshot({ path: `${name}.png` });
  await page.close();
}
await browser.close();
