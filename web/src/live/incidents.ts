import type { Incident, IncidentState, Severity } from "../api/types";

export interface Filter {
  text: string;
  states: Set<IncidentState>;
  severities: Set<Severity>;
}

export const STATES: IncidentState[] = [
  "unacknowledged",
  "returned",
  "acknowledged",
  "shelved",
  "closed",
];
export const OPEN_STATES: IncidentState[] = ["unacknowledged", "returned", "acknowledged"];

/** ISA-18.2 in words of everyday. */
export const STATE_WORDS: Record<IncidentState, string> = {
  unacknowledged: "unacknowledged",
  acknowledged: "acknowledged",
  returned: "returned, not seen",
  shelved: "shelved",
  closed: "closed",
};

const MOST_URGENT: IncidentState[] = STATES;
const GRAVEST: Severity[] = ["fault", "anomaly", "notice"];

/** The list with changed incidents in their place, and new ones in front. */
export function withChanged(incidents: Incident[], changed: Incident[]): Incident[] {
  const byId = new Map(changed.map((incident) => [incident.id, incident]));
  const known = incidents.map((incident) => {
    const newer = byId.get(incident.id);
    byId.delete(incident.id);
    return newer ?? incident;
  });
  return [...[...byId.values()].reverse(), ...known];
}

export function matches(incident: Incident, filter: Filter): boolean {
  if (!filter.states.has(incident.state) || !filter.severities.has(incident.severity)) return false;
  const words = filter.text.toLowerCase().split(/\s+/).filter(Boolean);
  const text = [incident.message, incident.place, incident.kind, incident.look_first, incident.id]
    .join(" ")
    .toLowerCase();
  return words.every((word) => text.includes(word));
}

/** What nobody has seen comes first, then what stands; within that, the gravest and newest. */
export function urgency(one: Incident, other: Incident): number {
  return (
    MOST_URGENT.indexOf(one.state) - MOST_URGENT.indexOf(other.state) ||
    GRAVEST.indexOf(one.severity) - GRAVEST.indexOf(other.severity) ||
    other.time.localeCompare(one.time)
  );
}
