// Graphviz text of a Petri net.

import { INK } from "../graph/dot";
import type { Net, Place } from "./types";
import { changesOf, spokenChange } from "./words";

/** Places and transitions that are drawn: a larger net is no picture any more. */
export const MOST_NODES = 130;

export function nodes(net: Net): number {
  return net.places.length + net.transitions.length;
}

/** With colours that stand for those of the page; `plain` has colours of its own, to be kept as a file. */
export function netDot(net: Net, signals: Record<string, Place>, plain = false): string {
  const ink = plain ? PLAIN : INK;
  const lines = [
    "digraph {",
    `rankdir=TB; bgcolor="transparent"; nodesep=0.3; ranksep=0.24;`,
    `node [fontname="Helvetica", fontsize=11, color="${ink.ink}", fontcolor="${ink.ink}"];`,
    `edge [color="${ink.ink}", arrowsize=0.6];`,
  ];
  net.places.forEach((place, number) => {
    const [colour, width] = place.first ? [ink.green, 2] : place.last ? [ink.red, 2] : [ink.ink, 1];
    lines.push(`p${number} [id="place ${number}", shape=circle, style=filled, fillcolor="${ink.node}", color="${colour}", penwidth=${width}, label="", width=0.26, fixedsize=true];`);
  });
  net.transitions.forEach((each, number) => {
    if (each.label === null) {
      lines.push(`t${number} [id="transition ${number}", shape=box, style=filled, fillcolor="${ink.ink}", label="", width=0.32, height=0.07, fixedsize=true];`);
    } else {
      const label = changesOf(each.label).map((change) => escaped(spokenChange(change, signals))).join("\\n");
      const fill = each.signal_class === "input" ? ink.input : each.signal_class === "output" ? ink.output : ink.node;
      lines.push(`t${number} [id="transition ${number}", shape=box, style="filled,rounded", fillcolor="${fill}", label="${label}", height=0.3, margin="0.12,0.04"];`);
    }
  });
  net.transitions.forEach((each, number) => {
    for (const place of each.inputs) lines.push(`p${place} -> t${number} [id="${arcIn(place, number)}"];`);
    for (const place of each.outputs) lines.push(`t${number} -> p${place} [id="${arcOut(number, place)}"];`);
  });
  lines.push("}");
  return lines.join("\n");
}

export function arcIn(place: number, transition: number): string {
  return `arc in ${place} ${transition}`;
}

export function arcOut(transition: number, place: number): string {
  return `arc out ${transition} ${place}`;
}

const PLAIN = {
  ink: "#3c4247",
  node: "#ffffff",
  input: "#ddf4ff",
  output: "#fff1d6",
  green: "#2da44e",
  red: "#cf222e",
};

function escaped(text: string): string {
  return text.replace(/["\\]/g, "\\$&").replace(/[\n\r]/g, " ");
}
