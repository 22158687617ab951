// A fault in the served machine, from the first sign to the exported list, by keyboard alone; then
// every view is looked at by axe. Tells what it saw as lines of JSON; `tests/server/test_browser.py`
// breaks the machine and judges.

import { readFileSync } from "node:fs";
import { createRequire } from "node:module";
import { opened, say, tabTo, watchedPage } from "./browser.mjs";

const [base] = process.argv.slice(2);
const AXE = readFileSync(createRequire(import.meta.url).resolve("axe-core/axe.min.js"), "utf-8");

const browser = await opened();
// axe is put into the page from outside; everything else keeps to the page's own policy.
const { page, complaints } = await watchedPage(browser);
page.setDefaultTimeout(30_000);

await page.goto(base);
await page.getByText("connected", { exact: true }).waitFor();
await page.evaluate(() => {
  window.appeared = new Promise((resolve) => {
    const look = () => {
      const found = document.querySelector("li[data-incident].fault.unacknowledged");
      if (!found) return;
      watch.disconnect();
      resolve(Date.now());
    };
    const watch = new MutationObserver(look);
    watch.observe(document.body, { subtree: true, childList: true, attributes: true });
    look();
  });
});
say({ ready: true });
say({ appeared_ms: await page.evaluate(() => window.appeared) });

// Who is here, which incident, what is known of it.
await tabTo(page, "#operator");
await page.keyboard.type("Ada");
await tabTo(page, "li.fault a.message");
await page.keyboard.press("Enter");
await page.locator("article h2").waitFor();
say({
  sentence: await page.locator("article h2").innerText(),
  suspect: await page.locator(".suspects li").first().innerText(),
});
await page.locator("article .holder svg").waitFor();
say({ red_nodes: await page.locator("article svg .stroke-red").count() });
await page.locator("article canvas[data-fetched]:not([data-fetched='0'])").waitFor();
say({ devices: await page.locator("article tbody tr").count() });

await tabTo(page, "article button.primary");
await page.keyboard.press("Enter");
await page.getByText(/acknowledged by Ada/).first().waitFor();
say({ acknowledged: true });

await tabTo(page, 'a[href="#/live"]');
await page.keyboard.press("Enter");
await tabTo(page, "a[download]");
const [download] = await Promise.all([page.waitForEvent("download"), page.keyboard.press("Enter")]);
say({ exported: readFileSync(await download.path(), "utf-8") });

// Timing: zoom, jump from edge to edge, measure.
await page.keyboard.press("Alt+2");
await page.locator(".waves canvas:not([data-fetched='0'])").waitFor();
await tabTo(page, ".waves");
for (const key of ["l", "f", "ArrowDown", "p", "b", "p", "p", "+", "+", "ArrowRight"]) {
  await page.keyboard.press(key);
  await page.waitForTimeout(300);
}
say({ measured: await page.locator(".readout").innerText() });
const lanes = () => page.locator(".labels li").count();
const unfolded = await lanes();
await page.keyboard.press("z");
say({ folded: [unfolded, await lanes()] });
await page.keyboard.press("z");
// A cycle of the recording stays and is laid over the live machine.
await tabTo(page, ".tools select");
await page.keyboard.type("nominal");
await page.locator(".waves[aria-label$='nominal.csv']").waitFor();
await tabTo(page, ".waves");
for (const key of ["+", "+", "o"]) await page.keyboard.press(key);
await page.locator(".golden").waitFor();
await tabTo(page, ".tools select");
await page.keyboard.press("Home");
await page.locator(".waves[aria-label$='live']").waitFor();
say({ golden: await page.locator(".golden").innerText() });

// Model: a transition by keyboard, with its charts.
await page.keyboard.press("Alt+3");
await page.locator("section.graph svg").waitFor();
await tabTo(page, "nav[aria-label='Groups and devices'] a:nth-of-type(2)");
await page.keyboard.press("Enter");
await page.locator(".list button", { hasText: /^\s*RET_OFF/ }).first().waitFor();
await tabTo(page, ".list button", "RET_OFF");
await page.keyboard.press("Enter");
await page.locator("section[aria-label=Transition] canvas").first().waitFor();
say({
  charts: await page.locator("section[aria-label=Transition] canvas").count(),
  times_of: await page.locator("section[aria-label=Transition] select option:checked").innerText(),
});

// The same device in another model: where it differs, and by how much.
await tabTo(page, "label select", "–");
await page.keyboard.press("ArrowDown");
await page.locator(".legend").waitFor();
const differing = page.locator("nav[aria-label='Groups and devices'] .changed");
await differing.first().waitFor();
await page.locator(".list button .removed").first().waitFor();
say({
  differing: await differing.allInnerTexts(),
  first: await page.locator(".list li").first().innerText(),
  red: await page.locator("section.graph svg g.edge path[stroke='#b3201b']").count(),
});
await page.locator("input[type=range]").first().press("End");
await page.getByText(/left out/).waitFor();
say({ hidden: await page.getByText(/left out/).innerText() });

// Recordings: record, see it grow, stop.
await page.keyboard.press("Alt+4");
await tabTo(page, "section[aria-label=Record] input");
await page.keyboard.type("by hand");
await page.keyboard.press("Enter");
await page.getByRole("button", { name: "Stop recording" }).waitFor();
await tabTo(page, "section[aria-label=Record] button");
await page.keyboard.press("Enter");
await page.getByRole("link", { name: "by-hand" }).waitFor();
say({ recorded: true });
await tabTo(page, "textarea");
await page.keyboard.type("[souce]");
await page.getByText(/did you mean source/).waitFor();
say({ validated: true });

// Process: mined, played and followed by keyboard.
await page.keyboard.press("Alt+6");
await page.locator("input[name=reset]:checked").waitFor();
say({ opening: await page.locator("tr.chosen td:nth-child(2)").innerText() });
await tabTo(page, "section[aria-label=Mine] button.primary");
await page.keyboard.press("Enter");
await page.locator("section.net svg .token").waitFor();
const mined = new URL(page.url()).hash;
await tabTo(page, ".player input[type=range]");
for (const key of ["ArrowRight", "ArrowRight", "ArrowRight", "ArrowLeft"]) await page.keyboard.press(key);
await page.locator("li[aria-current=step]").waitFor();
say({ played: await page.locator("li[aria-current=step]").innerText() });
await page.locator("section.net svg .now").waitFor();
say({ quality: await page.locator("section[aria-label='Is the net good?']").innerText() });
await tabTo(page, "a", "Live machine");
await page.keyboard.press("Enter");
await page.locator("section[aria-label='Learned controller'] table.outputs tbody tr").first().waitFor();
say({ outputs: await page.locator("table.outputs tbody tr").count() });
const [net] = await Promise.all([
  page.waitForEvent("download"),
  page.locator("section.files a", { hasText: "PNML" }).press("Enter"),
]);
say({ pnml: readFileSync(await net.path(), "utf-8").slice(0, 400) });

say({ complaints });

// Each view by axe, in both schemes and on a phone.
const incident = await page.evaluate(async () => (await (await fetch("/api/live")).json()).incidents[0].id);
const views = ["#/live", `#/live/${incident}`, "#/timing", "#/model", "#/identify", "#/recordings"];
views.push("#/process", mined, `${mined}?live=1`);
say({ views: views.length });
for (const [colorScheme, width] of [["light", 1280], ["dark", 1280], ["light", 390]]) {
  const context = await browser.newContext({
    colorScheme,
    viewport: { width, height: 844 },
    bypassCSP: true,
    reducedMotion: "reduce",
  });
  const looked = await context.newPage();
  for (const view of views) {
    await looked.goto(`${base}${view}`);
    await looked.reload();
    await looked.locator("main h1 ~ *").first().waitFor();
    await looked.waitForTimeout(700);
    await looked.evaluate(AXE);
    const { violations } = await looked.evaluate(() => window.axe.run());
    const wide = await looked.evaluate(() => document.documentElement.scrollWidth);
    say({
      axe: `${view.replace(incident, "incident")} ${colorScheme} ${width}`,
      violations: violations.map((each) => `${each.id}: ${each.nodes[0].html.slice(0, 160)}`),
      sticks_out: wide > width,
    });
  }
  await context.close();
}
await browser.close();
