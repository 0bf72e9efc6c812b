// What the design bears: break-even values against the baseline, other speeds, scatter; asked by a button.

import { seek } from "../asking.js";
import { elementsIn, kindOf } from "../library.js";
import { baselineOf, soughtAnswer } from "../questions.js";
import { Moving } from "../parts/clock.js";
import { Select, Table, formHandler } from "../parts/controls.js";
import { doubted, isOk } from "../parts/doubts.js";
import { html } from "../parts/html.js";
import { printed, shown } from "../state/scale.js";
import { indicesOf, signed } from "./answers.js";

/** @import { Store, State } from "../state/store.js" */
/** @import { Api } from "../api.js" */

/** The first of what was computed, for the line of the decision. @param {any} value */
export function marginTold(value) {
  const first = value?.break_even?.find((/** @type {any} */ each) => typeof each.value === "number");
  return first ? first.short : value ? "No break-even value" : "Not computed";
}

/** @param {{store: Store, api: Api}} props */
export function MarginsPanel({ store, api }) {
  const state = store.get();
  const { layout } = state.history.present;
  const { is, value, sentence } = soughtAnswer(state, "margins");
  if (layout === baselineOf(state.history.present).layout) return html`<p class="quiet">${layout} is the baseline:
    select another layout.</p>`;
  return html`<form class="row" aria-busy=${is === "coming"}
      onSubmit=${formHandler(() => void seek(store, api, "margins", {}))}>
      <button class="edged">What does it bear?</button>
      <p role="status">${is === "coming" ? html`<${Moving} what="Simulating" />` : sentence}</p></form>
    ${value && html`<${Margins} value=${value} />`}
    <${Budget} store=${store} api=${api} indices=${indicesOf(state)} />`;
}

/** @param {{value: any}} props */
function Margins({ value: { break_even: rows = [], speeds = [], scatter, caveats = [] } }) {
  return html`${caveats.length > 0 && html`<div class="doubts problem" role="alert">
      ${caveats.map((/** @type {any} */ { sentence }) => html`<p key=${sentence}>${sentence}</p>`)}</div>`}
    ${rows.map((/** @type {any} */ { parameter, sentence, message, status }) => html`<p key=${parameter}
      class=${isOk(status) || status === "unbounded" ? "" : "problem"}>${sentence || message}</p>`)}
    ${speeds.length > 0 && html`<${Table} label="Other speeds" heads=${["speed", "against the baseline"]}>
      ${speeds.map((/** @type {any} */ { factor, improvement_percent: better, status }) => html`<tr key=${factor}>
        <th scope="row">${signed(100 * (factor - 1), 0)}</th>
        <td class="number">${isOk(status) ? "" : `${status}: `}${signed(better)}</td></tr>`)}<//>`}
    ${scatter?.sentence && html`<p>${scatter.sentence}</p>`}`;
}

/** How much of an element the design bears before the baseline is as good.
 * @param {{store: Store, api: Api, indices: {symbol: string, title: string}[]}} props */
function Budget({ store, api, indices }) {
  const state = store.get();
  const document = state.history.present;
  const names = elementsIn(state, document.layout);
  if (names.length === 0 || indices.length === 0) return null;
  const switching = names.find((name) => kindOf(state, name)?.switches) ?? names[0];
  const { is, value, sentence } = soughtAnswer(state, "budget");
  return html`<section class="budget"><h3>Break-even value of one element</h3>
    <form class="row" aria-busy=${is === "coming"} onSubmit=${formHandler((form) =>
      void seek(store, api, "budget", { index: form.get("index"), parameter: form.get("parameter") }))}>
    <${Select} label="Element" name="parameter" key=${document.layout} choices=${names} selected=${switching} />
    <${Select} label="index" name="index" choices=${indices.map(({ symbol }) => symbol)} />
    <button class="edged">Compute</button>
    <p role="status">${is === "coming" ? html`<${Moving} what="Simulating" />` : value
      ? budgetTold(value, document.layout, baselineOf(document).layout) : sentence}</p>
  </form></section>`;
}

/** What a budget says, first whether it can be relied on. @param {any} found @param {string} layout
 * @param {string} baseline */
export function budgetTold({ parameter, value, unit, standard_error, status, message }, layout, baseline) {
  if (typeof value !== "number") return message || "There is no break-even value.";
  const error = standard_error ? ` ± ${shown(standard_error, 2)}` : "";
  const doubts = doubted([{ of: "the budget", status, message }]);
  return `${doubts}At ${parameter} = ${shown(value)}${error} ${printed(unit)}, ${layout} is as good as ${baseline}.`;
}
