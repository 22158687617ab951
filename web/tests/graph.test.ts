import { describe, expect, it } from "vitest";
import type { Finding, Rule } from "../src/api/types";
import { dotOf, faultyDot, INK, keyOf, near, transitions } from "../src/graph/dot";
import { compared, differingParts, partOf } from "../src/model/compare";
import { histogram, numbers } from "../src/model/times";

function rule(current: string, next: string, changes: Partial<Rule> = {}): Rule {
  return {
    model: "device",
    group: "G",
    device: "D",
    current: `G-D-${current}`,
    next: `G-D-${next}`,
    count: 20,
    transition_probability: 1,
    cluster: 0,
    average_s: 1,
    minimum_s: 0.9,
    maximum_s: 1.1,
    early_limit_s: 0.5,
    late_limit_s: 2,
    time_probability: 1,
    position: 0,
    start_up: false,
    trigger: null,
    trigger_average_s: null,
    ...changes,
  };
}
const RULES = [rule("A_ON", "B_ON"), rule("A_ON", "B_ON", { cluster: 1, average_s: 5 }), rule("B_ON", "A_ON")];

describe("graphs", () => {
  it("have one edge a transition, with all its times", () => {
    const found = transitions(RULES);
    expect(found.map((each) => each.clusters.length)).toEqual([2, 1]);
    expect(dotOf(found)).toContain('label="  1 s | 5 s "');
  });
  it("show in red what was not known", () => {
    const finding = { from: "G-D-A_ON", to: "G-D-C_ON", path: [] } as unknown as Finding;
    const dot = faultyDot(RULES, finding)!;
    expect(dot).toMatch(new RegExp(`"G-D-A_ON" -> "G-D-C_ON" \\[color="${INK.red}"`));
    expect(dot).toContain('"G-D-C_ON" [label="C_ON"');
  });
  it("leave rare transitions out", () => {
    const rare = transitions([...RULES, rule("A_ON", "X_ON", { transition_probability: 0.01 })]);
    expect(dotOf(rare, { rarest: 0.05 })).not.toContain("X_ON");
  });
  it("survive any name", () => {
    const odd = dotOf(transitions([rule('q"u\\o', "new\nline")]));
    expect(odd).toContain('\\"u\\\\o');
    expect(odd.split("\n").every((line) => !line.startsWith("line"))).toBe(true);
  });
  it("of thousands of states show what lies near", () => {
    const many = transitions(Array.from({ length: 2000 }, (_, at) => rule(`S${at}`, `S${at + 1}`)));
    const shown = near(many, ["G-D-S1000"]);
    expect(shown.map((each) => each.current)).toContain("G-D-S1000");
    expect(shown.length).toBeLessThan(100);
  });
});

it("two models are compared", () => {
  const older = transitions([...RULES, rule("OLD", "A_ON")]);
  const newer = transitions([rule("A_ON", "B_ON", { average_s: 9 }), rule("B_ON", "A_ON"), rule("NEW", "A_ON")]);
  const { all, differences } = compared(older, newer);
  const told = Object.fromEntries(all.map((each) => [keyOf(each).split("\n")[0]!.slice(4), differences.get(keyOf(each))]));
  expect(told).toEqual({ A_ON: "changed", B_ON: undefined, NEW: "added", OLD: "removed" });
});

describe("histograms", () => {
  it("count everything once", () => {
    const values = Array.from({ length: 1000 }, (_, at) => Math.sin(at) + 5);
    const { counts, edges } = histogram(values);
    expect(counts.reduce((sum, count) => sum + count, 0)).toBe(1000);
    expect(edges.length).toBe(counts.length + 1);
    expect(counts.length).toBeLessThanOrEqual(60);
  });
  it.each([[[]], [[3]], [[3, 3, 3]], [[0, 0, 0, 0, 9]]])("of %j", (values) => {
    const { counts } = histogram(values);
    expect(counts.reduce((sum, count) => sum + count, 0)).toBe(values.length);
  });
  it("are told in numbers", () => {
    expect(numbers([3, 1, 2])).toEqual({ count: 3, median: 2, low: 1, high: 3 });
    expect(numbers([])).toBeNull();
  });
});

it("two models are held against each other device by device", () => {
  const older = [...RULES, rule("A_ON", "C_ON", { device: "E" }), rule("A_ON", "D_ON", { model: "group", device: null })];
  const newer = [...RULES, rule("A_ON", "C_ON", { device: "E", average_s: 3 })];
  const found = differingParts(older, newer);
  expect([...found]).toEqual([
    [partOf("G", "E"), 1],
    [partOf("G", ""), 1],
  ]);
});
