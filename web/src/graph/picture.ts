// From Graphviz' SVG to a picture in the page's own colours.

import { INK } from "./dot";

const CLASSES = Object.fromEntries(Object.entries(INK).map(([name, colour]) => [colour, name]));

/** Parsed as a picture: nothing in it is run. */
export function pictureOf(svg: string): SVGSVGElement {
  const parsed = new DOMParser().parseFromString(svg, "image/svg+xml").documentElement;
  const picture = document.importNode(parsed, true) as unknown as SVGSVGElement;
  for (const element of picture.querySelectorAll("[fill], [stroke]")) {
    for (const attribute of ["fill", "stroke"]) {
      const name = CLASSES[element.getAttribute(attribute) ?? ""];
      if (name) element.classList.add(`${attribute}-${name}`);
    }
  }
  for (const text of picture.querySelectorAll("text:not([fill])")) text.classList.add("fill-ink");
  picture.querySelectorAll("title").forEach((title) => title.remove());
  picture.removeAttribute("id");
  picture.setAttribute("aria-hidden", "true");
  return picture;
}
