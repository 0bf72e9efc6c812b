// Which layout: all of them ranked by the goal, each with its network, its value, and what it is against the baseline.

import { methodChoice, unchosenIn } from "../library.js";
import { allDesigns, answerOf, baselineOf, goalOf, isRightStill } from "../questions.js";
import { indicesIn, nextLayout } from "../state/document.js";
import { aligned, withError, toPlaces, scaled, shown, unitFor, withUnit } from "../state/scale.js";
import { DropDown, Select, Table, formHandler } from "../parts/controls.js";
import { doubtsIn, isOk } from "../parts/doubts.js";
import { html, useLayoutEffect, useMemo, useRef, useState } from "../parts/html.js";
import { shortLabel } from "../network/drawing.js";
import { layoutColour } from "../plots/colours.js";
import { useLate, useShown } from "../parts/clock.js";
import { Sketch, sketchesOf } from "./sketch.js";
import { toSearch } from "./search.js";
import { problemsOf } from "./values.js";

/** @import { Store, State } from "../state/store.js" */

/** @param {{store: Store}} props */
export function AnswersPanel({ store }) {
  const state = store.get();
  const answer = answerOf(state, "decision");
  const { value, sentence } = answer;
  useShown("decision", state);
  const present = value?.rows.find((/** @type {any} */ { layout }) => layout === state.history.present.layout);
  return html`<section class="panel answers" aria-labelledby="answers-title" aria-busy=${answer.is === "coming"}
    data-being=${answer.is} data-keys="Ranking">
    <div class="head"><h2 id="answers-title">Layouts by ${goalOf(state) ?? "no index"}</h2>
      <${Select} aria-label="Method" ...${methodChoice(store)} /></div>
    ${sentence && problemsOf(state).length === 0 && html`<p class="problem pad" role="alert">${sentence}</p>`}
    <${Ranking} store=${store} answer=${answer} />
    ${present?.in_conditions.length > 0 && html`<${Conditions} state=${state} goal=${value.goal} row=${present}
      baseline=${value.rows.find((/** @type {any} */ row) => row.is_baseline)} />`}
    <${Reasons} rows=${value?.rows ?? []} goal=${value?.goal} />
    <${Limits} limits=${present?.limits ?? []} />
    <${Layouts} store=${store} />
  </section>`;
}

/** The rows of the answer, or the layouts of the study in their order until it comes.
 * @param {State} state @param {any} value @returns {any[]} */
function rowsOf(state, value) {
  const document = state.history.present;
  const designs = allDesigns(document);
  /** @type {any[]} */
  const rows = (value?.rows ?? []).filter((/** @type {any} */ { layout }) =>
    designs.some((design) => design.layout === layout));
  const missing = designs.filter(({ layout }) => !rows.some((row) => row.layout === layout));
  const others = (rows[0]?.others ?? []).map((/** @type {any} */ { index }) => ({ index }));
  return [...rows, ...missing.map((design) => ({ layout: design.layout, unchosen: unchosenIn(state, design),
    is_baseline: design.layout === baselineOf(document).layout, others }))];
}

/** In another order they are drawn anew: Chromium keeps the former style of a row that is moved and changed at once.
 * The layout that had the focus has it again.
 * @param {{store: Store, answer: import("../state/answers.js").Shown}} props */
function Ranking({ store, answer: { is, value, before } }) {
  const state = store.get();
  const document = state.history.present;
  const rows = rowsOf(state, value);
  const others = value?.rows?.[0]?.others ?? [];
  const baseline = baselineOf(document).layout;
  const { goal } = value ?? {};
  /** @param {string} unit @param {(row: any) => unknown} of */
  const written = (unit, of) => unitFor(state.about, rows.map(of), unit);
  const units = goal && { goal: written(goal.unit, (row) => row.value), others: others.map(
    (/** @type {any} */ { unit }, /** @type {number} */ i) => written(unit, (row) => row.others[i].value)) };
  const isRight = useLate(before) ? isRightStill(state, "decision") : () => true;
  /** @param {KeyboardEvent} event */
  const turn = (event) => {
    const step = { ArrowDown: 1, ArrowUp: -1 }[event.key];
    const all = [.../** @type {Element} */ (event.currentTarget).querySelectorAll(".pick")];
    const next = step && all[all.indexOf(/** @type {Element} */ (event.target)) + step];
    if (!next) return;
    event.preventDefault();
    /** @type {HTMLElement} */ (next).focus();
  };
  const table = useRef(/** @type {HTMLElement | null} */ (null));
  const order = rows.map(({ layout }) => layout).join();
  const active = globalThis.document.activeElement;
  const focused = active instanceof HTMLElement && table.current?.contains(active) ? active.title : null;
  useLayoutEffect(() => {
    const picks = [.../** @type {HTMLElement} */ (table.current).querySelectorAll(".pick")];
    /** @type {HTMLElement[]} */ (picks).find(({ title }) => title === focused)?.focus();
  }, [order]);
  useLayoutEffect(() => {
    const box = /** @type {HTMLElement} */ (table.current);
    const show = () => showSelected(box);
    show();
    const sized = new ResizeObserver(show); // as when a message above it takes room
    sized.observe(box);
    return () => sized.disconnect();
  }, [order, document.layout]);
  const { parts, trees, about } = state;
  const sketches = useMemo(() => sketchesOf(state), [document.study.layouts, parts, trees, about]);
  return html`<div class="scroll" role="group" aria-label="Layouts" ref=${table} onKeyDown=${turn}>
    <table><thead><tr><th scope="col">layout</th>
      <th scope="col" title=${goal && withUnit(goal.title, units.goal.unit)}>${
        goal ? withUnit(goal.index, units.goal.unit) : goalOf(state)}</th>
      <th scope="col" title=${`gain on ${baseline}: + is better`}>gain on ${shortLabel(baseline)}</th>
      ${others.map((/** @type {any} */ { index, title }, /** @type {number} */ i) => html`<th scope="col" key=${index}
        title=${withUnit(title, units.others[i].unit)}>${withUnit(index, units.others[i].unit)}</th>`)}</tr></thead>
    <tbody key=${order}>${rows.map((row) => html`<${Row} key=${row.layout}
      store=${store} row=${row} units=${units}
      sketched=${sketches[row.layout] ?? []}
      stale=${!isRight(row.layout)} compared=${isRight(baseline)}
      missing=${is === "coming" ? "…" : "–"} />`)}</tbody></table></div>`;
}

/** Scrolls the ranking, and nothing else, so that the selected layout is seen. @param {HTMLElement} box */
function showSelected(box) {
  const row = /** @type {HTMLElement | null} */ (box.querySelector("tr.on"));
  if (!row) return;
  const below = row.offsetTop + row.offsetHeight - box.clientHeight;
  const head = box.querySelector("thead")?.offsetHeight ?? 0;
  box.scrollTop = Math.min(Math.max(box.scrollTop, below), row.offsetTop - head);
}

/** A layout; `stale` where its numbers are of before, `compared` unless those of the baseline are.
 * @param {{store: Store, row: any, units: any, sketched: import("./sketch.js").Sketched[], stale: boolean,
 * compared: boolean, missing: string}} props */
function Row({ store, row, units, sketched, stale, compared, missing }) {
  const state = store.get();
  const { layout, is_baseline: isBaseline, unchosen = [], others } = row;
  const document = state.history.present;
  const on = layout === document.layout;
  const select = () => on || store.change({ type: "selected", layout });
  const goal = goalOf(state);
  const classes = [on && "on", unchosen.length > 0 && "quiet", stale && "stale", !compared && "apart"].filter(Boolean);
  return html`<tr class=${classes.join(" ")} onClick=${select}>
    <th scope="row"><button type="button" class="pick" aria-pressed=${on} title=${layout}>
      ${sketched.map(({ struts, tree }) => html`<span key=${struts.join()} class="of" title=${struts.join(", ")
        || undefined}><${Sketch} state=${state} tree=${tree} small=${sketched.length > 1} /></span>`)}
      <span style=${{ color: layoutColour(document, layout) }}>${layout}
        ${isBaseline && html`<small aria-hidden="true">baseline</small>`}</span></button></th>
    <td class="number" title=${row.message} data-index=${on ? goal : undefined}
      data-value=${row.value}>${row.value === undefined ? missing : html`<${Measured}
        result=${scaled(row, units.goal.factor)} />`}</td>
    <td class=${`number ${better(row)}`} data-better=${row.improvement_percent}>
      <${Against} row=${{ ...row, status: null }} unchosen=${unchosen.length > 0} /></td>
    ${others.map((/** @type {any} */ other, /** @type {number} */ i) => html`<td
      class=${`number other ${unchosen.length ? "" : better(other)}`} key=${other.index} title=${other.message}
      data-index=${on ? other.index : undefined} data-value=${other.value}>
      <${Against} row=${{ ...other, is_baseline: isBaseline || unchosen.length > 0 }} />
      <div class="scatter">${amountText(units ? scaled(other, units.others[i].factor) : other)}</div></td>`)}
  </tr>`;
}

const LEAST = 0.05; // [%] a standard error that changes what is written

/** By how much the goal is better than of the baseline; first what makes that doubtful.
 * @param {{row: any, unchosen?: boolean}} props */
export function Against({ row: { is_baseline: isBaseline, improvement_percent: value, improvement_error_percent: error,
  improvement_status: difference, status: own, tie }, unchosen = false }) {
  if (unchosen) return html`<span class="quiet wraps">not chosen yet</span>`;
  const none = isBaseline || typeof value !== "number";
  const status = none ? own : difference;
  const told = error >= LEAST ? withError(value, error, 1) : null;
  return html`${isOk(status) ? "" : html`<div class="doubt">${status}</div>`}
    ${none ? null : told === null ? percentChange(value) : html`${value > 0 ? "+" : ""}${told[0]} %
      <div class="scatter">± ${told[1]} %</div>`}${!none && tie && html`<div class="scatter">as good</div>`}`;
}

/** A change in per cent, with its sign. @param {number | null | undefined} value */
export function percentChange(value) {
  if (typeof value !== "number") return "–";
  const size = Math.abs(value);
  if (size < 0.005) return "0 %";
  return `${value < 0 ? "−" : "+"}${size.toFixed(size < 0.1 ? 2 : size < 100 ? 1 : 0)} %`;
}

/** The indices that the study asks for, or those of other symbols. @param {State} state @param {string[]} [symbols]
 * @returns {{symbol: string, title: string}[]} */
export function indicesOf(state, symbols = indicesIn(state.history.present.study)) {
  const known = state.about?.indices ?? [];
  return symbols.map((symbol) =>
    known.find((/** @type {any} */ each) => each.symbol === symbol) ?? ownIndex(symbol));
}

/** An index that the file names: its name is what it is called in words. @param {string} symbol */
export const ownIndex = (symbol) => ({ symbol, title: symbol.replaceAll("-", " ") });

/** Whether the title of an index contains its name, as the library sees it.
 * @param {{symbol: string, title: string}} index */
export const isInTitle = ({ symbol, title }) => title.includes(symbol.replaceAll("-", " "));

/** An index as short as it can be named. @param {{symbol: string, title: string}} index */
export const indexName = (index) => (isInTitle(index) ? index.title : index.symbol);

/** An index in words, after its name unless they contain it. @param {{symbol: string, title: string}} index
 * @param {string} between */
export const indexWords = (index, between) =>
  (isInTitle(index) ? index.title : `${index.symbol}${between}${index.title}`);

/** An index as the title of an axis. @param {string} symbol @param {string} title */
export const indexAxis = (symbol, title) => (isInTitle({ symbol, title }) ? title : `${title} ${symbol}`);

/** What a `Select` of indices has to choose from. @param {{symbol: string, title: string}[]} indices */
export const indexChoices = (indices) => indices.map((index) => [index.symbol, indexWords(index, ": ")]);

/** What the answers of designs are made of: each value, and each limit. @param {any} value
 * @returns {import("../parts/doubts.js").Member[]} */
export const membersOf = (value) =>
  (value?.designs ?? []).flatMap((/** @type {any} */ { name, results, limits = [] }) => [
    ...results.map((/** @type {any} */ { index, status, message }) => ({ of: `${index} of ${name}`, status, message })),
    ...limits.map((/** @type {any} */ { title, status, message }) => ({ of: `${title}, of ${name}`, status, message })),
  ]);

/** A value, above it its status where that is not ok, and below it its standard error where that is more than its
 * other errors.
 * @param {{result: {value: any, status?: any, standard_error?: any, error_bound?: any, decimals?: any}}} props */
export function Measured({ result }) {
  return html`${!isOk(result.status) && html`<div class="doubt">${result.status}</div>`}<${Amount} result=${result} />`;
}

/** @param {{result: {value: any, standard_error?: any, error_bound?: any, decimals?: any}}} props */
function Amount({ result: { value, standard_error: error, error_bound: bound, decimals } }) {
  if (typeof value === "string") return html`${value.replace("inf", "∞")}`;
  if (typeof error !== "number" || !(error > (bound ?? 0) * Math.abs(value))) return html`${toPlaces(value, decimals)}`;
  const [number, scatter] = withError(value, error, decimals ?? Infinity);
  return html`${number}<div class="scatter">± ${scatter}</div>`;
}

/** @param {{value: any}} result */
const amountText = ({ value }) => (typeof value === "string" ? value.replace("inf", "∞") : aligned(value, 4));

/** @param {{improvement_percent?: number | null, improvement_status?: string | null, tie?: boolean | null}} result */
export const better = ({ improvement_percent: value, improvement_status: status, tie }) =>
  (typeof value !== "number" || tie || !isOk(status) || Math.abs(value) < 0.005 ? "" : value > 0 ? "good" : "bad");

/** The goal in each condition of the study: of the selected layout, and of the baseline if that is another one.
 * @param {{state: State, goal: any, row: any, baseline: any}} props */
function Conditions({ state, goal, row, baseline }) {
  const both = [row, ...(baseline && baseline !== row ? [baseline] : [])];
  const values = both.flatMap(({ in_conditions: each }) => each.map((/** @type {any} */ { value }) => value));
  const { unit, factor } = unitFor(state.about, values, goal.unit);
  const heads = [`${withUnit(goal.index, unit)} in condition`, ...both.map(({ name }) => name),
    ...(both.length > 1 ? [`gain on ${baseline.name}`] : [])].map((head) => [head, head]);
  return html`<${Table} label="Conditions" class="conditions" heads=${heads}>
    ${row.in_conditions.map((/** @type {any} */ own, /** @type {number} */ i) => html`<tr key=${own.name}>
      <th scope="row">${own.name}${own.share !== null && html` <small>(${shown(100 * own.share, 3)} %)</small>`}</th>
      ${both.map(({ name, in_conditions: each }) => html`<td class="number" key=${name}
        data-value=${each[i].value}><${Measured} result=${scaled(each[i], factor)} /></td>`)}
      ${both.length > 1 && html`<td class=${`number ${better(own)}`}>
        <${Against} row=${{ ...own, status: null }} unchosen=${row.unchosen.length > 0} /></td>`}</tr>`)}<//>`;
}

/** Why values in the ranking are missing or unreliable, each reason once. @param {{rows: any[], goal: any}} props */
function Reasons({ rows, goal }) {
  const reasons = doubtsIn(rows.flatMap(({ name, others = [], ...own }) => [{ ...own, index: goal?.index }, ...others]
    .filter(({ message }) => message).map(({ index, status, message }) => ({ of: `${index} of ${name}`, status,
      message }))));
  return reasons.length === 0 ? null : html`<ul class="limits" aria-label="Reasons">
    ${reasons.map((reason) => html`<li key=${reason} class="bad">${reason}</li>`)}</ul>`;
}

/** Which limits the design satisfies. @param {{limits: any[]}} props */
function Limits({ limits }) {
  return limits.length === 0
    ? null
    : html`<ul class="limits" aria-label="Limits">
      ${limits.map(({ title, status, kept, sentence }) => html`<li key=${title} class=${!isOk(status) || kept === null
        ? "quiet" : kept ? "good" : "bad"}>${sentence}</li>`)}</ul>`;
}

/** Adding, renaming and removing layouts. @param {{store: Store}} props */
function Layouts({ store }) {
  const document = store.get().history.present;
  const layouts = Object.keys(document.study.layouts ?? {});
  const baseline = baselineOf(document).layout;
  const [renaming, setRenaming] = useState(false);
  return html`<div class="foot layouts">
    <button type="button" title="A new layout like this one"
      onClick=${() => store.change({ type: "layoutAdded", name: nextLayout(document) })}>Add a layout</button>
    ${document.layout && html`<${DropDown} title="This layout">
      <button type="button" onClick=${() => setRenaming(!renaming)}>Rename…</button>
      ${renaming && html`<form onSubmit=${formHandler((form) => {
        const name = String(form.get("name")).trim();
        if (name && !layouts.includes(name)) store.change({ type: "layoutRenamed", name });
        else if (name && name !== document.layout)
          store.say(`Got ${name}, the name of another layout; expected an unused name.`, "layout name");
        setRenaming(false);
      })}>
        <label>New name <input name="name" key=${document.layout} defaultValue=${document.layout}
          autocomplete="off" /></label> <button>Rename</button></form>`}
      <button type="button" disabled=${document.layout === baseline}
        onClick=${() => store.change({ type: "placed", place: ["study", "baseline"],
          value: document.layout })}>Make it the baseline</button>
      <button type="button" disabled=${layouts.length < 2}
        onClick=${() => store.change({ type: "layoutRemoved" })}>Delete it</button>
    <//>`}
    <button type="button" onClick=${() => toSearch(store)}>More networks</button>
    <button type="button" onClick=${() => store.look({ tab: "compare" })}>Compare</button>
  </div>`;
}
