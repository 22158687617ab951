// What stands behind the `#`: `#/timing/SOURCE?at=123`.

export interface Address {
  view: string;
  rest: string[];
  query: URLSearchParams;
}

export function parseAddress(hash: string, fallback: string): Address {
  const [path = "", query = ""] = hash.replace(/^#\/?/, "").split("?", 2);
  const [view, ...rest] = path.split("/").filter(Boolean).map(decode);
  return { view: view ?? fallback, rest, query: new URLSearchParams(query) };
}

export function hashOf(view: string, rest: string[] = [], query: Record<string, string> = {}): string {
  const path = [view, ...rest].map(encodeURIComponent).join("/");
  const asked = new URLSearchParams(query).toString();
  return `#/${path}${asked ? `?${asked}` : ""}`;
}

function decode(part: string): string {
  try {
    return decodeURIComponent(part);
  } catch {
    return part;
  }
}
