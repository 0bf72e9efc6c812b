// Trade-off fronts: points in a plot, each of which can be taken into the editor, and a card of the one looked at.

import { Doubts, isOk } from "../parts/doubts.js";
import { Select, Table, useChoice } from "../parts/controls.js";
import { html, useMemo, useState } from "../parts/html.js";
import { Plot } from "../plot.js";
import { coloursOf } from "../plots/colours.js";
import { baselineOf } from "../questions.js";
import { own } from "../state/document.js";
import { aligned, toPlaces, printed, scaled, times, unitFor, valuesIn, withUnit } from "../state/scale.js";
import { TAKEN } from "../state/store.js";
import { takeOptima } from "../working.js";
import { indexAxis, indexChoices, indicesOf, percentChange } from "./answers.js";
import { Files } from "./files.js";

/** @import { State, Store, Job } from "../state/store.js" */
/** @import { Api } from "../api.js" */
/** @import { Declaration, Point as Place } from "../plots/layout.js" */
/** @typedef {{status: string, message?: string}} Outcome */
/** `improvements`: per cent below the best of the baseline, by index; `network`: where the points have several.
 * `decimals`: the places that the errors of the values allow, where they have any; `reference`: the knee with which it
 * is compared, and how it differs.
 * @typedef {Outcome & {reference?: {layout: string, point: number, name: string, sentence: string} | null,
 * values: {[index: string]: any}, decimals?: {[index: string]: number | null},
 * texts: {[name: string]: string}, network?: string, improvements?: {[index: string]: number | null}}} Point */
/** `knee`: the place of the knee among the points.
 * @typedef {Outcome & {layout: string, knee: number | null, points: Point[],
 * problem_digests?: string[]}} Front */
/** An index with its title and unit; its values times `factor` are in the unit in which they are written.
 * @typedef {{index: string, title: string, unit: string, factor: number}} Index */
/** A point among all: `number` among those of its front, from 1 on.
 * @typedef {{front: Front, point: Point, number: number, isKnee: boolean}} Entry */

const ALL = "all fronts";

/** The indices of which a front can be: those of the study, first those of its trade-off; else all that there are.
 * @param {State} state @returns {{symbol: string, title: string}[]} */
export function frontIndices(state) {
  const known = state.about?.indices ?? [];
  const { trade_off: wanted = [] } = state.history.present.study.study ?? {};
  const all = [...indicesOf(state, wanted), ...indicesOf(state).filter(({ symbol }) => !wanted.includes(symbol))];
  return all.length > 1 ? all : known;
}

/** @param {{store: Store}} props */
export function FrontForm({ store }) {
  const state = store.get();
  const indices = frontIndices(state);
  const third = (state.history.present.study.study?.trade_off ?? []).length > 2 ? indices[2].symbol : "";
  /** @param {string} selected @param {(string | string[])[]} [more] */
  const choice = (selected, more = []) => html`<${Select} name="index" aria-label="Index"
    choices=${[...more, ...indexChoices(indices)]} selected=${selected} />`;
  return html`${choice(indices[0].symbol)} and ${choice(indices[1].symbol)} and ${choice(third, [["", "no other"]])}
    ${" "}<label>points <input name="points" type="number" min="3" max="200" defaultValue="15" /></label>`;
}

/** @param {FormData} form */
export const frontBody = (form) => ({ indices: form.getAll("index").filter((index) => index !== ""),
  points: Number(form.get("points")) });

/** @param {{store: Store, api: Api, job: Job}} props */
export function FrontResult({ store, api, job }) {
  const { result } = job;
  /** @type {{index: string, title: string, unit: string}[]} */
  const indices = result.indices;
  /** @type {Front[]} */
  const fronts = result.fronts;
  /** @param {Entry} entry */
  const take = ({ front: { layout, problem_digests }, point: { texts, status, message } }) => {
    const gesture = Symbol("point");
    store.say(takeOptima(store, [{ layout, index: indices.map(({ index }) => index).join(" against "), texts, status,
      message, problem_digests }], gesture), TAKEN);
    if (own(store.get().history.present.study.layouts, layout)) store.change({ type: "selected", layout }, gesture);
  };
  const { present } = store.get().history;
  return html`<${FrontView} about=${store.get().about} indices=${indices} fronts=${fronts} take=${take}
      layout=${present.layout} baseline=${result.baseline ?? baselineOf(present).layout} />
    <${Files} store=${store} api=${api} job=${job} />`;
}

/** Fronts in a plot, with a card of the point that is looked at: at first the knee of the front of `layout`. Of three
 * indices two are drawn, which can be chosen. At first all fronts are drawn, or the first of them `alone`.
 * @param {{about: any, indices: {index: string, title: string, unit: string}[], fronts: Front[], baseline: string,
 * take: (entry: Entry) => void, layout?: string, alone?: boolean}} props */
export function FrontView({ about, indices: all, fronts: every, baseline, take, layout, alone = false }) {
  const names = every.map(({ layout }) => layout);
  const [only, setOnly] = useChoice(alone ? [...names, ALL] : [ALL, ...names]);
  /** @type {Index[]} */
  const indices = useMemo(() => all.map((each) => ({ ...each, ...unitFor(about, every.flatMap(({ points }) =>
    points.map(({ values }) => values[each.index])), each.unit) })), [about, all, every]);
  const symbols = indices.map(({ index }) => index);
  const [across, setAcross] = useChoice(symbols);
  const [up, setUp] = useChoice(symbols.filter((symbol) => symbol !== across));
  const fronts = useMemo(() => every.filter(({ layout }) => only === ALL || layout === only), [every, only]);
  const plot = useMemo(() => declared(about, indices, [String(across), String(up)], fronts,
    coloursOf(names, baseline)), [indices, across, up, fronts, baseline]);
  const knees = plot.points.filter(({ big, of }) => big && of.front.layout !== baseline);
  const [picked, look] = useState(/** @type {number | null} */ (null));
  const here = plot.points[picked ?? -1] ?? knees.find(({ of }) => of.front.layout === layout) ?? knees[0]
    ?? plot.points[0];
  /** @param {string} label @param {string | undefined} value @param {(index: string) => void} set */
  const axis = (label, value, set) => html`<${Select} label=${label} value=${value} set=${set}
    choices=${label === "across" ? symbols : symbols.filter((symbol) => symbol !== across)} />`;
  return html`<${Doubts} members=${every.flatMap(({ layout, status, message, points }) => [
      { of: `the front of ${layout}`, status, message },
      ...points.map((point, i) => ({ ...point, of: `point ${i + 1} of ${layout}` })),
    ])} />
    ${here === undefined && html`<p class="quiet">There is no point.</p>`}
    ${here && html`<div class="front-result">
      <${Plot} plot=${plot} table=${tableOf(plot, indices)} picked=${picked} look=${look}
        take=${(/** @type {Place} */ { of }) => take(of)} switches=${["x", "y"]}>
        ${symbols.length > 2 && [axis("across", across, setAcross), axis("up", up, setUp)]}
        ${every.length > 1 && html`<${Select} aria-label="Fronts that are drawn" value=${only}
          choices=${[ALL, ...names]} set=${setOnly} />`}<//>
      <${Card} about=${about} entry=${here.of} fronts=${every} indices=${indices} baseline=${baseline}
        take=${() => take(here.of)} /></div>
    <p class="quiet">${every.flatMap(({ layout, status, message }) => (message && isOk(status)
      ? [`${layout}: ${message}`] : [])).join(" ")} Lower left is better${symbols.length > 2
        ? `; in the plane of ${across} and ${up} a point may be above others, if it is better in the third index` : ""}.
      Click a point to take it into the editor.</p>`}`;
}

/** Points of fronts over two of the indices; those of three do not lie on a line. @param {any} about
 * @param {Index[]} indices @param {string[]} drawn @param {Front[]} fronts @param {{[layout: string]: string}} colours
 * @returns {Declaration & {points: Place[]}} */
function declared(about, indices, drawn, fronts, colours) {
  const [first, second] = drawn;
  /** @param {string} symbol */
  const axis = (symbol) => {
    const { title = "", unit = "", factor = 1 } = indices.find(({ index }) => index === symbol) ?? {};
    return { what: indexAxis(symbol, title), unit, size: 1 / factor, padded: true };
  };
  const all = fronts.map((front) => entriesOf(front).filter(({ point: { values } }) =>
    drawn.every((index) => typeof values[index] === "number")));
  return {
    title: `${second} against ${first}`,
    x: axis(first),
    y: axis(second),
    curves: fronts.map(({ layout }, i) => ({ name: layout, colour: colours[layout], dash: colours[layout] === "s1",
      loose: indices.length > 2, ...lineThrough(all[i], first, second) })),
    points: all.flatMap((entries, curve) => entries.map((entry) => {
      const { front: { layout }, point: { status, values, texts, network }, isKnee } = entry;
      const [x, y] = drawn.map((index) => values[index]);
      const name = `${isOk(status) ? "" : `${status}: `}${layout}${isKnee ? ", the knee" : ""}`;
      const read = indices.map((each) => `${each.index} ${told(entry.point, each)} ${printed(each.unit)}`.trim());
      return { curve, x, y, big: isKnee, doubtful: !isOk(status), of: entry,
        lines: [name, read.join(",  "), network ?? "", valuesIn(about, texts)].filter(Boolean),
        label: `${[name, network].filter(Boolean).join(", ")}: ${read.join(", ")}; take it into the editor` };
    })),
  };
}

/** The line through points, broken between two networks, where there is no design.
 * @param {Entry[]} entries @param {string} first @param {string} second */
function lineThrough(entries, first, second) {
  const places = entries.flatMap(({ point }, i) =>
    (i > 0 && point.network !== entries[i - 1].point.network ? [{ x: point.values[first], y: null }] : [])
      .concat({ x: point.values[first], y: point.values[second] }));
  return { x: places.map(({ x }) => x), y: places.map(({ y }) => y) };
}

/** The value of an index at a point, in the digits that its error allows. @param {Point} point @param {Index} index */
function told({ values, decimals }, { index, factor }) {
  const { value, decimals: places } = scaled({ value: values[index], decimals: decimals?.[index] }, factor);
  return typeof places === "number" ? toPlaces(value, places) : aligned(value, 4);
}

/** @param {Front} front @returns {Entry[]} */
const entriesOf = (front) => front.points.map((point, i) => ({ front, point, number: i + 1,
  isKnee: i === front.knee }));

/** @param {{points: Place[]}} plot @param {Index[]} indices */
function tableOf({ points }, indices) {
  const names = [...new Set(points.flatMap(({ of }) => Object.keys(of.point.texts)))];
  const networks = points.some(({ of }) => of.point.network) ? ["network"] : [];
  return {
    heads: ["layout", "point", ...networks, ...indices.map(({ index, unit }) => withUnit(index, unit)), "status",
      ...names],
    rows: points.map(({ of: { front, point, number } }) => [front.layout, number,
      ...networks.map(() => point.network ?? ""), 
      ...indices.map(({ index, factor }) => times(point.values[index], factor)), point.status,
      ...names.map((name) => point.texts[name] ?? "")]),
  };
}

/** The point that is looked at: its indices against those of another design, its values, and what it costs.
 * @param {{about: any, entry: Entry, fronts: Front[], indices: Index[], baseline: string, take: () => void}} props */
function Card({ about, entry, fronts, indices, baseline, take }) {
  const { front, point, number, isKnee } = entry;
  const { improvements, reference } = point;
  const other = reference && fronts.find(({ layout }) => layout === reference.layout)?.points[reference.point];
  return html`<section class="front-card" aria-live="polite" aria-label="Point">
    <h4>${front.layout}, point ${number} of ${front.points.length}${isKnee ? ", the knee" : ""}</h4>
    ${point.network && html`<p><code>${point.network}</code></p>`}
    ${!isOk(point.status) && html`<p class="problem"><b>Unreliable.</b> ${point.status}</p>`}
    <${Table} label="Indices of the point" heads=${["index", "here", ...(other ? [reference.name] : []),
        ...(improvements ? [[`gain on ${baseline}`, `on the lowest value of ${baseline}`]] : [])]}>
      ${indices.map((each) => html`<tr key=${each.index}>
        <th scope="row" title=${each.title}>${each.index}</th>
        <td class="number" data-value=${point.values[each.index]}>${told(point, each)}
          ${" "}<span class="unit">${printed(each.unit)}</span></td>
        ${other && html`<td class="number">${told(other, each)}</td>`}
        ${improvements && html`<td class="number">${percentChange(improvements[each.index])}</td>`}</tr>`)}
    <//>
    <p>${valuesIn(about, point.texts)}</p>
    ${reference && html`<p>${reference.sentence}</p>`}
    <button type="button" class="edged" onClick=${take}>Take this point</button>
  </section>`;
}
