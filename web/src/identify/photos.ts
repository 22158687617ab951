// Stepping through photos.

const FAR = 10;

/** The photo taken nearest to a time; -1 where there is none. */
export function nearestPhoto(photos: number[], at: number): number {
  let low = 0;
  let high = photos.length - 1;
  while (low < high) {
    const middle = (low + high) >> 1;
    if (photos[middle]! < at) low = middle + 1;
    else high = middle;
  }
  if (low > 0 && at - photos[low - 1]! < photos[low]! - at) return low - 1;
  return photos.length ? low : -1;
}

/** Where a key leads; null for keys that do not step. */
export function stepped(key: string, shift: boolean, index: number, count: number): number | null {
  const by: Record<string, number> = {
    ArrowLeft: shift ? -FAR : -1,
    ArrowRight: shift ? FAR : 1,
    PageUp: -FAR,
    PageDown: FAR,
    Home: -count,
    End: count,
  };
  const step = by[key];
  return step === undefined ? null : Math.max(0, Math.min(index + step, count - 1));
}

export function photoAddress(source: string, originNs: bigint, at: number): string {
  return `/api/identify/${encodeURIComponent(source)}/photos/${originNs + BigInt(at)}`;
}
