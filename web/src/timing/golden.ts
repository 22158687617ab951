// A golden cycle: one sound passing of the machine, to be laid over the others.

import { get, getBytes } from "../api/client";
import type { Signal, Source } from "../api/types";
import type { Lane } from "./spans";
import { unpack } from "./spans";
import type { View } from "./view";

export interface GoldenCycle {
  lanes: Map<number, Lane>;
  from: number;
  until: number;
  /** The signal whose rises begin a cycle. */
  lane: number;
}

const COLUMNS = 4000;
const MOST_LANES = 400;

/** The cycle around the middle of a view, from one rise of a signal to the next; null without. */
export async function goldenCycle(
  source: Source,
  start: Signal,
  signals: Signal[],
  view: View,
): Promise<GoldenCycle | null> {
  const middle = Math.round((view.from + view.until) / 2);
  const from = (await rise(source, start, middle, -1)) ?? (await rise(source, start, middle, 1));
  if (from === null) return null;
  const until = await rise(source, start, from, 1);
  if (until === null) return null;
  const lanes = signals.slice(0, MOST_LANES).map((signal) => signal.lane);
  const query = new URLSearchParams({
    origin: source.origin_ns,
    from: String(from - 1),
    until: String(until),
    columns: String(COLUMNS),
    lanes: lanes.join(),
  });
  const { bytes } = await getBytes(`/api/sources/${source.id}/window?${query}`);
  const unpacked = unpack(bytes);
  return {
    from,
    until,
    lane: start.lane,
    lanes: new Map(lanes.map((lane, index) => [lane, unpacked[index]!])),
  };
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
