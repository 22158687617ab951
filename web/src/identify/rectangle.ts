// A rectangle of the photos, in their pixels.

export interface Rectangle {
  x: number;
  y: number;
  width: number;
  height: number;
}

export interface Size {
  width: number;
  height: number;
}

export const LEAST_PX = 4;

/** The rectangle between two corners, within the photo. */
export function between(one: { x: number; y: number }, other: { x: number; y: number }, photo: Size): Rectangle {
  return within(
    {
      x: Math.min(one.x, other.x),
      y: Math.min(one.y, other.y),
      width: Math.abs(one.x - other.x),
      height: Math.abs(one.y - other.y),
    },
    photo,
  );
}

export function middle(photo: Size): Rectangle {
  const { width, height } = photo;
  return within({ x: width * 0.4, y: height * 0.4, width: width * 0.2, height: height * 0.2 }, photo);
}

/** Moved, or with Shift made larger or smaller, by an arrow key; null for other keys. */
export function keyed(rectangle: Rectangle, key: string, shift: boolean, step: number, photo: Size): Rectangle | null {
  const direction = { ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, -1], ArrowDown: [0, 1] }[key];
  if (!direction) return null;
  const [right = 0, down = 0] = direction.map((each) => each * step);
  const { x, y, width, height } = rectangle;
  if (!shift) {
    return within(
      {
        x: Math.min(x + right, photo.width - width),
        y: Math.min(y + down, photo.height - height),
        width,
        height,
      },
      photo,
    );
  }
  return within({ x, y, width: width + right, height: height + down }, photo);
}

function within(rectangle: Rectangle, photo: Size): Rectangle {
  const x = Math.round(Math.max(0, Math.min(rectangle.x, photo.width - LEAST_PX)));
  const y = Math.round(Math.max(0, Math.min(rectangle.y, photo.height - LEAST_PX)));
  const width = Math.round(Math.max(LEAST_PX, Math.min(rectangle.width, photo.width - x)));
  const height = Math.round(Math.max(LEAST_PX, Math.min(rectangle.height, photo.height - y)));
  return { x, y, width, height };
}
