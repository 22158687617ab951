// Graphviz text of rules, with what shall be seen in them.

import type { Finding, Rule } from "../api/types";

/** Colours that stand for those of the page: Graphviz knows no others than its own and numbers. */
export const INK = {
  ink: "#010101",
  soft: "#010102",
  red: "#010103",
  accent: "#010104",
  node: "#010105",
  redground: "#010106",
  input: "#010107",
  output: "#010108",
  green: "#010109",
};

export interface Transition {
  current: string;
  next: string;
  probability: number;
  count: number;
  startUp: boolean;
  trigger: string | null;
  clusters: Rule[];
}

/** The rows of the rules table by transition: one for every time cluster. */
export function transitions(rules: Rule[]): Transition[] {
  const found = new Map<string, Transition>();
  for (const rule of rules) {
    const key = `${rule.current}\n${rule.next}`;
    const known = found.get(key);
    if (known) known.clusters.push(rule);
    else {
      found.set(key, {
        current: rule.current,
        next: rule.next,
        probability: rule.transition_probability,
        count: rule.count,
        startUp: rule.start_up,
        trigger: rule.trigger,
        clusters: [rule],
      });
    }
  }
  return [...found.values()];
}

export interface Look {
  /** Transitions rarer than this are left out. */
  rarest?: number;
  causes?: boolean;
  chosen?: string | null;
  /** Nodes and edges in red. */
  faulty?: { from: string | null; to: string | null } | null;
  /** By key of the transition: only in one of two models, or of another time. */
  differences?: Map<string, "added" | "removed" | "changed">;
}

export function keyOf(transition: { current: string; next: string }): string {
  return `${transition.current}\n${transition.next}`;
}

const CHANGE_COLOUR = { added: "#2f9e54", removed: "#b3201b", changed: "#b06a00" };

export function dotOf(all: Transition[], look: Look = {}): string {
  const shown = all.filter((each) => each.probability >= (look.rarest ?? 0));
  const prefix = commonPrefix(shown.flatMap((each) => [each.current, each.next]));
  const lines = [
    "digraph {",
    'rankdir=TB; bgcolor="transparent"; nodesep=0.25; ranksep=0.35;',
    `node [shape=box, style="rounded,filled", fontname="Helvetica", fontsize=11, height=0.3, margin="0.12,0.04", color="${INK.ink}", fillcolor="${INK.node}", fontcolor="${INK.ink}"];`,
    `edge [fontname="Helvetica", fontsize=9.5, color="${INK.ink}", fontcolor="${INK.soft}", arrowsize=0.7];`,
  ];
  const states = [...new Set(shown.flatMap((each) => [each.current, each.next]))];
  const { from = null, to = null } = look.faulty ?? {};
  for (const state of [from, to]) if (state && !states.includes(state)) states.push(state);
  for (const state of states) {
    const red = look.faulty && state === to;
    const paint = red ? `, color="${INK.red}", fillcolor="${INK.redground}", fontcolor="${INK.red}", penwidth=1.6` : "";
    lines.push(`${quoted(state)} [label=${quoted(state.slice(prefix.length))}${paint}];`);
  }
  for (const each of shown) {
    const key = keyOf(each);
    const changed = look.differences?.get(key);
    const paint = [`label=${quoted(edgeLabel(each))}`, `id=${quoted(`edge ${key.replace("\n", " > ")}`)}`];
    if (changed) paint.push(`color="${CHANGE_COLOUR[changed]}", fontcolor="${CHANGE_COLOUR[changed]}", penwidth=1.8`);
    if (changed === "removed") paint.push("style=dashed");
    if (look.chosen === key) paint.push(`color="${INK.accent}", fontcolor="${INK.accent}", penwidth=2.4`);
    else if (look.faulty && each.current === from) paint.push(`color="${INK.accent}", fontcolor="${INK.accent}", penwidth=1.6`);
    else paint.push(`penwidth=${(0.7 + each.probability * 0.9).toFixed(2)}`);
    lines.push(`${quoted(each.current)} -> ${quoted(each.next)} [${paint.join(", ")}];`);
  }
  if (look.causes) {
    for (const each of shown) {
      if (!each.trigger) continue;
      const cause = quoted(`cause ${each.trigger}`);
      lines.push(`${cause} [label=${quoted(each.trigger)}, shape=plaintext, style="", fontcolor="${INK.accent}", fontsize=10];`);
      lines.push(`${cause} -> ${quoted(each.next)} [style=dashed, color="${INK.accent}", arrowhead=open];`);
    }
  }
  if (look.faulty && from && to) {
    lines.push(`${quoted(from)} -> ${quoted(to)} [color="${INK.red}", fontcolor="${INK.red}", penwidth=2.6, label="not known"];`);
  }
  lines.push("}");
  return lines.join("\n");
}

/** The graph around a finding: what was known, and in red what happened. */
export function faultyDot(rules: Rule[], finding: Finding): string | null {
  const all = transitions(rules);
  if (!all.length) return null;
  const { from, to } = finding;
  const known = all.some((each) => each.current === from && each.next === to);
  const faulty = to && !known ? { from, to } : { from: null, to: to ?? from };
  return dotOf(near(all, [from, to, ...finding.path]), { faulty });
}

const MOST_NODES = 60;

/** Of a large graph, what lies within two steps of some states. */
export function near(all: Transition[], states: (string | null)[]): Transition[] {
  const every = new Set(all.flatMap((each) => [each.current, each.next]));
  if (every.size <= MOST_NODES) return all;
  const inside = new Set(states.filter((state) => state !== null));
  for (let step = 0; step < 2; step += 1) {
    for (const each of all) {
      if (inside.has(each.current) || inside.has(each.next)) {
        if (inside.size >= MOST_NODES) break;
        inside.add(each.current).add(each.next);
      }
    }
  }
  return all.filter((each) => inside.has(each.current) && inside.has(each.next));
}

function edgeLabel(each: Transition): string {
  const times = each.clusters.flatMap((rule) => (rule.average_s === null ? [] : [seconds(rule.average_s)]));
  const share = each.probability < 0.995 ? `${Math.round(each.probability * 100)} %  ` : "";
  return `  ${share}${times.join(" | ")} `;
}

function seconds(value: number): string {
  return value < 1 ? `${Math.round(value * 1000)} ms` : `${Number(value.toPrecision(3))} s`;
}

function commonPrefix(states: string[]): string {
  const first = states[0];
  if (!first) return "";
  let at = first.lastIndexOf("-") + 1;
  while (at > 0 && !states.every((state) => state.startsWith(first.slice(0, at)))) {
    at = first.lastIndexOf("-", at - 2) + 1;
  }
  return first.slice(0, at);
}

function quoted(text: string): string {
  return `"${text.replace(/["\\]/g, "\\$&").replace(/[\n\r]/g, " ")}"`;
}
