import { opened, say, watchedPage } from "./browser.mjs";
const [base, out] = process.argv.slice(2);
const browser = await opened();
const o = await (await fetch(`${base}api/process`)).json();
const { page, complaints } = await watchedPage(browser, { viewport: { width: 1280, height: 900 } });
page.setDefaultTimeout(60000);
let n=0;
for (const each of o.mined) {
  await page.goto(`${base}#/process/${each.id}`); await page.waitForTimeout(4000);
  await page.locator("button[aria-label=Step]").click(); await page.locator("button[aria-label=Step]").click(); await page.waitForTimeout(1500);
  await page.screenshot({ path: `${out}/big-${n++}.png` });
}
say(complaints); await browser.close();
