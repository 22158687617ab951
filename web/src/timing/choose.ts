// Which signals are shown, and in which order.

import type { Signal } from "../api/types";

export interface Branch {
  group: string;
  device: string;
  signals: Signal[];
}

/** Signals by group and device, in the order in which they first come. */
export function branches(signals: Signal[]): Branch[] {
  const found = new Map<string, Branch>();
  for (const signal of signals) {
    const key = `${signal.group}\n${signal.device}`;
    const branch = found.get(key) ?? { group: signal.group, device: signal.device, signals: [] };
    branch.signals.push(signal);
    found.set(key, branch);
  }
  return [...found.values()];
}

export function searched(signals: Signal[], text: string): Signal[] {
  const words = text.toLowerCase().split(/\s+/).filter(Boolean);
  if (!words.length) return signals;
  return signals.filter((signal) => {
    const all = `${signal.group} ${signal.device} ${signal.signal} ${signal.address} ${signal.description}`;
    const lower = all.toLowerCase();
    return words.every((word) => lower.includes(word));
  });
}

export function isWord(signal: Signal): boolean {
  return signal.type !== "BOOL" || signal.low < 0 || signal.high > 1;
}
