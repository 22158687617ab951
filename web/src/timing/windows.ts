// Fetches windows of a source ahead of what is looked at, and draws from what there is meanwhile.

import { getBytes } from "../api/client";
import type { Lane } from "./spans";
import { unpack } from "./spans";
import type { View } from "./view";
import { lengthOf } from "./view";

export interface Fetched {
  view: View;
  /** Nanoseconds a column. */
  column: number;
  lanes: Map<number, Lane>;
}

/** How much is fetched on either side of what is looked at, in lengths of it. */
const AHEAD = 1;
const COARSEST = 1.6;
const FINEST = 0.2;

export class Windows {
  #fetched: Fetched | null = null;
  #running: AbortController | null = null;
  /** Where a live source ends by now. */
  until: number | null = null;

  constructor(
    private readonly source: string,
    private readonly originNs: string,
    private readonly arrived: () => void,
    private readonly failed: (error: unknown) => void,
  ) {}

  lane(number: number): Lane | undefined {
    return this.#fetched?.lanes.get(number);
  }

  /** Sees to it that a view is there, sharp enough; `anew` asks even where it is. */
  want(view: View, lanes: number[], width: number, anew = false): void {
    const column = lengthOf(view) / Math.max(width, 1);
    if (!anew && this.#suffices(view, lanes, column)) return;
    const margin = lengthOf(view) * AHEAD;
    const from = Math.floor(view.from - margin);
    const until = Math.ceil(view.until + margin);
    // One at a time: while the view moves, each would be given up for the next, and none would
    // ever arrive. Whoever is told that one has, asks again.
    if (this.#running) return;
    void this.#fetch({ from, until }, lanes, Math.min(Math.ceil(width) * (1 + 2 * AHEAD), 20_000));
  }

  stop(): void {
    this.#running?.abort();
  }

  #suffices(view: View, lanes: number[], column: number): boolean {
    const there = this.#fetched;
    if (!there || there.view.from > view.from || there.view.until < view.until) return false;
    const sharp = there.column / column;
    if (sharp > COARSEST || sharp < FINEST) return false;
    return lanes.every((lane) => there.lanes.has(lane));
  }

  async #fetch(view: View, lanes: number[], columns: number): Promise<void> {
    const running = new AbortController();
    this.#running = running;
    const query = new URLSearchParams({
      origin: this.originNs,
      from: String(view.from),
      until: String(view.until),
      columns: String(columns),
      lanes: lanes.join(),
    });
    try {
      const path = `/api/sources/${encodeURIComponent(this.source)}/window?${query}`;
      const { bytes, headers } = await getBytes(path, running.signal);
      const unpacked = unpack(bytes);
      this.until = Number(headers.get("x-until") ?? 0);
      this.#fetched = {
        view,
        column: lengthOf(view) / columns,
        lanes: new Map(lanes.map((lane, index) => [lane, unpacked[index]!])),
      };
      if (this.#running === running) this.#running = null;
      this.arrived();
    } catch (error) {
      if (this.#running === running) this.#running = null;
      if (!running.signal.aborted) this.failed(error);
    }
  }
}
