import { expect, it } from "vitest";
import type { Incident } from "../src/api/types";
import { matches, OPEN_STATES, urgency, withChanged } from "../src/live/incidents";
import { withLights } from "../src/live/lights";

function incident(id: string, changes: Partial<Incident> = {}): Incident {
  return {
    id,
    time: "2026-01-05T06:00:00Z",
    last: "",
    severity: "fault",
    state: "unacknowledged",
    kind: "transition",
    group: "G",
    device: "D",
    place: "G-D",
    message: "PRT_CHK switched ON",
    look_first: "%IX0.2",
    findings: 1,
    acknowledged: null,
    shelved: null,
    accepted: null,
    ...changes,
  };
}

it("changes incidents in place and puts new ones in front", () => {
  const list = [incident("b"), incident("a")];
  const changed = withChanged(list, [incident("a", { state: "closed" }), incident("c"), incident("d")]);
  expect(changed.map((each) => each.id)).toEqual(["d", "c", "b", "a"]);
  expect(changed[3]!.state).toBe("closed");
  expect(changed[2]).toBe(list[0]);
});

it("filters by every word, by state and by severity", () => {
  const filter = { text: "prt %ix0.2", states: new Set(OPEN_STATES), severities: new Set(["fault" as const]) };
  expect(matches(incident("a"), filter)).toBe(true);
  expect(matches(incident("a"), { ...filter, text: "prt other" })).toBe(false);
  expect(matches(incident("a", { state: "closed" }), filter)).toBe(false);
  expect(matches(incident("a", { severity: "notice" }), filter)).toBe(false);
});

it("has first what nobody has seen", () => {
  const list = [
    incident("old", { time: "2026-01-05T05:00:00Z" }),
    incident("seen", { state: "acknowledged", time: "2026-01-05T09:00:00Z" }),
    incident("odd", { severity: "anomaly", time: "2026-01-05T08:00:00Z" }),
    incident("new", { time: "2026-01-05T07:00:00Z" }),
  ];
  expect(list.sort(urgency).map((each) => each.id)).toEqual(["new", "old", "odd", "seen"]);
});

it("a group shows the worst of its devices, and only what changed is new", () => {
  const green = { colour: "green" as const, blinks: false };
  const device = (name: string) => ({ device: name, light: green, state: null, since_ms: null });
  const groups = [
    { group: "A", light: green, devices: [device("1"), device("2")] },
    { group: "B", light: green, devices: [device("1")] },
  ];
  const red = { ...device("2"), light: { colour: "red" as const, blinks: true } };
  const changed = withLights(groups, { "A-2": red });
  expect(changed[0]!.light).toEqual(red.light);
  expect(changed[1]).toBe(groups[1]);
});
