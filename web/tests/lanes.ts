import type { Lane } from "../src/timing/spans";

export function lane(...spans: [start: number, value: number, changes?: number][]): Lane {
  return {
    start: Float64Array.from(spans, (span) => span[0]),
    value: Float64Array.from(spans, (span) => span[1]),
    changes: Uint32Array.from(spans, (span) => span[2] ?? 0),
    known: Uint8Array.from(spans, () => 1),
  };
}
