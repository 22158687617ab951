import type { SymbolRow } from "../api/types";

export const COLUMNS = ["address", "group", "device", "signal", "class", "type", "description"] as const;

export function emptyRow(): SymbolRow {
  return { address: "", group: "", device: "", signal: "", class: "", type: "BOOL", description: "" };
}

/** What is wrong with which row, in a sentence. */
export function wrongRows(rows: SymbolRow[]): Map<number, string> {
  const wrong = new Map<number, string>();
  const addresses = new Map<string, number>();
  const names = new Map<string, number>();
  rows.forEach((row, index) => {
    const address = row.address.trim();
    const name = [row.group, row.device, row.signal].map((part) => part.trim()).join("-");
    if (!address) wrong.set(index, `row ${index + 1} has no address`);
    else if (addresses.has(address)) {
      wrong.set(index, `${address} is in row ${addresses.get(address)! + 1} and row ${index + 1}`);
    } else if (row.signal.trim() && names.has(name)) {
      wrong.set(index, `${name} is the name of row ${names.get(name)! + 1} and row ${index + 1}`);
    }
    addresses.set(address, addresses.get(address) ?? index);
    names.set(name, names.get(name) ?? index);
  });
  return wrong;
}

/** Rows of tab-separated cells, as spreadsheets copy them; none for a single cell. */
export function pastedRows(text: string): SymbolRow[] {
  if (!text.includes("\t")) return [];
  return text
    .split(/\r?\n/)
    .filter((line) => line.trim())
    .map((line) => {
      const cells = line.split("\t");
      return Object.fromEntries(COLUMNS.map((column, at) => [column, cells[at]?.trim() ?? ""])) as unknown as SymbolRow;
    });
}
