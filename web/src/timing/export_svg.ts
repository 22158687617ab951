// The diagram as a drawing for a report.

import type { Signal } from "../api/types";
import { moment, ticks } from "./axis";
import { isWord } from "./choose";
import type { Golden } from "./overlay";
import type { Row } from "./rows";
import type { Lane } from "./spans";
import { spanAt } from "./spans";
import type { View } from "./view";
import { toPixel } from "./view";

const LABELS = 190;
const ROW = 24;
const TOP = 30;
const CURSOR = "#1a5aa0";

export interface Drawn {
  view: View;
  golden?: Golden | null;
  cursors?: Record<string, number | null>;
}

export function svgOf(
  rows: Row[],
  laneOf: (lane: number) => Lane | undefined,
  drawn: Drawn,
  originNs: bigint,
  title: string,
  width = 1000,
): string {
  const { view } = drawn;
  const height = TOP + rows.length * ROW + 10;
  const parts: string[] = [];
  for (const tick of ticks(view, width, originNs)) {
    const x = LABELS + toPixel(view, width, tick.time);
    parts.push(`<path d="M${x.toFixed(1)} ${TOP}V${height - 10}" stroke="#e0e2e1"/>`);
    parts.push(`<text x="${(x + 3).toFixed(1)}" y="24" fill="#555c62">${tick.label}</text>`);
  }
  rows.forEach((row, number) => {
    const top = TOP + number * ROW + 4;
    const signal = row.signals[0]!;
    const named = row.folded ? `${row.device} (${row.signals.length})` : `${signal.device} ${signal.signal}`;
    parts.push(`<text x="4" y="${top + 12}">${escaped(named)}</text>`);
    const lanes = row.signals.flatMap((each) => laneOf(each.lane) ?? []);
    if (row.folded) parts.push(changes(lanes, view, width, top));
    else if (lanes[0]) parts.push((isWord(signal) ? word : bit)(lanes[0], view, width, top));
    if (drawn.golden && !row.folded) parts.push(golden(drawn.golden, signal, view, width, top));
  });
  for (const [name, time] of Object.entries(drawn.cursors ?? {})) {
    if (time === null || time < view.from || time > view.until) continue;
    const x = (LABELS + toPixel(view, width, time)).toFixed(1);
    parts.push(`<path d="M${x} ${TOP}V${height - 10}" stroke="${CURSOR}"/><text x="${x}" dx="3" y="${height - 1}" fill="${CURSOR}">${name}</text>`);
  }
  const from = moment(originNs, view.from);
  return [
    `<svg xmlns="http://www.w3.org/2000/svg" width="${LABELS + width}" height="${height}" font-family="sans-serif" font-size="11">`,
    `<title>${escaped(title)}</title><desc>from ${from} UTC</desc>`,
    `<rect width="100%" height="100%" fill="#fff"/><text x="4" y="12" font-weight="bold">${escaped(title)}</text><text x="${LABELS}" y="12" fill="#555c62">from ${from} UTC</text>`,
    ...parts,
    "</svg>",
  ].join("\n");
}

function* visible(lane: Lane, view: View, width: number): Generator<[number, number, number]> {
  for (let at = Math.max(spanAt(lane, view.from), 0); at < lane.start.length; at += 1) {
    if (lane.start[at]! >= view.until) return;
    const left = LABELS + Math.max(toPixel(view, width, lane.start[at]!), 0);
    const end = at + 1 < lane.start.length ? lane.start[at + 1]! : view.until;
    yield [at, left, LABELS + Math.min(toPixel(view, width, end), width)];
  }
}

function bit(lane: Lane, view: View, width: number, top: number): string {
  let path = "";
  let busy = "";
  for (const [at, left, right] of visible(lane, view, width)) {
    if (!lane.known[at]) continue;
    if (lane.changes[at]) {
      busy += `<rect x="${left.toFixed(1)}" y="${top}" width="${Math.max(right - left, 1).toFixed(1)}" height="16" fill="#7d95ab"/>`;
      path += `M${right.toFixed(1)} ${top}`;
      continue;
    }
    const y = lane.value[at] ? top : top + 16;
    path += `${path ? "L" : "M"}${left.toFixed(1)} ${y}H${right.toFixed(1)}`;
  }
  return `${busy}<path d="${path}" fill="none" stroke="#23282c"/>`;
}

function changes(lanes: Lane[], view: View, width: number, top: number): string {
  let path = `M${LABELS} ${top + 16}h${width}`;
  for (const lane of lanes) {
    for (const [at, left] of visible(lane, view, width)) {
      if (at > 0 && lane.start[at]! >= view.from) path += `M${left.toFixed(1)} ${top}v16`;
    }
  }
  return `<path d="${path}" fill="none" stroke="#23282c"/>`;
}

/** The golden cycle laid over a row, once for every cycle in sight. */
function golden(laid: Golden, signal: Signal, view: View, width: number, top: number): string {
  const spans = laid.lanes.get(signal.lane);
  if (!spans) return "";
  const x = (time: number) => (LABELS + Math.max(0, Math.min(toPixel(view, width, time), width))).toFixed(1);
  let path = "";
  for (const start of laid.starts) {
    const shift = start - laid.from;
    if (laid.until + shift < view.from || start > view.until) continue;
    let before = isWord(signal) ? null : "";
    for (let at = 0; at < spans.start.length && spans.start[at]! < laid.until; at += 1) {
      const from = x(Math.max(spans.start[at]!, laid.from) + shift);
      const until = x(Math.min(spans.start[at + 1] ?? laid.until, laid.until) + shift);
      if (before === null) path += `M${from} ${top}v16`;
      else {
        path += `${before || "M"}${from} ${spans.value[at] ? top : top + 16}H${until}`;
        before = "L";
      }
    }
  }
  return `<path d="${path}" fill="none" stroke="${CURSOR}" stroke-dasharray="4 2"/>`;
}

function word(lane: Lane, view: View, width: number, top: number): string {
  let drawn = "";
  for (const [at, left, right] of visible(lane, view, width)) {
    if (!lane.known[at]) continue;
    const fill = lane.changes[at] ? "#7d95ab" : "#f3f6f9";
    const wide = Math.max(right - left, 1);
    drawn += `<rect x="${left.toFixed(1)}" y="${top}" width="${wide.toFixed(1)}" height="16" fill="${fill}" stroke="#23282c" stroke-width=".6"/>`;
    const text = String(lane.value[at]);
    if (!lane.changes[at] && wide > text.length * 7 + 6) {
      drawn += `<text x="${((left + right) / 2).toFixed(1)}" y="${top + 12}" text-anchor="middle">${text}</text>`;
    }
  }
  return drawn;
}

function escaped(text: string): string {
  return text.replace(/[&<>"]/g, (letter) => `&#${letter.charCodeAt(0)};`);
}
