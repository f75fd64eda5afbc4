// Uses two reports as a reader would: node report.test.js PLANE_RESULTS SOLID_RESULTS PICTURES

import assert from "node:assert/strict";
import { mkdirSync, mkdtempSync, readFileSync, rmSync } from "node:fs";
import { tmpdir } from "node:os";
import { join, resolve } from "node:path";
import { pathToFileURL } from "node:url";
import { chromium } from "playwright-core";
import { array, frames, history } from "./frame.js";

const [plane, solid, pictures] = process.argv.slice(2).map((path) => resolve(path));
mkdirSync(pictures, { recursive: true });

const FLAGS = ["--headless", "--no-sandbox", "--disable-gpu", "--disable-quic", "--no-first-run", "--disable-background-networking", "--disable-component-update", "--disable-sync"];
// WebGL 2 without a graphics card.
const SOFTWARE = ["--use-angle=swiftshader", "--enable-unsafe-swiftshader"];

async function browser(flags, options = {}) {
  const profile = mkdtempSync(join(tmpdir(), "jstsph-browser-"));
  const context = await chromium.launchPersistentContext(profile, {
    executablePath: "/usr/bin/chromium", args: [...FLAGS, ...flags], viewport: { width: 1400, height: 1000 }, ...options,
  });
  return { context, close: async () => { await context.close(); rmSync(profile, { recursive: true, force: true }); } };
}

/** A page with a report; every message of an error and every request is kept. */
async function open(context, results) {
  const page = await context.newPage();
  page.setDefaultTimeout(15000);
  page.problems = [];
  page.requests = [];
  page.on("console", (message) => { if (["error", "warning"].includes(message.type()) && !/GPU stall|swiftshader/i.test(message.text())) page.problems.push(message.text()); });
  page.on("pageerror", (error) => page.problems.push(String(error)));
  page.on("request", (request) => { if (!/^(data|blob):/.test(request.url())) page.requests.push(request.url()); });
  await page.goto(pathToFileURL(join(results, "report.html")).href);
  return page;
}

const settle = (page) => page.evaluate(() => new Promise((done) => { requestAnimationFrame(() => requestAnimationFrame(done)); }));

/** The picture of the body as a text, and how many colours it has. */
async function picture(page) {
  await settle(page);
  return page.evaluate(() => {
    const canvas = document.getElementById("scene");
    const copy = document.createElement("canvas");
    copy.width = canvas.width;
    copy.height = canvas.height;
    const pen = copy.getContext("2d");
    pen.drawImage(canvas, 0, 0);
    const { data } = pen.getImageData(0, 0, copy.width, copy.height);
    const words = new Uint32Array(data.buffer);
    return { url: canvas.toDataURL(), colours: new Set(words).size };
  });
}

/** Text of a file that a click saves. */
async function saved(page, locator) {
  const [file] = await Promise.all([page.waitForEvent("download"), locator.click()]);
  return { name: file.suggestedFilename(), text: readFileSync(await file.path(), "utf8") };
}

/** A shown number in SI units. */
function si(text) {
  const [number, unit = ""] = text.split(" ");
  const factor = { mm: 1e-3, "\u00b5m": 1e-6, m: 1, MPa: 1e6, GPa: 1e9, kPa: 1e3, Pa: 1 }[unit] ?? 1;
  return Number(number.replace("\u2212", "-")) * factor;
}

/** Moves over the view until a particle is under the pointer; its read-out as name and text. */
async function hover(page, from = 0.5) {
  const box = await page.locator("#scene").boundingBox();
  for (let i = 0; i < 400; i += 1) {
    const [u, v] = [0.2 + 0.5 * ((i * 0.618) % 1), from * 0.1 + 0.05 + 0.85 * ((i * 0.755) % 1)];
    await page.mouse.move(box.x + u * box.width, box.y + v * box.height);
    if (await page.locator("#tip").isVisible()) {
      const texts = await page.locator("#tip span").allTextContents();
      return Object.fromEntries(Array.from({ length: texts.length / 2 }, (_, k) => [texts[2 * k], texts[2 * k + 1]]));
    }
  }
  throw new Error("no particle was found under the pointer");
}

/** Five digits are shown: half of the last one. */
function assertShown(text, value, what, absolute = 0) {
  const shown = si(text);
  assert.ok(Math.abs(shown - value) <= 6e-5 * Math.abs(value) + absolute, `${what}: ${text} is shown, the file has ${value}`);
}

async function checkHover(page, results, axes) {
  const last = frames(results).at(-1).file;
  const tip = await hover(page);
  const particle = Number(tip.particle);
  const points = array(last, "Points");
  ["x", "y", "z"].slice(0, axes).forEach((name, axis) => assertShown(tip[name], points[3 * particle + axis], name, 6e-8)); // 0.0001 mm is shown
  assertShown(tip["equivalent plastic strain"], array(last, "equivalent_plastic_strain")[particle], "plastic strain");
  for (const [field, label] of [["von_mises_stress", "von Mises stress"], ["pressure", "pressure, tension positive"]]) {
    await page.locator("#field").selectOption({ label });
    const { [label]: text, particle: other } = await hover(page);
    assertShown(text, array(last, field)[Number(other)], field);
  }
  // Derived in the page: the magnitude of a vector and the displacement.
  await page.locator("#field").selectOption({ label: "velocity magnitude" });
  const velocity = await hover(page);
  const part = (i) => array(last, "velocity").slice(3 * i, 3 * i + axes);
  assertShown(velocity["velocity magnitude"].replace(" m/s", ""), Math.hypot(...part(Number(velocity.particle))), "velocity");
  await page.locator("#field").selectOption({ label: "displacement y" });
  const moved = await hover(page);
  const u = array(last, "displacement")[3 * Number(moved.particle) + 1];
  assert.ok(Math.abs(si(moved["displacement y"]) - u) <= 1e-4 * Math.abs(u) + 2e-8, `displacement ${moved["displacement y"]}, ${u}`);
  await page.locator("#field").selectOption({ label: "equivalent plastic strain" });
}

async function checkFrames(page, results) {
  const last = await picture(page);
  assert.ok(last.colours > 20, `the picture of the body has ${last.colours} colours`);
  const total = frames(results).length;
  assert.match(await page.locator("#moment").textContent(), new RegExp(`frame ${total} of ${total}`));
  await page.locator("#frame").evaluate((slider) => { slider.value = 1; slider.dispatchEvent(new Event("input")); });
  await page.waitForFunction((n) => document.getElementById("moment").textContent.includes(`frame 2 of ${n}`), total);
  const second = await picture(page);
  assert.ok(second.url !== last.url, "another frame looks the same");
  await page.locator("#play").click();
  await page.waitForFunction(() => / frame ([6-9]|\d\d) of/.test(document.getElementById("moment").textContent));
  await page.locator("#play").click();
  assert.ok((await picture(page)).url !== second.url, "playing changes nothing");
  await page.locator("#frame").evaluate((slider) => { slider.value = slider.max; slider.dispatchEvent(new Event("input")); });
  await page.waitForFunction((n) => document.getElementById("moment").textContent.includes(`frame ${n} of`), total);
  assert.ok((await picture(page)).url === last.url, "the same frame looks different after playing");
  // From the keyboard.
  await page.locator("#scene").focus();
  await page.keyboard.press(",");
  await page.waitForFunction((n) => document.getElementById("moment").textContent.includes(`frame ${n - 1} of`), total);
  await page.keyboard.press(".");
  await page.waitForFunction((n) => document.getElementById("moment").textContent.includes(`frame ${n} of`), total);
  for (const key of ["ArrowLeft", "+"]) {
    const before = await picture(page);
    await page.keyboard.press(key);
    assert.ok((await picture(page)).url !== before.url, `${key} changes nothing`);
  }
  await page.locator("#views button", { hasText: "Fit" }).click();
  // Range and colours.
  const before = await picture(page);
  await page.locator("#high").fill("0.1");
  await page.locator("#high").press("Enter");
  const narrow = await picture(page);
  assert.ok(narrow.url !== before.url, "the range changes nothing");
  await page.locator("#map").selectOption("cividis");
  assert.ok((await picture(page)).url !== narrow.url, "the colours change nothing");
  await page.locator("#map").selectOption("");
  await page.locator("#range-all").click();
}

async function checkSavedFrame(page, results) {
  const { text } = await saved(page, page.locator("#save-frame"));
  const rows = text.trim().split("\n");
  const strain = array(frames(results).at(-1).file, "equivalent_plastic_strain");
  assert.equal(rows.length, strain.length + 1);
  assert.match(rows[0], /^particle,x \(m\),y \(m\).*equivalent plastic strain$/);
  const middle = Math.floor(strain.length / 2);
  const value = Number(rows[middle + 1].split(",").at(-1));
  assert.ok(Math.abs(value - strain[middle]) <= 1e-7 * Math.abs(strain[middle]), `${value}, ${strain[middle]}`);
}

async function checkCurves(page, results) {
  const columns = history(results);
  const chart = page.locator(".chart", { has: page.locator("h3", { hasText: /^Energies$/ }) });
  const { name, text } = await saved(page, chart.locator("button", { hasText: "CSV" }));
  assert.match(name, /-Energies\.csv$/);
  const [header, ...rows] = text.trim().split("\n").map((line) => line.split(","));
  assert.match(header[0], /^time \(s\)$/);
  assert.equal(rows.length, columns.time.length);
  const kinetic = header.findIndex((cell) => cell.startsWith("kinetic"));
  rows.forEach((row, i) => {
    assert.equal(Number(row[0]), Number(columns.time[i]));
    assert.equal(Number(row[kinetic]), Number(columns.kinetic_energy[i]), `row ${i}`);
  });
  // Values at the cursor.
  const canvas = chart.locator("canvas");
  await canvas.scrollIntoViewIfNeeded();
  const box = await canvas.boundingBox();
  const at = (u, v) => [box.x + u * box.width, box.y + v * box.height];
  await page.mouse.move(...at(0.5, 0.5));
  const shown = await chart.locator(".legend button", { hasText: "kinetic" }).locator("output").textContent();
  const time = await chart.locator(".at").textContent();
  const seconds = Number(time.split(" ")[0]) * { s: 1, ms: 1e-3, "\u00b5s": 1e-6, ns: 1e-9 }[time.split(" ")[1]];
  const nearest = columns.time.map(Number).reduce((best, t, i, all) => (Math.abs(t - seconds) < Math.abs(all[best] - seconds) ? i : best), 0);
  const prefix = { k: 1e3, m: 1e-3, M: 1e6, "\u00b5": 1e-6 };
  const [number, unit] = shown.split(" ");
  const value = Number(number) * (prefix[unit[0]] ?? 1);
  assert.ok(Math.abs(value - Number(columns.kinetic_energy[nearest])) <= 1e-4 * Math.abs(value), `${shown} at ${time}, ${columns.kinetic_energy[nearest]}`);
  // Enlarge and back.
  const look = () => canvas.evaluate((node) => node.toDataURL());
  await page.mouse.move(...at(0.3, 0.3));
  const whole = await look();
  await page.mouse.down();
  await page.mouse.move(...at(0.4, 0.6), { steps: 3 });
  await page.mouse.up();
  await page.mouse.move(...at(0.3, 0.3));
  assert.ok(await look() !== whole, "dragging enlarges nothing");
  await chart.locator("button", { hasText: "All" }).click();
  await page.mouse.move(...at(0.3, 0.3));
  assert.ok(await look() === whole, "the whole range does not come back");
  // A click shows that time above.
  await page.mouse.click(...at(0.15, 0.5));
  await page.waitForFunction(() => !/frame (\d+) of \1$/.test(document.getElementById("moment").textContent));
  await page.locator("#frame").evaluate((slider) => { slider.value = slider.max; slider.dispatchEvent(new Event("input")); });
  assert.ok(await page.locator(".chart").count() >= 6, "diagrams are missing");
}

async function checkTables(page, results) {
  const summary = JSON.parse(readFileSync(join(results, "summary.json"), "utf8"));
  const row = (name) => page.locator("#tables tr", { has: page.locator("th", { hasText: name }) }).first().locator("td");
  assert.equal(await row("status").first().textContent(), "completed");
  assert.equal((await row("particles").first().textContent()).replace(/\s/g, ""), String(summary.particles));
  assert.ok((await page.locator("#case-text").textContent()).includes("[[body]]"));
  assert.ok((await page.locator("#log-text").textContent()).length > 50);
  assert.equal(await page.locator("h1").textContent(), await page.title());
}

async function checkTheme(page, name) {
  const background = () => page.evaluate(() => getComputedStyle(document.body).backgroundColor);
  const light = await background();
  const lightPicture = await picture(page);
  await page.evaluate(() => window.scrollTo(0, 0));
  await page.screenshot({ path: join(pictures, `${name}-light.png`), fullPage: true });
  await page.locator("#theme").selectOption("dark");
  assert.notEqual(await background(), light);
  assert.ok((await picture(page)).url !== lightPicture.url, "the view stays light");
  await page.screenshot({ path: join(pictures, `${name}-dark.png`), fullPage: true });
  await page.locator("#theme").selectOption("light");
}

async function checkSolid(page) {
  await page.locator("#scene").scrollIntoViewIfNeeded();
  await page.evaluate(() => window.scrollTo(0, 0));
  await page.locator("#views button", { hasText: "oblique" }).click();
  const whole = await picture(page);
  const box = await page.locator("#scene").boundingBox();
  await page.mouse.move(box.x + 300, box.y + 300);
  await page.mouse.down();
  await page.mouse.move(box.x + 360, box.y + 320, { steps: 3 });
  await page.mouse.up();
  const turned = await picture(page);
  assert.ok(turned.url !== whole.url, "dragging turns nothing");
  await page.locator("#clip").selectOption("1");
  const cut = await picture(page);
  assert.ok(cut.url !== turned.url, "the clip plane cuts nothing");
  await page.screenshot({ path: join(pictures, "solid-cut.png") });
  await page.locator("#clip-flip").check();
  assert.ok((await picture(page)).url !== cut.url, "the other side looks the same");
  await page.locator("#clip-flip").uncheck();
  await page.locator("#clip").selectOption("");
  await page.locator("#walls").uncheck();
  assert.ok((await picture(page)).url !== turned.url, "the wall is not drawn");
  await page.locator("#walls").check();
  await page.locator("#views button", { hasText: "oblique" }).click();
  assert.ok((await picture(page)).url === whole.url, "the first view does not come back");
}

async function check(context, name, results, axes) {
  const page = await open(context, results);
  await page.waitForFunction(() => / frame \d+ of/.test(document.getElementById("moment").textContent) && document.querySelector("#field").value !== "");
  assert.equal(await page.locator("#no-view").isVisible(), false, await page.locator("#no-view").textContent());
  await checkTables(page, results);
  await checkFrames(page, results);
  await checkHover(page, results, axes);
  await checkSavedFrame(page, results);
  await checkCurves(page, results);
  if (axes === 3) await checkSolid(page);
  await checkTheme(page, name);
  assert.deepEqual(page.problems, [], "messages in the console");
  assert.equal(page.requests.length, 1, `requests: ${page.requests.join(", ")}`);
  await page.close();
  console.log(`${name}: ok`);
}

const start = Date.now();
const software = await browser(SOFTWARE, { colorScheme: "light" });
try {
  await check(software.context, "plane", plane, 2);
  await check(software.context, "solid", solid, 3);
} finally {
  await software.close();
}

// The system's dark theme, and a browser without WebGL: tables and curves are there all the same.
const bare = await browser(["--disable-3d-apis"], { colorScheme: "dark" });
try {
  const page = await open(bare.context, solid);
  await page.locator("#no-view").waitFor();
  assert.match(await page.locator("#no-view").textContent(), /no WebGL 2/);
  assert.equal(await page.evaluate(() => document.documentElement.dataset.theme), "dark");
  assert.ok(await page.locator(".chart").count() >= 6);
  assert.ok(await page.locator("#tables tr").count() > 20);
  console.log("without WebGL: ok");
} finally {
  await bare.close();
}
console.log(`browser tests passed in ${((Date.now() - start) / 1000).toFixed(0)} s`);
