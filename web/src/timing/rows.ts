// The rows of a diagram: a signal each, or all signals of a device that is folded.

import type { Signal } from "../api/types";

export interface Row {
  key: string;
  device: string;
  signals: Signal[];
  folded: boolean;
}

export function deviceOf(signal: Signal): string {
  return [signal.group, signal.device].filter(Boolean).join(" · ");
}

/** A folded device stands where its first signal stands. */
export function rowsOf(signals: Signal[], folded: ReadonlySet<string> = new Set()): Row[] {
  const rows: Row[] = [];
  const places = new Map<string, Row>();
  for (const signal of signals) {
    const device = deviceOf(signal);
    if (!folded.has(device)) {
      rows.push({ key: String(signal.lane), device, signals: [signal], folded: false });
      continue;
    }
    const there = places.get(device);
    if (there) {
      there.signals.push(signal);
      continue;
    }
    const row = { key: `folded ${device}`, device, signals: [signal], folded: true };
    places.set(device, row);
    rows.push(row);
  }
  return rows;
}

/** The signals in the order that results when a row is moved to another row's place. */
export function movedRow(rows: Row[], from: number, to: number): Signal[] {
  const order = [...rows];
  const [row] = order.splice(from, 1);
  if (row) order.splice(Math.max(0, Math.min(to, order.length)), 0, row);
  return order.flatMap((each) => each.signals);
}

export function toggled(folded: ReadonlySet<string>, device: string): Set<string> {
  const next = new Set(folded);
  if (!next.delete(device)) next.add(device);
  return next;
}
