// A trade-off front: its points in a picture, each of which can be taken into the editor.

import { Doubts, isOk } from "../parts/doubts.js";
import { html } from "../parts/html.js";
import { shown, withUnit } from "../state/scale.js";
import { takeOptima } from "../working.js";
import { indicesOf } from "./answers.js";
import { Files } from "./files.js";

/** @import { State, Store, Job } from "../state/store.js" */

const [WIDTH, HEIGHT, EDGE] = [640, 300, 56];

/** @param {{state: State}} props */
export function FrontForm({ state }) {
  const indices = indicesOf(state);
  if (indices.length < 2) return html`<span class="quiet">The study has only one index.</span>`;
  /** @param {string} name @param {number} chosen */
  const choice = (name, chosen) => html`<select name=${name} aria-label=${`${name} index`}>${indices.map(({ symbol, title }, i) => html`<option key=${symbol} value=${symbol} selected=${i === chosen}>${symbol}: ${title}</option>`)}</select>`;
  return html`${choice("first", 0)} against ${choice("second", 1)} <label>points <input name="points" type="number" min="2" max="200" defaultValue="15" /></label>`;
}

/** @param {State} _ @param {FormData} form */
export const frontBody = (_, form) => ({ indices: [form.get("first"), form.get("second")], points: Number(form.get("points")) });

/** @param {{store: Store, api: import("../api.js").Api, job: Job}} props */
export function FrontResult({ store, api, job }) {
  const { indices, fronts } = job.result;
  const [first, second] = indices.map((/** @type {any} */ { index }) => index);
  const points = fronts.flatMap((/** @type {any} */ front, /** @type {number} */ number) =>
    front.points.map((/** @type {any} */ point, /** @type {number} */ i) => ({ layout: front.layout, number, point, knee: i === front.knee, x: point.values[first], y: point.values[second] })),
  ).filter((/** @type {any} */ { x, y }) => typeof x === "number" && typeof y === "number");
  const doubts = html`<${Doubts} members=${fronts.flatMap((/** @type {any} */ front) => [
    { of: `the front of ${front.layout}`, status: front.status, message: front.message },
    ...front.points.map((/** @type {any} */ { status, message }, /** @type {number} */ i) => ({ of: `point ${i + 1} of ${front.layout}`, status, message })),
  ])} />`;
  if (points.length === 0) return html`${doubts}<p class="quiet">There is no point.</p>`;
  const [across, up] = [scale(points.map((/** @type {any} */ { x }) => x), EDGE, WIDTH - 16), scale(points.map((/** @type {any} */ { y }) => y), HEIGHT - EDGE, 16)];
  /** @param {any} each */
  const take = ({ layout, point }) => {
    const { status, message } = point;
    const text = takeOptima(store, [{ layout, index: `${first} against ${second}`, texts: point.texts, status, message }]);
    store.dispatch({ type: "said", about: "taken", text });
    if (layout in (store.get().history.present.study.layouts ?? {})) store.change({ type: "selected", layout });
  };
  return html`${doubts}<svg class="front" viewBox=${`0 0 ${WIDTH} ${HEIGHT}`} role="group" aria-label=${`${first} against ${second}`}>
      <path class="wire" d=${`M${EDGE} 16V${HEIGHT - EDGE}H${WIDTH - 16}`} />
      <text x=${WIDTH / 2} y=${HEIGHT - 12} text-anchor="middle">${withUnit(first, indices[0].unit)}: ${shown(across.from, 4)} to ${shown(across.to, 4)}</text>
      <text x="16" y=${HEIGHT / 2} text-anchor="middle" transform=${`rotate(-90 16 ${HEIGHT / 2})`}>${withUnit(second, indices[1].unit)}: ${shown(up.from, 4)} to ${shown(up.to, 4)}</text>
      ${points.map((/** @type {any} */ each) => {
        const label = `${isOk(each.point.status) ? "" : `${each.point.status}: `}${each.layout}${each.knee ? ", the knee" : ""}: ${first} ${shown(each.x)}, ${second} ${shown(each.y)}; take it into the editor`;
        return html`<circle class=${`point ${isOk(each.point.status) ? "" : "doubtful"}`} style=${{ fill: `var(--curve-${(each.number % 6) + 1})` }} cx=${across.at(each.x)} cy=${up.at(each.y)} r=${each.knee ? 8 : 5} tabindex="0" role="button" aria-label=${label}
          onClick=${() => take(each)} onKeyDown=${(/** @type {KeyboardEvent} */ event) => event.key === "Enter" && take(each)}><title>${label}</title></circle>`;
      })}
    </svg>
    <p class="row quiet">${fronts.map((/** @type {any} */ front, /** @type {number} */ i) => html`<span key=${front.layout}><span class="swatch" style=${{ background: `var(--curve-${(i % 6) + 1})` }}></span> ${front.layout}${front.message && isOk(front.status) ? `: ${front.message}` : ""}</span>`)} Click on a point to take it; the large ones are the knees.</p>
    <${Files} api=${api} job=${job} />`;
}

/** @param {number[]} values @param {number} begin @param {number} end */
function scale(values, begin, end) {
  const [from, to] = [Math.min(...values), Math.max(...values)];
  const inner = begin + 0.06 * (end - begin);
  return { from, to, at: (/** @type {number} */ value) => (to === from ? (begin + end) / 2 : inner + ((value - from) / (to - from)) * 0.9 * (end - begin)) };
}
