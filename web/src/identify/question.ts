// A question that is asked again and again: only the newest answer counts.

import { post } from "../api/client";

export class Question<Answer> {
  #timer: ReturnType<typeof setTimeout> | undefined;
  #asked = 0;

  constructor(
    private readonly path: string,
    /** How long it waits for a newer one. */
    private readonly pauseMs: number,
  ) {}

  ask(body: unknown, told: (answer: Answer) => void, failed: (error: unknown) => void): void {
    this.drop();
    const number = this.#asked;
    this.#timer = setTimeout(() => {
      post<Answer>(this.path, body).then(
        (answer) => number === this.#asked && told(answer),
        (error) => number === this.#asked && failed(error),
      );
    }, this.pauseMs);
  }

  /** Nobody waits for an answer any more. */
  drop(): void {
    clearTimeout(this.#timer);
    this.#asked += 1;
  }
}
