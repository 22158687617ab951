// The shapes the server answers with; `runglight/server/routes` says what they mean.

export type Severity = "fault" | "anomaly" | "notice";
export type IncidentState = "unacknowledged" | "acknowledged" | "returned" | "shelved" | "closed";
export type Colour = "green" | "amber" | "red" | "grey";

export interface Session {
  needs_token: boolean;
  version?: string;
  read_only?: boolean;
  upload_bytes?: number;
}

export interface Light {
  colour: Colour;
  blinks: boolean;
}

export interface DeviceLight {
  device: string;
  light: Light;
  state: string | null;
  since_ms: number | null;
}

export interface GroupLight {
  group: string;
  light: Light;
  devices: DeviceLight[];
}

export interface Deed {
  who: string;
  time: string;
  until: string | null;
}

export interface Incident {
  id: string;
  time: string;
  last: string;
  severity: Severity;
  state: IncidentState;
  kind: string;
  group: string | null;
  device: string | null;
  place: string;
  message: string;
  look_first: string;
  findings: number;
  acknowledged: Deed | null;
  shelved: Deed | null;
  accepted: Deed | null;
}

export interface Status {
  watching: {
    state: string;
    reason: string | null;
    status: {
      source: string;
      reconnects: number;
      gaps: number;
      scans: number;
      scans_per_s: number;
      changes: number;
    } | null;
  };
  until_ms: number | null;
  recording: {
    name: string;
    rows: number;
    seconds: number;
    changes_per_s: number;
    free_bytes: number;
  } | null;
}

export interface Note {
  time: string;
  text: string;
}

export interface LivePicture extends Status {
  model: { id: string; name: string } | null;
  groups: GroupLight[];
  incidents: Incident[];
  notes: Note[];
}

export interface Finding {
  id: string;
  time: string;
  kind: string;
  severity: Severity;
  state: string;
  model: string;
  message: string;
  group: string | null;
  device: string | null;
  from: string | null;
  to: string | null;
  expected: { state: string; probability: number | null; limit_s: number | null }[];
  observed_s: number | null;
  limit_s: number | null;
  suspects: { address: string | null; signal: string | null; score: number | null }[];
  path: string[];
}

export interface Ghost {
  signal: string;
  value: number | null;
  probability: number | null;
  typical_ns: string | null;
  earliest_ns: string | null;
  latest_ns: string | null;
}

export interface Rule {
  model: string;
  group: string;
  device: string | null;
  current: string;
  next: string;
  count: number;
  transition_probability: number;
  cluster: number;
  average_s: number | null;
  minimum_s: number | null;
  maximum_s: number | null;
  early_limit_s: number | null;
  late_limit_s: number | null;
  time_probability: number | null;
  position: number | null;
  start_up: boolean;
  trigger: string | null;
  trigger_average_s: number | null;
}

export interface IncidentDetail {
  summary: Incident;
  leading: Finding;
  findings: Finding[];
  acceptable: string[];
  at_ns: string;
  source: string | null;
  ghosts: Ghost[];
  rules: Rule[];
  snapshot: {
    devices: Record<string, { state: string; since: string }>;
    groups: Record<string, { state: string; since: string }>;
  } | null;
}

export interface SourceItem {
  id: string;
  name: string;
  kind: "live" | "recording" | "log";
}

export interface Signal {
  lane: number;
  name: string;
  group: string;
  device: string;
  signal: string;
  address: string;
  description: string;
  type: string;
  changes: number;
  low: number;
  high: number;
}

export interface Source {
  id: string;
  name: string;
  origin_ns: string;
  length_ns: number;
  gaps: [number, number][];
  signals: Signal[];
}

export interface ModelItem {
  id: string;
  name: string;
  watching: boolean;
}

export interface ModelSummary {
  name: string;
  created: string;
  events: number;
  duration_s: number;
  rules: number;
  signals: number;
  devices: number;
  source: string[];
  group_list: {
    group: string;
    start: string;
    devices: { device: string; start: string; signals: number; rules: number }[];
  }[];
}

export interface Recording {
  id: string;
  name: string;
  kind: "recording" | "log";
  bytes: number;
  changed_ms: number;
  source: string | null;
  signals: number | null;
  recording: boolean;
}

export interface SymbolRow {
  address: string;
  group: string;
  device: string;
  signal: string;
  class: string;
  type: string;
  description: string;
}
