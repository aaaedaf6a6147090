// A page of a report in headless Chromium, with all that it says to the console and asks of the network.

import { chromium } from "playwright-core";
import { pathToFileURL } from "node:url";

export const EXECUTABLE = process.env.CHROMIUM ?? "/usr/bin/chromium";

// One browser a process: starting it takes longer than most tests.
let started;

/** A new page, with all that it says to the console and asks of the network. */
export async function newPage({ width = 1280, height = 900 } = {}) {
  started ??= chromium.launch({
    executablePath: EXECUTABLE,
    // WebGL without a graphics card, and nothing of the browser's own that asks the network.
    args: ["--no-sandbox", "--use-angle=swiftshader", "--enable-unsafe-swiftshader", "--disable-background-networking", "--disable-component-update", "--disable-sync", "--no-first-run"],
  });
  const browser = await started;
  const page = await browser.newPage({ viewport: { width, height } });
  const faults = [];
  const requests = [];
  page.on("console", (message) => { if (["error", "warning"].includes(message.type())) faults.push(message.text()); });
  page.on("pageerror", (error) => faults.push(String(error)));
  page.on("request", (request) => { if (!/^(data|blob):/.test(request.url())) requests.push(request.url()); });
  return { page, faults, requests, close: () => page.close() };
}

/** Opens a report in a page of its own; `close` closes the page. */
export async function open(report, size) {
  const opened = await newPage(size);
  const address = pathToFileURL(report).href;
  await opened.page.goto(address);
  await opened.page.waitForFunction(() => window.knotdock !== undefined || document.querySelector("[role=alert]") !== null);
  return { ...opened, address };
}

/** Ends the browser. */
export async function end() {
  await (await started)?.close();
}
