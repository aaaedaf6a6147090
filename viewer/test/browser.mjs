// A page of a report in headless Chromium, with all that it says to the console and asks of the network.

import { chromium } from "playwright-core";
import { pathToFileURL } from "node:url";

export const EXECUTABLE = process.env.CHROMIUM ?? "/usr/bin/chromium";
// WebGL without a graphics card, and nothing of the browser's own that asks the network.
export const ARGUMENTS = ["--no-sandbox", "--use-angle=swiftshader", "--enable-unsafe-swiftshader", "--disable-background-networking", "--disable-component-update", "--disable-sync", "--no-first-run"];

// One browser a process: starting it takes longer than most tests.
let started;

/** Opens a report in a page of its own; `close` closes the page. */
export async function open(report, { width = 1280, height = 900 } = {}) {
  started ??= chromium.launch({
    executablePath: EXECUTABLE,
    args: ARGUMENTS,
  });
  const browser = await started;
  const page = await browser.newPage({ viewport: { width, height } });
  const faults = [];
  const requests = [];
  page.on("console", (message) => { if (["error", "warning"].includes(message.type())) faults.push(message.text()); });
  page.on("pageerror", (error) => faults.push(String(error)));
  page.on("request", (request) => { if (!/^(data|blob):/.test(request.url())) requests.push(request.url()); });
  const address = pathToFileURL(report).href;
  await page.goto(address);
  await page.waitForFunction(() => window.knotdock !== undefined || document.querySelector("[role=alert]") !== null);
  return { page, faults, requests, address, close: () => page.close() };
}

/** Ends the browser. */
export async function end() {
  await (await started)?.close();
}
