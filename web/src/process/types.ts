// What the server tells of a process.

import type { Finding } from "../api/types";

export interface Place {
  name: string;
  group: string;
  device: string;
  signal: string;
  address: string;
  type: string;
  description: string;
}

export interface NetPlace {
  id: string;
  first: number;
  last: number;
}

export interface NetTransition {
  id: string;
  label: string | null;
  signal_class: string | null;
  inputs: number[];
  outputs: number[];
}

export interface Net {
  places: NetPlace[];
  transitions: NetTransition[];
}

export type Marking = Record<string, number>;

export interface Step {
  fired: number[];
  marking: Marking;
  missing?: number[];
  remaining?: number[];
  known?: boolean;
}

export interface Departure {
  event: number;
  activity: string | null;
  known: boolean;
  allowed: string[];
}

export interface Variant {
  runs: number[];
  count: number;
  share: number;
  events: number;
  seconds: number;
  shortest_s: number;
  longest_s: number;
  fits: boolean;
  departs: Departure | null;
}

export interface Runs {
  source: string;
  count: number;
  events: number;
  activities: number;
  fitness: number;
  fitting: number;
  precision: number;
  variants: Variant[];
  different: number;
}

/** What the learned controller would have done otherwise. */
export interface Disagreement extends Finding {
  address: string | null;
}

export interface Process {
  id: string;
  title: string;
  kept: boolean;
  reset: string | null;
  signals: Record<string, Place>;
  net: Net;
  soundness: { sound: boolean | null; problems: string[]; markings: number };
  epsilon: number | null;
  runs: Runs | null;
  guards: string[];
  no_controller: string | null;
  network: string | null;
  disagreements: Disagreement[];
  files: string[];
}

export interface PlayedEvent {
  at_s: number;
  activity: string;
  step: Step;
  foretold: { expected: string; probability: number } | null;
}

export interface Run {
  number: number;
  name: string;
  began_ms: number;
  events: PlayedEvent[];
  end: Step;
}

export interface Opening {
  change: string;
  signal_class: string | null;
  times: number;
  runs: number;
  same_activities: number;
  same_order: number;
  events: number;
  seconds: number;
  pause_s: number;
}

export interface Openings {
  /** Only of an event log that has runs of its own. */
  runs?: number;
  activities: number;
  events?: number;
  signals?: Place[];
  places?: Record<string, Place>;
  openings?: Opening[];
  left_out?: number;
  /** Why there are none. */
  why?: string;
}

export interface Overview {
  sources: { id: string; name: string; kind: string }[];
  nets: { id: string; name: string }[];
  mined: { id: string; name: string; reset: string | null }[];
  configured: { reset: string | null; eta: number; epsilon: number; only: string[] };
}

export interface Job {
  id: string;
  stage: string;
  done: boolean;
  process: string | null;
  error: string | null;
}

export interface LiveStep {
  number: number;
  time_ms: number;
  activity: string;
  step: Step;
  opens: boolean;
}

export interface LiveProcess {
  state: string;
  at_ms: number;
  since_ms: number;
  missing: string[];
  /** The net is too large to be followed. */
  given_up: boolean;
  sure: boolean;
  runs: number;
  marking: Marking;
  steps: LiveStep[];
  now: { waits_for: string[]; sets: string | null; after_s: number; why: string | null; may_set: string[] } | null;
  outputs: { signal: string; plc: number | null; learned: number | null }[];
  problem: string | null;
  follows: boolean;
  told: number;
  disagreements: Disagreement[];
  chances: [string, number][];
}
