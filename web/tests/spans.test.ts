import { expect, it } from "vitest";
import { rises, spanAt, unpack, valueAt } from "../src/timing/spans";
import { lane } from "./lanes";

function packed(version = 1): ArrayBuffer {
  const bytes = new ArrayBuffer(16 + 3 * 8 + 3 * 8 + 3 * 4 + 2 * 4 + 3);
  new Uint32Array(bytes, 0, 4).set([version, 2, 3, 0]);
  new Float64Array(bytes, 16, 3).set([0, 10, 5]);
  new Float64Array(bytes, 40, 3).set([0, 1, 42]);
  new Uint32Array(bytes, 64, 3).set([0, 7, 0]);
  new Uint32Array(bytes, 76, 2).set([2, 1]);
  new Uint8Array(bytes, 84, 3).set([0, 1, 1]);
  return bytes;
}

it("unpacks what the server packed", () => {
  const [first, second] = unpack(packed());
  expect([...first!.start]).toEqual([0, 10]);
  expect([...first!.changes]).toEqual([0, 7]);
  expect([...first!.known]).toEqual([0, 1]);
  expect([...second!.value]).toEqual([42]);
});

it("says so where the server is another version", () => {
  expect(() => unpack(packed(2))).toThrow("load it again");
});

it("finds spans and values", () => {
  const spans = lane([0, 0], [10, 1, 3], [20, 5]);
  expect([-1, 0, 9, 10, 25].map((time) => spanAt(spans, time))).toEqual([-1, 0, 0, 1, 2]);
  expect([-1, 5, 15, 99].map((time) => valueAt(spans, time))).toEqual([null, 0, "busy", 5]);
  expect(valueAt(undefined, 1)).toBeNull();
});

it("finds rises, and none that nobody saw", () => {
  expect(rises(lane([0, 0], [10, 1], [20, 0], [30, 1]))).toEqual([10, 30]);
  expect(rises(lane([0, 1], [10, 1, 9], [20, 0], [30, 1]))).toEqual([30]);
});
