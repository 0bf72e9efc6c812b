// Long work: one queue, and a row for each kind of it with its form and what is shown of its result.

import { percent } from "./answers.js";
import { Files } from "./files.js";
import { FrontForm, FrontResult, frontBody } from "./front.js";
import { Plot } from "../plot.js";
import { html, useState } from "../parts/html.js";
import { placed, printed, quantity, shown, takenApart, withUnit } from "../state/scale.js";
import { Clock } from "../parts/clock.js";
import { Doubts, isOk } from "../parts/doubts.js";
import { answerOf } from "../questions.js";
import { begin, membersOf, stop, takeOptima } from "../working.js";

/** @import { Store, State, Job } from "../state/store.js" */
/** @import { Api } from "../api.js" */

/** A kind of long work: what it needs beside the study, its form, and its result.
 * @typedef {{kind: string, title: string, sentence: string, body: (state: State, form: FormData) => object, Form?: any, Result?: any}} Kind */

/** @type {Kind[]} */
export const KINDS = [
  { kind: "run", title: "Run the whole study", sentence: "As inerter run does: all layouts and indices, with report, tables and figures.", body: () => ({}), Result: RunResult },
  { kind: "sweep", title: "Sweep", sentence: "The best designs over one number of the study.", body: sweepBody, Form: SweepForm, Result: SweepResult },
  { kind: "front", title: "Trade-off front", sentence: "The designs of which none is better by both indices: each point can be taken into the editor.", body: frontBody, Form: FrontForm, Result: FrontResult },
];

/** @param {{store: Store, api: Api}} props */
export function WorkPanel({ store, api }) {
  const state = store.get();
  const jobs = Object.values(state.work).toReversed();
  const known = new Set((state.about?.work ?? []).map((/** @type {any} */ each) => each.key));
  return html`<div class="work">
    ${KINDS.filter(({ kind }) => known.size === 0 || known.has(kind)).map((kind) => html`<${Begin} key=${kind.kind} store=${store} api=${api} kind=${kind} />`)}
    <h3>Under way and done</h3>
    ${jobs.length === 0 && html`<p class="quiet">Nothing yet.</p>`}
    <ul class="jobs">${jobs.map((job) => html`<${JobRow} key=${job.id} store=${store} api=${api} job=${job} />`)}</ul>
  </div>`;
}

/** @param {{store: Store, api: Api, kind: Kind}} props */
function Begin({ store, api, kind }) {
  const [told, setTold] = useState("");
  const state = store.get();
  return html`<form class="begin" onSubmit=${async (/** @type {SubmitEvent} */ event) => {
    event.preventDefault();
    const form = new FormData(/** @type {HTMLFormElement} */ (event.currentTarget));
    try {
      await begin(store, api, { kind: kind.kind, title: `${kind.title}: ${state.history.present.study.title ?? "study"}`, study: state.history.present.study, ...kind.body(state, form) });
      setTold("");
    } catch (error) {
      setTold(/** @type {Error} */ (error).message);
    }
  }}>
    <h3>${kind.title}</h3>
    <p class="quiet">${kind.sentence}</p>
    <div class="row">${kind.Form && html`<${kind.Form} state=${state} />`}<button>Begin</button></div>
    ${told && html`<p class="problem" role="alert">${told}</p>`}
  </form>`;
}

const RUNNING = ["waiting", "running"];

/** How far work is, and since when it goes on: of what moves in large steps the time moves. @param {{job: Job}} props */
export const Progress = ({ job }) =>
  html`<p class="row progress"><progress max="1" value=${job.share ?? undefined} aria-label=${`${job.title}, progress`} /> <${Clock} key=${job.begun} since=${job.begun === null ? null : 1000 * job.begun} /></p>`;

/** @param {{store: Store, api: Api, job: Job}} props */
function JobRow({ store, api, job }) {
  const running = RUNNING.includes(job.state);
  const kind = KINDS.find((each) => each.kind === job.kind);
  const Result = kind?.Result ?? (job.kind === "optimise" ? OptimumResult : null);
  return html`<li class="job" data-state=${job.state}>
    <div class="row"><b>${job.title || job.kind}</b> <span class="state">${job.state}</span>
      <button type="button" onClick=${() => stop(store, api, job.id)}>${running ? "Stop" : "Forget"}</button></div>
    ${running && html`<${Progress} job=${job} />`}
    ${job.sentence && html`<p class=${job.state === "failed" ? "problem" : "quiet"} role=${job.state === "failed" ? "alert" : undefined}>${job.sentence}</p>`}
    ${job.result && Result && html`<${Result} store=${store} api=${api} job=${job} />`}
  </li>`;
}

/** @param {{store: Store, job: Job}} props */
function OptimumResult({ store, job }) {
  const { result } = job;
  const { doubts = [], others = [] } = result.at_speeds ?? {};
  return html`<${Doubts} members=${result.designs.flatMap(membersOf)} />
    ${doubts.length > 0 && html`<div class="doubts problem" role="alert">${doubts.map((/** @type {string} */ doubt) => html`<p key=${doubt}>${doubt}</p>`)}</div>`}
    ${others.map((/** @type {string} */ sentence) => html`<p class="quiet" key=${sentence}>${sentence}</p>`)}${result.designs.map(
    (/** @type {any} */ design) => html`<p key=${`${design.layout} ${design.index}`}>${Object.entries(design.texts).map(([name, text]) => `${name} = ${rounded(String(text))}`).join(", ")}
      <button type="button" onClick=${() => store.dispatch({ type: "said", about: "taken", text: takeOptima(store, [design]) })}>Take it into the editor</button></p>`,
  )}`;
}

/** A quantity with few digits. @param {string} text */
function rounded(text) {
  const apart = takenApart(text);
  return apart ? `${shown(apart.number)} ${apart.unit}` : text;
}

/** The rows of a result of runs: designs with their index and values. @param {any} result @returns {any[]} */
const rowsOf = (result) => result.rows ?? result.designs ?? (Array.isArray(result) ? result : []);

/** @param {{store: Store, api: Api, job: Job}} props */
function RunResult({ store, api, job }) {
  const rows = rowsOf(job.result);
  const many = 60;
  return html`<${Doubts} members=${rows.flatMap(membersOf)} /><div class="scroll" tabindex="0" role="region" aria-label="Results"><table>
    <thead><tr><th scope="col">layout</th><th scope="col">index</th><th scope="col">method</th><th scope="col">value</th><th scope="col">better by</th><th scope="col"></th></tr></thead>
    <tbody>${rows.slice(0, many).map((row, i) => html`<tr key=${i}><td>${row.layout}</td><td>${row.index}</td><td>${row.method}</td><td class="number">${!isOk(row.status) && html`<div class="doubt">${String(row.status).split(": ")[0]}</div>`}${placed(row.value, row.decimals)} <span class="unit">${printed(row.unit ?? "")}</span></td><td class="number">${percent(row.improvement_percent ?? row.improvement)}</td>
      <td>${row.parameters && Object.keys(row.parameters).length > 0 && html`<button type="button" onClick=${() => store.dispatch({ type: "said", about: "taken", text: takeOptima(store, [row]) })}>Take</button>`}</td></tr>`)}</tbody>
  </table></div>
  ${rows.length > many && html`<p class="quiet">${rows.length} rows in all: they are in summary.csv.</p>`}
  <${Files} api=${api} job=${job} />`;
}

/** The numbers that can be swept: elements, and then what else the study has. @param {State} state @returns {{place: string, words: string, text: string}[]} */
function sweepable(state) {
  const numbers = answerOf(state, "check").value?.places ?? [];
  return numbers.toSorted((/** @type {any} */ one, /** @type {any} */ other) => Number(one.place.includes(".")) - Number(other.place.includes(".")));
}

/** @param {{state: State}} props */
function SweepForm({ state }) {
  const numbers = sweepable(state);
  const [place, setPlace] = useState("");
  const chosen = numbers.find((each) => each.place === place) ?? numbers[0];
  const apart = takenApart(chosen?.text);
  if (!chosen || !apart) return html`<span class="quiet">There is no fixed value to sweep.</span>`;
  return html`<label>of <select name="of" value=${chosen.place} onChange=${(/** @type {Event} */ event) => setPlace(/** @type {HTMLSelectElement} */ (event.currentTarget).value)}>${numbers.map((each) => html`<option key=${each.place} value=${each.place}>${each.place}${each.words === each.place ? "" : `: ${each.words}`}</option>`)}</select></label>
    <label>from <input name="from" class="entry" key=${`from ${chosen.place}`} defaultValue=${quantity(apart.number / 2, apart.unit)} /></label>
    <label>to <input name="to" class="entry" key=${`to ${chosen.place}`} defaultValue=${quantity(apart.number * 2, apart.unit)} /></label>
    <label>points <input name="points" type="number" min="2" max="100000" defaultValue="16" /></label>`;
}

/** @param {State} _ @param {FormData} form */
function sweepBody(_, form) {
  const [of, from, to, points] = ["of", "from", "to", "points"].map((name) => String(form.get(name) ?? ""));
  return { sweep: { [of]: { from, to, points: Number(points) } } };
}

/** @param {{store: Store, api: Api, job: Job}} props */
function SweepResult({ store, api, job }) {
  const rows = rowsOf(job.result);
  const indices = [...new Set(rows.map(({ index }) => index))];
  const [picked, setPicked] = useState("");
  const index = indices.includes(picked) ? picked : indices[0];
  const shownRows = rows.filter((row) => row.index === index);
  const swept = sweptIn(shownRows);
  if (!swept) return html`<${RunResult} store=${store} api=${api} job=${job} />`;
  const x = [...new Set(shownRows.map(swept))].sort((a, b) => a - b);
  const curves = [...new Set(shownRows.map(({ layout }) => layout))].map((layout) => ({
    label: layout,
    values: x.map((at) => shownRows.find((row) => row.layout === layout && swept(row) === at)?.value ?? null),
  }));
  return html`<${Doubts} members=${rows.flatMap(membersOf)} /><div class="row" role="group" aria-label="Index">${indices.map((each) => html`<button type="button" class="chip" key=${each} aria-pressed=${each === index} onClick=${() => setPicked(each)}>${each}</button>`)}</div>
    <${Plot} x=${x} curves=${curves} xLabel="swept value, in SI" yLabel=${withUnit(index, shownRows[0]?.unit)} title=${`${index} over the swept value`} theme=${store.get().view.theme} />
    <${Files} api=${api} job=${job} />`;
}

/** How the swept value is read from a row, if there is one. @param {any[]} rows @returns {((row: any) => number) | null} */
function sweptIn(rows) {
  const known = new Set(["layout", "index", "method", "value", "decimals", "unit", "error_bound", "improvement_percent", "improvement_error_percent", "standard_error", "realisations", "status", "parameters"]);
  const key = Object.keys(rows[0] ?? {}).find((each) => !known.has(each) && typeof rows[0][each] === "number");
  return key === undefined ? null : (row) => row[key];
}
