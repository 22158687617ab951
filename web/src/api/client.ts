// Requests to the server. An error is one sentence for the user, thrown as `Refused`.

export class Refused extends Error {
  constructor(
    message: string,
    readonly status: number,
  ) {
    super(message);
  }
}

async function answered(request: Promise<Response>): Promise<Response> {
  let response: Response;
  try {
    response = await request;
  } catch (error) {
    if (error instanceof DOMException && error.name === "AbortError") throw error;
    throw new Refused("the server does not answer; is runglight serve still running?", 0);
  }
  if (response.ok) return response;
  let sentence = `the server answered ${response.status}`;
  try {
    const told: unknown = await response.json();
    if (told && typeof told === "object" && "error" in told) sentence = String(told.error);
  } catch {
    // An answer that is no JSON says no more than its number.
  }
  throw new Refused(sentence, response.status);
}

export async function get<T>(path: string, signal?: AbortSignal): Promise<T> {
  return (await answered(fetch(path, { signal: signal ?? null }))).json() as Promise<T>;
}

export async function getBytes(
  path: string,
  signal?: AbortSignal,
): Promise<{ bytes: ArrayBuffer; headers: Headers }> {
  const response = await answered(fetch(path, { signal: signal ?? null }));
  return { bytes: await response.arrayBuffer(), headers: response.headers };
}

export async function post<T>(path: string, body: unknown = {}): Promise<T> {
  const response = await answered(
    fetch(path, {
      method: "POST",
      headers: { "content-type": "application/json", "x-runglight": "page" },
      body: JSON.stringify(body),
    }),
  );
  return response.json() as Promise<T>;
}

// `fetch` tells nothing of how far an upload is.
export function upload<T>(file: File, told: (share: number) => void): Promise<T> {
  return new Promise((resolve, reject) => {
    const request = new XMLHttpRequest();
    request.open("POST", `/api/uploads?name=${encodeURIComponent(file.name)}`);
    request.setRequestHeader("x-runglight", "page");
    request.upload.onprogress = (event) => told(event.loaded / event.total);
    request.onload = () => {
      let answer: { error?: string } = {};
      try {
        answer = JSON.parse(request.responseText);
      } catch {
        // Told by its number below.
      }
      if (request.status === 200) resolve(answer as T);
      else reject(new Refused(answer.error ?? `the server answered ${request.status}`, request.status));
    };
    request.onerror = () => reject(new Refused("the upload broke off; try it again", 0));
    request.send(file);
  });
}

export function sentence(error: unknown): string {
  return error instanceof Error ? error.message : String(error);
}
