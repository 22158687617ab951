// Events as they are declared: a list in time order. What is done can be undone.

import type { DeclaredEvent } from "./types";

/** Times closer than this are one: `events.csv` holds milliseconds. */
export const SAME_NS = 1e6;

export function eventAt(events: DeclaredEvent[], at: number): DeclaredEvent | undefined {
  return events.find((event) => Math.abs(event.at - at) <= SAME_NS);
}

export function withEvents(events: DeclaredEvent[], more: DeclaredEvent[]): DeclaredEvent[] {
  const added = more.filter((event, place) => !eventAt([...events, ...more.slice(0, place)], event.at));
  return [...events, ...added].sort((one, other) => one.at - other.at);
}

export function without(events: DeclaredEvent[], at: number): DeclaredEvent[] {
  return events.filter((event) => Math.abs(event.at - at) > SAME_NS);
}

export function relabelled(events: DeclaredEvent[], at: number, label: string): DeclaredEvent[] {
  return events.map((event) => (event.at === at ? { ...event, label } : event));
}

/** The next event after a time (or the one before it). */
export function neighbour(events: DeclaredEvent[], at: number, direction: 1 | -1): DeclaredEvent | undefined {
  const beyond = events.filter((event) => (event.at - at) * direction > SAME_NS);
  return direction > 0 ? beyond[0] : beyond.at(-1);
}

export function labelsOf(events: DeclaredEvent[]): string[] {
  return [...new Set(events.map((event) => event.label))].sort();
}

const STEPS_KEPT = 200;

export interface History {
  now: DeclaredEvent[];
  past: DeclaredEvent[][];
  future: DeclaredEvent[][];
}

export function begun(events: DeclaredEvent[]): History {
  return { now: events, past: [], future: [] };
}

export function did(history: History, next: DeclaredEvent[]): History {
  return { now: next, past: [...history.past, history.now].slice(-STEPS_KEPT), future: [] };
}

export function undone(history: History): History {
  const before = history.past.at(-1);
  if (!before) return history;
  return { now: before, past: history.past.slice(0, -1), future: [history.now, ...history.future] };
}

export function redone(history: History): History {
  const [next, ...later] = history.future;
  if (!next) return history;
  return { now: next, past: [...history.past, history.now], future: later };
}
