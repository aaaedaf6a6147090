// The page of `knotdock serve`: drop, mark residues, start, watch, look, repeat, and a server that ends in mid-run.

import assert from "node:assert/strict";
import { spawn } from "node:child_process";
import { mkdtempSync, readFileSync, rmSync } from "node:fs";
import { tmpdir } from "node:os";
import path from "node:path";
import { after, test } from "node:test";

import { end, newPage } from "./browser.mjs";

const program = process.env.KNOTDOCK;
if (!program) throw new Error("set KNOTDOCK to the program");
const root = path.resolve(import.meta.dirname, "../..");
const example = (side) => path.join(root, `structures/examples/1ppe_${side}_unbound.pdb`);
const library = readFileSync(path.join(root, "viewer/node_modules/3dmol/build/3Dmol-min.js"));
const folder = mkdtempSync(path.join(tmpdir(), "knotdock-serve-"));
const servers = [];

after(async () => {
  servers.forEach((server) => server.kill("SIGKILL"));
  await end();
  // A run that was ended with its server goes on to its next look at it.
  await new Promise((done) => setTimeout(done, 1000));
  rmSync(folder, { recursive: true, force: true, maxRetries: 5 });
});

/** Starts a server; the process and its link. */
async function serve(port = 0, name = "runs") {
  const server = spawn(program, ["serve", "--folder", path.join(folder, name), "--port", String(port), "--no-browser", "--json"], { stdio: ["ignore", "pipe", "inherit"] });
  servers.push(server);
  const link = await new Promise((done, failed) => {
    server.stdout.once("data", (line) => done(JSON.parse(line).link));
    server.once("exit", (code) => failed(new Error(`the server ended with ${code}`)));
  });
  return { server, link };
}

/** Opens the page, with the library where its address says. */
async function visit(link, size) {
  const opened = await newPage(size);
  await opened.page.route("https://cdn.jsdelivr.net/**", (route) => route.fulfill({ body: library, contentType: "text/javascript", headers: { "access-control-allow-origin": "*" } }));
  await opened.page.goto(link);
  await opened.page.waitForFunction(() => window.knotdock !== undefined);
  return opened;
}

/** Drops a file on a side, as from a file manager. */
async function drop(page, side, file) {
  const data = await page.evaluateHandle(([text, name]) => {
    const transfer = new DataTransfer();
    transfer.items.add(new File([text], name));
    return transfer;
  }, [readFileSync(file, "utf8"), path.basename(file)]);
  await page.dispatchEvent(`#${side} .drop`, "drop", { dataTransfer: data });
  await page.waitForFunction((id) => document.querySelectorAll(`#${id} [data-key]`).length > 0, side);
}

/** Sets an option. */
async function set(page, option, value) {
  if (!(await page.isVisible("#find"))) await page.click("#settings > details > summary");
  await page.fill("#find", option);
  await page.locator("#options label", { hasText: new RegExp(`^--${option}`) }).locator("input").first().fill(value);
}

const item = (page, run) => page.locator(`#runs > [data-run="${run}"]`);
const becomes = (page, run, state) => page.waitForSelector(`#runs > [data-run="${run}"][data-state="${state}"]`, { timeout: 120000 });

test("a pair is dropped, marked, docked, looked at and repeated, and a run survives its server", { timeout: 300000 }, async () => {
  const { server, link } = await serve();
  const { page, faults, requests } = await visit(link);
  assert.equal(await page.locator("#start").isDisabled(), true);
  await drop(page, "receptor", example("receptor"));
  await drop(page, "ligand", example("ligand"));
  assert.match(await page.locator("#receptor [role=status]").textContent(), /1 chain, 223 residues, 1628 atoms/);
  // Nothing is requested from elsewhere before the button of the view is pressed.
  assert.equal(requests.filter((address) => !address.startsWith(link)).length, 0);
  if (await page.locator("#receptor .scene button").count() > 0) await page.locator("#receptor .scene button").click();
  await page.waitForSelector("#receptor [data-drawn]");
  await page.waitForSelector("#ligand [data-drawn]");

  // Marks: in the sequence, and by a click on an atom of the view.
  await page.click('#receptor [data-key="A:57"]');
  const spot = await page.evaluate(() => {
    const { viewer, model } = window.knotdock.sides.ligand.view;
    // The atom nearest to the eye hides no other.
    const atoms = model.selectedAtoms({ atom: "CA" }).map((atom) => ({ atom, at: viewer.modelToScreen(atom) }));
    viewer.setStyle({}, { sphere: { radius: 1 } });
    viewer.render();
    return { x: atoms[0].at.x, y: atoms[0].at.y };
  });
  await page.mouse.click(spot.x, spot.y);
  await page.waitForFunction(() => window.knotdock.sides.ligand.marks.size === 1);
  await page.click("#ligand button");
  assert.equal(await page.evaluate(() => window.knotdock.sides.ligand.marks.size), 0);
  await page.check('#receptor input[value="blocked"]');
  for (const number of [60, 61, 62]) await page.click(`#receptor [data-key="A:${number}"]`);
  await page.check("[name=preset][value=fast]");
  await set(page, "write-top", "2");
  await page.click("#start");
  const run = "1ppe_receptor_unbound_1ppe_ligand_unbound";
  await page.waitForSelector("#now:not([hidden])");
  assert.equal(await page.textContent("#now-run"), run);
  await becomes(page, run, "done");
  await page.waitForSelector("#news a");
  const command = await item(page, run).locator("pre").textContent();
  assert.match(command, /^knotdock dock serve\/inputs\/0001\/1ppe_receptor_unbound.pdb .*--preset=fast --active-receptor=A:57 --block-receptor=A:60-62 --write-top=2$/);
  assert.equal(await item(page, run).locator("a[download]", { hasText: "top/" }).count(), 2);

  // The report shows itself and reaches nothing of the server.
  const [report] = await Promise.all([page.waitForEvent("popup"), page.click("#news a")]);
  await report.waitForFunction(() => window.knotdock !== undefined);
  assert.match(await report.textContent("h1"), /1ppe/);
  assert.equal(await report.evaluate(() => fetch("/api/runs").then(() => "answered", () => "refused")), "refused");
  await report.close();

  // Repeated with a change, cancelled, and started again behind another.
  await page.click('#receptor button:has-text("Clear marks")');
  await item(page, run).getByRole("button", { name: "Repeat with changes" }).click();
  await page.waitForSelector('#receptor .blocked[data-key="A:62"]');
  assert.equal(await page.isChecked("[name=preset][value=fast]"), true);
  assert.equal(await page.locator('#receptor .active[data-key="A:57"]').count(), 1);
  await page.check("[name=preset][value=default]");
  await set(page, "rotations", "200000");
  await page.waitForFunction(() => !document.getElementById("start").disabled);
  await page.click("#start");
  const second = `${run}_2`;
  await page.waitForFunction((name) => document.getElementById("now-run").textContent === name, second);
  await page.waitForFunction(() => document.getElementById("now-bar").value > 0, null, { timeout: 60000 });
  await page.click("#start");
  const third = `${run}_3`;
  await becomes(page, third, "waiting");
  await page.click("#now-cancel");
  await becomes(page, second, "cancelled");
  await page.waitForFunction((name) => document.getElementById("now-run").textContent === name, third);
  await page.waitForFunction(() => document.getElementById("now-bar").value > 0, null, { timeout: 60000 });

  // The server ends without a word in the middle of a run.
  server.kill("SIGKILL");
  await page.waitForFunction(() => document.getElementById("now-stage").textContent.includes("does not answer"));
  const again = await serve(Number(new URL(link).port));
  await becomes(page, third, "interrupted");
  const refusals = faults.filter((fault) => !/ERR_(CONNECTION_REFUSED|INCOMPLETE_CHUNKED_ENCODING|CONNECTION_RESET|EMPTY_RESPONSE)/.test(fault));
  assert.deepEqual(refusals, []);
  await item(page, second).getByRole("button", { name: "Remove from the list" }).click();
  await page.waitForFunction((name) => !document.querySelector(`[data-run="${name}"]`), second);
  await item(page, third).getByRole("button", { name: "Start again" }).click();
  await becomes(page, third, "running");
  await page.click("#now-cancel");
  await becomes(page, third, "cancelled");
  again.server.kill("SIGKILL");
  await page.close();
});

test("the page works by keyboard alone at 400 pixels, and what it refuses it says", { timeout: 120000 }, async () => {
  const { server, link } = await serve(0, "keyboard");
  const { page, faults } = await visit(link, { width: 400 });
  const focused = () => page.evaluate(() => document.activeElement.outerHTML);
  const tabTo = async (wanted) => {
    for (let steps = 0; steps < 200; steps += 1) {
      await page.keyboard.press("Tab");
      if (await page.evaluate((selector) => document.activeElement.matches(selector), wanted)) return;
    }
    assert.fail(`the Tab key does not reach ${wanted}: ${await focused()}`);
  };
  const choose = async (side, file) => {
    await tabTo(`#${side} input[type=file]`);
    const [chooser] = await Promise.all([page.waitForEvent("filechooser"), page.keyboard.press("Space")]);
    await chooser.setFiles(file);
    await page.waitForFunction((id) => document.querySelectorAll(`#${id} [data-key]`).length > 0, side);
  };
  await choose("receptor", example("receptor"));
  await tabTo("#receptor [data-key]");
  for (const key of ["ArrowRight", "ArrowDown", "ArrowLeft", "Space", "End", "Enter"]) await page.keyboard.press(key);
  assert.deepEqual(await page.evaluate(() => [...window.knotdock.sides.receptor.marks.keys()]), ["A:26", "A:245"]);
  await choose("ligand", example("ligand"));
  // A number that is out of range is refused by the program; the page shows its sentence.
  await tabTo("#settings summary");
  await page.keyboard.press("Enter");
  await tabTo("#find");
  await page.keyboard.type("rotations");
  await tabTo("#options input[placeholder]");
  await page.keyboard.type("-3");
  await tabTo("#start");
  await page.keyboard.press("Enter");
  await becomes(page, "1ppe_receptor_unbound_1ppe_ligand_unbound", "failed");
  assert.match(await page.textContent("#runs .warnings"), /rotations/);
  assert.equal(await page.evaluate(() => document.documentElement.scrollWidth), 400);
  assert.deepEqual(await tooFaint(page), []);
  assert.deepEqual(faults, []);
  await page.close();
  server.kill("SIGKILL");
});

/** Texts whose contrast is below 4.5, the bound of WCAG's level AA. */
function tooFaint(page) {
  return page.evaluate(() => {
    document.querySelectorAll("details").forEach((details) => { details.open = true; });
    const parts = (colour) => colour.match(/[\d.]+/g).map(Number);
    const light = (colour) => {
      const [r, g, b] = parts(colour).map((part) => (part / 255 <= 0.04045 ? part / 255 / 12.92 : ((part / 255 + 0.055) / 1.055) ** 2.4));
      return 0.2126 * r + 0.7152 * g + 0.0722 * b;
    };
    const behind = (element) => {
      for (let at = element; at; at = at.parentElement) {
        const colour = getComputedStyle(at).backgroundColor;
        if ((parts(colour)[3] ?? 1) > 0) return colour;
      }
      return "rgb(255, 255, 255)";
    };
    const walker = document.createTreeWalker(document.body, NodeFilter.SHOW_TEXT);
    const faint = [];
    while (walker.nextNode()) {
      const element = walker.currentNode.parentElement;
      if (walker.currentNode.textContent.trim() === "" || !element.checkVisibility() || element.closest(":disabled, script, noscript")) continue;
      const [high, low] = [getComputedStyle(element).color, behind(element)].map(light).sort((a, b) => b - a);
      if ((high + 0.05) / (low + 0.05) < 4.5) faint.push(walker.currentNode.textContent.trim().slice(0, 40));
    }
    return faint;
  });
}

test("meshes are shown and dock", { timeout: 120000 }, async () => {
  const { server, link } = await serve(0, "meshes");
  const { page, faults } = await visit(link);
  for (const [side, size] of [["receptor", 10], ["ligand", 6]]) {
    const vertices = [[0, 0, 0], [size, 0, 0], [0, size, 0], [0, 0, size]].map((point) => `v ${point.join(" ")}\n`).join("");
    await page.setInputFiles(`#${side} input >> nth=0`, { name: `${side}.obj`, mimeType: "text/plain", buffer: Buffer.from(`${vertices}f 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\n`) });
    await page.waitForFunction((id) => document.querySelector(`#${id} [role=status]`).textContent.includes("mesh"), side);
  }
  if (await page.locator("#receptor .scene button").count() > 0) await page.locator("#receptor .scene button").click();
  await page.waitForSelector("#receptor [data-drawn] canvas");
  await set(page, "rotations", "60");
  await page.click("#start");
  await becomes(page, "receptor_ligand", "done");
  assert.deepEqual(faults, []);
  await page.close();
  server.kill("SIGKILL");
});

test("an idle server takes no time and little memory", { skip: process.platform !== "linux" }, async () => {
  const { server } = await serve(0, "idle");
  const read = (name) => readFileSync(`/proc/${server.pid}/${name}`, "utf8");
  const ticks = () => read("stat").split(" ").slice(13, 15).map(Number).reduce((sum, part) => sum + part);
  const before = ticks();
  await new Promise((done) => setTimeout(done, 3000));
  assert.ok(ticks() - before <= 1, `${ticks() - before} hundredths of a second`);
  const [, kilobytes] = /VmRSS:\s+(\d+)/.exec(read("status"));
  assert.ok(kilobytes < 40000, `${kilobytes} kB`);
  server.kill("SIGKILL");
});
