// Times as they are shown: UTC, as everywhere in runglight.

export function clockTime(ms: number, digits = 3): string {
  const text = new Date(ms).toISOString();
  return digits ? text.slice(11, 20 + digits) : text.slice(11, 19);
}

export function dayAndTime(text: string | number): string {
  const iso = typeof text === "number" ? new Date(text).toISOString() : text;
  return `${iso.slice(0, 10)} ${iso.slice(11, 23)}`;
}

/** A length of time in the unit that suits it: `1.42 s`, `350 ms`, `2 h 5 min`. */
export function length(seconds: number): string {
  const size = Math.abs(seconds);
  const sign = seconds < 0 ? "−" : "";
  if (size === 0) return "0 s";
  if (size < 1e-6) return `${sign}${trim(size * 1e9)} ns`;
  if (size < 1e-3) return `${sign}${trim(size * 1e6)} µs`;
  if (size < 1) return `${sign}${trim(size * 1e3)} ms`;
  if (size < 120) return `${sign}${trim(size)} s`;
  if (size < 7200) return `${sign}${Math.floor(size / 60)} min ${Math.round(size % 60)} s`;
  if (size < 172_800) return `${sign}${Math.floor(size / 3600)} h ${Math.round((size % 3600) / 60)} min`;
  return `${sign}${trim(size / 86_400)} d`;
}

export function bytes(count: number): string {
  const units = ["B", "kB", "MB", "GB", "TB"];
  let size = count;
  let unit = 0;
  while (size >= 1000 && unit < units.length - 1) {
    size /= 1000;
    unit += 1;
  }
  return `${unit ? size.toFixed(1) : size} ${units[unit]}`;
}

function trim(value: number): string {
  return String(Number(value.toPrecision(value >= 100 ? 4 : 3)));
}
