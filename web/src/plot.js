// Curves by uPlot, in the colours of the page, with bands that are shaded.
import uPlot from "uplot";
import { shown } from "./state/scale.js";
import { html, useLayoutEffect, useRef } from "./parts/html.js";

/** @typedef {{label: string, values: (number | null)[], dash?: boolean, colour?: number}} Curve */
/** @typedef {{from: number, to: number, kind: string}} Band */

const COLOURS = 6;

/** @param {string} name */
const colour = (name) => getComputedStyle(document.documentElement).getPropertyValue(name).trim();

/**
 * @param {{x: number[], curves: Curve[], xLabel: string, yLabel: string, log?: boolean, logY?: boolean, bands?: Band[], height?: number, title: string, theme: string, keep?: (plot: any) => void}} props
 */
export function Plot({ x, curves, xLabel, yLabel, log = false, logY = false, bands = [], height = 240, title, theme, keep }) {
  const place = useRef(/** @type {HTMLDivElement | null} */ (null));
  const plot = useRef(/** @type {uPlot | null} */ (null));
  const shape = JSON.stringify([curves.map(({ label, dash, colour: number }) => [label, dash, number]), xLabel, yLabel, log, logY, height, theme]);
  const shading = useRef(bands);
  shading.current = bands;
  useLayoutEffect(() => {
    const element = place.current;
    if (!element) return;
    const options = optionsOf(curves, { xLabel, yLabel, log, logY, height, width: element.clientWidth || 400 }, () => shading.current);
    const made = new uPlot(options, dataOf(x, curves), element);
    plot.current = made;
    keep?.(made);
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

/** @param {number[]} x @param {Curve[]} curves @returns {any} */
const dataOf = (x, curves) => [x, ...curves.map(({ values }) => values)];

/** What stands at the marks of an axis. @param {uPlot} _ @param {(number | null)[]} marks */
const marked = (_, marks) => marks.map((mark) => (mark === null ? "" : shown(mark).replace(/^1·/, "")));

/** @param {Curve[]} curves @param {{xLabel: string, yLabel: string, log: boolean, logY: boolean, height: number, width: number}} how @param {() => Band[]} bands @returns {uPlot.Options} */
function optionsOf(curves, { xLabel, yLabel, log, logY, height, width }, bands) {
  const [ink, faint] = [colour("--ink"), colour("--line")];
  const rem = parseFloat(getComputedStyle(document.documentElement).fontSize);
  const font = `${0.8 * rem}px system-ui`;
  const axis = { stroke: ink, grid: { stroke: faint, width: 1 }, ticks: { stroke: faint, width: 1 }, font, labelFont: font, labelSize: 1.35 * rem };
  return {
    width,
    height,
    cursor: { drag: { x: true, y: false } },
    legend: { live: true },
    scales: { x: { time: false, distr: log ? 3 : 1 }, y: { distr: logY ? 3 : 1 } },
    axes: [{ ...axis, label: xLabel, values: marked }, { ...axis, label: yLabel, size: 4.3 * rem, values: marked }],
    series: [
      { label: xLabel, value: (_, v) => (v === null ? "–" : v.toPrecision(4)) },
      ...curves.map(({ label, dash, colour: number }, i) => ({
        label,
        stroke: colour(`--curve-${((number ?? i) % COLOURS) + 1}`),
        width: 1.6,
        dash: dash ? [6, 4] : undefined,
        points: { show: false },
        value: (/** @type {any} */ _, /** @type {number | null} */ v) => (v === null || v === undefined ? "–" : v.toPrecision(4)),
      })),
    ],
    hooks: { drawAxes: [(made) => shade(made, bands())] },
  };
}

/** @param {uPlot} made @param {Band[]} bands */
function shade(made, bands) {
  const { ctx, bbox } = made;
  ctx.save();
  for (const { from, to, kind } of bands) {
    const [a, b] = [made.valToPos(from, "x", true), made.valToPos(to, "x", true)].map((v) => Math.min(bbox.left + bbox.width, Math.max(bbox.left, v)));
    ctx.fillStyle = colour(`--${kind}`);
    ctx.fillRect(a, bbox.top, Math.max(b - a, 0.5), bbox.height);
  }
  ctx.restore();
}
