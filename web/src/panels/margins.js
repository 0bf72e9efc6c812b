// What the design bears: break-even values against the baseline, other speeds, scatter; asked by a button, and a job,
// since it simulates.

import { seek, seekNow } from "../asking.js";
import { elementsIn, kindOf } from "../library.js";
import { answerOf, baselineOf, goalOf, soughtAnswer } from "../questions.js";
import { Moving } from "../parts/clock.js";
import { Select, Table, formHandler } from "../parts/controls.js";
import { isOk } from "../parts/doubts.js";
import { html } from "../parts/html.js";
import { begin, ended } from "../working.js";
import { Against, indicesOf } from "./answers.js";
import { JobHead, RUNNING } from "./work.js";

/** @import { Store, Job } from "../state/store.js" */
/** @import { Api } from "../api.js" */

/** A value of what was computed, simulated if there is one, for the line of the decision. @param {any} value */
export function marginTold(value) {
  const found = (value?.break_even ?? []).filter((/** @type {any} */ each) => typeof each.value === "number");
  const first = found.find((/** @type {any} */ each) => each.standard_error > 0) ?? found[0];
  if (!first) return value ? "No break-even value" : "Not computed";
  return first.short;
}

const NAME = "margins";

/** Begins the job; its result is the answer to what is asked now. @param {Store} store @param {Api} api */
const compute = (store, api) => seek(store, NAME, {}, async ({ body }) => {
  const job = await ended(store, await begin(store, api, { kind: NAME, ...body }));
  if (!job?.result) throw new Error(job?.sentence || "Stopped.");
  return job.result;
});

/** @param {{store: Store, api: Api}} props */
export function MarginsPanel({ store, api }) {
  const state = store.get();
  const { layout } = state.history.present;
  const { is, value, sentence } = soughtAnswer(state, NAME);
  const job = Object.values(state.work).find(({ kind, state: how }) => kind === NAME && RUNNING.includes(how));
  const other = html`<${Best} store=${store} />`;
  if (layout === baselineOf(state.history.present).layout) return html`<p class="quiet">${layout} is the baseline:
    select another layout.</p>${other}`;
  return html`${other}<form class="row" aria-busy=${is === "coming"}
      onSubmit=${formHandler(() => void compute(store, api))}>
      <button class="edged" disabled=${is === "coming"}>Compute break-even values</button>
      <p role="status">${is !== "coming" && (sentence || (!value && `Friction, backlash and stiffness at which ${layout}
        equals ${baselineOf(state.history.present).layout}; simulation takes a minute, or several with operating
        conditions.`))}</p></form>
    ${is === "coming" && job && html`<${JobHead} store=${store} api=${api} job=${job} /><p class="quiet">
      ${job.sentence}</p>`}
    ${value && html`<${Margins} value=${value} />`}
    <${Budget} store=${store} api=${api} indices=${indicesOf(state)} />`;
}

/** Which layout is the best, and a button that selects it, where another one is selected, so that nobody takes the
 * break-even values of that one for those of the best. @param {{store: Store}} props */
function Best({ store }) {
  const state = store.get();
  const { is, value } = answerOf(state, "decision");
  /** @type {any[]} */
  const best = is === "current" ? value.rows.filter((/** @type {any} */ { rank }) => rank === 1) : [];
  const { layout } = best.find((row) => !row.is_baseline) ?? {};
  if (!layout || best.some((row) => row.layout === state.history.present.layout && !row.is_baseline)) return null;
  return html`<p class="row"><span>${layout} is the best in ${value.goal.index}.</span>
    <button type="button" class="edged" onClick=${() => store.change({ type: "selected", layout })}>Select ${
      layout}</button></p>`;
}

/** The result of a job. @param {{job: Job}} props */
export function MarginsResult({ job }) { // a declaration, since the module of jobs names it before this one has run
  return html`<${Margins} value=${job.result} />`;
}

/** @param {{value: any}} props */
function Margins({ value: { break_even: rows = [], speeds = [], scatter, caveats = [] } }) {
  const told = (/** @type {any[]} */ some) => some.map(({ sentence }) => html`<p key=${sentence}>${sentence}</p>`);
  const doubts = caveats.filter((/** @type {any} */ { severity }) => severity !== "info");
  return html`<div class="margins">${doubts.length > 0
      && html`<div class="doubts problem" role="alert">${told(doubts)}</div>`}
    ${told(caveats.filter((/** @type {any} */ one) => !doubts.includes(one)))}
    ${rows.map((/** @type {any} */ { parameter, sentence, message, status }) => html`<p key=${parameter}
      class=${isOk(status) || status === "unbounded" ? "" : "problem"}>${sentence || message}</p>`)}
    ${speeds.length > 0 && html`<${Table} label="Other speeds" heads=${["Speed", "gain on the baseline"]}>
      ${speeds.map((/** @type {any} */ { factor, short, status, ...one }) => html`<tr key=${factor}>
        <th scope="row">${short}</th>
        <td class="number"><${Against} row=${{ ...one, status, improvement_status: status }} /></td></tr>`)}<//>`}
    ${scatter?.sentence && html`<p>${scatter.sentence}</p>`}</div>`;
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
      void seekNow(store, api, "budget", { index: form.get("index"), parameter: form.get("parameter") }))}>
    <${Select} label="Element" name="parameter" key=${document.layout} choices=${names} selected=${switching} />
    <${Select} label="Index" name="index" selected=${goalOf(state)}
      key=${goalOf(state)} choices=${indices.map(({ symbol }) => symbol)} />
    <button class="edged">Compute</button>
    <p role="status">${is === "coming" ? html`<${Moving} what="Simulating" />` : value?.sentence ?? sentence}</p>
  </form></section>`;
}
