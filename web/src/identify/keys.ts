export const KEYS: [string, string][] = [
  ["← →", "photo before, next; with Shift ten"],
  ["Home End", "first photo, last"],
  [", .", "photo before, next, also in the diagram"],
  ["e Space", "an event here; again: none"],
  ["[ ]", "event before, next"],
  ["Del", "take the event here away"],
  ["u U", "undo, redo"],
  ["l", "label of new events"],
  ["r", "a rectangle: arrows move it, Shift sizes it"],
  ["Enter", "in the rectangle: propose events"],
  ["s", "save the events"],
];
