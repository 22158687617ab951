// Saved views, kept in this browser. Signals are kept by name: lanes differ between recordings.

import type { View } from "./view";

export interface Saved {
  name: string;
  signals: string[];
  view: View;
  /** Devices that are folded. */
  folded?: string[];
}

const KEY = "runglight.views";
const AT_MOST = 50;

export function savedViews(storage: Pick<Storage, "getItem">): Saved[] {
  try {
    const found: unknown = JSON.parse(storage.getItem(KEY) ?? "[]");
    return Array.isArray(found) ? found.filter(isSaved) : [];
  } catch {
    return [];
  }
}

/** A view of the same name is replaced; the newest comes first. */
export function withSaved(views: Saved[], saved: Saved): Saved[] {
  return [saved, ...views.filter((view) => view.name !== saved.name)].slice(0, AT_MOST);
}

export function withoutSaved(views: Saved[], name: string): Saved[] {
  return views.filter((view) => view.name !== name);
}

export function keepViews(storage: Pick<Storage, "setItem">, views: Saved[]): void {
  storage.setItem(KEY, JSON.stringify(views));
}

function isSaved(found: unknown): found is Saved {
  if (!found || typeof found !== "object") return false;
  const saved = found as Partial<Saved>;
  return (
    typeof saved.name === "string" &&
    Array.isArray(saved.signals) &&
    saved.signals.every((name) => typeof name === "string") &&
    (saved.folded === undefined || Array.isArray(saved.folded)) &&
    typeof saved.view?.from === "number" &&
    typeof saved.view.until === "number" &&
    saved.view.until > saved.view.from
  );
}
