// The shapes of `runglight/server/routes/identify.py`. Times: nanoseconds from the source's origin.

export interface Searchable {
  id: string;
  name: string;
  photos: number;
  events: boolean;
}

export interface DeclaredEvent {
  at: number;
  label: string;
}

export interface Opened {
  id: string;
  name: string;
  origin_ns: string;
  length_ns: number;
  photos: number[];
  declared: { file: string; events: DeclaredEvent[]; version: string | null };
  declared_error: string | null;
  tau_s: number;
  view: ChangeView;
  order: Order;
  naming: string;
  table: string;
}

export type ChangeView = "all" | "rising" | "falling" | "increments";
export type Order = "scores" | "agreement";

export interface Candidate {
  rank: number;
  address: string;
  name: string | null;
  score_in: number;
  score_out: number;
  changes: number;
  same_as: string;
  agreement: number | null;
}

export interface Ranked {
  windows: [start: number, end: number, events: number][];
  unrecorded: number[];
  changing: number;
  kept: number;
  candidates: Candidate[];
  verdict: string;
}

export interface Swept {
  tau_s: number;
  reason: string;
  steps: [tau_s: number, met: number, windows: number][];
}
