interface Answer {
  id: number;
  svg?: string;
  error?: string;
}

let worker: Worker | null = null;
let next = 0;
const waiting = new Map<number, { resolve: (svg: string) => void; reject: (error: Error) => void }>();

/** The SVG of a Graphviz text. The worker is loaded when the first graph is drawn. */
export function layout(dot: string): Promise<string> {
  worker ??= started();
  const id = next++;
  return new Promise((resolve, reject) => {
    waiting.set(id, { resolve, reject });
    worker!.postMessage({ id, dot });
  });
}

function started(): Worker {
  const made = new Worker(new URL("./layout.worker.ts", import.meta.url), { type: "module" });
  made.onmessage = (event: MessageEvent<Answer>) => {
    const { id, svg, error } = event.data;
    const asker = waiting.get(id);
    waiting.delete(id);
    if (svg !== undefined) asker?.resolve(svg);
    else asker?.reject(new Error(error));
  };
  made.onerror = () => {
    for (const asker of waiting.values()) asker.reject(new Error("graphs cannot be drawn in this browser"));
    waiting.clear();
  };
  return made;
}
