// An address is identified by keyboard alone: photos are stepped through, events declared, the
// ranking read, a name accepted; then once more by a rectangle, and in a log without photos. Tells
// what it saw as lines of JSON; `tests/server/test_browser_identify.py` judges.

import { lookedAt } from "./axe.mjs";
import { opened, say, tabTo, watchedPage } from "./browser.mjs";

const [base, photosOfEvents, log] = process.argv.slice(2);
const browser = await opened();
const { page, complaints } = await watchedPage(browser);
page.setDefaultTimeout(30_000);
const press = (...keys) => keys.reduce((done, key) => done.then(() => page.keyboard.press(key)), Promise.resolve());

await page.goto(base);
await page.locator("nav[aria-label=Views]").waitFor();
await press("Alt+5");
await page.locator(".stage img").waitFor();
await tabTo(page, ".strip");

// Ten at a time, then one by one: to every photo on which something happens.
let at = 0;
for (const wanted of photosOfEvents.split(",").map(Number)) {
  for (; at + 10 <= wanted; at += 10) await press("Shift+ArrowRight");
  for (; at < wanted; at += 1) await press("ArrowRight");
  await press("e");
}
say({ place: await page.locator(".place").innerText() });
await press("Home", "e", "u", "]");
say({ back: await page.locator(".place").innerText() });
await press("s");
await page.getByRole("button", { name: "Saved" }).waitFor();
say({ saved: await page.locator(".tools [role=status]").innerText() });

const first = () => page.locator("tbody tr.first button").allInnerTexts();
await page.locator("tbody tr.first").first().waitFor();
await tabTo(page, "input[type=range]");
await press("ArrowLeft", "ArrowLeft");
await page.waitForTimeout(500);
say({ tau: await page.locator("output").innerText(), narrower: await first() });
await press("ArrowRight", "ArrowRight");
await tabTo(page, "[aria-label='Which changes count'] button", "Rising");
await press("Enter");
await page.waitForTimeout(500);
say({ rising: await page.locator("tbody tr").first().innerText() });
await page.keyboard.press("Shift+Tab");
await press("Enter");
await tabTo(page, "select[aria-label=Order]");
await press("ArrowDown");
await page.locator("th", { hasText: "Agrees" }).waitFor();
await page.waitForTimeout(500);
say({ first: await first(), verdict: await page.locator(".verdict b").innerText() });
await page.locator("canvas[data-fetched]:not([data-fetched='0'])").waitFor();

await tabTo(page, "form.accept input");
await page.keyboard.type("Line3-Conveyor-Running");
await press("Enter");
await page.locator("form.accept .said").waitFor();
say({ accepted: await page.locator("form.accept .said").innerText() });
await page.locator("tbody td", { hasText: "Line3-Conveyor-Running" }).waitFor();
say({ shown: true });

// A rectangle, moved and sized by keys, proposes events.
await tabTo(page, ".strip");
const count = async () => Number(await page.locator(".events h2 span").innerText());
const before = await count();
await press("r");
await page.locator(".told:focus").waitFor();
for (let times = 0; times < 60; times += 1) await press("ArrowDown");
for (let times = 0; times < 20; times += 1) await press("Shift+ArrowUp");
await press("Tab");
await tabTo(page, "select[aria-label='An event is a change of']");
await press("ArrowDown");
await tabTo(page, "button.propose");
await press("Enter");
await page.getByText(/events proposed|nothing changes/).waitFor();
say({ proposed: (await count()) - before, said: await page.getByText(/events proposed|nothing changes/).innerText() });

const recording = page.url();

// Without photos, events are declared in the diagram.
await page.goto(`${base}#/identify/${log}`);
await page.getByText('conveyor.csv has no photos').waitFor();
await tabTo(page, ".waves[role=application]");
await press("e");
await page.locator(".verdict, .error").first().waitFor();
say({ without_photos: await count() });
say({ complaints });

// As somebody finds it who comes back: with events and a ranking, and then draws a rectangle.
await lookedAt(browser, recording, async (looked) => {
  await looked.locator("tbody tr.first").first().waitFor();
  await looked.locator(".strip").press("r");
  await looked.locator(".told:focus").waitFor();
});
await browser.close();
