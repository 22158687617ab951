import { describe, expect, it } from "vitest";
import { moment, parseMoment, stepFor, ticks } from "../src/timing/axis";
import { around, kept, lengthOf, panned, SHORTEST_NS, toPixel, toTime, zoomed } from "../src/timing/view";

const VIEW = { from: 1000, until: 3000 };
const ORIGIN = 1_767_594_421_220_000_123n;

describe("views", () => {
  it("zoom around a moment that stays where it is", () => {
    const near = zoomed(VIEW, 0.5, 1500, 1e9);
    expect(toPixel(near, 800, 1500)).toBeCloseTo(toPixel(VIEW, 800, 1500));
    expect(lengthOf(near)).toBeCloseTo(SHORTEST_NS);
  });
  it("zoom neither into nothing nor out of everything", () => {
    expect(lengthOf(zoomed(VIEW, 1e-9, 1500, 1e9))).toBeCloseTo(SHORTEST_NS);
    expect(lengthOf(zoomed(VIEW, 1e12, 1500, 1e9))).toBeCloseTo(1.2e9);
  });
  it("pan, and keep something in sight", () => {
    expect(panned(VIEW, 50)).toEqual({ from: 1050, until: 3050 });
    expect(kept({ from: 1e9, until: 1e9 + 100 }, 1000).from).toBe(990);
    expect(kept({ from: -1e9, until: -1e9 + 100 }, 1000).from).toBe(-90);
    expect(kept(VIEW, 1e6)).toBe(VIEW);
  });
  it("count pixels and times back and forth", () => {
    expect(toTime(VIEW, 400, toPixel(VIEW, 400, 1234))).toBeCloseTo(1234);
    expect(around(100, 10, 0.7)).toEqual({ from: 93, until: 103 });
  });
});

describe("the axis", () => {
  it.each([
    [1, 1],
    [3, 5],
    [1.2e6, 2e6],
    [0.4e9, 0.5e9],
    [3e9, 5e9],
    [40e9, 60e9],
    [3e12, 3.6e12],
    [1e17, 4 * 3.1536e16],
  ])("counts in round steps: %d", (wanted, step) => expect(stepFor(wanted)).toBeCloseTo(step));

  it("has its ticks at round moments of the clock", () => {
    const found = ticks({ from: 0, until: 10e9 }, 1000, ORIGIN);
    expect(found.length).toBeGreaterThan(4);
    for (const tick of found) {
      expect((ORIGIN + BigInt(Math.round(tick.time))) % 1_000_000_000n).toBe(0n);
    }
    expect(found[0]!.label).toBe("06:27:02");
  });
  it("tells microseconds apart where it must", () => {
    const found = ticks({ from: 0, until: 1000 }, 1000, ORIGIN);
    expect(new Set(found.map((tick) => tick.label)).size).toBe(found.length);
  });
  it("has no more ticks than fit", () => {
    for (let length = 10; length < 1e18; length *= 7) {
      const found = ticks({ from: -length, until: length }, 1200, ORIGIN);
      expect(found.length, `${length} ns`).toBeLessThan(20);
    }
  });
});

describe("moments", () => {
  it.each([
    ["2026-01-05 06:29:05.12", 123_899_999_877],
    ["2026-01-05T06:29:05.12Z", 123_899_999_877],
    ["06:29:05,12", 123_899_999_877],
    ["06:29", 118_779_999_877],
    ["+12.5", 12.5e9],
    ["+3 s", 3e9],
  ])("%s", (text, time) => expect(parseMoment(text, ORIGIN, 0)).toBe(time));

  it.each(["", "noon", "25", "2026-13-45 99:99:99", "+x"])("%j is none", (text) => {
    expect(parseMoment(text, ORIGIN, 0)).toBeNull();
  });
  it("are told in full", () => {
    expect(moment(ORIGIN, 0)).toBe("2026-01-05 06:27:01.220000");
  });
});
