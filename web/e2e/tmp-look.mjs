import { opened, say, watchedPage } from "./browser.mjs";
const [base, out] = process.argv.slice(2);
const browser = await opened();
const o = await (await fetch(`${base}api/process`)).json();
const net = o.nets[0].id, mined = o.mined[0]?.id;
for (const [scheme, width, height] of [["light",1280,900],["dark",1280,900],["light",390,844],["dark",390,844]]) {
  const { page, complaints } = await watchedPage(browser, { viewport: { width, height }, colorScheme: scheme });
  for (const [name, hash] of [["setup","#/process"],["mined",`#/process/${mined}`],["live",`#/process/${net}`]]) {
    await page.goto(`${base}${hash}`); await page.reload();
    await page.waitForTimeout(2500);
    if (name === "mined") { for (let i=0;i<5;i++) await page.locator("button[aria-label=Step]").click(); await page.waitForTimeout(700); }
    if (name === "live") await page.waitForTimeout(6000);
    await page.screenshot({ path: `${out}/${name}-${scheme}-${width}.png` });
    await page.evaluate(() => { const m = document.querySelector("main"); m.scrollTo(0, m.scrollHeight); });
    if (width === 390 || name !== "setup") { await page.waitForTimeout(300); await page.screenshot({ path: `${out}/${name}-${scheme}-${width}-end.png` }); }
  }
  say(complaints);
  await page.close();
}
await browser.close();
