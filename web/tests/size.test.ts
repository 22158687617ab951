// What a browser loads before the page shows: it may be a phone on a shop floor.

import { existsSync, readdirSync, readFileSync } from "node:fs";
import { gzipSync } from "node:zlib";
import { expect, it } from "vitest";

const PAGE = new URL("../../python/runglight/server/page/", import.meta.url);
const BUDGET_BYTES = 120_000;

it.runIf(existsSync(PAGE))("everything but the graph worker stays under 120 kB, compressed", () => {
  const assets = readdirSync(new URL("assets/", PAGE)).filter((name) => !name.includes("worker"));
  expect(assets.some((name) => name.endsWith(".js"))).toBe(true);
  const files = ["index.html", ...assets.map((name) => `assets/${name}`)];
  const size = files.reduce((sum, name) => sum + gzipSync(readFileSync(new URL(name, PAGE))).length, 0);
  console.log(`page: ${(size / 1000).toFixed(1)} kB compressed, all views together`);
  expect(size).toBeLessThan(BUDGET_BYTES);
});

it.runIf(existsSync(PAGE))("the page needs nothing from elsewhere", () => {
  const html = readFileSync(new URL("index.html", PAGE), "utf-8");
  expect(html).not.toMatch(/https?:\/\//);
  expect(html).not.toMatch(/<script(?![^>]*src=)|<style|style=/);
});
