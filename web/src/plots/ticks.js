// Round marks of axes, their texts, and units with a prefix where numbers would be long.

import { capital, printed, superscript, withUnit } from "../state/scale.js";

const ROUND = [1, 2, 5, 10];

/** The smallest round step by which an interval has at most so many parts. @param {number} span @param {number} most */
export function roundStep(span, most) {
  const rough = span / Math.max(1, most);
  const power = 10 ** Math.floor(Math.log10(rough));
  return power * /** @type {number} */ (ROUND.find((each) => each * power >= rough * (1 - 1e-9)) ?? 10);
}

/** Round marks from one end to the other. @param {number} from @param {number} to @param {number} most */
export function linearTicks(from, to, most) {
  const step = roundStep(to - from, most);
  const [first, last] = [Math.ceil(from / step - 1e-6), Math.floor(to / step + 1e-6)];
  const digits = Math.max(0, -Math.floor(Math.log10(step) + 1e-9));
  return Array.from({ length: Math.max(0, last - first + 1) }, (_, i) =>
    Number(((first + i) * step).toFixed(Math.min(100, digits))));
}

/** Marks at 1, 2 and 5 of each power of ten, or at fewer of them where there are many; round ones where a scale has
 * less than two of these. @param {number} from @param {number} to @param {number} most */
export function logTicks(from, to, most) {
  const [low, high] = [Math.floor(Math.log10(from)), Math.ceil(Math.log10(to))];
  const marks = (/** @type {number[]} */ digits, every = 1) => Array.from({ length: high - low + 1 }, (_, i) => low + i)
    .filter((power) => power % every === 0).flatMap((power) => digits.map((digit) => Number(`${digit}e${power}`)))
    .filter((mark) => mark >= from * (1 - 1e-9) && mark <= to * (1 + 1e-9));
  for (const digits of [[1, 2, 5], [1, 3]]) {
    const found = marks(digits);
    if (found.length <= most && found.length >= 2) return found;
  }
  for (let every = 1; every < 100; every += 1) {
    const found = marks([1], every);
    if (found.length <= most) return found.length >= 2 ? found : linearTicks(from, to, most).filter((each) => each > 0);
  }
  return [];
}

/** What stands at marks: of a linear axis all with the same places. @param {number[]} ticks @param {boolean} log */
export function tickTexts(ticks, log) {
  const most = Math.max(...ticks.map(Math.abs), 0);
  const powers = log && (most >= 1e5 || Math.min(...ticks) < 1e-3);
  const step = ticks.length > 1 ? Math.min(...ticks.slice(1).map((each, i) => each - ticks[i])) : most || 1;
  const places = Math.min(20, Math.max(0, -Math.floor(Math.log10(step) + 1e-6)));
  return ticks.map((tick) => (powers ? power(tick) : log ? String(tick) : tick.toFixed(places)).replace("-", "−"));
}

/** @param {number} tick */
function power(tick) {
  const [mantissa, exponent] = tick.toExponential().split("e");
  const ten = `10${superscript(String(Number(exponent)))}`;
  return mantissa === "1" ? ten : `${mantissa}·${ten}`;
}

/** @type {{[power: number]: string}} */
const PREFIXES = { [-9]: "n", [-6]: "µ", [-3]: "m", 3: "k", 6: "M", 9: "G" };
const PREFIXED = /^(m|N|W|J|Pa)(?=$|[ /])/; // what a unit begins with before which a prefix can stand

/** The unit, with a prefix or a power of ten, in which numbers up to the largest are short, and its size.
 * @param {number} largest @param {string} unit @returns {{unit: string, size: number}} */
export function shortUnit(largest, unit) {
  if (!(largest > 0) || (largest >= 0.1 && largest < 1e4)) return { unit, size: 1 };
  const exponent = 3 * Math.floor(Math.log10(largest) / 3 + 1e-9);
  const prefix = PREFIXES[exponent];
  if (prefix && PREFIXED.test(unit)) return { unit: prefix + unit, size: 10 ** exponent };
  return { unit: `10${superscript(String(exponent))} ${printed(unit)}`.trim(), size: 10 ** exponent };
}

/** The title of an axis: what it is, and the unit in brackets. @param {string} what @param {string} unit */
export function axisTitle(what, unit) {
  return withUnit(/^[a-z]{2}/.test(what) ? capital(what) : what, unit).replaceAll(" x ", " × ");
}
