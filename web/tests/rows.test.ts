import { expect, it } from "vitest";
import type { Signal } from "../src/api/types";
import { laidOver, nameOf, type GoldenCycle } from "../src/timing/golden";
import { drawFolded, Pixels } from "../src/timing/raster";
import { movedRow, rowsOf, toggled } from "../src/timing/rows";
import { lane } from "./lanes";

function signal(lane: number, device: string, name: string): Signal {
  return {
    lane,
    name,
    group: "G",
    device,
    signal: name,
    address: "",
    description: "",
    type: "BOOL",
    changes: 1,
    low: 0,
    high: 1,
  };
}

const SIGNALS = [signal(0, "A", "ON"), signal(1, "B", "ON"), signal(2, "A", "OFF"), signal(3, "C", "ON")];

it("a folded device stands where its first signal stands, wherever the others are", () => {
  const rows = rowsOf(SIGNALS, new Set(["G · A"]));
  expect(rows.map((row) => row.signals.map((each) => each.lane))).toEqual([[0, 2], [1], [3]]);
  expect(rows.map((row) => row.folded)).toEqual([true, false, false]);
  expect(rowsOf(SIGNALS).map((row) => row.signals[0]!.lane)).toEqual([0, 1, 2, 3]);
});

it("a folded device is moved as a whole", () => {
  const rows = rowsOf(SIGNALS, toggled(new Set(), "G · A"));
  expect(movedRow(rows, 0, 1).map((each) => each.lane)).toEqual([1, 0, 2, 3]);
  expect(movedRow(rows, 2, -5).map((each) => each.lane)).toEqual([3, 0, 2, 1]);
  expect(toggled(new Set(["G · A"]), "G · A").size).toBe(0);
});

it("a folded row shows every change of its signals", () => {
  const pixels = new Pixels(10, 12);
  const inks = { ground: 0, wave: 2, high: 3, busy: 4, unknown: 5, grid: 6, gap: 7 };
  const lanes = [lane([0, 0], [300, 1]), lane([0, 1], [700, 0])];
  drawFolded(pixels, lanes, { from: 0, until: 1000 }, { top: 0, height: 12, thick: 1 }, inks);
  const middle = Array.from(pixels.data.subarray(60, 70));
  expect(middle).toEqual([0, 0, 0, 2, 0, 0, 0, 2, 0, 0]);
});

it("a golden cycle finds its signals by name in another recording", () => {
  const golden: GoldenCycle = {
    lanes: new Map([
      [nameOf(SIGNALS[0]!), lane([0, 1])],
      [nameOf(SIGNALS[1]!), lane([0, 0])],
    ]),
    from: 0,
    until: 10,
    start: nameOf(SIGNALS[1]!),
    sourceName: "sound",
    began: "06:00:00",
  };
  const elsewhere = [signal(8, "B", "ON"), signal(9, "A", "ON"), signal(7, "X", "ON")];
  const laid = laidOver(golden, elsewhere);
  expect(laid?.lane).toBe(8);
  expect([...laid!.lanes.keys()]).toEqual([8, 9]);
  expect(laidOver(golden, [elsewhere[1]!])).toBeNull();
});
