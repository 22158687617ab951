// Pictures of every view for the documentation, in both schemes, on a desk and on a phone.
// Run by docs/pictures.py.

import { mkdirSync } from "node:fs";
import { opened, say, watchedPage } from "./browser.mjs";

const [base] = process.argv.slice(2);
const BELT = (process.env.BELT ?? "").split(",").filter(Boolean).map(Number);
const INTO = process.env.PICTURES ?? "pictures";
mkdirSync(INTO, { recursive: true });

const browser = await opened();
const { page } = await watchedPage(browser);
page.setDefaultTimeout(60_000);
await page.goto(base);
await page.getByText("connected", { exact: true }).waitFor();
say({ ready: true });
await page.locator("li[data-incident].fault").first().waitFor();
const told = await (await page.request.get(`${base}api/live`)).json();
const incident = told.incidents.find((each) => each.severity === "fault").id;
const sources = await (await page.request.get(`${base}api/sources`)).json();
const log = sources.find((each) => each.kind === "log");
const line = sources.find((each) => each.kind === "recording");
// The net of the sound machine, mined and kept as anybody would; then what broke held against it.
const headers = { "x-runglight": "pictures" };
async function mined(source, net) {
  const asked = { source: sources.find((each) => each.name === source).id, reset: "Group1-PrtLDR-PRT_CHK=1", net };
  let job = await (await page.request.post(`${base}api/process/mine`, { headers, data: asked })).json();
  while (!job.done) job = await (await page.request.get(`${base}api/process/jobs/${job.id}`)).json();
  return job.process;
}
const sound = await mined("sound.csv", null);
const kept = await (await page.request.post(`${base}api/process/${sound}/keep`, { headers, data: { name: "cell" } })).json();
const departing = await mined("with-fault.csv", kept.id);
await page.close();

const VIEWS = [
  ["live", "#/live"],
  ["incident", `#/live/${incident}`],
  ["timing", `#/timing/${log.id}`],
  ["model", `#/model/${told.model.id}/Group1/PrtLDR`],
  ["identify", `#/identify/${line.id}`],
  ["recordings", "#/recordings"],
  ["process", `#/process/${departing}`],
  ["process-set-up", "#/process"],
];

for (const colorScheme of ["light", "dark"]) {
  for (const [width, height] of [[1280, 800], [390, 844]]) {
    const context = await browser.newContext({
      colorScheme,
      viewport: { width, height },
      reducedMotion: "reduce",
    });
    const looked = await context.newPage();
    looked.setDefaultTimeout(60_000);
    for (const [name, hash] of VIEWS) {
      await looked.goto(`${base}${hash}`);
      await looked.reload();
      await looked.evaluate(() => localStorage.setItem("runglight.operator", "Ada"));
      if (name === "incident") await looked.locator("article svg").waitFor();
      if (name === "timing") {
        await looked.locator(".waves canvas:not([data-fetched='0'])").waitFor();
        const waves = looked.locator(".waves canvas");
        const box = await waves.boundingBox();
        for (const key of ["+", "+", "+", "+"]) await looked.locator(".waves").press(key);
        await looked.mouse.click(box.x + box.width * 0.3, box.y + 60);
        await looked.keyboard.down("Shift");
        await looked.mouse.click(box.x + box.width * 0.6, box.y + 60);
        await looked.keyboard.up("Shift");
      }
      if (name === "model") {
        await looked.locator("section.graph svg").waitFor();
        await looked.locator(".list button", { hasText: /RET_OFF\s*→\s*ADV_ON/ }).first().click();
        // The recording in the directory is of another machine.
        await looked.locator("section[aria-label=Transition] select").selectOption(log.id);
        await looked.locator("section[aria-label=Transition] canvas").first().waitFor();
        await looked.evaluate(() => document.querySelector("main").scrollTo(0, 0));
      }
      if (name === "identify") {
        // Where the belt starts or stops, as somebody would declare it.
        await looked.locator(".strip").focus();
        let at = 0;
        for (const wanted of BELT) {
          for (; at + 10 <= wanted; at += 10) await looked.keyboard.press("Shift+ArrowRight");
          for (; at < wanted; at += 1) await looked.keyboard.press("ArrowRight");
          await looked.keyboard.press("e");
        }
        await looked.locator("tbody tr.first").first().waitFor();
      }
      if (name === "process") {
        await looked.locator("section.net svg .token").waitFor();
        await looked.getByRole("button", { name: /^Play variant/ }).last().click();
        await looked.locator("section.net svg .token.missing").first().waitFor();
        await looked.evaluate(() => document.querySelector("main").scrollTo(0, 0));
      }
      if (name === "process-set-up") await looked.locator("input[name=reset]:checked").waitFor();
      await looked.waitForTimeout(1200);
      await looked.screenshot({ path: `${INTO}/${name}-${colorScheme}-${width}.png` });
    }
    await context.close();
  }
}
await browser.close();
