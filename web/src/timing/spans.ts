// The spans of a window, as `runglight/server/window.py` packs them.

export interface Lane {
  /** Start of every span: nanoseconds from the source's origin. */
  start: Float64Array;
  value: Float64Array;
  /** Above 0: so many changes after its start are too close together to be drawn one by one. */
  changes: Uint32Array;
  /** 0 before the signal's first row. */
  known: Uint8Array;
}

const HEAD_BYTES = 16;
const VERSION = 1;

export function unpack(bytes: ArrayBuffer): Lane[] {
  const [version, laneCount = 0, spanCount = 0] = new Uint32Array(bytes, 0, 4);
  if (version !== VERSION) throw new Error("this page is older than its server; load it again");
  let at = HEAD_BYTES;
  const start = new Float64Array(bytes, at, spanCount);
  at += 8 * spanCount;
  const value = new Float64Array(bytes, at, spanCount);
  at += 8 * spanCount;
  const changes = new Uint32Array(bytes, at, spanCount);
  at += 4 * spanCount;
  const counts = new Uint32Array(bytes, at, laneCount);
  at += 4 * laneCount;
  const known = new Uint8Array(bytes, at, spanCount);
  const lanes: Lane[] = [];
  let first = 0;
  for (const count of counts) {
    const end = first + count;
    lanes.push({
      start: start.subarray(first, end),
      value: value.subarray(first, end),
      changes: changes.subarray(first, end),
      known: known.subarray(first, end),
    });
    first = end;
  }
  return lanes;
}

/** Index of the span that holds a time; -1 before the first. */
export function spanAt(lane: Lane, time: number): number {
  let low = 0;
  let high = lane.start.length;
  while (low < high) {
    const middle = (low + high) >> 1;
    if (lane.start[middle]! <= time) low = middle + 1;
    else high = middle;
  }
  return low - 1;
}

/** The value at a time: null where it is unknown, "busy" where too much happens around it. */
export function valueAt(lane: Lane | undefined, time: number): number | "busy" | null {
  if (!lane) return null;
  const at = spanAt(lane, time);
  if (at < 0 || !lane.known[at]) return null;
  return lane.changes[at] ? "busy" : lane.value[at]!;
}

/** Times at which a lane rises to a value other than 0, of those that can be told. */
export function rises(lane: Lane): number[] {
  const found: number[] = [];
  for (let at = 1; at < lane.start.length; at += 1) {
    const rose = lane.value[at]! !== 0 && lane.value[at - 1]! === 0 && !lane.changes[at - 1];
    if (rose && lane.known[at - 1]) found.push(lane.start[at]!);
  }
  return found;
}
