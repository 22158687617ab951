import { type Address, parseAddress } from "./address";
import { VIEWS } from "./navigation";

const FIRST = VIEWS[0]!.id;

class Route {
  address: Address = $state.raw(parseAddress(location.hash, FIRST));

  constructor() {
    addEventListener("hashchange", () => {
      this.address = parseAddress(location.hash, FIRST);
    });
  }

  /** What stands behind a view's own name; nothing while another view is opened. */
  of(view: string): Address {
    return this.address.view === view ? this.address : { view, rest: [], query: new URLSearchParams() };
  }

  get view() {
    return VIEWS.find((view) => view.id === this.address.view) ?? VIEWS[0]!;
  }
}

export const route = new Route();

export function go(hash: string): void {
  location.hash = hash;
}
