import { post } from "../api/client";
import { operator } from "../shell/operator.svelte";

export function acknowledge(ids: string[]): Promise<unknown> {
  return post("/api/incidents/acknowledge", { ids, who: operator.name });
}

/** Quiet for so many minutes; 0 takes them off the shelf. */
export function shelve(ids: string[], minutes: number): Promise<unknown> {
  return post("/api/incidents/shelve", { ids, who: operator.name, minutes });
}

export function accept(finding: string): Promise<{ new_transitions: number }> {
  return post("/api/incidents/accept", { finding, who: operator.name });
}
