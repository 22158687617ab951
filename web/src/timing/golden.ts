// A golden cycle: one sound passing of the machine, to be laid over others, also over those of
// another recording.

import { get, getBytes } from "../api/client";
import type { Signal, Source } from "../api/types";
import { moment } from "./axis";
import type { Golden } from "./overlay";
import type { Lane } from "./spans";
import { unpack } from "./spans";
import type { View } from "./view";

export interface GoldenCycle {
  /** By what a signal is called: lanes are other ones in another recording. */
  lanes: Map<string, Lane>;
  from: number;
  until: number;
  /** The signal whose rises begin a cycle. */
  start: string;
  sourceName: string;
  /** When it began, for people. */
  began: string;
}

const COLUMNS = 4000;
const MOST_LANES = 400;

export function nameOf(signal: Signal): string {
  return [signal.group, signal.device, signal.signal].join("\n");
}

/** The cycle around the middle of a view, from one rise of a signal to the next; null without. */
export async function goldenCycle(
  source: Source,
  start: Signal,
  shown: Signal[],
  view: View,
): Promise<GoldenCycle | null> {
  const middle = Math.round((view.from + view.until) / 2);
  const from = (await rise(source, start, middle, -1)) ?? (await rise(source, start, middle, 1));
  if (from === null) return null;
  const until = await rise(source, start, from, 1);
  if (until === null) return null;
  // Those in sight first: others may be looked at later, here or in another recording.
  const signals = [...new Set([...shown, ...source.signals])].slice(0, MOST_LANES);
  const query = new URLSearchParams({
    origin: source.origin_ns,
    from: String(from - 1),
    until: String(until),
    columns: String(COLUMNS),
    lanes: signals.map((signal) => signal.lane).join(),
  });
  const { bytes } = await getBytes(`/api/sources/${source.id}/window?${query}`);
  const unpacked = unpack(bytes);
  return {
    from,
    until,
    start: nameOf(start),
    sourceName: source.name,
    began: moment(BigInt(source.origin_ns), from).slice(11, 19),
    lanes: new Map(signals.map((signal, index) => [nameOf(signal), unpacked[index]!])),
  };
}

/** The cycle as it is laid over a source's lanes; null where the signal that begins it is missing. */
export function laidOver(
  golden: GoldenCycle,
  signals: Signal[],
): (Omit<Golden, "starts"> & { lane: number }) | null {
  const start = signals.find((signal) => nameOf(signal) === golden.start);
  if (!start) return null;
  const lanes = new Map<number, Lane>();
  for (const signal of signals) {
    const lane = golden.lanes.get(nameOf(signal));
    if (lane) lanes.set(signal.lane, lane);
  }
  return { lanes, from: golden.from, until: golden.until, lane: start.lane };
}

async function rise(
  source: Source,
  signal: Signal,
  after: number,
  direction: 1 | -1,
): Promise<number | null> {
  let at = after;
  // Every second change of a bit is a rise.
  for (let tries = 0; tries < 4; tries += 1) {
    const query = new URLSearchParams({
      origin: source.origin_ns,
      at: String(Math.round(at)),
      direction: String(direction),
      lanes: String(signal.lane),
    });
    const found = await get<{ at: number; value: number } | null>(
      `/api/sources/${source.id}/edge?${query}`,
    );
    if (!found) return null;
    if (found.value !== 0) return found.at;
    at = found.at;
  }
  return null;
}
