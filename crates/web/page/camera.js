// A camera that turns about a point: vectors are arrays of three numbers.

const add = (a, b, factor = 1) => a.map((value, axis) => value + factor * b[axis]);
const dot = (a, b) => a.reduce((sum, value, axis) => sum + value * b[axis], 0);
const cross = ([a, b, c], [x, y, z]) => [b * z - c * y, c * x - a * z, a * y - b * x];
const unit = (a) => a.map((value) => value / Math.hypot(...a));

/** Turns a vector about a unit axis (Rodrigues 1840). */
function turned(vector, axis, angle) {
  const along = dot(axis, vector) * (1 - Math.cos(angle));
  const side = cross(axis, vector);
  return vector.map((value, at) => value * Math.cos(angle) + side[at] * Math.sin(angle) + axis[at] * along);
}

const steepest = 89 * Math.PI / 180;

/** Turns eye and direction about the centre: by `yaw` about the view's up, by `pitch` (radians) about its right. */
export function orbit(view, centre, yaw, pitch) {
  const up = unit(view.up);
  const round = (vector) => turned(vector, up, yaw);
  let direction = round(unit(view.direction)), offset = round(add(view.eye, centre, -1));
  const height = Math.asin(Math.max(-1, Math.min(1, dot(direction, up))));
  // A view that is steeper from the start may stay so.
  const most = Math.max(steepest, Math.abs(height));
  const climb = Math.max(-most, Math.min(most, height + pitch)) - height;
  const right = cross(direction, up);
  if (Math.hypot(...right) > 1e-6) {
    direction = turned(direction, unit(right), climb);
    offset = turned(offset, unit(right), climb);
  }
  return { ...view, eye: add(centre, offset), direction };
}

/** Moves the eye along its direction, by a share of its distance to the centre: positive is nearer. */
export function dolly(view, centre, radius, share) {
  const distance = Math.max(Math.hypot(...add(view.eye, centre, -1)), 0.1 * radius);
  const eye = add(view.eye, unit(view.direction), distance * share);
  const isTooFar = share < 0 && Math.hypot(...add(eye, centre, -1)) > 8 * radius;
  return isTooFar ? view : { ...view, eye };
}

/** Six numbers of a link: eye and direction. */
export const cameraText = ({ eye, direction }) => [...eye, ...direction].map((value) => String(+value.toPrecision(7))).join(',');

/** Eye and direction of a link's text; null where it is broken. */
export function cameraOf(text) {
  const numbers = text.split(',').map(Number);
  const isWhole = numbers.length === 6 && numbers.every(Number.isFinite) && Math.hypot(...numbers.slice(3)) > 0;
  return isWhole ? { eye: numbers.slice(0, 3), direction: numbers.slice(3) } : null;
}
