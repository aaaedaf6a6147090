// Every kind of report opens without a fault, fits its window and is small.

import assert from "node:assert/strict";
import { createHash } from "node:crypto";
import { readFileSync, statSync } from "node:fs";
import path from "node:path";
import { after, test } from "node:test";
import { end, open } from "./browser.mjs";
import { reports } from "./reports.mjs";

after(end);

for (const [kind, report] of Object.entries(reports())) {
  for (const width of [1280, 400]) {
    test(`${kind}, ${width} pixels wide`, async () => {
      const { page, faults, requests, address, close } = await open(report, { width });
      try {
        await page.waitForTimeout(200);
        assert.deepEqual(faults, []);
        assert.deepEqual(requests, [address]);
        const [scroll, client] = await page.evaluate(() => [document.documentElement.scrollWidth, document.documentElement.clientWidth]);
        assert.ok(scroll <= client, `${scroll} pixels of content in ${client}`);
        const wide = await page.evaluate(() => [...document.querySelectorAll("main *")].filter((one) => !one.closest(".scroll, svg, .hidden") && one.getBoundingClientRect().right > document.documentElement.clientWidth + 1).map((one) => one.outerHTML.slice(0, 80)));
        assert.deepEqual(wide, []);
        assert.ok(await page.locator("tbody tr").count() > 0);
      } finally {
        await close();
      }
    });
  }
  test(`${kind} is smaller than 6 MB`, () => assert.ok(statSync(report).size < 6e6));
}

test("names of pairs lead to their reports", async () => {
  const { page, close } = await open(reports().batch);
  try {
    await page.click("tbody a");
    await page.waitForFunction(() => window.knotdock?.choose !== undefined);
    assert.match(await page.title(), /docked to/);
  } finally {
    await close();
  }
});

test("a report without the library says what it lacks, and shows the rest", async () => {
  const { page, faults, close } = await open(reports().bare);
  try {
    assert.deepEqual(faults, []);
    assert.match(await page.locator("#scene-side").innerText(), /no three-dimensional view/);
    assert.equal(await page.locator("#scene").isVisible(), false);
    assert.ok(await page.locator("#funnel circle").count() > 100);
  } finally {
    await close();
  }
});

const viewer = path.resolve(import.meta.dirname, "..");
const library = readFileSync(path.join(viewer, "node_modules/3dmol/build/3Dmol-min.js"));

test("the address and the checksum of the library are those of npm's package", async () => {
  const { page, close } = await open(reports().bare);
  try {
    const { address, integrity } = await page.locator("#load-view").evaluate((button) => ({ ...button.dataset }));
    const lock = JSON.parse(readFileSync(path.join(viewer, "package-lock.json"), "utf8"));
    const { version } = lock.packages["node_modules/3dmol"];
    assert.equal(address, `https://cdn.jsdelivr.net/npm/3dmol@${version}/build/3Dmol-min.js`);
    assert.equal(integrity, `sha384-${createHash("sha384").update(library).digest("base64")}`);
    const policy = await page.locator("meta[http-equiv]").getAttribute("content");
    assert.deepEqual(policy.match(/https?:[^ ;]*/g), [address]);
  } finally {
    await close();
  }
});

/** Lets the address of the library have a body. */
const serve = (page, body) => page.route(/^https:/, (route) => route.fulfill({ body, contentType: "text/javascript", headers: { "access-control-allow-origin": "*" } }));

test("a row of solids that is chosen before the library is there is shown once it is", async () => {
  const { page, close } = await open(reports().bareCollide);
  try {
    const picture = () => page.evaluate(() => window.knotdock.picture());
    const row = (number) => page.locator("#list-table tbody tr").nth(number);
    await row(2).click();
    await serve(page, library);
    await page.click("#load-view");
    await page.waitForSelector("#scene canvas");
    const third = await picture();
    await row(0).click();
    assert.notEqual(await picture(), third);
    await row(2).click();
    assert.equal(await picture(), third);
  } finally {
    await close();
  }
});

for (const [kind, body, works] of [["the library", library, true], ["another file", `${library} `, false]]) {
  test(`a pressed button asks for one file, and ${kind} is ${works ? "shown" : "refused"}`, async () => {
    const { page, requests, address, close } = await open(reports().bare);
    try {
      await serve(page, body);
      await page.click("#load-view");
      if (works) {
        await page.waitForSelector("#scene canvas");
        assert.equal(await page.locator("#best button").count(), 10);
      } else {
        await page.waitForFunction(() => document.getElementById("no-view").textContent.includes("could not be loaded"));
        assert.equal(await page.locator("#scene").isVisible(), false);
      }
      const [own, asked, ...others] = requests;
      assert.deepEqual([own, others], [address, []]);
      assert.match(asked, /^https:\/\/cdn\.jsdelivr\.net\/npm\/3dmol@/);
    } finally {
      await close();
    }
  });
}

for (const width of [1280, 400]) {
  test(`the known complex and the figures of the cluster, ${width} pixels wide`, async () => {
    const { page, faults, close } = await open(reports().run, { width });
    try {
      const within = (selector) => page.locator(selector).evaluateAll((all) => all.length > 0 && all.every((one) => {
        const { left, right, height } = one.getBoundingClientRect();
        return left >= 0 && right <= document.documentElement.clientWidth && height > 0;
      }));
      const picture = () => page.evaluate(() => window.knotdock.picture());
      const before = await picture();
      await page.check("#show-overlay");
      assert.notEqual(await picture(), before);
      for (const selector of ["#show-overlay", "#legend li", "#cluster div"]) assert.ok(await within(selector), selector);
      assert.equal(await page.locator("#cluster div").count(), 6);
      assert.deepEqual(faults, []);
    } finally {
      await close();
    }
  });
}

test("a run without a known complex has none to draw", async () => {
  const { page, close } = await open(reports().ring);
  try {
    assert.equal(await page.locator("#show-overlay").isVisible(), false);
    assert.match(await page.locator("#of-cluster").innerText(), /at most 5\sÅ/);
    assert.equal(await page.locator("#cluster div").count(), 6);
  } finally {
    await close();
  }
});

test("a narrow window shows the view before the table", async () => {
  const { page, close } = await open(reports().run, { width: 400 });
  try {
    const top = (id) => page.locator(id).evaluate((element) => element.getBoundingClientRect().top);
    assert.ok(await top("#scene") < await top("#pose-table"));
  } finally {
    await close();
  }
});

for (const kind of ["ring", "solids", "collide"]) {
  test(`${kind}: another row is another picture, and the first is the same again`, async () => {
    const { page, close } = await open(reports()[kind]);
    try {
      const rows = page.locator("tbody tr.choice");
      const picture = () => page.evaluate(() => window.knotdock.picture());
      const first = await picture();
      await rows.nth(1).click();
      assert.notEqual(await picture(), first);
      await rows.nth(0).click();
      assert.equal(await picture(), first);
    } finally {
      await close();
    }
  });
}
