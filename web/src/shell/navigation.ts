import type { Component } from "svelte";

export interface View {
  id: string;
  title: string;
  key: string;
  load: () => Promise<{ default: Component }>;
}

// A view is added by its line here: its code is loaded when it is first opened.
export const VIEWS: View[] = [
  { id: "live", title: "Live", key: "1", load: () => import("../live/LiveView.svelte") },
  { id: "timing", title: "Timing", key: "2", load: () => import("../timing/TimingView.svelte") },
  { id: "model", title: "Model", key: "3", load: () => import("../model/ModelView.svelte") },
  { id: "identify", title: "Identify", key: "5", load: () => import("../identify/IdentifyView.svelte") },
  {
    id: "recordings",
    title: "Recordings",
    key: "4",
    load: () => import("../recordings/RecordingsView.svelte"),
  },
  { id: "process", title: "Process", key: "6", load: () => import("../process/ProcessView.svelte") },
];
