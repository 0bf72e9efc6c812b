// What scatter of its elements makes of an index of the design, and which of them matters.

import { isQuick, judging } from "../methods.js";
import { designOf } from "../questions.js";
import { html, useState } from "../parts/html.js";
import { download } from "../remembering.js";
import { namesIn } from "../state/document.js";
import { shown, withUnit } from "../state/scale.js";
import { indicesOf, percent } from "./answers.js";

/** @typedef {import("../state/store.js").Store} Store */
/** @typedef {import("../state/store.js").State} State */
/** @typedef {import("../api.js").Api} Api */

const USUAL = 10; // [%] that a value lies above or below its own at the most
const DESIGNS = 10_000; // that are judged while one waits, by norms, and a quarter of them by what takes longer
const [FEWEST, MOST] = [64, 1024]; // samples, a power of two

/** @param {{store: Store, api: Api}} props */
export function TolerancePanel({ store, api }) {
  const state = store.get();
  const document = state.history.present;
  const [found, setFound] = useState(/** @type {{of: string, body: object, value: any} | null} */ (null));
  const [told, setTold] = useState("");
  const indices = indicesOf(state);
  const names = namesIn(document.study, document.layout);
  const of = JSON.stringify([document.study, designOf(document)]);
  if (names.length === 0 || indices.length === 0) return html`<p class="quiet">There is no element, or no index, to be asked about.</p>`;
  return html`<form onSubmit=${async (/** @type {SubmitEvent} */ event) => {
    event.preventDefault();
    const form = new FormData(/** @type {HTMLFormElement} */ (event.currentTarget));
    const spread = spreadOf(names, form);
    const body = { study: document.study, design: designOf(document), index: form.get("index"), spread, ...effortOf(state, Object.keys(spread).length) };
    setTold("Under way…");
    try {
      setFound({ of, body, value: await api.post("panel/tolerance", { ...body, client: "page.tolerance", sequence: Date.now() }) });
      setTold("");
    } catch (error) {
      setTold(/** @type {Error} */ (error).message);
    }
  }}>
    <p class="quiet">How far each value of ${document.layout} may lie above or below its own; all between is equally likely. What is empty does not scatter.</p>
    <div class="row spreads">${names.map((name) => html`<label key=${name}><span>${name} ±</span> <input name=${`spread ${name}`} class="short" type="number" min="0" max="99" step="any" defaultValue=${USUAL} /> %</label>`)}</div>
    <div class="row"><label>Index <select name="index">${indices.map(({ symbol, title }) => html`<option key=${symbol} value=${symbol}>${symbol}: ${title}</option>`)}</select></label> <button>Find out</button></div>
    <p role="status">${told}</p>
  </form>
  ${found && found.of !== of && html`<p class="quiet">These are the values of the design before it was changed.</p>`}
  ${found &&
    html`<${Scattered} value=${found.value} />
    <p class="row"><button type="button" onClick=${async () => download(await api.blob("export/csv", { panel: "tolerance", request: found.body }), `tolerance-${found.value.index}.csv`)}>Save (CSV)</button></p>`}`;
}

/** By what part of themselves values scatter. @param {string[]} names @param {FormData} form */
function spreadOf(names, form) {
  const parts = names.map((name) => [name, Number(form.get(`spread ${name}`)) / 100]);
  return Object.fromEntries(parts.filter(([, part]) => Number(part) > 0));
}

/** The method that the page judges by, unless it averages over roads, and as many samples as a wait allows. @param {State} state @param {number} scattering how many values scatter */
function effortOf(state, scattering) {
  const method = judging(state);
  const quick = !method || method.averages || isQuick(method);
  const samples = 2 ** Math.floor(Math.log2((quick ? DESIGNS : DESIGNS / 4) / (2 + scattering)));
  return { ...(method && !method.averages ? { method: method.name } : {}), samples: Math.min(MOST, Math.max(FEWEST, samples)) };
}

/** @param {{value: any}} props */
function Scattered({ value }) {
  const rows = [
    ["as it is", value.nominal],
    ["mean", value.mean],
    ["standard deviation", value.standard_deviation],
    ["95 % stay below", value.quantiles["0.95"]],
    ["worst that was found", value.worst],
  ];
  const names = Object.keys(value.total ?? {}).toSorted((a, b) => (value.total[b] ?? 0) - (value.total[a] ?? 0));
  return html`${value.status !== "ok" && value.message && html`<p class="problem" role="alert">${value.message}</p>`}
    <div class="scattered">
      <div class="scroll" tabindex="0" role="region" aria-label="Distribution"><table data-scatter=${value.index}>
        <thead><tr><th scope="col">${withUnit(value.index, value.unit)}, ${value.method.replaceAll("-", " ")}</th><th scope="col">value</th></tr></thead>
        <tbody>${rows.map(([title, number]) => html`<tr key=${title}><th scope="row">${title}</th><td class="number" data-value=${number}>${shown(number)}</td></tr>`)}</tbody>
      </table></div>
      <${Histogram} histogram=${value.histogram} title=${`Distribution of ${value.index}`} />
      <div class="scroll" tabindex="0" role="region" aria-label="Which value matters"><table>
        <thead><tr><th scope="col">variance from</th><th scope="col" title="what the value makes by itself">by itself</th><th scope="col" title="what would go if the value did not scatter">in all</th><th scope="col"></th></tr></thead>
        <tbody>${names.map((name) => html`<tr key=${name}><th scope="row">${name}</th><td class="number">${share(value.main[name])}</td><td class="number">${share(value.total[name])}</td><td class="measure"><span class="measured" style=${{ width: `${100 * Math.min(1, Math.max(0, value.total[name] ?? 0))}%` }}></span></td></tr>`)}</tbody>
      </table></div>
    </div>`;
}

/** @param {number | null} part */
const share = (part) => percent(part === null ? null : 100 * part);

const [WIDTH, HEIGHT] = [320, 150];

/** @param {{histogram: {edges: number[], counts: number[]}, title: string}} props */
function Histogram({ histogram: { edges, counts }, title }) {
  const most = Math.max(...counts);
  if (!(most > 0)) return null;
  const step = WIDTH / counts.length;
  return html`<svg class="histogram" viewBox=${`0 0 ${WIDTH} ${HEIGHT + 20}`} role="img" aria-label=${title}>
    ${counts.map((count, i) => html`<rect key=${i} x=${i * step} width=${step * 0.9} y=${HEIGHT * (1 - count / most)} height=${(HEIGHT * count) / most} />`)}
    <text x="0" y=${HEIGHT + 15}>${shown(edges[0], 4)}</text><text x=${WIDTH} y=${HEIGHT + 15} text-anchor="end">${shown(edges.at(-1), 4)}</text>
  </svg>`;
}
