// A rig corner: measured records, what was found in them, what the device is made of, and the device into the editor.

import { Doubts, isOk } from "../parts/doubts.js";
import { open } from "../remembering.js";
import { Plot } from "../plot.js";
import { Select, Table, useChoice, formHandler, showNewest } from "../parts/controls.js";
import { html, useMemo, useState } from "../parts/html.js";
import { recordSuffixes } from "../library.js";
import { strutTexts } from "../questions.js";
import { capital, shown, strutWords } from "../state/scale.js";
import { Files } from "./files.js";
import { takeFitted, tryToBegin, withheld } from "../working.js";
import { JobHead } from "./work.js";

/** @import { Store, Job } from "../state/store.js" */
/** @import { Api } from "../api.js" */

/** @param {{store: Store, api: Api}} props */
export function RigPanel({ store, api }) {
  const state = store.get();
  const [told, setTold] = useState("");
  const fits = Object.values(state.work).filter(({ kind }) => kind === "identify").toReversed();
  const suffixes = recordSuffixes(state);
  const models = modelsOf(state);
  const [picked, setModel] = useChoice(models.map(({ key }) => key));
  const model = models.find(({ key }) => key === picked);
  return html`<div>
    <p class="quiet">Drop a measured record anywhere on the page (${suffixes.join(", ")}), or</p>
    <label class="file">choose one <input type="file" accept=${suffixes.join()} multiple
      onChange=${(/** @type {Event} */ event) => open(store, api,
        /** @type {HTMLInputElement} */ (event.currentTarget).files ?? [])} /></label>
    ${state.records.length > 0 &&
    html`<form class="row" onSubmit=${formHandler(async () => setTold(await fit(store, api, state.records,
      { model: picked ?? "" }, model?.title)))}>
      <${Select} label="Model" name="model" choices=${models.map(({ key, title }) => [key, title])} value=${picked}
        set=${setModel} />
      <button class=${fits.length === 0 ? "main" : "edged"}>Identify</button>
      <span class="quiet">${model?.words}</span>
    </form>`}
    ${told && html`<p class="problem" role="alert">${told}</p>`}
    ${fits.map((job, i) => html`<${Fit} key=${job.id} store=${store} api=${api} job=${job} main=${i === 0} />`)}
    <ul class="records">
      ${state.records.map((record) => html`<${RecordRow} key=${record.id} store=${store} api=${api}
        record=${record} />`)}</ul>
  </div>`;
}

/** The models that can be fitted, first the choice between them. @param {import("../state/store.js").State} state
 * @returns {{key: string, title: string, words: string}[]} */
const modelsOf = ({ about }) => about?.models ?? [];

/** Begins a fit of records, and shows it; gives the sentence why it cannot be begun. @param {Store} store
 * @param {Api} api @param {any[]} records @param {{model: string, config?: object}} asked @param {string} [label] */
async function fit(store, api, records, asked, label = asked.model) {
  const told = await tryToBegin(store, api, { kind: "identify", study: {}, records: records.map(({ id }) => id),
    title: `Identify ${records.map(({ name }) => name).join(", ")}: ${label}`, ...asked });
  if (!told) showNewest(".fit");
  return told;
}

/** @param {{store: Store, api: Api, record: any}} props */
function RecordRow({ store, api, record }) {
  /** @type {{name: string, unit: string, time: number[], values: number[]}[]} */
  const channels = record.channels ?? [];
  const [picked, setPicked] = useChoice(channels.map(({ name }) => name));
  const channel = channels.find(({ name }) => name === picked);
  const plot = useMemo(() => channel && { title: `${channel.name} of ${record.name} over time`,
    x: { what: "time", unit: "s" }, y: { what: channel.name, unit: channel.unit },
    curves: [{ name: channel.name, x: channel.time, y: channel.values, colour: "s3", unnamed: true }] }, [channel]);
  return html`<li><div class="row"><b>${record.name}</b> ${shown(record.samples)} samples, ${shown(record.duration)} s.
      ${channel && html`<${Select} label="Show" value=${channel.name} choices=${channels.map(({ name }) => name)}
        set=${setPicked} />`}
      <button type="button" aria-label=${`Remove ${record.name}`}
        onClick=${() => forget(store, api, record.id)}>Remove</button></div>
    <ul>${(record.findings ?? []).map((/** @type {any} */ { severity, about, sentence }) => html`<li
      key=${`${about} ${sentence}`} class="finding" data-severity=${severity}>${sentence}</li>`)}
      ${(record.notes ?? []).map((/** @type {string} */ note) => html`<li key=${note} class="quiet">${note}</li>`)}</ul>
    ${plot && html`<${Plot} plot=${plot} />`}</li>`;
}

/** @param {Store} store @param {Api} api @param {string} id */
async function forget(store, api, id) {
  await api.remove(`records/${id}`).catch(() => null); // the server may have begun afresh, without it
  store.dispatch({ type: "unrecorded", id });
}

/** @param {Store} store @param {Api} api @param {any} fit @param {string} [strut] */
async function takeIn(store, api, fit, strut) {
  const text = await takeFitted(store, api, fit, fit.device, strut)
    .catch((/** @type {Error} */ error) => error.message);
  store.say(text, "device");
}

/** What a fit advises: another model, a setting, or a value that has to be stated.
 * @typedef {{label: string, model?: string, config?: {[section: string]: object},
 * ask?: {section: string, key: string, example: string}}} Offer */

/** What may be wrong with a fit that is not to be relied on, the likeliest first, and what can be done about it.
 * @param {{store: Store, api: Api, result: any, main: boolean}} props */
function Causes({ store, api, result, main }) {
  /** @type {{sentence: string, explained: number, remedy: string, offers: Offer[]}[]} */
  const causes = result.causes ?? [];
  return causes.length === 0 ? null : html`<h4>Possible causes, most likely first</h4><ol class="causes">
    ${causes.map(({ sentence, explained, remedy, offers }, number) => html`<li key=${sentence}>
      ${capital(sentence)}: explains ${Math.round(100 * explained)} % of the residual.
      ${remedy && html` <span class="quiet">${capital(remedy)}.</span>`}
      ${offers.map((offer, i) => html`<${Offered} key=${offer.label} store=${store} api=${api} result=${result}
        offer=${offer} main=${main && number + i === 0} />`)}</li>`)}</ol>`;
}

/** A button that fits the same records again, as a fit advises.
 * @param {{store: Store, api: Api, result: any, offer: Offer, main?: boolean}} props */
function Offered({ store, api, result, offer: { label, model, config = {}, ask }, main = false }) {
  const [told, setTold] = useState("");
  const sources = (result.records ?? []).map((/** @type {any} */ { source }) => source);
  const records = store.get().records.filter(({ name }) => sources.includes(name));
  if (records.length < new Set(sources).size)
    return html`<p class="quiet">${label}: drop the record of this fit on the page again.</p>`;
  return html`<form class="row" onSubmit=${formHandler(async (form) => {
    const stated = ask ? { [ask.section]: { [ask.key]: String(form.get("value")).trim() } } : config;
    setTold(await fit(store, api, records, { model: model ?? result.asked?.model,
      config: mergedTables(result.asked?.config ?? {}, stated) }, label));
  })}>
    ${ask && html`<label>${label} <input name="value" class="entry" required placeholder=${ask.example}
      autocomplete="off" spellcheck=${false} /></label>`}
    <button class=${main ? "main" : "edged"}>${ask ? "Fit again" : label}</button>
    ${told && html`<span class="problem" role="alert">${told}</span>`}</form>`;
}

/** Tables with the entries of others. @param {{[section: string]: object}} some
 * @param {{[section: string]: object}} others */
const mergedTables = (some, others) => ({ ...some,
  ...Object.fromEntries(Object.entries(others).map(([section, table]) => [section, { ...some[section], ...table }])) });

/** `main`: the newest one, of which one button is the next thing to do.
 * @param {{store: Store, api: Api, job: Job, main: boolean}} props */
function Fit({ store, api, job, main }) {
  const { result } = job;
  const struts = Object.keys(strutTexts(store.get()));
  const several = struts.length > 1;
  const words = modelsOf(store.get()).find(({ key }) => key === result?.model)?.words;
  /** @type {{identified: boolean, sentence: string}[]} */
  const parameters = result?.device ? Object.values(result.parameters) : [];
  return html`<section class="fit" data-state=${job.state}>
    <${JobHead} store=${store} api=${api} job=${job} />
    ${job.sentence && html`<p class=${job.state === "failed" ? "problem" : "quiet"}>${job.sentence}</p>`}
    ${result &&
    html`<${Doubts} members=${[{ of: result.model, status: result.status,
      message: result.reason }]} />
      <${Causes} store=${store} api=${api} result=${result} main=${main && !result.device} />
      <p><b>${result.model}</b>${words && `: ${words}`}</p>
      ${isOk(result.status) && html`<p>${parameters.every(({ identified }) => identified)
        && html`<b>Reliable estimates.</b>`} ${result.residual.join(" ")}</p>`}
      <${Table} label="Identified values" heads=${["parameter", "value", "95 % interval"]}>
        ${Object.entries(result.shown).map(([name, [value, interval]]) => html`<tr key=${name}>
          <th scope="row">${name}</th><td class="number">${value}</td><td class="number">${interval}</td></tr>`)}
      <//>
      ${parameters.filter(({ identified }) => !identified).map(({ sentence }) =>
        html`<p key=${sentence}>${sentence}</p>`)}
      ${(result.findings ?? []).map((/** @type {string} */ each) => html`<p key=${each} class="quiet">${each}</p>`)}
      ${result.device
        ? html`<p class="row">${several && "Take the device into the strut"}
          ${(several ? struts : [undefined]).map((strut) => html`<button type="button" key=${strut}
            class=${main && (!several || strut === struts[0]) ? "main" : "edged"}
            onClick=${() => void takeIn(store, api, result, strut)}>${strut ? strutWords([strut])
              : "Take the device into the editor"}</button>`)}</p>`
        : html`<p>${withheld(result)}</p>`}
      ${(result.offers ?? []).map((/** @type {Offer} */ offer) => html`<${Offered} key=${offer.label} store=${store}
        api=${api} result=${result} offer=${offer} />`)}
      <${Files} store=${store} api=${api} job=${job} />`}
  </section>`;
}
