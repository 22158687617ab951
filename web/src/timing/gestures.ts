// Mouse, wheel and fingers on a diagram: dragging pans, the wheel and two fingers zoom, a click chooses.

import { lengthOf, panned, toTime, zoomed, type View } from "./view";

export interface Board {
  view: () => View;
  width: () => number;
  /** Of what is drawn: nothing is zoomed out much further. */
  length: () => number;
  scrollTop: () => number;
  look: (view: View) => void;
  scroll: (top: number) => void;
  choose: (time: number, y: number, shift: boolean) => void;
}

const CLICK_PX = 4;

export class Gestures {
  #held: { x: number; y: number; view: View; moved: boolean; top: number } | null = null;
  #pinch: { apart: number; view: View; at: number } | null = null;
  readonly #touches = new Map<number, number>();

  constructor(private readonly board: Board) {}

  wheel(event: WheelEvent): void {
    event.preventDefault();
    const view = this.board.view();
    const width = this.board.width();
    const sideways = event.shiftKey ? event.deltaY : event.deltaX;
    if (Math.abs(sideways) > Math.abs(event.deltaY) || event.shiftKey) {
      this.board.look(panned(view, (sideways / width) * lengthOf(view)));
    } else {
      const at = toTime(view, width, event.offsetX);
      const factor = Math.exp(Math.max(-60, Math.min(event.deltaY, 60)) * 0.006);
      this.board.look(zoomed(view, factor, at, this.board.length()));
    }
  }

  press(event: PointerEvent): void {
    const view = this.board.view();
    this.#touches.set(event.pointerId, event.offsetX);
    if (this.#touches.size === 2) {
      const [one = 0, other = 0] = this.#touches.values();
      const at = toTime(view, this.board.width(), (one + other) / 2);
      this.#pinch = { apart: Math.max(Math.abs(one - other), 10), view, at };
      this.#held = null;
    } else {
      this.#held = { x: event.clientX, y: event.clientY, view, moved: false, top: this.board.scrollTop() };
    }
  }

  drag(event: PointerEvent): void {
    if (this.#touches.has(event.pointerId)) this.#touches.set(event.pointerId, event.offsetX);
    const pinch = this.#pinch;
    if (pinch && this.#touches.size === 2) {
      const [one = 0, other = 0] = this.#touches.values();
      const factor = pinch.apart / Math.max(Math.abs(one - other), 10);
      this.board.look(zoomed(pinch.view, factor, pinch.at, this.board.length()));
      return;
    }
    const held = this.#held;
    if (!held) return;
    const by = event.clientX - held.x;
    if (!held.moved && Math.abs(by) + Math.abs(event.clientY - held.y) < CLICK_PX) return;
    held.moved = true;
    this.board.look(panned(held.view, (-by / this.board.width()) * lengthOf(held.view)));
    this.board.scroll(held.top - (event.clientY - held.y));
  }

  release(event: PointerEvent): void {
    this.#touches.delete(event.pointerId);
    if (this.#touches.size < 2) this.#pinch = null;
    if (this.#held && !this.#held.moved) {
      const time = Math.round(toTime(this.board.view(), this.board.width(), event.offsetX));
      this.board.choose(time, event.offsetY, event.shiftKey);
    }
    this.#held = null;
  }
}
