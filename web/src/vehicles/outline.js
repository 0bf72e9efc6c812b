// The outline of a car, in hundredths of its wheelbase: the rear hub at (0, 0), the front one at (100, 0), y upwards.

/** @import { Point } from "./symbols.js" */

const FINE = 10; // points of a curve

/** @param {Point} from @param {Point[]} through two points that pull, and the end @returns {Point[]} */
function curve(from, [first, second, to]) {
  return Array.from({ length: FINE }, (_, i) => {
    const t = (i + 1) / FINE;
    const s = 1 - t;
    const at = (/** @type {0 | 1} */ axis) => s ** 3 * from[axis] + 3 * s * s * t * first[axis]
      + 3 * s * t * t * second[axis] + t ** 3 * to[axis];
    return /** @type {Point} */ ([at(0), at(1)]);
  });
}

/** Points of several curves, each of which goes on from the one before. @param {Point} start @param {Point[][]} curves
 * @returns {Point[]} */
const along = (start, curves) => curves.reduce((points, each) =>
  [...points, ...(each.length === 1 ? each : curve(points[points.length - 1], each))], [start]);

/** An arch over a wheel, from the front to the rear. @param {number} hub @returns {Point[]} */
const arch = (hub) => Array.from({ length: 13 }, (_, i) => {
  const angle = (Math.PI * i) / 12;
  return /** @type {Point} */ ([hub + 20 * Math.cos(angle), 2 + 20 * Math.sin(angle)]);
});

/** @type {Point[]} */
export const CAR = [
  ...along([-32, 8], [
    [[-35, 22], [-30, 30], [-20, 32]], [[0, 36]], [[14, 52], [30, 58], [52, 58]], [[72, 58], [82, 48], [92, 36]],
    [[108, 34], [124, 30], [130, 22]], [[133, 16], [133, 8], [131, 4]],
  ]),
  ...arch(100), ...arch(0), [-30, 3],
];

/** @type {Point[][]} */
export const WINDOWS = [
  along([8, 37], [[[18, 49], [30, 53], [46, 53]], [[48, 37]]]),
  along([53, 53], [[[68, 53], [78, 46], [85, 36]], [[54, 37]]]),
];

/** Where the two sides of the body are joined. @type {Point[]} */
export const EDGES = [[0, 36], [30, 56], [52, 58], [92, 36], [130, 22]];
