// What is in sight of a diagram as a picture that can stand alone: with names, axis and title.

import { AXIS, ROW } from "./paint";
import type { Row } from "./rows";

const LABELS = 190;
const TITLE = 22;

export function pngOf(
  waves: HTMLCanvasElement,
  axis: HTMLCanvasElement,
  rows: Row[],
  /** Where the first row begins: above 0 where it is scrolled out in part. */
  top: number,
  title: string,
): string {
  const style = getComputedStyle(waves);
  const css = (name: string) => style.getPropertyValue(name).trim();
  const ratio = waves.width / Math.max(waves.clientWidth, 1);
  const height = Math.min(waves.clientHeight, top + rows.length * ROW);
  const whole = document.createElement("canvas");
  whole.width = waves.width + LABELS * ratio;
  whole.height = (TITLE + AXIS + height) * ratio;
  const context = whole.getContext("2d")!;
  context.fillStyle = css("--surface");
  context.fillRect(0, 0, whole.width, whole.height);
  context.drawImage(axis, LABELS * ratio, TITLE * ratio);
  context.drawImage(waves, LABELS * ratio, (TITLE + AXIS) * ratio);
  context.scale(ratio, ratio);
  context.fillStyle = css("--ink");
  context.textBaseline = "middle";
  context.font = `600 12px ${css("--sans")}`;
  context.fillText(title, 6, TITLE / 2);
  context.font = `12px ${css("--sans")}`;
  context.beginPath();
  context.rect(0, TITLE + AXIS, LABELS - 4, height);
  context.clip();
  rows.forEach((row, number) => {
    const signal = row.signals[0]!;
    const named = row.folded ? `${row.device} (${row.signals.length})` : `${signal.device} ${signal.signal}`;
    context.fillText(named.trim(), 6, TITLE + AXIS + top + (number + 0.5) * ROW);
  });
  return whole.toDataURL("image/png");
}
