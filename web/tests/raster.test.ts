import { describe, expect, it } from "vitest";
import { drawBit, drawWord, packed, Pixels, type Inks } from "../src/timing/raster";
import type { Lane } from "../src/timing/spans";
import { lane } from "./lanes";

const INKS: Inks = { ground: 1, wave: 2, high: 3, busy: 4, unknown: 5, grid: 6, gap: 7 };

function drawn(spans: Lane, width = 20, draw = drawBit): string[] {
  const pixels = new Pixels(width, 12);
  pixels.clear(INKS.ground);
  draw(pixels, spans, { from: 0, until: 1000 }, { top: 0, height: 12, thick: 1 }, INKS);
  return Array.from({ length: 12 }, (_, y) =>
    Array.from(pixels.data.subarray(y * width, (y + 1) * width), (ink) => ".#+=?"[ink - 1]).join(""),
  );
}

describe("bits", () => {
  it("run high and low", () => {
    expect(drawn(lane([0, 0], [500, 1]))).toEqual([
      "....................",
      "....................",
      "..........##########",
      ...Array(6).fill("..........#+++++++++"),
      "###########+++++++++",
      "....................",
      "....................",
    ]);
  });

  it("never lose a pulse, however short", () => {
    const rows = drawn(lane([0, 0], [333.3333, 1], [333.3334, 0]));
    expect(rows[4]![6]).toBe("#");
  });

  it("show that more happens than can be drawn", () => {
    const rows = drawn(lane([0, 0], [400.1, 1, 500], [400.2, 0]));
    expect(rows[2]![8]).toBe("#");
    const wide = drawn(lane([0, 0], [200, 1, 500], [600, 0]));
    expect(wide[5]!.slice(5, 12)).toBe("=======");
  });

  it("are dotted before the first row", () => {
    const unknown = { ...lane([0, 0], [500, 1]), known: Uint8Array.from([0, 1]) };
    expect(drawn(unknown)[6]).toContain("??");
    expect(drawn(unknown)[9]!.startsWith("#")).toBe(false);
  });

  it("stay inside the picture wherever the view is", () => {
    const pixels = new Pixels(20, 12);
    const spans = lane([-1e15, 0], [-5e14, 1], [1e15, 0]);
    drawBit(pixels, spans, { from: 0, until: 1 }, { top: -6, height: 12, thick: 2 }, INKS);
    drawBit(pixels, spans, { from: 0, until: 1 }, { top: 8, height: 12, thick: 2 }, INKS);
    expect(pixels.data.length).toBe(240);
    expect(pixels.data.some((ink) => ink === INKS.high)).toBe(true);
  });
});

describe("words", () => {
  it("are boxes with an edge at every change", () => {
    const rows = drawn(lane([0, 7], [500, 9]), 20, drawWord);
    expect(rows[2]).toBe("#".repeat(20));
    expect(rows[9]).toBe("#".repeat(20));
    expect(rows[5]![10]).toBe("#");
  });
});

describe("colours", () => {
  it.each([
    ["#ff8000", 0xff0080ff],
    ["#fff", 0xffffffff],
    [" #102030 ", 0xff302010],
    ["red", 0xff808080],
  ])("%s", (text, ink) => expect(packed(text)).toBe(ink));
});
