// What scatter of its elements makes of an index of the design, and which of them matters.

import { seekNow } from "../asking.js";
import { elementsIn } from "../library.js";
import { designOf, soughtAnswer, soughtOf } from "../questions.js";
import { Moving } from "../parts/clock.js";
import { Doubts, Unchosen } from "../parts/doubts.js";
import { Name, Select, Table, formHandler } from "../parts/controls.js";
import { html } from "../parts/html.js";
import { Plot } from "../plot.js";
import { download } from "../remembering.js";
import { withError, shown, times, unitFor, withUnit } from "../state/scale.js";
import { indexAxis, indexChoices, indicesOf } from "./answers.js";

/** @import { Store, State } from "../state/store.js" */
/** @import { Api } from "../api.js" */

const USUAL = 10; // [%] that a value lies above or below its own at the most

/** @param {{store: Store, api: Api}} props */
export function TolerancePanel({ store, api }) {
  const state = store.get();
  const document = state.history.present;
  const indices = indicesOf(state);
  const names = elementsIn(state, document.layout);
  const answer = soughtAnswer(state, "tolerance");
  const { is, value, sentence } = answer;
  if (names.length === 0 || indices.length === 0) return html`<p
    class="quiet">There is no element, or no index, to analyse.</p>`;
  const save = async () => download(
    await api.blob("export/csv", { panel: "tolerance", request: soughtOf(state, "tolerance")?.body }),
    `tolerance-${value.index}.csv`);
  return html`<form aria-busy=${is === "coming"} onSubmit=${formHandler((form) =>
    void seekNow(store, api, "tolerance", { index: form.get("index"), spread: spreadOf(names, form) }))}>
    <p class="quiet">Relative tolerance of each value of ${document.layout}: the half-width, uniformly distributed. A
      value without one is held.</p>
    <div class="row spreads">
      ${names.map((name) => html`<label key=${name}><span>
        <span class="symbol-name"><${Name} label=${name} /></span> ±</span> <input name=${`spread ${name}`}
          class="short" type="number" min="0" max="99" step="any"
          defaultValue=${USUAL} /> %</label>`)}</div>
    <div class="row"><${Select} label="Index" name="index" choices=${indexChoices(indices)} />
      ${" "}<button class="edged">Compute</button></div>
    <p role="status">${is === "coming" ? html`<${Moving} what="Under way" />` : sentence}</p>
  </form>
  <${Unchosen} state=${state} designs=${[designOf(document)]} />
  ${value &&
    html`<${Scattered} about=${state.about} value=${value}
      title=${indices.find(({ symbol }) => symbol === value.index)?.title ?? ""} />
    <p class="row"><button type="button" onClick=${save}>Save (CSV)</button></p>`}`;
}

/** By what part of themselves values scatter. @param {string[]} names @param {FormData} form */
function spreadOf(names, form) {
  const parts = names.map((name) => [name, Number(form.get(`spread ${name}`)) / 100]);
  return Object.fromEntries(parts.filter(([, part]) => Number(part) > 0));
}

/** @param {{about: any, value: any, title: string}} props  `title`: of the index */
function Scattered({ about, value, title }) {
  const errors = value.standard_errors;
  const rows = [
    ["nominal", value.nominal],
    ["mean", value.mean, errors.mean],
    ["standard deviation", value.standard_deviation, errors.standard_deviation],
    ["95th percentile", value.quantiles["0.95"], errors["0.95"]],
    ["worst case", value.worst],
  ];
  const { unit, factor } = unitFor(about, [value.nominal], value.unit);
  const names = Object.keys(value.total ?? {}).toSorted((a, b) => (value.total[b] ?? 0) - (value.total[a] ?? 0));
  return html`<${Doubts}
    members=${[{ of: `the scatter of ${value.index}`, status: value.status, message: value.message }]} />
    <div class="scattered">
      <${Table} label="Distribution" data-scatter=${value.index}
        heads=${[`${withUnit(value.index, unit)}, ${value.method.replaceAll("-", " ")}`, "value"]}>
        ${rows.map(([what, number, error]) => html`<tr key=${what}><th scope="row">${what}</th>
          <td class="number" data-value=${number}>${error > 0
            ? withError(number * factor, error * factor).join(" ± ") : shown(times(number, factor))}</td></tr>`)}
      <//>
      ${value.histogram.counts.some((/** @type {number} */ count) => count > 0) && html`<${Plot} plot=${{
        title: `Distribution of ${value.index}`, curves: [],
        x: { what: indexAxis(value.index, title), unit: value.unit },
        y: { what: "number of samples", unit: "", zero: true }, bars: value.histogram,
        marks: [{ x: value.nominal, text: "nominal" }],
      }} />`}
      <${Table} label="Which value matters" heads=${[["Sobol' index of"],
        ["first order", "first-order Sobol' index: effect of the value alone"],
        ["total order", "total-order Sobol' index: with all interactions"], [""]]}>
        ${names.map((name) => html`<tr key=${name}><th scope="row">${name}</th>
          <td class="number">${share(value.main[name])}</td><td class="number">${share(value.total[name])}</td>
          <td class="measure"><span class="measured"
            style=${{ width: `${100 * Math.min(1, Math.max(0, value.total[name] ?? 0))}%` }}></span></td></tr>`)}
      <//>
    </div>`;
}

/** A share of the variance, whose estimate has no error bound, in whole per cent. @param {number | null} part */
const share = (part) => (part === null ? "–" : `${Math.round(100 * part)} %`.replace("-", "−"));
