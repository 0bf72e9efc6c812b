// A trade-off front: its points in a picture, each of which can be taken into the editor.

import { Doubts, isOk } from "../parts/doubts.js";
import { Select } from "../parts/controls.js";
import { html } from "../parts/html.js";
import { curveColour } from "../plot.js";
import { shown, withUnit } from "../state/scale.js";
import { takeAndTell } from "../working.js";
import { indexChoices, indicesOf } from "./answers.js";
import { Files } from "./files.js";

/** @import { State, Store, Job } from "../state/store.js" */
/** @import { Api } from "../api.js" */
/** @typedef {{status: string, message?: string}} Outcome */
/** @typedef {Outcome & {values: {[index: string]: any}, texts: {[name: string]: string}}} Point */
/** `knee`: the place of the knee among the points.
 * @typedef {Outcome & {layout: string, knee: number, points: Point[]}} Front */

const [WIDTH, HEIGHT, EDGE] = [640, 300, 56];

/** @param {{state: State}} props */
export function FrontForm({ state }) {
  const indices = indicesOf(state);
  if (indices.length < 2) return html`<span class="quiet">The study has only one index.</span>`;
  /** @param {string} name @param {number} chosen */
  const choice = (name, chosen) => html`<${Select} name=${name} aria-label=${`${name} index`}
    choices=${indexChoices(indices)} selected=${indices[chosen].symbol} />`;
  return html`${choice("first", 0)} against ${choice("second", 1)}
    ${" "}<label>points <input name="points" type="number" min="2" max="200" defaultValue="15" /></label>`;
}

/** @param {State} _ @param {FormData} form */
export const frontBody = (_, form) =>
  ({ indices: [form.get("first"), form.get("second")], points: Number(form.get("points")) });

/** @param {{store: Store, api: Api, job: Job}} props */
export function FrontResult({ store, api, job }) {
  const { indices } = job.result;
  /** @type {Front[]} */
  const fronts = job.result.fronts;
  const [first, second] = indices.map((/** @type {any} */ { index }) => index);
  const points = fronts.flatMap(({ layout, knee, points: several }, number) => several.map((point, i) =>
    ({ layout, number, point, knee: i === knee, x: point.values[first], y: point.values[second] })))
    .filter(({ x, y }) => typeof x === "number" && typeof y === "number");
  const doubts = html`<${Doubts} members=${fronts.flatMap(({ layout, status, message, points: several }) => [
    { of: `the front of ${layout}`, status, message },
    ...several.map((point, i) => ({ ...point, of: `point ${i + 1} of ${layout}` })),
  ])} />`;
  if (points.length === 0) return html`${doubts}<p class="quiet">There is no point.</p>`;
  const across = scale(points.map(({ x }) => x), EDGE, WIDTH - 16);
  const up = scale(points.map(({ y }) => y), HEIGHT - EDGE, 16);
  /** @param {typeof points[number]} each */
  const take = ({ layout, point }) => {
    const { texts, status, message } = point;
    takeAndTell(store, { layout, index: `${first} against ${second}`, texts, status, message });
    if (layout in (store.get().history.present.study.layouts ?? {})) store.change({ type: "selected", layout });
  };
  /** @param {string} index @param {number} at @param {{from: number, to: number}} range */
  const extent = (index, at, { from, to }) =>
    `${withUnit(index, indices[at].unit)}: ${shown(from, 4)} to ${shown(to, 4)}`;
  const middle = HEIGHT / 2;
  return html`${doubts}<svg class="front" viewBox=${`0 0 ${WIDTH} ${HEIGHT}`} role="group"
      aria-label=${`${first} against ${second}`}>
      <path class="wire" d=${`M${EDGE} 16V${HEIGHT - EDGE}H${WIDTH - 16}`} />
      <text x=${WIDTH / 2} y=${HEIGHT - 12} text-anchor="middle">${extent(first, 0, across)}</text>
      <text x="16" y=${middle} text-anchor="middle"
        transform=${`rotate(-90 16 ${middle})`}>${extent(second, 1, up)}</text>
      ${points.map((each) => {
        const { layout, number, point: { status }, knee, x, y } = each;
        const name = `${isOk(status) ? "" : `${status}: `}${layout}${knee ? ", the knee" : ""}`;
        const label = `${name}: ${first} ${shown(x)}, ${second} ${shown(y)}; take it into the editor`;
        return html`<circle class=${`point ${isOk(status) ? "" : "doubtful"}`} style=${{ fill: curveColour(number) }}
          cx=${across.at(x)} cy=${up.at(y)} r=${knee ? 8 : 5} tabindex="0" role="button" aria-label=${label}
          onClick=${() => take(each)}
          onKeyDown=${(/** @type {KeyboardEvent} */ event) => event.key === "Enter" && take(each)}>
          <title>${label}</title></circle>`;
      })}
    </svg>
    <p class="row quiet">${fronts.map(({ layout, status, message }, i) => html`<span key=${layout}>
      <span class="swatch" style=${{ background: curveColour(i) }}></span>
      ${" "}${layout}${message && isOk(status) ? `: ${message}` : ""}</span>`)}
      ${" "}Click on a point to take it; the large ones are the knees.</p>
    <${Files} api=${api} job=${job} />`;
}

/** @param {number[]} values @param {number} begin @param {number} end */
function scale(values, begin, end) {
  const [from, to] = [Math.min(...values), Math.max(...values)];
  const inner = begin + 0.06 * (end - begin);
  /** @param {number} value */
  const at = (value) =>
    (to === from ? (begin + end) / 2 : inner + ((value - from) / (to - from)) * 0.9 * (end - begin));
  return { from, to, at };
}
