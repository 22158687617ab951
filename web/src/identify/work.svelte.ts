// What has been declared of each source and not saved yet: it outlives a look at another view.

import { begun, did, redone, undone, type History } from "./declared";
import type { DeclaredEvent, Opened } from "./types";

export class Work {
  history: History = $state.raw(begun([]));
  /** The version of the file that saving replaces. */
  version: string | null;
  file: string;
  #saved: DeclaredEvent[] = $state.raw([]);

  constructor(opened: Opened) {
    this.history = begun(opened.declared.events);
    this.#saved = opened.declared.events;
    this.version = opened.declared.version;
    this.file = opened.declared.file;
  }

  get events(): DeclaredEvent[] {
    return this.history.now;
  }

  get dirty(): boolean {
    return this.history.now !== this.#saved;
  }

  do(next: DeclaredEvent[]): void {
    this.history = did(this.history, next);
  }

  undo(): void {
    this.history = undone(this.history);
  }

  redo(): void {
    this.history = redone(this.history);
  }

  saved(events: DeclaredEvent[], version: string): void {
    this.#saved = events;
    this.version = version;
  }

  /** The file as it is now; what was declared meanwhile can be had back by undoing. */
  loaded(opened: Opened): void {
    this.do(opened.declared.events);
    this.#saved = opened.declared.events;
    this.version = opened.declared.version;
  }
}

const works = new Map<string, Work>();

export function workOf(opened: Opened): Work {
  const there = works.get(opened.id);
  if (there && (there.dirty || there.version === opened.declared.version)) return there;
  const work = new Work(opened);
  works.set(opened.id, work);
  return work;
}
