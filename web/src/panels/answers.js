// The indices of the strut beside the baseline, and what may be done about them at once.

import { kindOf } from "../kinds.js";
import { isQuick, judging, methodsOf, quickMethod } from "../methods.js";
import { baselineOf, designOf } from "../questions.js";
import { namesIn } from "../state/document.js";
import { estimated, placed, printed, shown, withUnit } from "../state/scale.js";
import { html, useState } from "../parts/html.js";
import { useShown } from "../parts/shown.js";
import { AskedPanel } from "./asked.js";
import { otherProblems } from "./values.js";
import { optimise } from "../working.js";

/** @typedef {import("../state/store.js").Store} Store */
/** @typedef {import("../state/store.js").State} State */

/** @param {{store: Store, api: import("../api.js").Api}} props */
export function AnswersPanel({ store, api }) {
  const state = store.get();
  const { value, sentence, waiting } = state.answers.indices ?? {};
  const document = state.history.present;
  const baseline = baselineOf(document).layout;
  const problems = state.answers.check?.value?.problems ?? [];
  useShown("indices", state);
  return html`<section class="panel answers" aria-labelledby="answers-title" aria-busy=${waiting === true}>
    <h2 id="answers-title">Answers</h2>
    <div class="row">
      <label>Judged <select value=${judging(state)?.name} onChange=${(/** @type {Event} */ event) => store.dispatch({ type: "viewed", view: { method: /** @type {HTMLSelectElement} */ (event.currentTarget).value } })}>
        ${methodsOf(state).map((method) => html`<option key=${method.name} value=${method.name}>${methodTitle(method)}</option>`)}
      </select></label>
    </div>
    ${sentence && problems.length === 0 && html`<p class="problem" role="alert">${sentence}</p>`}
    ${sentence && value && html`<p class="quiet">The values below are those of before.</p>`}
    ${value && html`<${Indices} value=${value} layout=${document.layout} baseline=${baseline} stale=${Boolean(sentence)} />`}
    <${Limits} value=${value} />
    <${AskedPanel} store=${store} />
    <${Optimise} store=${store} api=${api} indices=${indicesOf(state)} />
    <${Budget} store=${store} api=${api} indices=${indicesOf(state)} />
    <${OtherProblems} state=${state} />
  </section>`;
}

/** @param {import("../methods.js").Method} method */
export function methodTitle({ name, sees }) {
  const words = { neither: "without friction and gaps", friction: "with friction", both: "with friction and gaps" }[sees] ?? "";
  return `${words || name} (${name.replaceAll("-", " ")})`;
}

/** The indices that the study asks for. @param {State} state @returns {{symbol: string, title: string}[]} */
export function indicesOf(state) {
  const asked = state.history.present.study.study?.indices ?? [];
  const known = state.about?.indices ?? [];
  return asked.map((/** @type {string} */ symbol) => known.find((/** @type {any} */ each) => each.symbol === symbol) ?? { symbol, title: symbol });
}

/** @param {{value: any, layout: string, baseline: string, stale: boolean}} props */
function Indices({ value, layout, baseline, stale }) {
  const design = value.designs?.find((/** @type {any} */ each) => each.layout === layout) ?? value.designs?.[0];
  const other = value.designs?.find((/** @type {any} */ each) => each.layout === baseline);
  if (!design) return null;
  const alone = layout === baseline;
  return html`<div class="scroll" tabindex="0" role="region" aria-label="Indices"><table class=${stale ? "stale" : ""} data-sequence=${value.sequence}>
    <thead><tr><th scope="col">index</th><th scope="col" title=${layout}>${layout}</th>${!alone && html`<th scope="col" title=${`${baseline}, the baseline`}>${baseline} ★</th><th scope="col">better by</th>`}</tr></thead>
    <tbody>${design.results.map((/** @type {any} */ result) => {
      const reference = other?.results?.find((/** @type {any} */ each) => each.index === result.index);
      return html`<tr key=${result.index}>
        <th scope="row"><b>${result.index}</b> <span class="quiet">${withUnit(result.title, result.unit)}</span> <${Notes} result=${result} /></th>
        <td class="number" data-index=${result.index} data-value=${result.value}><${Measured} result=${result} /></td>
        ${!alone && html`<td class="number">${reference ? html`<${Measured} result=${reference} />` : "–"}</td><td class=${`number ${better(result)}`}><${Improvement} result=${result} />${result.tie ? html`<div class="scatter">as good</div>` : null}</td>`}
      </tr>`;
    })}</tbody>
  </table></div>`;
}

/** A value, and below it its standard error where that is more than its other errors. @param {{result: {value: any, standard_error?: any, error_bound?: any, decimals?: any}}} props */
export function Measured({ result: { value, standard_error: error, error_bound: bound, decimals } }) {
  if (typeof value === "string") return html`${value.replace("inf", "∞")}`;
  if (typeof error !== "number" || !(error > (bound ?? 0) * Math.abs(value))) return html`${placed(value, decimals)}`;
  const [number, scatter] = estimated(value, error, decimals ?? Infinity);
  return html`${number}<div class="scatter">± ${scatter}</div>`;
}

/** By how much it is better, and below that the standard error. @param {{result: any}} props */
function Improvement({ result: { improvement_percent: value, improvement_error_percent: error } }) {
  if (typeof value !== "number" || !error) return html`${percent(value)}`;
  const [number, scatter] = estimated(value, error);
  return html`${number} %<div class="scatter">± ${scatter} %</div>`;
}

/** @param {number | null | undefined} value @param {number | null} [error] */
export function percent(value, error) {
  if (value === null || value === undefined) return "–";
  if (error) return `${estimated(value, error).join(" ± ")} %`;
  const size = Math.abs(value);
  return `${value < 0 ? "−" : ""}${size < 100 ? size.toFixed(2) : size.toFixed(0)} %`;
}

/** @param {{improvement_percent?: number | null, tie?: boolean | null}} result */
const better = ({ improvement_percent: value, tie }) => (typeof value !== "number" || tie || Math.abs(value) < 0.005 ? "" : value > 0 ? "good" : "bad");

/** @param {{result: any}} props */
function Notes({ result }) {
  const texts = [result.status !== "ok" && result.message, ...(result.notes ?? [])].filter(Boolean);
  return texts.length === 0 ? null : html`<details class="notes"><summary>note</summary><ul>${texts.map((text) => html`<li>${text}</li>`)}</ul></details>`;
}

/** Which limits are kept. @param {{value: any}} props */
function Limits({ value }) {
  const limits = value?.designs?.[0]?.limits ?? [];
  return limits.length === 0
    ? null
    : html`<h3>Limits</h3><ul class="limits">${limits.map((/** @type {any} */ limit) => html`<li key=${limit.title} class=${LIMIT_CLASSES[limit.kept]}>${LIMIT_WORDS[limit.kept]}: ${limit.title}${limit.text && `; it is ${limit.text}`}${limit.message && ` (${limit.message})`}</li>`)}</ul>`;
}

/** @type {{[kept: string]: string}} */
const LIMIT_WORDS = { true: "kept", false: "broken", null: "not known" };
/** @type {{[kept: string]: string}} */
const LIMIT_CLASSES = { true: "good", false: "bad", null: "quiet" };

/** @param {{store: Store, api: import("../api.js").Api, indices: {symbol: string, title: string}[]}} props */
function Optimise({ store, api, indices }) {
  const state = store.get();
  const { study, layout } = state.history.present;
  const [index, setIndex] = useState("");
  const [told, setTold] = useState("");
  const chosen = indices.some(({ symbol }) => symbol === index) ? index : indices[0]?.symbol;
  const here = judging(state);
  const method = here?.searches ? here : quickMethod(state);
  if (!chosen || !method) return null;
  return html`<form class="row optimise" onSubmit=${async (/** @type {SubmitEvent} */ event) => {
    event.preventDefault();
    const all = /** @type {SubmitEvent} */ (event).submitter?.getAttribute("value") === "all";
    setTold("Searching…");
    setTold(await optimise(store, api, { study, layouts: all ? Object.keys(study.layouts ?? {}) : [layout], index: chosen, method: method.name }));
  }}>
    <label>Best values for <select name="index" value=${chosen} onChange=${(/** @type {Event} */ event) => setIndex(/** @type {HTMLSelectElement} */ (event.currentTarget).value)}>
      ${indices.map(({ symbol, title }) => html`<option key=${symbol} value=${symbol}>${symbol}: ${title}</option>`)}
    </select></label>
    <button class="main" value="one">Optimise</button> <button value="all">All layouts</button>
    <p class="quiet" role="status">${told}</p>
  </form>`;
}

/** How much of an element the design bears before the baseline is as good. @param {{store: Store, api: import("../api.js").Api, indices: {symbol: string, title: string}[]}} props */
function Budget({ store, api, indices }) {
  const state = store.get();
  const document = state.history.present;
  const [told, setTold] = useState("");
  const names = namesIn(document.study, document.layout);
  if (names.length === 0 || indices.length === 0 || document.layout === baselineOf(document).layout) return null;
  const switching = names.find((name) => kindOf(state, name)?.switches) ?? names[0];
  return html`<details class="budget"><summary>What it bears</summary><form class="row" onSubmit=${async (/** @type {SubmitEvent} */ event) => {
    event.preventDefault();
    const form = new FormData(/** @type {HTMLFormElement} */ (event.currentTarget));
    const body = { study: document.study, design: designOf(document), baseline: baselineOf(document), index: form.get("index"), parameter: form.get("parameter"), ...seeing(state) };
    setTold("Simulating…");
    try {
      setTold(budgetTold(await api.post("panel/budget", { ...body, client: "page.budget", sequence: Date.now() }), document.layout, baselineOf(document).layout));
    } catch (error) {
      setTold(/** @type {Error} */ (error).message);
    }
  }}>
    <label>How much of <select name="parameter" key=${document.layout} defaultValue=${switching}>${names.map((name) => html`<option key=${name} selected=${name === switching}>${name}</option>`)}</select></label>
    <label>by <select name="index">${indices.map(({ symbol }) => html`<option key=${symbol}>${symbol}</option>`)}</select></label>
    <button>Find out</button>
    <p role="status">${told}</p>
  </form></details>`;
}

/** The method by which the page judges, where it sees what a budget is about; else that of the study. @param {State} state */
function seeing(state) {
  const method = judging(state);
  return !method || isQuick(method) ? {} : { method: method.name };
}

/** @param {any} found @param {string} layout @param {string} baseline */
function budgetTold({ parameter, value, unit, standard_error, status, message }, layout, baseline) {
  if (typeof value !== "number") return message || "There is no such value.";
  const error = standard_error ? ` ± ${shown(standard_error, 2)}` : "";
  return `At ${parameter} = ${shown(value)}${error} ${printed(unit)}, ${layout} is as good as ${baseline}.${status === "ok" ? "" : ` ${message}`}`;
}

/** What is wrong with the study at places that have no field on the page. @param {{state: State}} props */
function OtherProblems({ state }) {
  const problems = otherProblems(state);
  /** A sentence that begins with its place needs no other. @param {{place: string[], sentence: string}} problem */
  const placed = ({ place, sentence }) => (sentence.startsWith(place.join(".")) ? "" : html`<code>${place.join(".")}</code> `);
  return problems.length === 0
    ? null
    : html`<div class="problems" role="alert"><h3>In the study</h3><ul>${problems.map((/** @type {any} */ problem) => html`<li class="problem">${placed(problem)}${problem.sentence}</li>`)}</ul></div>`;
}
