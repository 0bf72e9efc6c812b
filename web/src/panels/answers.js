// The indices of the strut beside the baseline, and what may be done about them at once.

import { elementsIn, kindOf } from "../library.js";
import { seek } from "../asking.js";
import { judging, methodsOf, quickMethod } from "../methods.js";
import { answerOf, baselineOf, shownDesigns, soughtAnswer } from "../questions.js";
import { estimated, placed, printed, shown, withUnit } from "../state/scale.js";
import { Being, Moving } from "../parts/clock.js";
import { Doubts, Unchosen, doubted, isOk } from "../parts/doubts.js";
import { Select, Table, useChoice, formHandler } from "../parts/controls.js";
import { html, useState } from "../parts/html.js";
import { useShown } from "../parts/shown.js";
import { AskedPanel } from "./asked.js";
import { otherProblems, problemsOf } from "./values.js";
import { optimise } from "../working.js";

/** @import { Store, State } from "../state/store.js" */
/** @import { Api } from "../api.js" */
/** @import { Document } from "../state/document.js" */

/** @param {{store: Store, api: Api}} props */
export function AnswersPanel({ store, api }) {
  const state = store.get();
  const shown = answerOf(state, "indices");
  const { value, sentence } = shown;
  const document = state.history.present;
  const baseline = baselineOf(document).layout;
  const problems = problemsOf(state);
  useShown("indices", state);
  return html`<section class="panel answers" aria-labelledby="answers-title" aria-busy=${shown.is === "coming"}>
    <div class="head"><h2 id="answers-title">Answers</h2><${Being} shown=${shown} /></div>
    <div class="row"><${Select} label="Judged" value=${judging(state)?.name}
      choices=${methodsOf(state).map((method) => [method.name, methodTitle(method)])}
      set=${(/** @type {string} */ method) => store.look({ method })} /></div>
    ${sentence && problems.length === 0 && html`<p class="problem" role="alert">${sentence}</p>`}
    <${Unchosen} state=${state} designs=${shownDesigns(document)} />
    <${Doubts} members=${membersOf(value)} />
    <${Indices} state=${state} shown=${shown} layout=${document.layout} baseline=${baseline} />
    <${Limits} value=${value} />
    <${AskedPanel} store=${store} />
    <${Optimise} store=${store} api=${api} indices=${indicesOf(state)} />
    <${Budget} store=${store} api=${api} indices=${indicesOf(state)} />
    <${OtherProblems} state=${state} />
  </section>`;
}

/** @param {import("../methods.js").Method} method */
export function methodTitle({ name, sees }) {
  const words = { neither: "without friction and gaps", friction: "with friction",
    both: "with friction and gaps" }[sees] ?? "";
  return `${words || name} (${name.replaceAll("-", " ")})`;
}

/** The indices that the study asks for. @param {State} state @returns {{symbol: string, title: string}[]} */
export function indicesOf(state) {
  const asked = state.history.present.study.study?.indices ?? [];
  const known = state.about?.indices ?? [];
  return asked.map((/** @type {string} */ symbol) => known.find((/** @type {any} */ each) => each.symbol === symbol)
    ?? { symbol, title: symbol });
}

/** What a `Select` of indices has to choose from. @param {{symbol: string, title: string}[]} indices */
export const indexChoices = (indices) => indices.map(({ symbol, title }) => [symbol, `${symbol}: ${title}`]);

/** What the answers of designs are made of: each value, and each limit. @param {any} value
 * @returns {import("../parts/doubts.js").Member[]} */
export const membersOf = (value) =>
  (value?.designs ?? []).flatMap((/** @type {any} */ { name, results, limits = [] }) => [
    ...results.map((/** @type {any} */ { index, status, message }) => ({ of: `${index} of ${name}`, status, message })),
    ...limits.map((/** @type {any} */ { title, status, message }) => ({ of: `${title}, of ${name}`, status, message })),
  ]);

/** The indices of the study: each with its value, or with a mark in its place.
 * @param {{state: State, shown: import("../state/answers.js").Shown, layout: string, baseline: string}} props */
function Indices({ state, shown: { is, value, before }, layout, baseline }) {
  const design = value?.designs?.find((/** @type {any} */ each) => each.layout === layout);
  const other = value?.designs?.find((/** @type {any} */ each) => each.layout === baseline);
  const alone = layout === baseline;
  const rows = design?.results ?? indicesOf(state).map(({ symbol, title }) => ({ index: symbol, title, unit: null }));
  if (rows.length === 0 || layout === "") return null;
  const missing = is === "coming" ? "…" : "–";
  /** @param {any} result */
  const measured = (result) => (result ? html`<${Measured} result=${result} />` : missing);
  const heads = [["index"], [layout, layout],
    ...(alone ? [] : [[`${baseline} ★`, `${baseline}, the baseline`], ["better by"]])];
  return html`<${Table} label="Indices" class=${before ? "stale" : ""} heads=${heads}>
    ${rows.map((/** @type {any} */ result) => {
      const reference = other?.results?.find((/** @type {any} */ each) => each.index === result.index);
      return html`<tr key=${result.index}>
        <th scope="row"><b>${result.index}</b> <span class="quiet">${withUnit(result.title, result.unit)}</span>
          ${" "}${design && html`<${Notes} result=${result} />`}</th>
        <td class="number" data-index=${result.index} data-value=${result.value}>${measured(design && result)}</td>
        ${!alone && html`<td class="number">${measured(reference)}</td>
          <td class=${`number ${better(result)}`} data-better=${result.improvement_percent}>
            ${design && other ? html`<${Improvement} result=${result}
              unchosen=${[design, other].some(({ unchosen }) => unchosen.length > 0)} />` : missing}${result.tie
                ? html`<div class="scatter">as good</div>` : null}</td>`}
      </tr>`;
    })}<//>`;
}

/** A value, above it its status where that is not ok, and below it its standard error where that is more than its
 * other errors.
 * @param {{result: {value: any, status?: any, standard_error?: any, error_bound?: any, decimals?: any}}} props */
export function Measured({ result }) {
  return html`${!isOk(result.status) && html`<div class="doubt">${result.status}</div>`}<${Amount} result=${result} />`;
}

/** @param {{result: {value: any, standard_error?: any, error_bound?: any, decimals?: any}}} props */
function Amount({ result: { value, standard_error: error, error_bound: bound, decimals } }) {
  if (typeof value === "string") return html`${value.replace("inf", "∞")}`;
  if (typeof error !== "number" || !(error > (bound ?? 0) * Math.abs(value))) return html`${placed(value, decimals)}`;
  const [number, scatter] = estimated(value, error, decimals ?? Infinity);
  return html`${number}<div class="scatter">± ${scatter}</div>`;
}

/** By how much it is better, and below that the standard error; first what makes that doubtful.
 * @param {{result: any, unchosen: boolean}} props */
function Improvement({ result: { improvement_percent: value, improvement_error_percent: error,
  improvement_status: status }, unchosen }) {
  if (unchosen) return html`<span class="quiet wraps">not chosen yet</span>`;
  const doubt = isOk(status) ? null : html`<div class="doubt">${status}</div>`;
  if (typeof value !== "number" || !error) return html`${typeof value === "number" && doubt}${percent(value)}`;
  const [number, scatter] = estimated(value, error);
  return html`${doubt}${number} %<div class="scatter">± ${scatter} %</div>`;
}

/** @param {number | null | undefined} value @param {number | null} [error] */
export function percent(value, error) {
  if (value === null || value === undefined) return "–";
  if (error) return `${estimated(value, error).join(" ± ")} %`;
  const size = Math.abs(value);
  return `${value < 0 ? "−" : ""}${size < 100 ? size.toFixed(2) : size.toFixed(0)} %`;
}

/** @param {{improvement_percent?: number | null, improvement_status?: string | null, tie?: boolean | null}} result */
const better = ({ improvement_percent: value, improvement_status: status, tie }) =>
  (typeof value !== "number" || tie || !isOk(status) || Math.abs(value) < 0.005 ? "" : value > 0 ? "good" : "bad");

/** @param {{result: any}} props */
function Notes({ result }) {
  const texts = [result.status !== "ok" && result.message, ...(result.notes ?? [])].filter(Boolean);
  return texts.length === 0 ? null : html`<details class="notes"><summary>note</summary><ul>
    ${texts.map((text) => html`<li>${text}</li>`)}</ul></details>`;
}

/** Which limits are kept. @param {{value: any}} props */
function Limits({ value }) {
  const limits = value?.designs?.[0]?.limits ?? [];
  return limits.length === 0
    ? null
    : html`<h3>Limits</h3><ul class="limits">
      ${limits.map((/** @type {any} */ limit) => html`<li key=${limit.title}
        class=${isOk(limit.status) ? LIMIT_CLASSES[limit.kept] : "quiet"}>
          ${!isOk(limit.status) && `${limit.status}: `}${LIMIT_WORDS[limit.kept]}: ${limit.title}${limit.text
            && `; it is ${limit.text}`}${limit.message && ` (${limit.message})`}</li>`)}</ul>`;
}

/** @type {{[kept: string]: string}} */
const LIMIT_WORDS = { true: "kept", false: "broken", null: "not known" };
/** @type {{[kept: string]: string}} */
const LIMIT_CLASSES = { true: "good", false: "bad", null: "quiet" };

/** @param {{store: Store, api: Api, indices: {symbol: string, title: string}[]}} props */
function Optimise({ store, api, indices }) {
  const state = store.get();
  const { study, layout } = state.history.present;
  const [chosen, setIndex] = useChoice(indices.map(({ symbol }) => symbol));
  const nothing = { text: "", of: null };
  const [told, setTold] = useState(/** @type {{text: any, of: Document | null}} */ (nothing));
  const here = judging(state);
  const method = here?.searches ? here : quickMethod(state);
  if (!chosen || !method) return null;
  return html`<form class="row optimise" onSubmit=${formHandler(async (_, { submitter }) => {
    const all = submitter?.getAttribute("value") === "all";
    setTold({ text: html`<${Moving} what="Searching" />`, of: state.history.present });
    const text = await optimise(store, api, { study, layouts: all ? Object.keys(study.layouts ?? {}) : [layout],
      index: chosen, method: method.name });
    const { present } = store.get().history;
    setTold(present.study === study ? { text, of: present } : nothing);
  })}>
    <${Select} label="Best values for" name="index" value=${chosen} choices=${indexChoices(indices)} set=${setIndex} />
    <button class="main" value="one">Optimise</button> <button value="all">All layouts</button>
    <p class="quiet" role="status">${told.of === state.history.present && told.text}</p>
  </form>`;
}

/** How much of an element the design bears before the baseline is as good.
 * @param {{store: Store, api: Api, indices: {symbol: string, title: string}[]}} props */
function Budget({ store, api, indices }) {
  const state = store.get();
  const document = state.history.present;
  const names = elementsIn(state, document.layout);
  const baseline = baselineOf(document).layout;
  if (names.length === 0 || indices.length === 0 || document.layout === baseline) return null;
  const switching = names.find((name) => kindOf(state, name)?.switches) ?? names[0];
  const { is, value, sentence } = soughtAnswer(state, "budget");
  return html`<details class="budget"><summary>Break-even values</summary>
    <form class="row" aria-busy=${is === "coming"} onSubmit=${formHandler((form) =>
      void seek(store, api, "budget", { index: form.get("index"), parameter: form.get("parameter") }))}>
    <${Select} label="How much of" name="parameter" key=${document.layout} choices=${names} selected=${switching} />
    <${Select} label="by" name="index" choices=${indices.map(({ symbol }) => symbol)} />
    <button>Compute</button>
    <p role="status">${is === "coming" ? html`<${Moving} what="Simulating" />` : value
      ? budgetTold(value, document.layout, baseline) : sentence}</p>
  </form></details>`;
}

/** What a budget says, first whether it can be relied on. @param {any} found @param {string} layout
 * @param {string} baseline */
export function budgetTold({ parameter, value, unit, standard_error, status, message }, layout, baseline) {
  if (typeof value !== "number") return message || "There is no break-even value.";
  const error = standard_error ? ` ± ${shown(standard_error, 2)}` : "";
  const doubts = doubted([{ of: "the budget", status, message }]);
  return `${doubts}At ${parameter} = ${shown(value)}${error} ${printed(unit)}, ${layout} is as good as ${baseline}.`;
}

/** What is wrong with the study at places that have no field on the page. @param {{state: State}} props */
function OtherProblems({ state }) {
  const problems = otherProblems(state);
  /** A sentence that begins with its place needs no other. @param {{place: string[], sentence: string}} problem */
  const placed = ({ place, sentence }) => (sentence.startsWith(place.join(".")) ? "" : html`<code>${place.join(".")}
    </code> `);
  return problems.length === 0
    ? null
    : html`<div class="problems" role="alert"><h3>In the study</h3><ul>
      ${problems.map((problem) => html`<li class="problem">${placed(problem)}${problem.sentence}
        </li>`)}</ul></div>`;
}
