// Zooms and pans a large recording and tells how long frames took, by the browser's own clock.

import { opened, say, watchedPage } from "./browser.mjs";

const [base, source] = process.argv.slice(2);
const browser = await opened();
const { page, complaints } = await watchedPage(browser);
page.setDefaultTimeout(180_000);
await page.goto(`${base}#/timing/${source}`);
await page.locator(".waves canvas:not([data-fetched='0'])").waitFor();
await page.waitForTimeout(1500);

/** One wheel event a frame; from frame to frame, and what drawing alone took. */
function frames([count, deltaY, deltaX]) {
  return new Promise((resolve) => {
    const canvas = document.querySelector(".waves canvas");
    const box = canvas.getBoundingClientRect();
    const between = [];
    const drawing = [];
    let before = null;
    const step = (now) => {
      if (before !== null) between.push(now - before);
      before = now;
      drawing.push(Number(canvas.dataset.frameMs));
      if (between.length >= count) return resolve({ between, drawing });
      canvas.dispatchEvent(
        new WheelEvent("wheel", {
          deltaY: between.length % 120 < 60 ? deltaY : -deltaY,
          deltaX: between.length % 120 < 60 ? deltaX : -deltaX,
          clientX: box.left + box.width * 0.4,
          clientY: box.top + 40,
          bubbles: true,
          cancelable: true,
        }),
      );
      requestAnimationFrame(step);
    };
    requestAnimationFrame(step);
  });
}

const p95 = (values) => [...values].sort((a, b) => a - b)[Math.floor(values.length * 0.95)];
for (const [name, deltaY, deltaX] of [["zoom", -30, 0], ["pan", 0, 60], ["zoom deep", -60, 0]]) {
  const { between, drawing } = await page.evaluate(frames, [480, deltaY, deltaX]);
  say({ name, frames: between.length, p95_ms: p95(between), drawing_p95_ms: p95(drawing) });
}
const rows = await page.locator(".labels li").count();
say({ rows, fetches: Number(await page.locator(".waves canvas").getAttribute("data-fetched")), complaints });
await browser.close();
