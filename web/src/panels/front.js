// A trade-off front: its points in a plot, each of which can be taken into the editor, and a card of the one looked at.

import { Doubts, isOk } from "../parts/doubts.js";
import { Select, Table, useChoice } from "../parts/controls.js";
import { html, useMemo, useState } from "../parts/html.js";
import { Plot } from "../plot.js";
import { coloursOf } from "../plots/colours.js";
import { baselineOf } from "../questions.js";
import { printed, rounded, shown, withUnit } from "../state/scale.js";
import { takeAndTell } from "../working.js";
import { indexChoices, indicesOf } from "./answers.js";
import { Files } from "./files.js";

/** @import { State, Store, Job } from "../state/store.js" */
/** @import { Api } from "../api.js" */
/** @import { Declaration, Point as Place } from "../plots/layout.js" */
/** @typedef {{status: string, message?: string}} Outcome */
/** @typedef {Outcome & {values: {[index: string]: any}, texts: {[name: string]: string}}} Point */
/** `knee`: the place of the knee among the points.
 * @typedef {Outcome & {layout: string, knee: number | null, points: Point[]}} Front */
/** An index with its title and unit. @typedef {{index: string, title: string, unit: string}} Index */
/** A point among all: `number` among those of its front, from 1 on.
 * @typedef {{front: Front, point: Point, number: number, isKnee: boolean}} Entry */

const ALL = ""; // layouts
const WORD = /^[a-z]+(-[a-z]+)*$/; // an index that is named by words

/** The indices of which a front can be: those of the study, first those of its trade-off; else all that there are.
 * @param {State} state @returns {{symbol: string, title: string}[]} */
function frontIndices(state) {
  const known = state.about?.indices ?? [];
  const { trade_off: wanted = [] } = state.history.present.study.study ?? {};
  const named = wanted.map((/** @type {string} */ symbol) =>
    known.find((/** @type {any} */ each) => each.symbol === symbol) ?? { symbol, title: symbol });
  const all = [...named, ...indicesOf(state).filter(({ symbol }) => !wanted.includes(symbol))];
  return all.length > 1 ? all : known;
}

/** @param {{state: State}} props */
export function FrontForm({ state }) {
  const indices = frontIndices(state);
  if (indices.length < 2) return html`<span class="quiet">No two indices are known.</span>`;
  /** @param {string} name @param {number} chosen */
  const choice = (name, chosen) => html`<${Select} name=${name} aria-label=${`${name} index`}
    choices=${indexChoices(indices)} selected=${indices[chosen].symbol} />`;
  return html`${choice("first", 0)} against ${choice("second", 1)}
    ${" "}<label>points <input name="points" type="number" min="2" max="200" defaultValue="15" /></label>`;
}

/** @param {State} _ @param {FormData} form */
export const frontBody = (_, form) =>
  ({ indices: [form.get("first"), form.get("second")], points: Number(form.get("points")) });

/** @param {FormData} form */
export const frontTitle = (form) => `Trade-off front of ${form.get("first")} and ${form.get("second")}`;

/** @param {{store: Store, api: Api, job: Job}} props */
export function FrontResult({ store, api, job }) {
  const { result } = job;
  const baseline = result.baseline ?? baselineOf(store.get().history.present).layout;
  /** @type {Front[]} */
  const every = result.fronts;
  const [only, setOnly] = useChoice([ALL, ...every.map(({ layout }) => layout)]);
  const fronts = useMemo(() => every.filter(({ layout }) => only === ALL || layout === only), [every, only]);
  const plot = useMemo(() => declared(result.indices, fronts, coloursOf(every.map(({ layout }) => layout), baseline)),
    [fronts, baseline]);
  const knee = plot.points.findIndex(({ big, of }) => big && of.front.layout !== baseline);
  const [picked, look] = useState(/** @type {number | null} */ (null));
  const [first, second] = result.indices.map((/** @type {Index} */ { index }) => index);
  const here = plot.points[picked ?? Math.max(0, knee)];
  /** @param {Place} place */
  const take = ({ of: { front: { layout }, point: { texts, status, message } } }) => {
    takeAndTell(store, { layout, index: `${first} against ${second}`, texts, status, message });
    if (layout in (store.get().history.present.study.layouts ?? {})) store.change({ type: "selected", layout });
  };
  return html`<${Doubts} members=${every.flatMap(({ layout, status, message, points }) => [
      { of: `the front of ${layout}`, status, message },
      ...points.map((point, i) => ({ ...point, of: `point ${i + 1} of ${layout}` })),
    ])} />
    ${here === undefined && html`<p class="quiet">There is no point.</p>`}
    ${here && html`<div class="front-result">
      <${Plot} plot=${plot} table=${tableOf(plot, result.indices)} picked=${picked} look=${look} take=${take}
        switches=${["x", "y"]}>${every.length > 1 && html`<${Select} aria-label="Layouts that are drawn" value=${only}
          choices=${[[ALL, "all layouts"], ...every.map(({ layout }) => layout)]} set=${setOnly} />`}<//>
      <${Card} entry=${here.of} fronts=${every} indices=${result.indices} baseline=${baseline}
        take=${() => take(here)} /></div>
    <p class="quiet">${every.flatMap(({ layout, status, message }) => (message && isOk(status)
      ? [`${layout}: ${message}`] : [])).join(" ")} Lower left is better. Click a point to take it into the editor, or
      with the keyboard: left and right for the next point, up and down for another layout, K for the knee, Enter to
      take.</p>`}
    <${Files} api=${api} job=${job} />`;
}

/** @param {Index[]} indices @param {Front[]} fronts @param {{[layout: string]: string}} colours
 * @returns {Declaration & {points: Place[]}} */
function declared(indices, fronts, colours) {
  const [first, second] = indices;
  /** @param {Index} index */
  const axis = ({ index, title, unit }) =>
    ({ what: WORD.test(index) ? title : `${title} ${index}`, unit, padded: true });
  const all = fronts.map((front) => entriesOf(front).filter(({ point: { values } }) =>
    [first, second].every(({ index }) => typeof values[index] === "number")));
  return {
    title: `${second.index} against ${first.index}`,
    x: axis(first),
    y: axis(second),
    curves: fronts.map(({ layout }, i) => ({ name: layout, colour: colours[layout], dash: colours[layout] === "s1",
      x: all[i].map(({ point }) => point.values[first.index]),
      y: all[i].map(({ point }) => point.values[second.index]) })),
    points: all.flatMap((entries, curve) => entries.map((entry) => {
      const { front: { layout }, point: { status, values }, isKnee } = entry;
      const [x, y] = [first, second].map(({ index }) => values[index]);
      const name = `${isOk(status) ? "" : `${status}: `}${layout}${isKnee ? ", the knee" : ""}`;
      const both = [first, second].map(({ index, unit }) => `${shown(values[index], 4)} ${printed(unit)}`.trim());
      return { curve, x, y, big: isKnee, doubtful: !isOk(status), of: entry, lines: [name, both.join(",  "),
        Object.entries(entry.point.texts).map(([key, text]) => `${key} = ${rounded(text)}`).join(", ")],
        label: `${name}: ${first.index} ${shown(x)}, ${second.index} ${shown(y)}; take it into the editor` };
    })),
  };
}

/** @param {Front} front @returns {Entry[]} */
const entriesOf = (front) => front.points.map((point, i) => ({ front, point, number: i + 1,
  isKnee: i === front.knee }));

/** @param {{points: Place[]}} plot @param {Index[]} indices */
function tableOf({ points }, indices) {
  const names = [...new Set(points.flatMap(({ of }) => Object.keys(of.point.texts)))];
  return {
    heads: ["layout", "point", ...indices.map(({ index, unit }) => withUnit(index, unit)), "status", ...names],
    rows: points.map(({ of: { front, point, number } }) => [front.layout, number,
      ...indices.map(({ index }) => point.values[index]), point.status, ...names.map((name) =>
        point.texts[name] ?? "")]),
  };
}

/** The point that is looked at: its indices against those of another design, its values, and what it costs.
 * @param {{entry: Entry, fronts: Front[], indices: Index[], baseline: string, take: () => void}} props */
function Card({ entry, fronts, indices, baseline, take }) {
  const { front, point, number, isKnee } = entry;
  const other = referenceOf(entry, fronts, baseline);
  return html`<section class="front-card" aria-live="polite" aria-label="Point">
    <h4>${front.layout}, point ${number} of ${front.points.length}${isKnee ? ", the knee" : ""}</h4>
    ${!isOk(point.status) && html`<p class="problem"><b>Unreliable.</b> ${point.status}</p>`}
    <${Table} label="Indices of the point" heads=${["index", "here", ...(other ? [other.name] : [])]}>
      ${indices.map(({ index, title, unit }) => html`<tr key=${index}><th scope="row" title=${title}>${index}</th>
        <td class="number" data-value=${point.values[index]}>${shown(point.values[index], 4)}
          ${" "}<span class="unit">${printed(unit)}</span></td>
        ${other && html`<td class="number">${shown(other.point.values[index], 4)}</td>`}</tr>`)}
    <//>
    <p>${Object.entries(point.texts).map(([name, text]) => `${name} = ${rounded(text)}`).join(", ")}</p>
    ${other && html`<p>${sentenceOf(point, other, indices)}</p>`}
    <button type="button" onClick=${take}>Take this point</button>
  </section>`;
}

/** What a point is compared with: the knee of its own front; the knee itself with that of the baseline.
 * @param {Entry} entry @param {Front[]} fronts @param {string} baseline
 * @returns {{name: string, point: Point} | null} */
function referenceOf({ front, isKnee }, fronts, baseline) {
  const of = isKnee ? fronts.find(({ layout }) => layout === baseline) : front;
  if (of === undefined || of.knee === null || (isKnee && of === front)) return null;
  return { name: `${of.layout} at its knee`, point: of.points[of.knee] };
}

/** How a point differs from another, in one sentence. @param {Point} point @param {{name: string, point: Point}} other
 * @param {Index[]} indices */
function sentenceOf(point, other, indices) {
  const parts = indices.map(({ index }) => {
    const percent = 100 * (point.values[index] / other.point.values[index] - 1);
    if (!Number.isFinite(percent)) return `${index} is not comparable`;
    const size = shown(Math.abs(percent), 2);
    return Math.abs(percent) < 0.005 ? `equal ${index}` : `${size} % ${percent < 0 ? "lower" : "higher"} ${index}`;
  });
  return `Relative to ${other.name}: ${parts.join(", ")}.`;
}
