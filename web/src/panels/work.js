// Long work: one queue, and for each kind that the library declares its form and what is shown of its result.

import { percentChange } from "./answers.js";
import { Files } from "./files.js";
import { FrontForm, FrontResult, frontBody, frontIndices } from "./front.js";
import { SearchForm, SearchResult, AddFreeNetwork, searchBody } from "./search.js";
import { SweepResult } from "./sweep.js";
import { Select, Table, formHandler, showNewest } from "../parts/controls.js";
import { html, useState } from "../parts/html.js";
import { toPlaces, printed, scaled, unitFor, valuesIn } from "../state/scale.js";
import { Clock } from "../parts/clock.js";
import { Doubts, isOk } from "../parts/doubts.js";
import { isSearched, searchedLayouts } from "../library.js";
import { answerOf } from "../questions.js";
import { MarginsResult } from "./margins.js";
import { membersOf, resume, stop, takeAndTell, tryToBegin } from "../working.js";

/** @import { Store, State, Job } from "../state/store.js" */
/** @import { Api } from "../api.js" */

/** A kind of long work as the library declares it: one that a person may begin has a description.
 * @typedef {{key: string, title: string, resumes: boolean, description: string, lacking: string}} Kind */
/** What is shown of a kind: the form of what it needs beside the study, with its body; its result; `lacks` whether the
 * study has nothing for it, and `Remedy` buttons that add that.
 * @typedef {{Form?: any, body?: (form: FormData) => object, Result?: any, lacks?: (state: State) => boolean,
 * Remedy?: any}} View */

/** @type {{[kind: string]: View}} */
const VIEWS = {
  run: { Result: RunResult },
  sweep: { Form: SweepForm, body: sweepBody, Result: SweepResult, lacks: (state) => sweepable(state).length === 0 },
  front: { Form: FrontForm, body: frontBody, Result: FrontResult, lacks: (state) => frontIndices(state).length < 2 },
  search: { Form: SearchForm, body: searchBody, Result: SearchResult,
    lacks: (state) => searchedLayouts(state).length === 0, Remedy: AddFreeNetwork },
  optimise: { Result: OptimumResult },
  margins: { Result: MarginsResult },
  identify: { Result: InRig },
};

/** @param {{store: Store, api: Api}} props */
export function WorkPanel({ store, api }) {
  const state = store.get();
  const jobs = Object.values(state.work).toReversed();
  return html`<div class="work">
    ${kindsOf(state).filter(({ description }) => description !== "").map((kind) =>
      html`<${Begin} key=${kind.key} store=${store} api=${api} kind=${kind} />`)}
    <h3>Under way and done</h3>
    ${jobs.length === 0 && html`<p class="quiet">Nothing yet.</p>`}
    <ul class="jobs">${jobs.map((job) => html`<${JobRow} key=${job.id} store=${store} api=${api} job=${job} />`)}</ul>
  </div>`;
}

/** @param {State} state @returns {Kind[]} */
const kindsOf = ({ about }) => about?.work ?? [];

/** Long work begins with its button: Enter in a field only takes over what was typed. @param {KeyboardEvent} event */
const notByEnter = (event) =>
  event.key === "Enter" && event.target instanceof HTMLInputElement && event.preventDefault();

/** @param {{store: Store, api: Api, kind: Kind}} props */
function Begin({ store, api, kind }) {
  const [told, setTold] = useState("");
  const state = store.get();
  const { study, layout } = state.history.present;
  const { Form, body, lacks, Remedy } = VIEWS[kind.key] ?? {};
  const isNext = Remedy && state.view.tall && isSearched(state, layout); // what is to be done with a free network
  return html`<form class="begin" onKeyDown=${notByEnter} onSubmit=${formHandler(async (form) => {
    const told = await tryToBegin(store, api, { kind: kind.key, study, ...body?.(form) });
    setTold(told);
    if (told) return;
    store.look({ tall: true });
    showNewest(".jobs .job");
  })}>
    <h3>${kind.title}</h3>
    <p class="quiet">${kind.description}</p>
    ${lacks?.(state) ? html`<p class="row"><span class="quiet">${kind.lacking}</span>
        ${Remedy && html`<${Remedy} store=${store} />`}</p>`
      : html`<div class="row">${Form && html`<${Form} store=${store} />`}
        <button class=${isNext ? "main" : "edged"}>Begin</button></div>`}
    ${told && html`<p class="problem" role="alert">${told}</p>`}
  </form>`;
}

export const RUNNING = ["waiting", "running"];

/** What the work is, the button that ends it, and how far it is: of what moves in large steps the time moves.
 * @param {{store: Store, api: Api, job: Job}} props */
export function JobHead({ store, api, job: { id, title, study, kind, state, share, begun } }) {
  const resumes = ["stopped", "failed"].includes(state)
    && kindsOf(store.get()).some((each) => each.key === kind && each.resumes);
  const running = RUNNING.includes(state);
  const isOther = study && study !== store.get().history.present.study.title;
  return html`<div class="row"><b>${title}</b>${isOther && html` <span class="quiet">of ${study}</span>`}
      <span class="state">${state}${resumes && share ? ` at ${Math.floor(100 * share)} %` : ""}</span>
      ${resumes && html`<button type="button" onClick=${() => resume(store, api, id)}>Resume</button>`}
      <button type="button" onClick=${() => stop(store, api, id)}>${running ? "Stop" : "Forget"}</button></div>
    ${running && html`<p class="row progress">
      <progress max="1" value=${share ?? undefined} aria-label=${`${title}, progress`} />
      ${" "}<${Clock} key=${begun} since=${begun === null ? null : 1000 * begun} /></p>`}`;
}

/** @param {{store: Store, api: Api, job: Job}} props */
function JobRow({ store, api, job }) {
  const Result = VIEWS[job.kind]?.Result;
  const failed = job.state === "failed";
  return html`<li class="job" data-state=${job.state}>
    <${JobHead} store=${store} api=${api} job=${job} />
    ${job.sentence
      && html`<p class=${failed ? "problem" : "quiet"} role=${failed ? "alert" : undefined}>${job.sentence}</p>`}
    ${(job.result ?? job.found) && Result && html`<${Result} store=${store} api=${api} job=${job} />`}
  </li>`;
}

/** @param {{store: Store, job: Job}} props */
function OptimumResult({ store, job: { result } }) {
  /** @type {any[]} */
  const designs = result.designs;
  /** @type {{doubts?: string[], others?: string[]}} */
  const { doubts = [], others = [] } = result.at_speeds ?? {};
  return html`<${Doubts} members=${designs.flatMap(membersOf)} />
    ${doubts.length > 0 && html`<div class="doubts problem" role="alert">
      ${doubts.map((doubt) => html`<p key=${doubt}>${doubt}</p>`)}</div>`}
    ${others.map((sentence) => html`<p class="quiet" key=${sentence}>${sentence}</p>`)}
    ${designs.filter(({ texts }) => Object.keys(texts).length > 0).map((design) => html`<p
      key=${`${design.layout} ${design.index}`}><b>${design.layout}</b>: ${valuesIn(store.get().about, design.texts)}
      <${Take} store=${store} design=${design}>Take<//></p>`)}`;
}

/** Leads to what a fit has found. @param {{store: Store}} props */
function InRig({ store }) {
  return html`<button type="button" class="link" onClick=${() => store.look({ tab: "rig" })}>See Rig</button>`;
}

/** A button that takes a design into the editor. @param {{store: Store, design: any, children: any}} props */
const Take = ({ store, design, children }) =>
  html`<button type="button" onClick=${() => takeAndTell(store, design)}>${children}</button>`;

/** @param {{store: Store, api: Api, job: Job}} props */
function RunResult({ store, api, job }) {
  /** @type {any[]} */
  const rows = job.result.designs;
  const { about } = store.get();
  /** @param {any} row */
  const unitOf = ({ index, unit = "" }) =>
    unitFor(about, rows.filter((row) => row.index === index).map(({ value }) => value), unit);
  const many = 60;
  return html`<${Doubts} members=${rows.flatMap(membersOf)} />
  <${Table} label="Results" class="results" heads=${["layout", "index", "method", "value", "gain on the baseline", ""]}>
    ${rows.slice(0, many).map((row, i) => html`<tr key=${i}>
      <td>${row.layout}</td><td>${row.index}</td><td>${row.method}</td>
      <td class="number">${!isOk(row.status) && html`<div class="doubt">${String(row.status).split(": ")[0]}</div>`}
        ${writtenIn(row, unitOf(row))}</td>
      <td class="number">${percentChange(row.improvement_percent)}</td>
      <td>${Object.keys(row.parameters ?? {}).length > 0 && html`<${Take} store=${store} design=${row}>Take<//>`}</td>
    </tr>`)}
  <//>
  ${rows.length > many && html`<p class="quiet">${rows.length} rows in all: they are in summary.csv.</p>`}
  <${Files} store=${store} api=${api} job=${job} />`;
}

/** @param {any} row @param {import("../state/scale.js").WrittenUnit} unit */
function writtenIn(row, { unit, factor }) {
  const { value, decimals } = scaled(row, factor);
  return html`${toPlaces(value, decimals)} <span class="unit">${printed(unit)}</span>`;
}

/** The numbers that can be swept, and from where to where at first. @param {State} state
 * @returns {{place: string, words: string, from: string, to: string}[]} */
const sweepable = (state) => answerOf(state, "check").value?.places ?? [];

/** @param {{store: Store}} props */
function SweepForm({ store }) {
  const numbers = sweepable(store.get());
  const [place, setPlace] = useState("");
  const chosen = numbers.find((each) => each.place === place) ?? numbers[0];
  /** @param {"from" | "to"} name */
  const bound = (name) => html`<label>${name} <input name=${name} class="entry"
    key=${`${name} ${chosen.place}`} defaultValue=${chosen[name]} /></label>`;
  return html`<${Select} label="of" name="of" value=${chosen.place} set=${setPlace}
      choices=${numbers.map(({ place: of, words }) => [of, words === of ? of : `${of}: ${words}`])} />
    ${bound("from")}
    ${bound("to")}
    <label>points <input name="points" type="number" min="2" max="100000" defaultValue="16" /></label>`;
}

/** @param {FormData} form */
function sweepBody(form) {
  const [of, from, to, points] = ["of", "from", "to", "points"].map((name) => String(form.get(name) ?? ""));
  return { sweep: { [of]: { from, to, points: Number(points) } } };
}
