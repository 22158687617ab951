// Activities, and how good a net is, as an electrician would say it.

import type { Departure, Place, Process, Runs } from "./types";

/** What a signal is called here: without the group, where it has one. */
export function nameOf(signal: string, places: Record<string, Place>): string {
  const place = places[signal];
  if (!place || !place.device) return signal;
  return `${place.device}-${place.signal}`;
}

/** `%IX0.1=0` is `%IX0.1 OFF`, a word keeps its number. */
export function spokenChange(change: string, places: Record<string, Place>): string {
  const at = change.lastIndexOf("=");
  if (at < 0) return change;
  const signal = change.slice(0, at);
  const value = change.slice(at + 1);
  const place = places[signal];
  if ((place && place.type !== "BOOL") || (value !== "0" && value !== "1")) return `${nameOf(signal, places)} = ${value}`;
  return `${nameOf(signal, places)} ${value === "1" ? "ON" : "OFF"}`;
}

export function changesOf(activity: string): string[] {
  return activity.split(" & ");
}

export function spoken(activity: string, places: Record<string, Place>): string {
  return changesOf(activity)
    .map((change) => spokenChange(change, places))
    .join(" & ");
}

/** Every change that a sentence names, as it is called here. */
export function spokenIn(sentence: string, places: Record<string, Place>): string {
  // The longest first: one name may begin like another.
  const names = Object.keys(places).sort((one, other) => other.length - one.length);
  let said = sentence;
  for (const name of names) {
    const pattern = new RegExp(`${name.replace(/[.*+?^${}()|[\]\\]/g, "\\$&")}=(-?\\d+)`, "g");
    said = said.replace(pattern, (change) => spokenChange(change, places));
  }
  return said;
}

/** Addresses of an activity's signals, where they are not its names. */
export function addressesOf(activity: string, places: Record<string, Place>): string {
  const found = changesOf(activity).flatMap((change) => {
    const signal = change.slice(0, change.lastIndexOf("="));
    const address = places[signal]?.address;
    return address && address !== signal ? [address] : [];
  });
  return found.join(", ");
}

export interface Verdict {
  good: boolean | null;
  short: string;
  sentence: string;
}

export function soundness({ sound, problems }: Process["soundness"]): Verdict {
  if (sound === null) {
    return {
      good: null,
      short: "not known",
      sentence: "The net has too many states to say whether it can get stuck. Choose fewer signals to know.",
    };
  }
  if (sound) {
    return {
      good: true,
      short: "sound",
      sentence: "Every run can come to its end, nothing is left over, and every step can happen.",
    };
  }
  return {
    good: false,
    short: "not sound",
    sentence: `${problems.join(" ") || "It can get stuck."} Do not control anything with it.`,
  };
}

export function fitness(runs: Runs): Verdict {
  const share = `${runs.fitting.toLocaleString("en")} of ${runs.count.toLocaleString("en")}`;
  if (runs.fitting === runs.count) {
    return { good: true, short: `${percent(runs.fitness)} fit`, sentence: `All ${runs.count.toLocaleString("en")} recorded runs go through the net exactly.` };
  }
  return {
    good: runs.fitness >= 0.95 ? null : false,
    short: `${percent(runs.fitness)} fit`,
    sentence: `${share} runs go through the net exactly; the others depart from it somewhere. The table of runs says where.`,
  };
}

export function precision(runs: Runs): Verdict {
  const sentence =
    runs.precision >= 0.999
      ? "The net allows only what was seen."
      : runs.precision >= 0.75
        ? "The net allows a little more than what was seen: some orders it draws as possible never came."
        : runs.precision >= 0.5
          ? "The net allows much that was never seen. It says what happens, but not strictly in which order."
          : "The net allows nearly everything: it says little about the order. Choose the signals of one station.";
  return { good: runs.precision >= 0.75 ? true : runs.precision >= 0.5 ? null : false, short: `${percent(runs.precision)} precise`, sentence };
}

export function departs(departure: Departure, places: Record<string, Place>): string {
  const allowed = departure.allowed.map((each) => spoken(each, places));
  const instead = allowed.length ? listed(allowed) : "the end of the run";
  if (departure.activity === null) return `ends too early: the net expects ${instead}`;
  const what = spoken(departure.activity, places);
  if (!departure.known) return `event ${departure.event + 1}, ${what}: the net has no such step`;
  return `event ${departure.event + 1}, ${what}: the net expects ${instead} here`;
}

const NAMED = 3;

export function listed(names: string[]): string {
  if (names.length > NAMED) return `${names.slice(0, NAMED).join(", ")} or ${names.length - NAMED} ${names.length - NAMED === 1 ? "other" : "others"}`;
  return names.length > 1 ? `${names.slice(0, -1).join(", ")} or ${names.at(-1)}` : (names[0] ?? "nothing");
}

/** Never rounded up to all of it. */
export function percent(share: number): string {
  if (share >= 1) return "100 %";
  const shown = Math.min(share * 100, 99.9);
  return `${shown >= 99 || shown < 1 ? shown.toFixed(1) : Math.round(shown)} %`;
}
