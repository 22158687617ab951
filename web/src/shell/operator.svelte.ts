// Who sits here: kept in this browser, written beside everything they do.

const KEY = "runglight.operator";

class Operator {
  name = $state(localStorage.getItem(KEY) ?? "");

  set(name: string): void {
    this.name = name.trim();
    localStorage.setItem(KEY, this.name);
  }
}

export const operator = new Operator();
