// How soon a fault is on the page, and whether an hour of looking at it fills the memory.

import { opened, say, watchedPage } from "./browser.mjs";

const [base] = process.argv.slice(2);
const MINUTES = Number(process.env.MINUTES ?? 0);
const browser = await opened();
const { page } = await watchedPage(browser);
page.setDefaultTimeout(120_000);
await page.goto(base);
await page.getByText("connected", { exact: true }).waitFor();
await page.evaluate(() => {
  window.appeared = new Promise((resolve) => {
    const look = () => {
      if (!document.querySelector("li[data-incident].fault")) return;
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
if (MINUTES) {
  // The live tail is what draws and fetches most.
  await page.goto(`${base}#/timing/live`);
  const session = await page.context().newCDPSession(page);
  for (let minute = 0; minute <= MINUTES; minute += 1) {
    await session.send("HeapProfiler.collectGarbage");
    const { usedSize } = await session.send("Runtime.getHeapUsage");
    const nodes = await page.evaluate(() => document.querySelectorAll("*").length);
    say({ minute, heap_mb: Number((usedSize / 1e6).toFixed(2)), nodes });
    if (minute < MINUTES) await page.waitForTimeout(60_000);
  }
}
await browser.close();
