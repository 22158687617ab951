// A run played: position 0 is before its first event, `events.length` after the last one, and one
// more is the end, where silent transitions have led to the last place.

import type { Marking, Net, Run, Step } from "./types";

export const SPEEDS = [
  { id: "even", name: "1 step a second" },
  { id: "1", name: "as it was" },
  { id: "10", name: "10 times faster" },
  { id: "100", name: "100 times faster" },
] as const;
export type Speed = (typeof SPEEDS)[number]["id"];

const EVEN_MS = 1000;
const LONGEST_WAIT_MS = 60_000;

export function lastPosition(run: Run): number {
  return run.events.length + 1;
}

export function stepAt(run: Run, position: number): Step | null {
  if (position <= 0) return null;
  return position > run.events.length ? run.end : run.events[position - 1]!.step;
}

export function initialMarking(net: Net): Marking {
  const found: Marking = {};
  net.places.forEach((place, number) => {
    if (place.first) found[number] = place.first;
  });
  return found;
}

export function markingAt(run: Run, position: number, net: Net): Marking {
  return stepAt(run, position)?.marking ?? initialMarking(net);
}

/** How long to wait at a position before the next step, in milliseconds. */
export function waitAt(run: Run, position: number, speed: Speed): number {
  if (speed === "even") return EVEN_MS;
  const factor = Number(speed);
  const at = position ? (run.events[position - 1]?.at_s ?? 0) : 0;
  const next = run.events[position]?.at_s;
  if (next === undefined) return EVEN_MS / factor;
  return Math.min(((next - at) * 1000) / factor, LONGEST_WAIT_MS);
}

export function departsAt(step: Step | null): boolean {
  return step !== null && ((step.missing?.length ?? 0) > 0 || (step.remaining?.length ?? 0) > 0 || step.known === false);
}

/** Positions at which a run departs from the net. */
export function departures(run: Run): number[] {
  const found: number[] = [];
  for (let position = 1; position <= lastPosition(run); position += 1) {
    if (departsAt(stepAt(run, position))) found.push(position);
  }
  return found;
}
