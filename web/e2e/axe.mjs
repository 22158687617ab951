// What axe has to say of a view: in both schemes, on a desk and on a phone.

import { readFileSync } from "node:fs";
import { createRequire } from "node:module";
import { say } from "./browser.mjs";

const AXE = readFileSync(createRequire(import.meta.url).resolve("axe-core/axe.min.js"), "utf-8");
const LOOKS = ["light", "dark"].flatMap((scheme) => [1280, 390].map((width) => [scheme, width]));

/** Tells of one address; `ready` waits for what is to be looked at. */
export async function lookedAt(browser, address, ready) {
  for (const [colorScheme, width] of LOOKS) {
    // axe is put into the page from outside, which the page's own policy would forbid.
    const context = await browser.newContext({
      colorScheme,
      viewport: { width, height: 844 },
      bypassCSP: true,
      reducedMotion: "reduce",
    });
    const page = await context.newPage();
    await page.goto(address);
    await ready(page);
    await page.evaluate(AXE);
    const { violations } = await page.evaluate(() => window.axe.run());
    const wide = await page.evaluate(() => document.documentElement.scrollWidth);
    say({
      axe: `${colorScheme} ${width}`,
      violations: violations.map((each) => `${each.id}: ${each.nodes[0].html.slice(0, 160)}`),
      sticks_out: wide > width,
    });
    await context.close();
  }
}
