// What of a source belongs to an incident: the signals to draw, and the edges that were expected.

import type { Ghost, IncidentDetail, Signal, Source } from "../api/types";
import type { Expected } from "../timing/overlay";

const MOST_SIGNALS = 16;

export function fullSignal(signal: Signal): string {
  return [signal.group, signal.device, signal.signal].filter(Boolean).join("-");
}

/** Suspects and expected signals first, then the rest of their devices. */
export function concerned(detail: IncidentDetail, signals: Signal[]): Signal[] {
  const byName = new Map(signals.map((signal) => [fullSignal(signal), signal]));
  const { leading } = detail;
  const named = [
    ...leading.suspects.map((suspect) => suspect.signal),
    ...detail.ghosts.map((ghost) => ghost.signal),
    ...[leading.to, leading.from].map((state) => state && withoutValue(state)),
  ];
  const found = new Set(named.flatMap((name) => (name && byName.get(name)) || []));
  const devices = new Set([...found].map((signal) => `${signal.group} ${signal.device}`));
  for (const signal of signals) {
    if (devices.has(`${signal.group} ${signal.device}`)) found.add(signal);
  }
  return [...found].slice(0, MOST_SIGNALS);
}

export function expectedEdges(ghosts: Ghost[], source: Source): Expected[] {
  const origin = BigInt(source.origin_ns);
  const at = (ns: string | null) => (ns === null ? null : Number(BigInt(ns) - origin));
  const byName = new Map(source.signals.map((signal) => [fullSignal(signal), signal.lane]));
  return ghosts.flatMap((ghost) => {
    const lane = byName.get(ghost.signal);
    if (lane === undefined) return [];
    return {
      lane,
      value: ghost.value,
      typical: at(ghost.typical_ns),
      earliest: at(ghost.earliest_ns),
      latest: at(ghost.latest_ns),
      label: ghost.probability === null ? "expected" : `expected ${Math.round(ghost.probability * 100)} %`,
    };
  });
}

export function withoutValue(state: string): string {
  return state.replace(/_(ON|OFF)$|=-?\d+$/, "");
}
