import { describe, expect, it } from "vitest";
import * as declared from "../src/identify/declared";
import { nearestPhoto, photoAddress, stepped } from "../src/identify/photos";
import { between, keyed, middle } from "../src/identify/rectangle";
import { stopOf, TAUS_S } from "../src/identify/tau";

const MS = 1e6;
const event = (seconds: number, label = "") => ({ at: seconds * 1e9, label });

describe("declared events", () => {
  it("stay in time order, and one moment has one event", () => {
    const some = declared.withEvents([event(3)], [event(1), event(3.0005), event(5)]);
    expect(some.map((each) => each.at / 1e9)).toEqual([1, 3, 5]);
    expect(declared.withEvents([], [event(1), event(1)])).toHaveLength(1);
  });

  it("are taken away within the millisecond that a file keeps", () => {
    expect(declared.without([event(1), event(2)], 1e9 + 0.4 * MS)).toEqual([event(2)]);
  });

  it("are visited one after the other", () => {
    const some = [event(1), event(2), event(3)];
    expect(declared.neighbour(some, 2e9, 1)).toEqual(event(3));
    expect(declared.neighbour(some, 2e9, -1)).toEqual(event(1));
    expect(declared.neighbour(some, 3e9, 1)).toBeUndefined();
  });

  it("are undone and done again; what is new ends what was undone", () => {
    let history = declared.did(declared.did(declared.begun([]), [event(1)]), [event(1), event(2)]);
    history = declared.undone(history);
    expect(history.now).toEqual([event(1)]);
    expect(declared.redone(history).now).toHaveLength(2);
    history = declared.did(history, [event(9)]);
    expect(declared.redone(history)).toBe(history);
    expect(declared.undone(declared.begun([]))).toEqual(declared.begun([]));
  });

  it("are labelled", () => {
    const some = declared.relabelled([event(1), event(2)], 2e9, "stops");
    expect(declared.labelsOf(some)).toEqual(["", "stops"]);
  });
});

describe("photos", () => {
  const photos = [0, 10, 20, 30];

  it("are found by time", () => {
    expect([-5, 4, 6, 14, 99].map((at) => nearestPhoto(photos, at))).toEqual([0, 0, 1, 1, 3]);
    expect(nearestPhoto([], 3)).toBe(-1);
  });

  it("are stepped through to the ends and no further", () => {
    expect(stepped("ArrowRight", false, 3, 4)).toBe(3);
    expect(stepped("ArrowLeft", true, 25, 40)).toBe(15);
    expect(stepped("End", false, 0, 40)).toBe(39);
    expect(stepped("x", false, 0, 40)).toBeNull();
  });

  it("are asked for by their exact time", () => {
    expect(photoAddress("a/b", 1_767_592_860_085_430_561n, 2)).toBe(
      "/api/identify/a%2Fb/photos/1767592860085430563",
    );
  });
});

describe("a rectangle", () => {
  const photo = { width: 640, height: 360 };

  it("is drawn in any direction and stays in the photo", () => {
    expect(between({ x: 100.4, y: 90 }, { x: -20, y: 400 }, photo)).toEqual({
      x: 0,
      y: 90,
      width: 120,
      height: 270,
    });
  });

  it("is moved and sized by keys, and never leaves the photo", () => {
    let rectangle = middle(photo);
    for (let times = 0; times < 200; times += 1) rectangle = keyed(rectangle, "ArrowRight", false, 6, photo)!;
    expect(rectangle.x + rectangle.width).toBe(640);
    for (let times = 0; times < 200; times += 1) rectangle = keyed(rectangle, "ArrowUp", true, 6, photo)!;
    expect(rectangle.height).toBe(4);
    expect(keyed(rectangle, "Enter", false, 6, photo)).toBeNull();
  });
});

it("the slider stands at the stop nearest to a τ", () => {
  expect(TAUS_S[stopOf(4)]).toBe(4);
  expect(TAUS_S[stopOf(0)]).toBe(0.1);
  expect(TAUS_S[stopOf(1000)]).toBe(30);
});
