// What there is at one time of a motion: pose, travels inside struts, states of friction and gaps, the road.

/** @import { Layout, Motion } from "./layout.js" */
/** @import { Pose } from "./scene.js" */

/** What is at one time: heights and angles, travels of elements [m], states of friction and gaps, how far wheels have
 * turned [rad], which element is selected, the height of a road so many px before the wheel that it is under [m], and
 * over how many px a road has been seen since the motion began.
 * @typedef {{pose: Pose, travels: {[mount: string]: {[element: string]: number}},
 * states: {[mount: string]: {[element: string]: string}}, turned: number,
 * road: (name: string, px: number) => number, passed: number, chosen?: string | null}} Moment */

/** Of a vehicle that stands still. @type {Moment} */
export const REST = { pose: {}, travels: {}, states: {}, turned: 0, road: () => 0, passed: Infinity };

const ROLLED = 9; // [rad/s] of a wheel, so that its spokes are seen to turn
const COLUMN = 200; // [px/s] of a road under one wheel

/** How fast a road passes [px/s]. @param {Layout} made @param {number} speed [m/s] */
export const passing = (made, speed) => (made.scene.column || !(speed > 0) ? COLUMN
  : speed * (made.project(1, 0, 0)[0] - made.project(0, 0, 0)[0]));

/** What is at one time of a motion. @param {Layout} made @param {Motion} motion @param {number} at [s]
 * @param {{speed: number, shaded?: {element: string, state: string, intervals: [number, number][]}[]}} how
 * @returns {Moment} */
export function momentOf(made, motion, at, { speed, shaded = [] }) {
  const { time } = motion;
  const step = time.length > 1 ? time[1] - time[0] : 1;
  const now = Math.max(0, Math.min(time.length - 1, at / step));
  /** @param {{[name: string]: number[]}} several */
  const each = (several) => Object.fromEntries(Object.entries(several).map(([name, values]) => [name,
    between(values, now)]));
  const travels = Object.fromEntries(Object.entries(motion.elements ?? {}).map(([mount, of]) => [mount, each(of)]));
  const states = shaded.filter(({ intervals }) => isWithin(intervals, at));
  const perSample = step * passing(made, speed);
  return {
    pose: each({ ...motion.coordinates, ...motion.roads }),
    travels,
    states: Object.fromEntries(Object.entries(travels).map(([mount, of]) => [mount, Object.fromEntries(
      Object.keys(of).flatMap((key) => {
        const found = states.find(({ element }) => element === `${mount}.${key}`)
          ?? states.find(({ element }) => element === key);
        return found ? [[key, found.state]] : [];
      }),
    )])),
    turned: ROLLED * at,
    road: (name, px) => smooth(motion.roads[name] ?? [0], now + px / perSample),
    passed: now * perSample,
  };
}

/** @param {number[]} values @param {number} at in samples */
function between(values, at) {
  const i = Math.min(Math.floor(at), values.length - 1);
  return values[i] + (at - i) * ((values[i + 1] ?? values[i]) - values[i]);
}

/** The same without corners. @param {number[]} values @param {number} at in samples */
function smooth(values, at) {
  const last = values.length - 1;
  const now = Math.max(0, Math.min(last, at));
  const i = Math.min(Math.floor(now), Math.max(0, last - 1));
  const t = now - i;
  const [a, b, c, d] = [i - 1, i, i + 1, i + 2].map((j) => values[Math.max(0, Math.min(last, j))]);
  return b + 0.5 * t * (c - a + t * (2 * a - 5 * b + 4 * c - d + t * (3 * (b - c) + d - a)));
}

/** Whether a time is in one of the intervals, which are in order. @param {[number, number][]} intervals
 * @param {number} at */
function isWithin(intervals, at) {
  let [low, high] = [0, intervals.length];
  while (low < high) {
    const middle = (low + high) >> 1;
    if (intervals[middle][0] <= at) low = middle + 1;
    else high = middle;
  }
  return low > 0 && at < intervals[low - 1][1];
}

/** How high a coordinate was, so many px ago; nan before the beginning. @param {Layout} made @param {Motion} motion
 * @param {number} at [s] @param {number} speed [m/s] @returns {Moment["road"]} */
export const pastOf = (made, motion, at, speed) => (name, px) => {
  const time = at + px / passing(made, speed);
  const step = motion.time.length > 1 ? motion.time[1] - motion.time[0] : 1;
  return time < 0 ? NaN : smooth(motion.coordinates[name] ?? [0], time / step);
};
