// Paints a diagram: what repeats into pixels of its own, what there is little of with the canvas's
// strokes over it.

import type { Signal } from "../api/types";
import { ticks } from "./axis";
import { isWord } from "./choose";
import { drawExpected, drawGolden, drawLine, type Expected, type Golden, type Line, type Marker } from "./overlay";
import { drawBit, drawFolded, drawWord, packed, Pixels, type Inks } from "./raster";
import type { Row } from "./rows";
import { spanAt, type Lane } from "./spans";
import { toPixel, type View } from "./view";

export const ROW = 26;
export const AXIS = 26;

export interface Scene {
  view: View;
  width: number;
  height: number;
  scrollTop: number;
  rows: Row[];
  first: number;
  last: number;
  selected: number;
  originNs: bigint;
  gaps: [number, number][];
  /** Stretches of time that are set off: windows around events. */
  bands: [number, number][];
  expected: Expected[];
  markers: Marker[];
  golden: Golden | null;
  cursorA: number | null;
  cursorB: number | null;
  laneOf: (lane: number) => Lane | undefined;
}

type Css = (name: string) => string;

export class Painter {
  #image: ImageData | null = null;
  readonly #colours = new Map<string, string>();

  constructor(
    private readonly canvas: HTMLCanvasElement,
    private readonly axis: HTMLCanvasElement,
  ) {}

  /** Colours are looked up once: asking for them makes the browser lay out the page. */
  readonly #css: Css = (name) => {
    let found = this.#colours.get(name);
    if (found === undefined) {
      found = getComputedStyle(this.canvas).getPropertyValue(name).trim();
      this.#colours.set(name, found);
    }
    return found;
  };

  /** The scheme is another one. */
  restyle(): void {
    this.#colours.clear();
  }

  paint(scene: Scene): void {
    const { canvas } = this;
    const ratio = devicePixelRatio || 1;
    const wide = Math.max(Math.round(scene.width * ratio), 1);
    const tall = Math.max(Math.round(scene.height * ratio), 1);
    if (canvas.width !== wide || canvas.height !== tall) {
      canvas.width = wide;
      canvas.height = tall;
      this.#image = null;
    }
    // Nothing shines through: the browser need not blend it with the page.
    const context = canvas.getContext("2d", { alpha: false });
    if (!context) return;
    this.#image ??= context.createImageData(wide, tall);
    const css = this.#css;
    const pixels = new Pixels(wide, tall, this.#image.data.buffer);
    const marks = ticks(scene.view, scene.width, scene.originNs);
    waves(pixels, scene, ratio, inksOf(css), marks.map((mark) => mark.time));
    context.putImageData(this.#image, 0, 0);
    context.save();
    context.scale(ratio, ratio);
    context.font = `11px ${css("--mono")}`;
    over(context, scene, css);
    context.restore();
    this.#paintAxis(scene, marks, ratio, css);
  }

  #paintAxis(scene: Scene, marks: ReturnType<typeof ticks>, ratio: number, css: Css): void {
    const { axis } = this;
    const wide = Math.round(scene.width * ratio);
    const tall = Math.round(AXIS * ratio);
    if (axis.width !== wide || axis.height !== tall) {
      axis.width = wide;
      axis.height = tall;
    }
    const context = axis.getContext("2d");
    if (!context) return;
    context.setTransform(ratio, 0, 0, ratio, 0, 0);
    context.clearRect(0, 0, scene.width, AXIS);
    context.font = `11px ${css("--mono")}`;
    context.fillStyle = css("--soft");
    context.strokeStyle = css("--line");
    context.textBaseline = "middle";
    for (const mark of marks) {
      const x = Math.round(toPixel(scene.view, scene.width, mark.time)) + 0.5;
      context.beginPath();
      context.moveTo(x, AXIS - 6);
      context.lineTo(x, AXIS);
      context.stroke();
      context.fillText(mark.label, x + 3, AXIS / 2 - 1);
    }
  }
}

function inksOf(css: Css): Inks & { band: number } {
  return {
    ground: packed(css("--surface")),
    wave: packed(css("--wave")),
    high: packed(css("--wave-high")),
    busy: packed(css("--wave-busy")),
    unknown: packed(css("--strong-line")),
    grid: packed(css("--wave-grid")),
    gap: packed(css("--wave-gap")),
    band: packed(css("--wave-band")),
  };
}

function waves(
  pixels: Pixels,
  scene: Scene,
  ratio: number,
  inks: Inks & { band: number },
  marks: number[],
): void {
  const { view } = scene;
  const { width, height } = pixels;
  const thick = Math.max(Math.round(ratio), 1);
  pixels.clear(inks.ground);
  for (const [stretches, ink] of [[scene.bands, inks.band], [scene.gaps, inks.gap]] as const) {
    for (const [from, until] of stretches) {
      if (until < view.from || from > view.until) continue;
      const left = Math.round(toPixel(view, width, from));
      pixels.rectangle(left, 0, Math.max(Math.round(toPixel(view, width, until)), left + thick), height, ink);
    }
  }
  for (const mark of marks) {
    pixels.column(Math.round(toPixel(view, width, mark)), 0, height, thick, inks.grid);
  }
  for (let number = scene.first; number < scene.last; number += 1) {
    const row = scene.rows[number]!;
    const band = {
      top: Math.round((number * ROW - scene.scrollTop) * ratio),
      height: Math.round(ROW * ratio),
      thick,
    };
    const lanes = row.signals.flatMap((signal) => scene.laneOf(signal.lane) ?? []);
    if (row.folded) drawFolded(pixels, lanes, view, band, inks);
    else if (lanes[0]) (isWord(row.signals[0]!) ? drawWord : drawBit)(pixels, lanes[0], view, band, inks);
  }
}

function over(context: CanvasRenderingContext2D, scene: Scene, css: Css): void {
  const { view, width, height } = scene;
  const ground = css("--surface");
  for (let number = scene.first; number < scene.last; number += 1) {
    const row = scene.rows[number]!;
    const box = { top: number * ROW - scene.scrollTop, height: ROW };
    if (!row.folded) signalOver(context, scene, row.signals[0]!, box, css);
    if (number === scene.selected && scene.rows.length > 1) {
      context.strokeStyle = css("--accent");
      context.globalAlpha = 0.5;
      context.strokeRect(0.5, box.top + 0.5, width - 1, ROW - 1);
      context.globalAlpha = 1;
    }
  }
  const line = (time: number, ink: string, label: string, more: Partial<Line> = {}): void => {
    const x = toPixel(view, width, time);
    if (x >= -1 && x <= width + 1) drawLine(context, { x, width, height, ink: css(ink), ground, label, ...more });
  };
  for (const marker of scene.markers) line(marker.time, marker.ink ?? "--red", marker.label);
  if (scene.cursorA !== null) line(scene.cursorA, "--accent", "A", { labelTop: 16 });
  if (scene.cursorB !== null) line(scene.cursorB, "--amber", "B", { labelTop: 16, dashed: true });
}

function signalOver(
  context: CanvasRenderingContext2D,
  scene: Scene,
  signal: Signal,
  box: { top: number; height: number },
  css: Css,
): void {
  const { view, width } = scene;
  const ghost = css("--wave-ghost");
  const lane = scene.laneOf(signal.lane);
  if (lane && isWord(signal)) values(context, lane, view, width, box.top, css("--ink"));
  if (scene.golden) drawGolden(context, scene.golden, signal, box, view, width, ghost);
  for (const each of scene.expected) {
    if (each.lane === signal.lane) drawExpected(context, each, box, view, width, ghost);
  }
}

/** What a word holds, written into its boxes where there is room. */
function values(
  context: CanvasRenderingContext2D,
  lane: Lane,
  view: View,
  width: number,
  top: number,
  ink: string,
): void {
  context.fillStyle = ink;
  context.textBaseline = "middle";
  for (let at = Math.max(spanAt(lane, view.from), 0); at < lane.start.length; at += 1) {
    if (lane.start[at]! > view.until) return;
    if (!lane.known[at] || lane.changes[at]) continue;
    const left = Math.max(toPixel(view, width, lane.start[at]!), 0);
    const right = Math.min(
      at + 1 < lane.start.length ? toPixel(view, width, lane.start[at + 1]!) : width,
      width,
    );
    const text = String(lane.value[at]);
    if (right - left > text.length * 7 + 6) context.fillText(text, left + 4, top + ROW / 2 + 0.5);
  }
}
