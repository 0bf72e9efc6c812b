// Where all of a plot stands, in pixels, from its declaration: pure functions, without a page.

import { axisTitle, linearTicks, logTicks, roundStep, shortUnit, tickTexts } from "./ticks.js";

/** An axis: what it is, its unit, by which the numbers are divided (`size`: of the unit in which it is written), the
 * range if it is not that of the data, whether that has 0 in it, and whether it is padded.
 * @typedef {{what: string, unit: string, size?: number, log?: boolean, from?: number, to?: number, zero?: boolean,
 * padded?: boolean, ticks?: number[]}} Axis */
/** A curve: its name stands at it, unless it is `unnamed`; `colour` is a token of the style; of a `loose` one only its
 * points are drawn; a value plus a `turn` is the same one, so that a line leaves at one edge and goes on at the other.
 * @typedef {{name: string, x: number[], y: (number | null)[], colour: string, dash?: boolean, pale?: boolean,
 * turn?: number, strong?: boolean, unnamed?: boolean, loose?: boolean, stale?: boolean}} Curve */
/** A point that can be taken: of which curve, what it is called, what is read at it, and what it is.
 * @typedef {{curve: number, x: number, y: number, label: string, lines?: string[], big?: boolean, doubtful?: boolean,
 * of: any}} Point */
/** @typedef {{from: number, to: number, kind: string}} Band */
/** A plot as it is declared. `marks` are values of x with a text; `bars` stand between neighbours of `edges`; `keys`
 * name what is shaded; a `note` on the values stands below.
 * @typedef {{title: string, x: Axis, y: Axis, curves: Curve[], points?: Point[], bands?: Band[],
 * keys?: {kind: string, text: string}[], note?: (y: Scale) => string, marks?: {x: number, text: string}[],
 * bars?: {edges: number[], counts: number[]}}} Declaration */
/** A scale: `at` gives pixels, `of` the value at pixels. @typedef {{from: number, to: number, log: boolean,
 * at: (value: number) => number, of: (pixel: number) => number, ticks: {at: number, text: string}[],
 * title: string, unit: string, size: number}} Scale */
/** @typedef {{left: number, right: number, top: number, bottom: number}} Box */
/** @typedef {{name: string, x: number, y: number, anchor: string, colour: string, spot: string}} Name */
/** @typedef {{width: number, height: number, font: number, box: Box, x: Scale, y: Scale, paths: string[],
 * names: Name[], bands: {kind: string, path: string}[], keys: {kind: string, text: string, x: number, y: number}[],
 * bars: string, dots: [number, number][], heading: string[],
 * titles: {x: {x: number, y: number}, y: {x: number, y: number}}}} Layout  `dots`: points of all curves, in pixels */

const WIDE = 0.6; // a letter, by the size of its type

/** Whether a number can stand on a scale. @param {number | null | undefined} value @param {boolean} log
 * @returns {value is number} */
const isDrawn = (value, log) => typeof value === "number" && Number.isFinite(value) && (!log || value > 0);

/** The declaration at a size. `zoom` is the range of x that is looked at; `before` are the names of before, which stay
 * at their places where these are good.
 * @param {Declaration} plot @param {{width: number, height: number, font: number, zoom?: [number, number] | null,
 * before?: Name[]}} how @returns {Layout} */
export function layoutOf(plot, { width, height, font, zoom = null, before = [] }) {
  const { curves, points = [], bars, keys = [] } = plot;
  const reach = zoom ?? rangeOf([...curves.flatMap(({ x }) => x), ...points.map(({ x }) => x), ...bars?.edges ?? [],
    ...(plot.marks ?? []).map(({ x }) => x)], plot.x);
  const seen = [...curves.flatMap(({ x, y }) => y.filter((_, i) => x[i] >= reach[0] && x[i] <= reach[1])),
    ...points.map(({ y }) => y), ...bars?.counts ?? []];
  const rise = rangeOf(seen, plot.y);
  const heading = linesOf(axisTitle(plot.y.what, `m${plot.y.unit}`), Math.floor((width - font) / (font * WIDE)));
  const tops = keysAt(keys, heading[0], width, font);
  const rows = Math.max(tops.rows + 1, heading.length);
  const box = { left: 0, right: width - font, top: rows * font * 1.5 + font * 0.8, bottom: height - font * 3.1 };
  const many = Math.max(2, Math.floor((box.bottom - box.top) / (font * 2.4)));
  const wide = roundedOut(rise, plot.y, many);
  const y = scaleOf(plot.y, wide, [box.bottom, box.top], many);
  box.left = Math.ceil(font * WIDE * Math.max(2, ...y.ticks.map(({ text }) => text.length)) + font);
  const along = Math.max(2, Math.floor((box.right - box.left) / (font * 4.2)));
  const x = scaleOf(plot.x, reach, [box.left, box.right], along);
  const lines = curves.map((curve) => pixelsOf(curve, x, y));
  const dots = lines.map((line) => denseIn(line, box));
  return {
    width, height, font, box, x, y, paths: lines.map(pathOf), dots: dots.flat(),
    names: namesOf(curves, dots, points, box, { x, y, font, before }),
    bands: bandsOf(plot.bands ?? [], x, box), keys: tops.keys, bars: barsOf(bars, x, y, box),
    titles: { x: { x: box.right, y: height - font * 0.4 }, y: { x: font * 0.5, y: font * 1.2 } },
    heading: linesOf(y.title, Math.floor((width - font) / (font * WIDE))),
  };
}

/** A text in lines of at most so many letters, broken at spaces. @param {string} text @param {number} most
 * @returns {string[]} */
function linesOf(text, most) {
  if (text.length <= most) return [text];
  const space = text.lastIndexOf(" ", most);
  return space <= 0 ? [text] : [text.slice(0, space), ...linesOf(text.slice(space + 1), most)];
}

/** @param {(number | null)[]} values @param {Axis} axis @returns {[number, number]} */
function rangeOf(values, { log = false, from, to, zero = false, padded = false }) {
  const drawn = values.filter((value) => isDrawn(value, log));
  let [low, high] = log ? [1, 10] : [0, 1];
  if (drawn.length > 0) {
    low = drawn.reduce((least, value) => Math.min(least, value));
    high = drawn.reduce((most, value) => Math.max(most, value));
  }
  if (zero && !log) [low, high] = [Math.min(0, low), Math.max(0, high)];
  if (low === high) [low, high] = log ? [low / 2, high * 2] : [low - (Math.abs(low) || 1) / 2,
    high + (Math.abs(high) || 1) / 2];
  if (padded) {
    const part = log ? (high / low) ** 0.05 : 0.05 * (high - low);
    [low, high] = log ? [low / part, high * part] : [low - part, high + part];
  }
  return [from ?? low, to ?? high];
}

/** A range that ends at round numbers. @param {[number, number]} range @param {Axis} axis @param {number} many
 * @returns {[number, number]} */
function roundedOut([low, high], { log = false, from, to, padded = false, size = 1 }, many) {
  if (padded) return [low, high];
  if (log) return [from ?? roundNear(low, Math.floor), to ?? roundNear(high, Math.ceil)];
  const step = roundStep((high - low) / size, many) * size;
  return [from ?? Math.floor(low / step + 1e-9) * step, to ?? Math.ceil(high / step - 1e-9) * step];
}

const THIRDS = [1, 2, 5]; // of a power of ten, in equal steps of its logarithm, nearly

/** The 1, 2 or 5 of a power of ten below or above a number. @param {number} value
 * @param {(value: number) => number} towards */
function roundNear(value, towards) {
  const place = towards(3 * Math.log10(value) + (towards === Math.floor ? 0.1 : -0.1));
  return Number(`${THIRDS[((place % 3) + 3) % 3]}e${Math.floor(place / 3)}`);
}

/** @param {Axis} axis @param {[number, number]} range @param {[number, number]} ends in pixels @param {number} many
 * @returns {Scale} */
function scaleOf({ what, unit, size = 1, log = false, ticks }, [from, to], [begin, end], many) {
  const [low, high] = log ? [Math.log(from), Math.log(to)] : [from, to];
  const per = (end - begin) / (high - low);
  const short = size === 1 ? shortUnit(Math.max(Math.abs(from), Math.abs(to)), unit) : { unit, size };
  const shown = [from / short.size, to / short.size];
  const marks = ticks ?? (log ? logTicks(shown[0], shown[1], many) : linearTicks(shown[0], shown[1], many));
  const texts = tickTexts(marks, log);
  const at = (/** @type {number} */ value) => begin + ((log ? Math.log(value) : value) - low) * per;
  return {
    from, to, log, unit: short.unit, size: short.size, title: axisTitle(what, short.unit), at,
    of: (pixel) => (log ? Math.exp : Number)(low + (pixel - begin) / per),
    ticks: marks.map((mark, i) => ({ at: at(mark * short.size), text: texts[i] })),
  };
}

/** The points of a curve in pixels; null where it is broken. @param {Curve} curve @param {Scale} x @param {Scale} y
 * @returns {([number, number] | null)[]} */
const pixelsOf = (curve, x, y) => curve.x.flatMap((at, i) => {
  const value = curve.y[i];
  if (!isDrawn(value, y.log) || !isDrawn(at, x.log)) return [null];
  const [before, last] = [curve.x[i - 1], curve.y[i - 1]];
  /** @type {[number, number]} */
  const here = [x.at(at), y.at(value)];
  if (!curve.turn || typeof last !== "number" || Math.abs(value - last) <= curve.turn / 2) return [here];
  const edge = (last > value ? 1 : -1) * (curve.turn / 2);
  const cut = x.at(before) + ((edge - last) / (value + 2 * edge - last)) * (here[0] - x.at(before));
  return [[cut, y.at(edge)], null, [cut, y.at(-edge)], here];
});

/** @param {([number, number] | null)[]} pixels */
function pathOf(pixels) {
  let path = "";
  let broken = true;
  for (const pixel of pixels) {
    if (pixel !== null) path += `${broken ? "M" : "L"}${tenths(pixel[0])} ${tenths(pixel[1])}`;
    broken = pixel === null;
  }
  return path;
}

/** @param {number} number */
const tenths = (number) => Math.round(10 * number) / 10;

/** Shaded intervals, all of a kind as one path; none is narrower than a pixel. @param {Band[]} bands @param {Scale} x
 * @param {Box} box */
function bandsOf(bands, x, { left, right, top, bottom }) {
  /** @type {{[kind: string]: string}} */
  const paths = {};
  for (const { from, to, kind } of bands) {
    const [begin, end] = [Math.max(left, x.at(from)), Math.min(right, x.at(to))];
    if (end < left || begin > right || end < begin) continue;
    paths[kind] = `${paths[kind] ?? ""}M${tenths(begin)} ${top}H${tenths(Math.max(end, begin + 1))}V${bottom}H${
      tenths(begin)}Z`;
  }
  return Object.entries(paths).map(([kind, path]) => ({ kind, path }));
}

/** @param {{edges: number[], counts: number[]} | undefined} bars @param {Scale} x @param {Scale} y @param {Box} box */
const barsOf = (bars, x, y, { bottom }) => (bars?.counts ?? []).map((count, i) => {
  const [begin, end] = [0, 1].map((next) => x.at(/** @type {any} */ (bars).edges[i + next]));
  return count > 0 ? `M${tenths(begin)} ${bottom}V${tenths(y.at(count))}H${tenths(end)}V${bottom}Z` : "";
}).join("");

/** The names of what is shaded stand to the right, beside the title of the axis or below it.
 * @param {{kind: string, text: string}[]} keys @param {string} title @param {number} width @param {number} font */
function keysAt(keys, title, width, font) {
  const letter = font * WIDE;
  let right = width - font;
  let row = 0;
  const placed = keys.toReversed().map(({ kind, text }) => {
    const wide = text.length * letter + 2 * font;
    if (right - wide < (row === 0 ? title.length * letter + font : 0)) [right, row] = [width - font, row + 1];
    right -= wide + font;
    return { kind, text, x: right + font, y: font * (1.2 + 1.5 * row) };
  });
  return { keys: placed, rows: row };
}

const CAPITAL = /\p{Lu}/u; // is wider
const CANDIDATES = 16; // places of a name along its curve
const SAMPLES = 110; // of a curve, where names look for room
const STAYS = 6; // by how much a better place must be better

/** Names at their curves: at the end where there is room, else above or below where nothing else is near.
 * @param {Curve[]} curves @param {[number, number][][]} dots @param {Point[]} points @param {Box} box
 * @param {{x: Scale, y: Scale, font: number, before: Name[]}} how @returns {Name[]} */
function namesOf(curves, dots, points, box, { x, y, font, before }) {
  const rings = points.map((point) => /** @type {[number, number]} */ ([x.at(point.x), y.at(point.y)]));
  /** @type {(Name & {box: Box})[]} */
  const placed = [];
  curves.forEach(({ name, colour, unnamed, pale }, number) => {
    if (unnamed || dots[number].length === 0) return;
    const wide = font * [...name].reduce((sum, letter) => sum + (CAPITAL.test(letter) ? 0.85 : 0.65), 0);
    const last = before.find((each) => each.name === name);
    const best = spotsOf(dots[number], wide, font, box).map((spot) => {
      const { box: own } = spot;
      let cost = spot.spot === last?.spot ? -STAYS : 0;
      for (const other of placed) if (overlap(own, other.box)) cost += 60;
      dots.forEach((others, i) => {
        const near = nearestIn(others, own);
        cost += i === number ? (near < 1 ? 25 : 0) : near < 1 ? 30 : Math.max(0, 14 - near);
      });
      for (const ring of rings) if (distance(ring, own) < 4) cost += 15;
      return { ...spot, cost: cost + spot.far };
    }).toSorted((one, other) => one.cost - other.cost)[0];
    if (best === undefined) return;
    placed.push({ name, colour: pale ? "pale" : colour, x: best.x, y: best.y, anchor: best.anchor, spot: best.spot,
      box: best.box });
  });
  return placed.map(({ box: _, ...name }) => name);
}

/** Points of a line within the box, about as far from each other in pixels. @param {([number, number] | null)[]} line
 * @param {Box} box @returns {[number, number][]} */
function denseIn(line, { left, right, top, bottom }) {
  /** @type {[number, number][]} */
  const inside = [];
  const step = Math.max(3, (right - left) / SAMPLES);
  /** @type {[number, number] | null} */
  let last = null;
  for (const pixel of line) {
    if (pixel === null || pixel[0] < left - 1 || pixel[0] > right + 1) {
      last = null;
      continue;
    }
    const far = last === null ? 0 : Math.hypot(pixel[0] - last[0], pixel[1] - last[1]);
    const parts = Math.min(50, Math.max(1, Math.ceil(far / step)));
    if (last !== null && Math.abs(pixel[0] - last[0]) < step / 2 && Math.abs(pixel[1] - last[1]) < step / 2) continue;
    for (let i = 1; i <= parts; i += 1) {
      const share = i / parts;
      const [x, y] = last === null ? pixel : [last[0] + share * (pixel[0] - last[0]),
        last[1] + share * (pixel[1] - last[1])];
      if (y >= top - 1 && y <= bottom + 1) inside.push([x, y]);
    }
    last = pixel;
  }
  return inside;
}

/** The places where a name can stand. @param {[number, number][]} dots @param {number} wide @param {number} font
 * @param {Box} box */
function spotsOf(dots, wide, font, box) {
  const [first, last] = [dots[0], dots[dots.length - 1]];
  const spots = [
    { spot: "end", x: last[0] + font, y: last[1] + font * 0.35, anchor: "start", far: 0 },
    { spot: "begin", x: first[0] - font, y: first[1] + font * 0.35, anchor: "end", far: 4 },
  ];
  for (let i = 0; i < CANDIDATES; i += 1) {
    const [x, y] = dots[Math.round(((i + 0.5) / CANDIDATES) * (dots.length - 1))];
    const far = 3 + Math.abs(i / CANDIDATES - 0.5) * 4;
    spots.push({ spot: `${i} above`, x, y: y - font * 0.55, anchor: "middle", far });
    spots.push({ spot: `${i} below`, x, y: y + font * 1.25, anchor: "middle", far });
    spots.push({ spot: `${i} right`, x: x + font * 0.8, y: y + font * 0.35, anchor: "start", far: far + 1 });
    spots.push({ spot: `${i} left`, x: x - font * 0.8, y: y + font * 0.35, anchor: "end", far: far + 1 });
  }
  return spots.map((spot) => {
    const left = spot.x - wide * (spot.anchor === "middle" ? 0.5 : spot.anchor === "end" ? 1 : 0);
    return { ...spot, box: { left, right: left + wide, top: spot.y - font * 0.8, bottom: spot.y + font * 0.2 } };
  }).filter(({ box: own }) => own.left >= box.left + 2 && own.right <= box.right + font && own.top >= box.top - font / 2
    && own.bottom <= box.bottom - 1);
}

/** @param {Box} one @param {Box} other */
const overlap = (one, other) => one.left < other.right + 4 && other.left < one.right + 4 && one.top < other.bottom
  && other.top < one.bottom;

/** How far the nearest of some points is from a box. @param {[number, number][]} dots @param {Box} box */
function nearestIn(dots, { left, right, top, bottom }) {
  let least = Infinity;
  for (const [x, y] of dots) {
    const across = x < left ? left - x : x > right ? x - right : 0;
    const up = y < top ? top - y : y > bottom ? y - bottom : 0;
    const square = across * across + up * up;
    if (square < least) least = square;
  }
  return Math.sqrt(least);
}

/** How far a point is from a box. @param {[number, number]} point @param {Box} box */
const distance = ([x, y], { left, right, top, bottom }) =>
  Math.hypot(Math.max(left - x, 0, x - right), Math.max(top - y, 0, y - bottom));

/** The value of a curve at a place, between its neighbours; null where there is none. @param {Curve} curve
 * @param {number} at */
export function valueAt({ x, y }, at) {
  if (!(at >= x[0] && at <= x[x.length - 1])) return null;
  const i = indexAt(x, at);
  const [before, after] = [y[i], y[Math.min(i + 1, y.length - 1)]];
  if (x[i] === at || before === null || after === null) return x[i] === at ? before : null;
  return before + ((after - before) * (at - x[i])) / (x[i + 1] - x[i]);
}

/** The last place of a rising list that is not above a value. @param {number[]} x @param {number} at */
export function indexAt(x, at) {
  let [low, high] = [0, x.length - 1];
  while (low < high) {
    const middle = (low + high + 1) >> 1;
    if (x[middle] <= at) low = middle;
    else high = middle - 1;
  }
  return low;
}

/** The sample of a rising list that is nearest to a value. @param {number[]} x @param {number} at */
export function nearest(x, at) {
  const i = indexAt(x, at);
  return i + 1 < x.length && Math.abs(x[i + 1] - at) < Math.abs(at - x[i]) ? i + 1 : i;
}
