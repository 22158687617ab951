import { describe, expect, it } from "vitest";
import { netDot, nodes } from "../src/process/net";
import { departures, lastPosition, markingAt, stepAt, waitAt } from "../src/process/play";
import type { Net, Place, Run, Runs } from "../src/process/types";
import { departs, fitness, listed, percent, precision, soundness, spoken, spokenIn } from "../src/process/words";

const place = (name: string, device: string, signal: string, type = "BOOL"): Place => ({
  name,
  group: device ? "Group1" : "plant",
  device,
  signal,
  address: "%IX0.1",
  type,
  description: "",
});
const PLACES = {
  "%IX0.1": place("%IX0.1", "", "%IX0.1"),
  "Group1-LDR-RET": place("Group1-LDR-RET", "LDR", "RET"),
  "Group1-LDR-STEP": place("Group1-LDR-STEP", "LDR", "STEP", "INT"),
};
const NET: Net = {
  places: [
    { id: "start", first: 1, last: 0 },
    { id: "p1", first: 0, last: 0 },
    { id: "end", first: 0, last: 1 },
  ],
  transitions: [
    { id: "t1", label: "%IX0.1=1", signal_class: "input", inputs: [0], outputs: [1] },
    { id: "tau", label: null, signal_class: null, inputs: [1], outputs: [2] },
  ],
};
const RUN: Run = {
  number: 0,
  name: "1",
  began_ms: 0,
  events: [
    { at_s: 0, activity: "%IX0.1=1", step: { fired: [0], marking: { 1: 1 } }, foretold: null },
    { at_s: 4.5, activity: "%IX0.1=1", step: { fired: [0], marking: { 1: 2 }, missing: [0] }, foretold: null },
  ],
  end: { fired: [1], marking: { 2: 1 }, remaining: [1] },
};

describe("words", () => {
  it("say changes as an electrician does", () => {
    expect(spoken("%IX0.1=0 & Group1-LDR-RET=1", PLACES)).toBe("%IX0.1 OFF & LDR-RET ON");
    expect(spoken("Group1-LDR-STEP=1", PLACES)).toBe("LDR-STEP = 1");
    expect(spoken("a job of another log", PLACES)).toBe("a job of another log");
    expect(spokenIn("after %IX0.1=0: set Group1-LDR-STEP=12", PLACES)).toBe("after %IX0.1 OFF: set LDR-STEP = 12");
  });
  it("never round up to all of it", () => {
    expect([1, 0.9996, 0.87, 0.004, 0].map(percent)).toEqual(["100 %", "99.9 %", "87 %", "0.4 %", "0.0 %"]);
  });
  it("tell where a run departs", () => {
    const at = { event: 1, activity: "%IX0.1=0", known: true, allowed: ["Group1-LDR-RET=1"] };
    expect(departs(at, PLACES)).toBe("event 2, %IX0.1 OFF: the net expects LDR-RET ON here");
    expect(departs({ ...at, known: false }, PLACES)).toContain("no such step");
    expect(departs({ ...at, activity: null }, PLACES)).toContain("ends too early");
  });
  it("judge", () => {
    const runs = { fitness: 0.99, fitting: 17, count: 36, precision: 0.33 } as Runs;
    expect(soundness({ sound: false, problems: ["After a it is stuck."], markings: 3 }).sentence).toContain("Do not control");
    expect(fitness(runs).sentence).toContain("17 of 36");
    expect(precision(runs).good).toBe(false);
    expect(fitness({ ...runs, fitting: 36 }).good).toBe(true);
  });
  it("name a few and count the others", () => {
    expect(listed(["a", "b", "c"])).toBe("a, b or c");
    expect(listed(["a", "b", "c", "d", "e"])).toBe("a, b, c or 2 others");
  });
});

describe("the drawing", () => {
  it("has a place for every token and an arc for every way", () => {
    const dot = netDot(NET, PLACES);
    expect(nodes(NET)).toBe(5);
    expect(dot).toContain('label="%IX0.1 ON"');
    for (const id of ["place 2", "transition 1", "arc in 0 0", "arc out 1 2"]) expect(dot).toContain(`id="${id}"`);
  });
  it("survives any name", () => {
    const odd = { ...NET, transitions: [{ ...NET.transitions[0]!, label: 'q"u\\o\nx' }] };
    expect(netDot(odd, {})).toContain('label="q\\"u\\\\o x"');
  });
});

describe("playing", () => {
  it("goes from the first place to the end of the run", () => {
    expect(lastPosition(RUN)).toBe(3);
    expect(markingAt(RUN, 0, NET)).toEqual({ 0: 1 });
    expect(stepAt(RUN, 1)!.fired).toEqual([0]);
    expect(markingAt(RUN, 3, NET)).toEqual({ 2: 1 });
  });
  it("knows where it departs", () => expect(departures(RUN)).toEqual([2, 3]));
  it("waits as long as the machine did, or evenly", () => {
    expect(waitAt(RUN, 1, "1")).toBe(4500);
    expect(waitAt(RUN, 1, "10")).toBe(450);
    expect(waitAt(RUN, 1, "even")).toBe(1000);
    expect(waitAt(RUN, 0, "1")).toBe(0);
  });
});
