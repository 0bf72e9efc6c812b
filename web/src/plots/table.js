// The numbers of a plot as a table, and as CSV with names and units in its head.

import { withUnit } from "../state/scale.js";

/** @import { Declaration } from "./layout.js" */
/** @typedef {{heads: string[], rows: (number | string | null)[][]}} Table */

/** The curves beside each other if they have the same places, else each with its own.
 * @param {Declaration} plot @returns {Table} */
export function tableOf({ x, y, curves, bars }) {
  if (bars) return { heads: [`${withUnit(x.what, x.unit)}, from`, "to", withUnit(y.what, y.unit)],
    rows: bars.counts.map((count, i) => [bars.edges[i], bars.edges[i + 1], count]) };
  const [across, up] = [x.size ?? 1, y.size ?? 1];
  const [first, ...others] = curves;
  if (first === undefined) return { heads: [], rows: [] };
  const alike = others.every((curve) => curve.x === first.x
    || (curve.x.length === first.x.length && curve.x.every((at, i) => at === first.x[i])));
  const blocks = alike ? [curves] : curves.map((curve) => [curve]);
  const longest = Math.max(...blocks.map(([{ x: places }]) => places.length));
  const heads = blocks.flatMap((block) => [withUnit(alike ? x.what : `${x.what} of ${block[0].name}`, x.unit),
    ...block.map(({ name }) => withUnit(`${y.what} of ${name}`, y.unit))]);
  const rows = Array.from({ length: longest }, (_, i) => blocks.flatMap((block) =>
    [block[0].x[i], ...block.map((curve) => curve.y[i])].map((value, column) =>
      (value === undefined || value === null ? null : value / (column === 0 ? across : up)))));
  return { heads, rows };
}

/** @param {Table} table */
export const csvOf = ({ heads, rows }) =>
  [heads, ...rows].map((row) => `${row.map(cell).join(",")}\r\n`).join("");

/** @param {number | string | null} value */
function cell(value) {
  const text = value === null ? "" : String(value);
  return /[",\r\n]/.test(text) ? `"${text.replaceAll('"', '""')}"` : text;
}

/** Rows of a table that are shown: so many of them, evenly. @param {Table} table @param {number} most */
export function thinned({ heads, rows }, most) {
  const every = Math.max(1, Math.ceil(rows.length / most));
  return { heads, rows: rows.filter((_, i) => i % every === 0), every };
}
