// Curves by uPlot, in the colours of the page, with bands that are shaded.
import uPlot from "uplot";
import { shown } from "./state/scale.js";
import { html, useLayoutEffect, useRef } from "./parts/html.js";

/** @typedef {{label: string, values: (number | null)[], dash?: boolean, colour?: number}} Curve */
/** @typedef {{from: number, to: number, kind: string}} Band */

const COLOURS = 6;

/** The colour of the curve of a number, for styles. @param {number} number */
export const curveColour = (number) => `var(${curveName(number)})`;

/** @param {number} number */
const curveName = (number) => `--curve-${(number % COLOURS) + 1}`;

/** @param {string} name */
const colour = (name) => getComputedStyle(document.documentElement).getPropertyValue(name).trim();

/** @param {{x: number[], curves: Curve[], xLabel: string, yLabel: string, log?: boolean, logY?: boolean,
 * bands?: Band[], height?: number, title: string, theme: string}} props */
export function Plot({ x, curves, bands = [], title, theme, ...axes }) {
  const { xLabel, yLabel, log = false, logY = false, height = 240 } = axes;
  const place = useRef(/** @type {HTMLDivElement | null} */ (null));
  const plot = useRef(/** @type {uPlot | null} */ (null));
  const lines = curves.map(({ label, dash, colour: number }) => [label, dash, number]);
  const shape = JSON.stringify([lines, xLabel, yLabel, log, logY, height, theme]);
  const shading = useRef(bands);
  shading.current = bands;
  useLayoutEffect(() => {
    const element = place.current;
    if (!element) return;
    const width = element.clientWidth || 400;
    const options = optionsOf(curves, { xLabel, yLabel, log, logY, height, width }, () => shading.current);
    const made = new uPlot(options, dataOf(x, curves), element);
    plot.current = made;
    const sized = new ResizeObserver(() => element.clientWidth && made.setSize({ width: element.clientWidth, height }));
    sized.observe(element);
    return () => {
      sized.disconnect();
      made.destroy();
    };
  }, [shape]);
  useLayoutEffect(() => plot.current?.setData(dataOf(x, curves)), [x, curves, bands]);
  return html`<div class="plot" ref=${place} role="img" aria-label=${title}></div>`;
}

const LARGEST = 1e18; // that uPlot has marks for, and the inverse of the smallest

/** Whether a number has a place on an axis. @param {number | null} number */
const isDrawable = (number) => number === null || number === 0
  || (Math.abs(number) <= LARGEST && Math.abs(number) >= 1 / LARGEST);

/** @param {number[]} x @param {Curve[]} curves @returns {any} */
function dataOf(x, curves) {
  const places = x.flatMap((at, i) => (isDrawable(at) ? [i] : []));
  return [places.map((i) => x[i]), ...curves.map(({ values }) =>
    places.map((i) => (isDrawable(values[i] ?? null) ? values[i] : null)))];
}

/** What stands at the marks of an axis. @param {uPlot} _ @param {(number | null)[]} marks */
const marked = (_, marks) => marks.map((mark) => (mark === null ? "" : shown(mark).replace(/^1·/, "")));

/** A value in the legend. @param {uPlot} _ @param {number | null | undefined} value */
const legendText = (_, value) => value?.toPrecision(4) ?? "–";

/** @param {Curve[]} curves @param {{xLabel: string, yLabel: string, log: boolean, logY: boolean, height: number,
 * width: number}} how @param {() => Band[]} bands @returns {uPlot.Options} */
function optionsOf(curves, { xLabel, yLabel, log, logY, height, width }, bands) {
  const [ink, faint] = [colour("--ink"), colour("--line")];
  const rem = parseFloat(getComputedStyle(document.documentElement).fontSize);
  const font = `${0.8 * rem}px system-ui`;
  const line = { stroke: faint, width: 1 };
  const axis = { stroke: ink, grid: line, ticks: line, font, labelFont: font, labelSize: 1.35 * rem };
  return {
    width,
    height,
    cursor: { drag: { x: true, y: false } },
    legend: { live: true },
    scales: { x: { time: false, distr: log ? 3 : 1 }, y: { distr: logY ? 3 : 1 } },
    axes: [{ ...axis, label: xLabel, values: marked }, { ...axis, label: yLabel, size: 4.3 * rem, values: marked }],
    series: [{ label: xLabel, value: legendText }, ...curves.map(({ label, dash, colour: number }, i) => ({
      label, stroke: colour(curveName(number ?? i)), width: 1.6, dash: dash ? [6, 4] : undefined,
      points: { show: false }, value: legendText,
    }))],
    hooks: { drawAxes: [(made) => shade(made, bands())] },
  };
}

/** @param {uPlot} made @param {Band[]} bands */
function shade(made, bands) {
  const { ctx, bbox } = made;
  ctx.save();
  for (const { from, to, kind } of bands) {
    const [a, b] = [from, to].map((at) =>
      Math.min(bbox.left + bbox.width, Math.max(bbox.left, made.valToPos(at, "x", true))));
    ctx.fillStyle = colour(`--${kind}`);
    ctx.fillRect(a, bbox.top, Math.max(b - a, 0.5), bbox.height);
  }
  ctx.restore();
}
