// What a browser loads before the page shows: it may be a phone on a shop floor.

import { existsSync, readdirSync, readFileSync } from "node:fs";
import { gzipSync } from "node:zlib";
import { expect, it } from "vitest";

const PAGE = new URL("../../python/runglight/server/page/", import.meta.url);
const FIRST_BYTES = 120_000;
const ALL_BYTES = 200_000;

const asset = (name: string) => readFileSync(new URL(`assets/${name}`, PAGE));
const compressed = (names: string[]) => names.reduce((sum, name) => sum + gzipSync(asset(name)).length, 0);

/** A script and what it cannot do without, with the styles that belong to them. */
function needed(scripts: string[], assets: string[], found = new Set<string>()): Set<string> {
  for (const name of scripts.filter((each) => !found.has(each))) {
    found.add(name);
    const stem = name.replace(/-[^-]+\.js$/, "");
    for (const style of assets) if (style.startsWith(`${stem}-`) && style.endsWith(".css")) found.add(style);
    const imports = [...asset(name).toString().matchAll(/(?:from|import)\s*"\.\/([^"]+\.js)"/g)];
    needed(imports.map((each) => each[1]!), assets, found);
  }
  return found;
}

it.runIf(existsSync(PAGE))("what a browser needs to show the first view stays under 120 kB, compressed", () => {
  const assets = readdirSync(new URL("assets/", PAGE)).filter((name) => !name.includes("worker"));
  const entry = assets.filter((name) => /^(index|LiveView)-.*\.js$/.test(name));
  expect(entry).toHaveLength(2);
  const first = [...needed(entry, assets)];
  expect(first.some((name) => name.startsWith("IdentifyView"))).toBe(false);
  const html = gzipSync(readFileSync(new URL("index.html", PAGE))).length;
  const [least, all] = [html + compressed(first), html + compressed(assets)];
  console.log(`page: ${(least / 1000).toFixed(1)} kB compressed, all views ${(all / 1000).toFixed(1)} kB`);
  expect(least).toBeLessThan(FIRST_BYTES);
  expect(all).toBeLessThan(ALL_BYTES);
});

it.runIf(existsSync(PAGE))("the page needs nothing from elsewhere", () => {
  const html = readFileSync(new URL("index.html", PAGE), "utf-8");
  expect(html).not.toMatch(/https?:\/\//);
  expect(html).not.toMatch(/<script(?![^>]*src=)|<style|style=/);
});
