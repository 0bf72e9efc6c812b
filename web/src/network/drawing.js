// Where everything in the drawing of a network is: the upper end at the top, parallel parts side by side between bars,
// series parts in a column, and the arms of a bridge in three columns, as in the figures of reports. Lengths in points,
// y downwards.

/** @import { Tree, Path } from "./algebra.js" */
/** @typedef {[number, number]} Point */
/** @typedef {{name: string, path: Path, x: number, y: number}} Placed  an element with the middle of its symbol */
/** @typedef {{path: Path, left: number, right: number, top: number, bottom: number}} Box  what a part covers */
/** @typedef {{left: number, right: number, height: number}} Size */
/** @typedef {Size & {placed: Placed[], boxes: Box[], lines: Point[][]}} Drawing */

export const HALF_WIDTH = 8;
export const HALF_HEIGHT = 20;
const TO_LABEL = 4;
const LETTER = 5.2;
const STUB = 7;
const OVERHANG = 4;
const BETWEEN = 12;
const LONGEST_LABEL = 12;

/** A name as short as a drawing shows it. @param {string} name */
export const shortLabel = (name) => (name.length > LONGEST_LABEL ? `${name.slice(0, LONGEST_LABEL - 1)}…` : name);

/** The drawing of a tree with its upper end at (0, 0), with so much room beside each symbol at the least.
 * @param {Tree} tree @param {Path} path @param {number} least @returns {Drawing} */
export function drawing(tree, path = [], least = 0) {
  if (tree.kind === "element") return symbol(tree.name, path, least);
  const parts = tree.parts.map((part, i) => drawing(part, [...path, i], least));
  const whole = { parallel: sideBySide, series: inAColumn, bridge: inABridge }[tree.kind](parts);
  const box = { path, left: -whole.left, right: whole.right, top: 0, bottom: whole.height };
  return { ...whole, boxes: [box, ...whole.boxes] };
}

/** @param {string} name @param {Path} path @param {number} least @returns {Drawing} */
function symbol(name, path, least) {
  const right = HALF_WIDTH + TO_LABEL + Math.max(least, LETTER * shortLabel(name).length);
  const box = { path, left: -HALF_WIDTH, right, top: 0, bottom: 2 * HALF_HEIGHT };
  const placed = [{ name, path, x: 0, y: HALF_HEIGHT }];
  return { left: HALF_WIDTH, right, height: 2 * HALF_HEIGHT, placed, boxes: [box], lines: [] };
}

/** @param {Drawing[]} parts @returns {Drawing} */
function sideBySide(parts) {
  const xs = [0];
  for (let i = 1; i < parts.length; i += 1) xs.push(xs[i - 1] + parts[i - 1].right + BETWEEN + parts[i].left);
  const n = xs.length;
  const middle = (xs[Math.floor((n - 1) / 2)] + xs[Math.floor(n / 2)]) / 2;
  const at = xs.map((x) => x - middle);
  const inside = Math.max(...parts.map((part) => part.height));
  const lines = bars(at, inside);
  const places = parts.map((part, i) => between(part, at[i], 0, inside, lines));
  const size = { left: parts[0].left - at[0], right: parts[n - 1].right + at[n - 1], height: inside + 2 * STUB };
  return together(parts, places, size, lines);
}

/** Arms a above b, e, and c above d; e runs down from the left to the right node.
 * @param {Drawing[]} arms @returns {Drawing} */
function inABridge(arms) {
  const [a, b, c, d, e] = arms;
  const [before, after] = [inAColumn([a, b]), inAColumn([c, d])];
  const at = [-(before.right + BETWEEN + e.left), 0, e.right + BETWEEN + after.left];
  const left = Math.max(a.height, c.height - e.height); // depths of the nodes below the upper bar
  const right = Math.max(left + e.height, c.height);
  const inside = Math.max(left + b.height, right + d.height);
  const lines = bars(at, inside);
  lines.push([[at[0], STUB + left], [0, STUB + left]], [[0, STUB + right], [at[2], STUB + right]]);
  const places = [
    between(a, at[0], 0, left, lines),
    between(b, at[0], left, inside, lines),
    between(c, at[2], 0, right, lines),
    between(d, at[2], right, inside, lines),
    between(e, at[1], left, right, lines),
  ];
  const size = { left: before.left - at[0], right: after.right + at[2], height: inside + 2 * STUB };
  return together(arms, places, size, lines);
}

/** Bars over and under columns, with the leads to the ends of the whole. @param {number[]} at @param {number} inside
 * @returns {Point[][]} */
function bars(at, inside) {
  const [top, bottom] = [STUB, STUB + inside];
  const [first, last] = [at[0] - OVERHANG, at[at.length - 1] + OVERHANG];
  return [
    [[0, 0], [0, top]],
    [[0, bottom], [0, bottom + STUB]],
    ...[top, bottom].map((y) => /** @type {Point[]} */ ([[first, y], [last, y]])),
  ];
}

/** Upper end of a part in the middle between two depths below the upper bar, with its leads added to `lines`.
 * @param {Drawing} part @param {number} x @param {number} upper @param {number} lower @param {Point[][]} lines
 * @returns {Point} */
function between(part, x, upper, lower, lines) {
  const lead = (lower - upper - part.height) / 2;
  const [top, bottom] = [STUB + upper, STUB + lower];
  if (lead > 0) lines.push([[x, top], [x, top + lead]], [[x, bottom - lead], [x, bottom]]);
  return [x, top + lead];
}

/** @param {Drawing[]} parts @returns {Drawing} */
function inAColumn(parts) {
  let y = 0;
  const places = parts.map((part) => {
    const place = /** @type {Point} */ ([0, y]);
    y += part.height;
    return place;
  });
  const size = {
    left: Math.max(...parts.map((part) => part.left)),
    right: Math.max(...parts.map((part) => part.right)),
    height: y,
  };
  return together(parts, places, size, []);
}

/** @param {Drawing[]} parts @param {Point[]} places @param {Size} size @param {Point[][]} lines @returns {Drawing} */
function together(parts, places, size, lines) {
  /** @type {Drawing} */
  const whole = { ...size, placed: [], boxes: [], lines: [...lines] };
  parts.forEach((part, i) => {
    const [x, y] = places[i];
    whole.placed.push(...part.placed.map((one) => ({ ...one, x: one.x + x, y: one.y + y })));
    whole.boxes.push(...part.boxes.map(({ path, left, right, top, bottom }) =>
      ({ path, left: left + x, right: right + x, top: top + y, bottom: bottom + y })));
    whole.lines.push(...part.lines.map((line) => line.map(([a, b]) => /** @type {Point} */ ([a + x, b + y]))));
  });
  return whole;
}

/** Lines as the text of an SVG path. @param {readonly (readonly Point[])[]} lines @param {number} sign of y */
export const pathOf = (lines, sign = 1) =>
  lines.map((line) => `M${line.map(([x, y]) => `${round(x)} ${round(sign * y)}`).join("L")}`).join("");

/** @param {number} x */
const round = (x) => Math.round(100 * x) / 100;
