// What differs between the rules of two models.

import type { Transition } from "../graph/dot";
import { keyOf, transitions } from "../graph/dot";
import type { Rule } from "../api/types";

export type Difference = "added" | "removed" | "changed";

/** Relative change of the usual time, or of the probability, that counts. */
const SIGNIFICANT = 0.15;
const SMALLEST_S = 0.02;

export const SAID: Record<Difference, string> = {
  added: "only here",
  removed: "only in the other",
  changed: "other time or share",
};

/** How many transitions differ, by device (`group` and `device` with a line break between), or by group for its chain. */
export function differingParts(older: Rule[], newer: Rule[]): Map<string, number> {
  const parts = new Map<string, [Rule[], Rule[]]>();
  [older, newer].forEach((rules, side) => {
    for (const rule of rules) {
      const name = partOf(rule.group, rule.model === "device" ? (rule.device ?? "") : "");
      const both = parts.get(name) ?? [[], []];
      both[side]!.push(rule);
      parts.set(name, both);
    }
  });
  const found = new Map<string, number>();
  for (const [name, [before, after]] of parts) {
    const count = compared(transitions(before), transitions(after)).differences.size;
    if (count) found.set(name, count);
  }
  return found;
}

export function partOf(group: string, device: string): string {
  return `${group}\n${device}`;
}

export interface Compared {
  all: Transition[];
  differences: Map<string, Difference>;
}

/** Transitions of both; `added` are only in the newer one. */
export function compared(older: Transition[], newer: Transition[]): Compared {
  const before = new Map(older.map((each) => [keyOf(each), each]));
  const differences = new Map<string, Difference>();
  for (const each of newer) {
    const known = before.get(keyOf(each));
    before.delete(keyOf(each));
    if (!known) differences.set(keyOf(each), "added");
    else if (differs(known, each)) differences.set(keyOf(each), "changed");
  }
  for (const key of before.keys()) differences.set(key, "removed");
  return { all: [...newer, ...before.values()], differences };
}

function differs(one: Transition, other: Transition): boolean {
  if (Math.abs(one.probability - other.probability) > SIGNIFICANT) return true;
  const [mean, otherMean] = [usual(one), usual(other)];
  if (mean === null || otherMean === null) return false;
  return Math.abs(mean - otherMean) > Math.max(SIGNIFICANT * mean, SMALLEST_S);
}

/** Mean time over all clusters. */
export function usual(transition: Transition): number | null {
  let sum = 0;
  let weight = 0;
  for (const rule of transition.clusters) {
    if (rule.average_s === null) continue;
    const share = rule.time_probability ?? 1;
    sum += rule.average_s * share;
    weight += share;
  }
  return weight ? sum / weight : null;
}
