import { get, post } from "../api/client";
import type { Session } from "../api/types";

class SessionState {
  told: Session | null = $state.raw(null);
  error = $state("");

  get readOnly(): boolean {
    return this.told?.read_only ?? false;
  }

  async look(): Promise<void> {
    try {
      this.told = await get<Session>("/api/session");
      this.error = "";
    } catch (error) {
      this.error = error instanceof Error ? error.message : String(error);
    }
  }

  async offer(token: string): Promise<void> {
    await post("/api/session", { token });
    await this.look();
  }
}

export const session = new SessionState();
