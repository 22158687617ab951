// Debian's Chromium, and what both the end-to-end test and the benchmark need of it.

import { existsSync } from "node:fs";
import { chromium } from "playwright-core";

const CHROMIUM = process.env.CHROMIUM ?? "/usr/bin/chromium";
export const THERE = existsSync(CHROMIUM);

export async function opened() {
  return chromium.launch({
    executablePath: CHROMIUM,
    args: ["--headless", "--no-sandbox", "--disable-quic", "--disable-background-networking"],
  });
}

/** A page whose complaints are kept: errors, and what the content security policy stopped. */
export async function watchedPage(browser, options = {}) {
  const page = await browser.newPage({ viewport: { width: 1280, height: 800 }, ...options });
  const complaints = [];
  page.on("pageerror", (error) => complaints.push(String(error)));
  page.on("console", (message) => {
    if (message.type() === "error") complaints.push(`${message.text()} ${message.location().url}`);
  });
  return { page, complaints };
}

/** Presses Tab until something has the focus: what cannot be reached so is not for everybody. */
export async function tabTo(page, selector, text = "", most = 400) {
  const there = ([wanted, said]) => {
    const active = document.activeElement;
    return active?.matches(wanted) && (active.textContent ?? "").trim().startsWith(said);
  };
  for (let pressed = 0; pressed < most; pressed += 1) {
    if (await page.evaluate(there, [selector, text])) return;
    await page.keyboard.press("Tab");
  }
  throw new Error(`${selector} is not reached by Tab`);
}

export function say(what) {
  console.log(JSON.stringify(what));
}
