// Draws lanes into pixels of its own. Thousands of edges a lane are thousands of short runs of
// memory here, and would be thousands of paths for a canvas.

import type { Lane } from "./spans";
import { spanAt } from "./spans";
import type { View } from "./view";
import { lengthOf } from "./view";

/** Below this, calling `fill` takes longer than what it does. */
const NARROW = 12;

export class Pixels {
  readonly data: Uint32Array;

  constructor(
    readonly width: number,
    readonly height: number,
    buffer?: ArrayBufferLike,
  ) {
    this.data = buffer ? new Uint32Array(buffer) : new Uint32Array(width * height);
  }

  clear(ink: number): void {
    this.data.fill(ink);
  }

  rectangle(left: number, top: number, right: number, bottom: number, ink: number): void {
    const from = Math.max(left, 0);
    const until = Math.min(right, this.width);
    if (until <= from) return;
    const last = Math.min(bottom, this.height);
    const narrow = until - from < NARROW;
    for (let y = Math.max(top, 0); y < last; y += 1) {
      const row = y * this.width;
      if (narrow) for (let x = from; x < until; x += 1) this.data[row + x] = ink;
      else this.data.fill(ink, row + from, row + until);
    }
  }

  column(x: number, top: number, bottom: number, thick: number, ink: number): void {
    if (thick > 1) {
      this.rectangle(x, top, x + thick, bottom, ink);
      return;
    }
    if (x < 0 || x >= this.width) return;
    const last = Math.min(bottom, this.height);
    for (let y = Math.max(top, 0); y < last; y += 1) this.data[y * this.width + x] = ink;
  }
}

/** Colours as a canvas keeps them: 0xAABBGGRR. */
export interface Inks {
  ground: number;
  wave: number;
  high: number;
  busy: number;
  unknown: number;
  grid: number;
  gap: number;
}

export interface Band {
  top: number;
  height: number;
  /** Pixels a line is thick: the device's pixels per CSS pixel. */
  thick: number;
}

export function drawBit(pixels: Pixels, lane: Lane, view: View, band: Band, inks: Inks): void {
  const { top, bottom, thick } = inside(band);
  eachSpan(lane, view, pixels.width, (left, right, at, first) => {
    const high = lane.value[at]! !== 0;
    if (!lane.known[at]) {
      dots(pixels, left, right, (top + bottom) >> 1, thick, inks.unknown);
      return;
    }
    if (lane.changes[at]) {
      // At least a pixel, and both levels: something was here.
      if (right > left + thick) pixels.rectangle(left + thick, top, right, bottom, inks.busy);
      pixels.column(left, top, bottom, thick, inks.wave);
      return;
    }
    if (high) pixels.rectangle(left, top + thick, right, bottom, inks.high);
    const y = high ? top : bottom - thick;
    pixels.rectangle(left, y, Math.max(right, left + thick), y + thick, inks.wave);
    if (!first) pixels.column(left, top, bottom, thick, inks.wave);
  });
}

export function drawWord(pixels: Pixels, lane: Lane, view: View, band: Band, inks: Inks): void {
  const { top, bottom, thick } = inside(band);
  eachSpan(lane, view, pixels.width, (left, right, at, first) => {
    if (!lane.known[at]) {
      dots(pixels, left, right, (top + bottom) >> 1, thick, inks.unknown);
      return;
    }
    const end = Math.max(right, left + thick);
    if (lane.changes[at]) {
      pixels.rectangle(left, top, end, bottom, inks.busy);
    } else if (lane.value[at]! !== 0) {
      pixels.rectangle(left, top, end, bottom, inks.high);
    }
    pixels.rectangle(left, top, end, top + thick, inks.wave);
    pixels.rectangle(left, bottom - thick, end, bottom, inks.wave);
    if (!first) pixels.column(left, top, bottom, thick, inks.wave);
  });
}

/** All signals of a device in one row: a stroke wherever one of them changes. */
export function drawFolded(pixels: Pixels, lanes: Lane[], view: View, band: Band, inks: Inks): void {
  const { top, bottom, thick } = inside(band);
  pixels.rectangle(0, bottom - thick, pixels.width, bottom, inks.unknown);
  for (const lane of lanes) {
    eachSpan(lane, view, pixels.width, (left, right, at, first) => {
      if (!lane.known[at]) return;
      if (lane.changes[at]) {
        pixels.rectangle(left, top + thick, Math.max(right, left + thick), bottom, inks.busy);
      }
      if (!first) pixels.column(left, top + thick, bottom, thick, inks.wave);
    });
  }
}

/** Calls for every span in sight with its pixels; spans within one pixel are drawn as one. */
function eachSpan(
  lane: Lane,
  view: View,
  width: number,
  draw: (left: number, right: number, at: number, first: boolean) => void,
): void {
  const count = lane.start.length;
  if (!count) return;
  const scale = width / lengthOf(view);
  let at = Math.max(spanAt(lane, view.from), 0);
  let drawn = -Infinity;
  let left = Math.max(Math.floor((lane.start[at]! - view.from) * scale), -4);
  for (; at < count && left < width; at += 1) {
    const next = at + 1 < count ? Math.floor((lane.start[at + 1]! - view.from) * scale) : width;
    const right = Math.min(next, width);
    // Within one pixel, the first edge has drawn all of it.
    if (right === left) {
      if (left === drawn) continue;
      drawn = left;
    }
    draw(left, right, at, at === 0 || !lane.known[at - 1]);
    left = right;
  }
}

function inside(band: Band): { top: number; bottom: number; thick: number } {
  const margin = Math.round(band.height * 0.18);
  return { top: band.top + margin, bottom: band.top + band.height - margin, thick: band.thick };
}

function dots(
  pixels: Pixels,
  left: number,
  right: number,
  y: number,
  thick: number,
  ink: number,
): void {
  for (let x = Math.max(left, 0); x < Math.min(right, pixels.width); x += 6 * thick) {
    pixels.rectangle(x, y, Math.min(x + 2 * thick, right), y + thick, ink);
  }
}

/** `#rrggbb` or `#rgb` as a canvas keeps it. */
export function packed(colour: string): number {
  const whole = colour.trim().replace(/^#(.)(.)(.)$/, "#$1$1$2$2$3$3");
  const found = /^#([0-9a-f]{2})([0-9a-f]{2})([0-9a-f]{2})$/i.exec(whole);
  if (!found) return 0xff808080;
  const [red, green, blue] = found.slice(1).map((part) => parseInt(part!, 16));
  return ((0xff << 24) | (blue! << 16) | (green! << 8) | red!) >>> 0;
}
