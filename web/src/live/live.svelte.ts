// What is live, kept up to date by server-sent events.
import { get } from "../api/client";
import type { DeviceLight, GroupLight, Incident, LivePicture, Note, Status } from "../api/types";
import { withChanged } from "./incidents";
import { withLights } from "./lights";

class Live {
  status: Status | null = $state.raw(null);
  model: LivePicture["model"] = $state.raw(null);
  groups: GroupLight[] = $state.raw([]);
  incidents: Incident[] = $state.raw([]);
  notes: Note[] = $state.raw([]);
  /** False while the server itself does not answer. */
  reachable = $state(true);
  /** Grows whenever the server began anew: views ask for everything again. */
  epoch = $state(0);
  #events: EventSource | null = null;

  start(): void {
    if (this.#events) return;
    const events = new EventSource("/api/live/stream");
    this.#events = events;
    events.onopen = () => (this.reachable = true);
    events.onerror = () => (this.reachable = false);
    this.#on<LivePicture>("hello", (picture) => this.#take(picture));
    this.#on<Status>("status", (status) => (this.status = status));
    this.#on<Record<string, DeviceLight>>("lights", (changed) => {
      this.groups = withLights(this.groups, changed);
    });
    this.#on<Incident[]>("incidents", (changed) => {
      this.incidents = withChanged(this.incidents, changed);
    });
    this.#on<Note>("note", (note) => (this.notes = [...this.notes.slice(-49), note]));
    events.addEventListener("resync", () => void this.look());
  }

  async look(): Promise<void> {
    try {
      this.#take(await get<LivePicture>("/api/live"));
    } catch {
      this.reachable = false;
    }
  }

  #on<T>(event: string, take: (content: T) => void): void {
    this.#events?.addEventListener(event, (message) => {
      take(JSON.parse((message as MessageEvent<string>).data) as T);
    });
  }

  #take(picture: LivePicture): void {
    this.reachable = true;
    this.status = picture;
    this.model = picture.model;
    this.groups = picture.groups;
    this.incidents = picture.incidents;
    this.notes = picture.notes;
    this.epoch += 1;
  }
}

export const live = new Live();
