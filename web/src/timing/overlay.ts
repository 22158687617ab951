// What lies over the waves: cursors, what was expected, a golden cycle. Drawn with the canvas's own
// strokes, because there are few of them.

import type { Signal } from "../api/types";
import { isWord } from "./choose";
import type { Lane } from "./spans";
import { spanAt } from "./spans";
import type { View } from "./view";
import { lengthOf, toPixel } from "./view";

export interface Expected {
  lane: number;
  value: number | null;
  /** Nanoseconds from the origin. */
  typical: number | null;
  earliest: number | null;
  latest: number | null;
  label: string;
}

export interface Marker {
  time: number;
  label: string;
  /** Name of its colour; red where it is left out. */
  ink?: string;
}

export interface Golden {
  lanes: Map<number, Lane>;
  from: number;
  until: number;
  /** Where the golden cycle is laid: its beginning goes here. */
  starts: number[];
}

export interface RowBox {
  top: number;
  height: number;
}

const FADED = 0.9;

export function drawGolden(
  context: CanvasRenderingContext2D,
  golden: Golden,
  signal: Signal,
  row: RowBox,
  view: View,
  width: number,
  colour: string,
): void {
  const spans = golden.lanes.get(signal.lane);
  if (!spans) return;
  const word = isWord(signal);
  context.save();
  context.strokeStyle = context.fillStyle = colour;
  context.textAlign = "right";
  context.textBaseline = "middle";
  context.setLineDash([4, 2]);
  context.globalAlpha = FADED;
  const { high, low } = levels(row);
  for (const start of golden.starts) {
    const shift = start - golden.from;
    const end = golden.until + shift;
    if (end < view.from || start > view.until) continue;
    context.beginPath();
    let drawing = false;
    const first = Math.max(spanAt(spans, Math.max(golden.from, view.from - shift)), 0);
    for (let at = first; at < spans.start.length; at += 1) {
      const time = Math.max(spans.start[at]!, golden.from);
      if (time >= golden.until || time + shift > view.until) break;
      const next = Math.min(spans.start[at + 1] ?? golden.until, golden.until);
      const y = spans.value[at] ? high : low;
      const left = Math.round(toPixel(view, width, time + shift)) + 0.5;
      const right = Math.round(toPixel(view, width, next + shift)) + 0.5;
      if (word) {
        // Its boxes are there already: dashed edges, and what it would hold.
        context.moveTo(left, high);
        context.lineTo(left, low);
        const text = String(spans.value[at]);
        if (right - left > text.length * 7 + 8) context.fillText(text, right - 4, row.top + row.height / 2);
        continue;
      }
      if (drawing) context.lineTo(left, y);
      else context.moveTo(left, y);
      drawing = true;
      context.lineTo(right, y);
    }
    context.stroke();
  }
  context.restore();
}

/** A dashed edge where it usually comes, and a band up to where it would have been late. */
export function drawExpected(
  context: CanvasRenderingContext2D,
  expected: Expected,
  row: RowBox,
  view: View,
  width: number,
  colour: string,
): void {
  const at = expected.typical ?? expected.latest;
  if (at === null) return;
  const { high, low } = levels(row);
  const x = Math.round(toPixel(view, width, at)) + 0.5;
  context.save();
  if (expected.earliest !== null && expected.latest !== null) {
    const left = toPixel(view, width, expected.earliest);
    const right = Math.max(toPixel(view, width, expected.latest), left + 2);
    context.globalAlpha = 0.16;
    context.fillStyle = colour;
    context.fillRect(left, row.top + 1, right - left, row.height - 2);
    context.globalAlpha = 1;
  }
  context.strokeStyle = colour;
  context.fillStyle = colour;
  context.lineWidth = 1.5;
  context.setLineDash([3, 2]);
  const rising = expected.value !== 0;
  const reach = Math.max(width * 0.02, 18);
  context.beginPath();
  context.moveTo(x - reach, rising ? low : high);
  context.lineTo(x, rising ? low : high);
  context.lineTo(x, rising ? high : low);
  context.lineTo(x + reach, rising ? high : low);
  context.stroke();
  if (expected.label && lengthOf(view) > 0) {
    const fits = x + reach + 6 + context.measureText(expected.label).width < width;
    context.textAlign = fits ? "left" : "right";
    context.textBaseline = "middle";
    context.fillText(expected.label, fits ? x + reach + 5 : x - reach - 5, row.top + row.height / 2);
  }
  context.restore();
}

export interface Line {
  x: number;
  width: number;
  height: number;
  ink: string;
  /** What the label is written with, on the line's ink. */
  ground: string;
  label: string;
  dashed?: boolean;
  /** How far down the label stands. */
  labelTop?: number;
}

export function drawLine(context: CanvasRenderingContext2D, line: Line): void {
  const { x, label, labelTop = 0 } = line;
  context.save();
  context.strokeStyle = context.fillStyle = line.ink;
  context.lineWidth = 1.5;
  if (line.dashed) context.setLineDash([5, 3]);
  context.beginPath();
  context.moveTo(Math.round(x) + 0.5, 0);
  context.lineTo(Math.round(x) + 0.5, line.height);
  context.stroke();
  if (label) {
    const wide = context.measureText(label).width + 8;
    const left = x + wide > line.width ? x - wide : x;
    context.fillRect(left, labelTop, wide, 15);
    context.fillStyle = line.ground;
    context.textBaseline = "middle";
    context.fillText(label, left + 4, labelTop + 8);
  }
  context.restore();
}

function levels(row: RowBox): { high: number; low: number } {
  const margin = Math.round(row.height * 0.18);
  return { high: row.top + margin + 0.5, low: row.top + row.height - margin - 0.5 };
}
