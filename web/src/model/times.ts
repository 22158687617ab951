// Histograms of the times a transition took.

export interface Histogram {
  /** Left edges of the bins, and the right edge of the last. */
  edges: number[];
  counts: number[];
}

const MOST_BINS = 60;

/** Bins of equal width: as wide as Freedman and Diaconis have it, between 8 and 60 of them. */
export function histogram(values: number[]): Histogram {
  if (!values.length) return { edges: [0, 1], counts: [0] };
  const sorted = [...values].sort((one, other) => one - other);
  const low = sorted[0]!;
  const high = sorted.at(-1)!;
  if (high - low < 1e-9) {
    const half = Math.max(Math.abs(low) * 0.05, 1e-3);
    return { edges: [low - half, low + half], counts: [values.length] };
  }
  const quartile = (share: number) => sorted[Math.floor((sorted.length - 1) * share)]!;
  const spread = quartile(0.75) - quartile(0.25);
  const wanted = spread > 0 ? (2 * spread) / Math.cbrt(values.length) : (high - low) / 20;
  const bins = Math.min(MOST_BINS, Math.max(8, Math.ceil((high - low) / wanted)));
  const width = (high - low) / bins;
  const counts = new Array<number>(bins).fill(0);
  for (const value of sorted) counts[Math.min(Math.floor((value - low) / width), bins - 1)]! += 1;
  return { edges: Array.from({ length: bins + 1 }, (_, bin) => low + bin * width), counts };
}

export interface Numbers {
  count: number;
  median: number;
  low: number;
  high: number;
}

export function numbers(values: number[]): Numbers | null {
  if (!values.length) return null;
  const sorted = [...values].sort((one, other) => one - other);
  return {
    count: sorted.length,
    median: sorted[Math.floor((sorted.length - 1) / 2)]!,
    low: sorted[0]!,
    high: sorted.at(-1)!,
  };
}
