// Tokens on the drawing of a net, and how they move.

import { arcIn, arcOut } from "./net";
import type { Marking, Net, Step } from "./types";

const SVG = "http://www.w3.org/2000/svg";
const RADIUS = 4.4;

interface Spot {
  x: number;
  y: number;
}

export class TokenLayer {
  #net: Net;
  #picture: SVGSVGElement;
  #layer: SVGGElement;
  #moving: SVGGElement;
  #spots: (Spot | null)[];
  #frame = 0;

  constructor(picture: SVGSVGElement, net: Net) {
    this.#picture = picture;
    this.#net = net;
    const drawn = picture.querySelector<SVGGElement>("g.graph") ?? picture;
    this.#layer = drawn.appendChild(document.createElementNS(SVG, "g"));
    this.#moving = drawn.appendChild(document.createElementNS(SVG, "g"));
    this.#spots = net.places.map((_, number) => {
      const circle = this.#element(`place ${number}`)?.querySelector("ellipse");
      return circle ? { x: Number(circle.getAttribute("cx")), y: Number(circle.getAttribute("cy")) } : null;
    });
  }

  /** Tokens as they stand; `step` marks what has just happened. */
  show(marking: Marking, step: Step | null): void {
    cancelAnimationFrame(this.#frame);
    this.#moving.replaceChildren();
    this.#layer.replaceChildren();
    for (const [place, count] of Object.entries(marking)) this.#put(Number(place), count);
    for (const element of this.#picture.querySelectorAll(".now, .missing")) element.classList.remove("now", "missing");
    for (const number of step?.fired.slice(-1) ?? []) this.#element(`transition ${number}`)?.classList.add("now");
    for (const place of [...(step?.missing ?? []), ...(step?.remaining ?? [])]) {
      this.#element(`place ${place}`)?.classList.add("missing");
      const spot = this.#spots[place];
      if (spot) this.#layer.append(token(spot, "token missing", 7.5));
    }
  }

  /** Moves the tokens of one step, and shows what comes of it. */
  move(before: Marking, step: Step, milliseconds: number): void {
    this.show(before, null);
    const legs = step.fired.flatMap((number) => {
      const transition = this.#net.transitions[number]!;
      return [
        { from: transition.inputs, paths: transition.inputs.map((place) => this.#path(arcIn(place, number))) },
        { from: [], paths: transition.outputs.map((place) => this.#path(arcOut(number, place))) },
      ];
    });
    if (!legs.length || milliseconds < 40) {
      this.show(step.marking, step);
      return;
    }
    const standing = { ...before };
    const begin = performance.now();
    const each = milliseconds / legs.length;
    let leg = -1;
    let dots: { dot: SVGCircleElement; path: SVGPathElement }[] = [];
    const frame = (now: number) => {
      const at = Math.floor((now - begin) / each);
      if (at >= legs.length) {
        this.show(step.marking, step);
        return;
      }
      if (at !== leg) {
        leg = at;
        for (const place of legs[leg]!.from) standing[place] = Math.max((standing[place] ?? 0) - 1, 0);
        this.#layer.replaceChildren();
        for (const [place, count] of Object.entries(standing)) this.#put(Number(place), count);
        this.#moving.replaceChildren();
        dots = legs[leg]!.paths.flatMap((path) => {
          if (!path) return [];
          const dot = token({ x: 0, y: 0 }, "token", RADIUS);
          this.#moving.append(dot);
          return [{ dot, path }];
        });
      }
      const share = Math.min(Math.max((now - begin) / each - leg, 0), 1);
      for (const { dot, path } of dots) {
        const point = path.getPointAtLength(path.getTotalLength() * share);
        dot.setAttribute("cx", String(point.x));
        dot.setAttribute("cy", String(point.y));
      }
      this.#frame = requestAnimationFrame(frame);
    };
    this.#frame = requestAnimationFrame(frame);
  }

  /** Where the eye should be: the transition that has just fired, or a place with a token. */
  centre(step: Step | null, marking: Marking): Element | null {
    const fired = step?.fired.at(-1);
    if (fired !== undefined) return this.#element(`transition ${fired}`);
    const place = Object.keys(marking)[0];
    return place === undefined ? null : this.#element(`place ${place}`);
  }

  stop(): void {
    cancelAnimationFrame(this.#frame);
  }

  #put(place: number, count: number): void {
    const spot = this.#spots[place];
    if (!spot || !count) return;
    this.#layer.append(token(spot, "token", RADIUS));
    if (count > 1) {
      const text = document.createElementNS(SVG, "text");
      text.setAttribute("x", String(spot.x + 8));
      text.setAttribute("y", String(spot.y - 5));
      text.setAttribute("class", "count");
      text.textContent = String(count);
      this.#layer.append(text);
    }
  }

  #element(id: string): Element | null {
    return this.#picture.querySelector(`[id="${id}"]`);
  }

  #path(id: string): SVGPathElement | null {
    return this.#element(id)?.querySelector("path") ?? null;
  }
}

function token({ x, y }: Spot, names: string, radius: number): SVGCircleElement {
  const dot = document.createElementNS(SVG, "circle");
  dot.setAttribute("class", names);
  dot.setAttribute("cx", String(x));
  dot.setAttribute("cy", String(y));
  dot.setAttribute("r", String(radius));
  return dot;
}
