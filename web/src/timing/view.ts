// The stretch of time that is looked at. All times: nanoseconds from the source's origin.

export interface View {
  from: number;
  until: number;
}

export const SHORTEST_NS = 1000;

export function lengthOf(view: View): number {
  return view.until - view.from;
}

export function zoomed(view: View, factor: number, around: number, longest: number): View {
  const wanted = lengthOf(view) * factor;
  const length = Math.min(Math.max(wanted, SHORTEST_NS), Math.max(longest * 1.2, SHORTEST_NS * 10));
  const share = (around - view.from) / lengthOf(view);
  const from = around - share * length;
  return { from, until: from + length };
}

export function panned(view: View, by: number): View {
  return { from: view.from + by, until: view.until + by };
}

/** Keeps some of the source in sight. */
export function kept(view: View, length: number): View {
  const span = lengthOf(view);
  const from = Math.min(Math.max(view.from, -span * 0.9), length - span * 0.1);
  return from === view.from ? view : { from, until: from + span };
}

export function around(time: number, length: number, share = 0.5): View {
  return { from: time - length * share, until: time + length * (1 - share) };
}

export function toPixel(view: View, width: number, time: number): number {
  return ((time - view.from) / lengthOf(view)) * width;
}

export function toTime(view: View, width: number, pixel: number): number {
  return view.from + (pixel / width) * lengthOf(view);
}
