import { expect, it } from "vitest";
import type { Signal } from "../src/api/types";
import { pastedRows, wrongRows } from "../src/recordings/symbols";
import { parseAddress, hashOf } from "../src/shell/address";
import { bytes, length } from "../src/shell/time";
import { branches, isWord, searched } from "../src/timing/choose";
import { svgOf } from "../src/timing/export_svg";
import { rowsOf } from "../src/timing/rows";
import { savedViews, withoutSaved, withSaved } from "../src/timing/saved";
import { lane } from "./lanes";

function signal(at: number, device: string, name: string): Signal {
  return {
    lane: at,
    name: `%IX0.${at}`,
    group: "G",
    device,
    signal: name,
    address: `%IX0.${at}`,
    description: "",
    type: "BOOL",
    changes: 2,
    low: 0,
    high: 1,
  };
}
const SIGNALS = [signal(0, "A", "RET"), signal(1, "B", "RET"), signal(2, "A", "ADV")];

it("signals are sorted into devices and searched", () => {
  expect(branches(SIGNALS).map((branch) => branch.signals.length)).toEqual([2, 1]);
  expect(searched(SIGNALS, "a ret").map((each) => each.lane)).toEqual([0]);
  expect(searched(SIGNALS, "ix0.2").map((each) => each.lane)).toEqual([2]);
  expect(isWord({ ...SIGNALS[0]!, high: 7 })).toBe(true);
});

it("views are kept, and what is no view is not read", () => {
  const view = { name: "a", signals: ["x"], view: { from: 0, until: 1 } };
  const storage = (text: string | null) => ({ getItem: () => text });
  expect(savedViews(storage(JSON.stringify([view, { name: 3 }, null])))).toEqual([view]);
  expect(savedViews(storage("{broken"))).toEqual([]);
  expect(savedViews(storage(null))).toEqual([]);
  expect(withSaved([view], { ...view, signals: ["y"] })).toHaveLength(1);
  expect(withoutSaved([view], view.name)).toEqual([]);
});

it("a drawing holds every signal and no markup of theirs", () => {
  const odd = [{ ...SIGNALS[0]!, signal: "<script>" }, { ...SIGNALS[1]!, high: 9 }];
  const drawn = {
    view: { from: 0, until: 1000 },
    golden: { lanes: new Map([[0, lane([0, 1], [50, 0])]]), from: 0, until: 100, starts: [200] },
    cursors: { A: 250, B: null },
  };
  const svg = svgOf(rowsOf(odd), () => lane([0, 0], [500, 7]), drawn, 0n, "t & t");
  expect(svg).not.toContain("<script>");
  expect(svg).toContain("t &#38; t");
  expect(svg).toContain(">7</text>");
  // The golden cycle of 50 and 50, from 200 on, and cursor A alone.
  expect(svg).toContain("M390.0 34H440.0L440.0 50H490.0");
  expect(svg).toContain(">A</text>");
  expect(svg).not.toContain(">B</text>");
});

it("addresses are read and written", () => {
  const hash = hashOf("model", ["a b", "x/y"], { at: "12" });
  const address = parseAddress(hash, "live");
  expect(address.view).toBe("model");
  expect(address.rest).toEqual(["a b", "x/y"]);
  expect(address.query.get("at")).toBe("12");
  expect(parseAddress("", "live").view).toBe("live");
  expect(parseAddress("#/%E0%A4%A", "live").view).toBe("%E0%A4%A");
});

it("lengths of time and sizes are told in the unit that suits them", () => {
  expect([0, 2e-9, 0.0000153, 0.35, 1.424, 119.9, 125, 7500, 200_000, -0.5].map(length)).toEqual([
    "0 s", "2 ns", "15.3 µs", "350 ms", "1.42 s", "119.9 s", "2 min 5 s", "2 h 5 min", "2.31 d", "−500 ms",
  ]);
  expect([12, 4250, 5e8].map(bytes)).toEqual(["12 B", "4.3 kB", "500.0 MB"]);
});

it("symbols are looked at while they are typed", () => {
  const row = { address: "a", group: "", device: "", signal: "s", class: "", type: "", description: "" };
  expect(wrongRows([row, { ...row, address: "b", signal: "t" }]).size).toBe(0);
  expect(wrongRows([row, row]).get(1)).toContain("row 1 and row 2");
  expect(wrongRows([{ ...row, address: " " }]).get(0)).toContain("no address");
  expect(pastedRows("a\tG\tD\tS\n\nb\tG\tD\tT\n").map((each) => each.signal)).toEqual(["S", "T"]);
  expect(pastedRows("only one cell")).toEqual([]);
});
