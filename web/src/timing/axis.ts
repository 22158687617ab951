import type { View } from "./view";

const NS = 1e9;
const MS = 1e6;
// Steps people count in: 1, 2, 5 below a second, then parts of minutes, hours and days.
const LONG_STEPS_S = [
  1, 2, 5, 10, 15, 30, 60, 120, 300, 600, 900, 1800, 3600, 7200, 10_800, 21_600, 43_200, 86_400,
  172_800, 604_800, 1_209_600, 2_592_000, 7_776_000, 31_536_000,
];

export interface Tick {
  /** Nanoseconds from the origin. */
  time: number;
  label: string;
}

export function stepFor(wanted: number): number {
  if (wanted >= NS) {
    const year = LONG_STEPS_S.at(-1)!;
    const step = LONG_STEPS_S.find((each) => each * NS >= wanted) ?? year * Math.ceil(wanted / NS / year);
    return step * NS;
  }
  const power = 10 ** Math.floor(Math.log10(Math.max(wanted, 1)));
  return [1, 2, 5, 10].map((step) => step * power).find((step) => step >= wanted * 0.999)!;
}

/** Ticks at round moments of the clock, at least `apart` pixels from one another. */
export function ticks(view: View, width: number, originNs: bigint, apart = 96): Tick[] {
  const step = stepFor(((view.until - view.from) / Math.max(width, 1)) * apart);
  // The origin is no round moment: only what is left of it counts.
  const rest = Number(originNs % BigInt(Math.round(step)));
  const found: Tick[] = [];
  const first = Math.ceil((view.from + rest) / step);
  const last = Math.floor((view.until + rest) / step);
  for (let number = first; number <= last; number += 1) {
    const time = number * step - rest;
    found.push({ time, label: label(originNs, time, step) });
  }
  return found;
}

function label(originNs: bigint, time: number, step: number): string {
  const at = originNs + BigInt(Math.round(time));
  const iso = new Date(Number(at / 1_000_000n)).toISOString();
  if (step >= 86_400 * NS) return iso.slice(0, 10);
  if (step >= 60 * NS) return iso.slice(11, 16);
  if (step >= NS) return iso.slice(11, 19);
  if (step >= MS) return iso.slice(14, 23);
  const fraction = String(((at % 1_000_000_000n) + 1_000_000_000n) % 1_000_000_000n).padStart(9, "0");
  return `${iso.slice(17, 19)}.${fraction.slice(0, 3)} ${fraction.slice(3, 6)}${step < 1000 ? ` ${fraction.slice(6)}` : ""}`;
}

/** A moment in full: `2026-01-05 06:29:05.121 888 337`. */
export function moment(originNs: bigint, time: number): string {
  const at = originNs + BigInt(Math.round(time));
  const iso = new Date(Number(at / 1_000_000n)).toISOString();
  const fraction = String(at % 1_000_000_000n).padStart(9, "0");
  return `${iso.slice(0, 10)} ${iso.slice(11, 19)}.${fraction.slice(0, 6)}`;
}

/**
 * What somebody typed as a time: `2026-01-05 06:29:05.12`, `06:29:05` (of the day looked at) or
 * `+12.5` (seconds from the start). Null where it is none.
 */
export function parseMoment(text: string, originNs: bigint, lookedAt: number): number | null {
  const typed = text.trim();
  const offset = /^\+\s*(\d+(?:\.\d+)?)\s*s?$/.exec(typed);
  if (offset) return Number(offset[1]) * NS;
  const found =
    /^(?:(\d{4}-\d{2}-\d{2})[T ]\s*)?(\d{1,2}):(\d{2})(?::(\d{2})(?:[.,](\d{1,9}))?)?\s*Z?$/.exec(typed);
  if (!found) return null;
  const [, date, hour, minute, second = "0", fraction = ""] = found;
  const day =
    date ?? new Date(Number((originNs + BigInt(Math.round(lookedAt))) / 1_000_000n)).toISOString().slice(0, 10);
  const ms = Date.parse(`${day}T${hour!.padStart(2, "0")}:${minute}:${second.padStart(2, "0")}Z`);
  if (Number.isNaN(ms)) return null;
  const ns = BigInt(ms) * 1_000_000n + BigInt(fraction.padEnd(9, "0") || "0");
  return Number(ns - originNs);
}
