// @ts-check
/**
 * Where a point that is dragged comes to rest.
 *
 * @module snaps
 */

const FARTHEST = 6; // mm from what it snaps to, however small the drawing is
const NEAR = 5; // px from it

/**
 * A coordinate that a point has come to, and of what.
 * @typedef {{axis: number, words: string}} Snap
 */

/**
 * Where a point comes to rest, in whole millimetres or at what it is near to.
 * @param {(number | null)[]} wanted in mm; null along the line of sight
 * @param {object} about
 * @param {number[]} about.from where the drag began
 * @param {number[]} about.own where the point is
 * @param {{at: number[], words: string}[]} about.others what it may come to
 * @param {number[]} about.scale px of 1 mm along each axis
 * @param {boolean} about.isFree whether it moves by tenths and comes to nothing
 * @param {boolean} about.isStraight whether only the coordinate changes that was moved more
 * @returns {{to: (number | null)[], snaps: Snap[]}} where null stays, and what it has come to
 */
export function snapped(wanted, { from, own, others, scale, isFree, isStraight }) {
  const moved = wanted.map((x, axis) => (x === null ? 0 : Math.abs(x - from[axis]) * scale[axis]));
  const most = moved.indexOf(Math.max(...moved));
  /** @type {Snap[]} */
  const snaps = [];
  const to = wanted.map((x, axis) => {
    if (x === null) return null;
    if (isStraight && axis !== most) return from[axis];
    if (isFree) return Math.round(10 * x) / 10;
    const reach = Math.min(NEAR / scale[axis], FARTHEST);
    const far = (/** @type {{at: number[]}} */ other) => Math.abs(other.at[axis] - x);
    const [nearest] = [...others].sort((a, b) => far(a) - far(b));
    if (nearest && far(nearest) <= reach) {
      if (nearest.at[axis] !== from[axis]) snaps.push({ axis, words: nearest.words });
      return nearest.at[axis];
    }
    // A coordinate that the pointer has not left keeps its tenths.
    return Math.abs(x - own[axis]) < 0.5 ? null : Math.round(x);
  });
  return { to, snaps };
}
