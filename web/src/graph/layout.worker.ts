// Graphviz in a thread of its own: a layout of a hundred nodes must not hold up the alarms.

import { instance } from "@viz-js/viz";

const graphviz = instance();

addEventListener("message", (event: MessageEvent<{ id: number; dot: string }>) => {
  const { id, dot } = event.data;
  graphviz.then(
    (viz) => {
      const drawn = viz.render(dot, { format: "svg" });
      if (drawn.status === "success") postMessage({ id, svg: drawn.output });
      else postMessage({ id, error: drawn.errors[0]?.message ?? "it cannot be drawn" });
    },
    (error) => postMessage({ id, error: String(error) }),
  );
});
