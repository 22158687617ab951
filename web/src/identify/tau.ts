// The stops of the slider: those that the server's sweep tries too.

export const TAUS_S = [0.1, 0.2, 0.3, 0.5, 0.7, 1, 1.5, 2, 3, 4, 5, 7, 10, 15, 20, 30];

/** The stop nearest to a τ, as a ratio. */
export function stopOf(tau: number): number {
  const off = TAUS_S.map((each) => Math.abs(Math.log(each / Math.max(tau, 1e-9))));
  return off.indexOf(Math.min(...off));
}
