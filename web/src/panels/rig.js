// A rig corner: measured records, what was found in them, what the device is made of, and the device into the editor.

import { Doubts } from "../parts/doubts.js";
import { open } from "../remembering.js";
import { Plot } from "../plot.js";
import { html, useMemo, useState } from "../parts/html.js";
import { shown, withUnit } from "../state/scale.js";
import { Files } from "./files.js";
import { begin, stop, takeFitted, withheld } from "../working.js";
import { Progress } from "./work.js";

/** @import { Store, Job } from "../state/store.js" */
/** @import { Api } from "../api.js" */

/** @param {{store: Store, api: Api}} props */
export function RigPanel({ store, api }) {
  const state = store.get();
  const [told, setTold] = useState("");
  const fits = Object.values(state.work).filter(({ kind }) => kind === "identify").toReversed();
  const models = (state.about?.models ?? []).map((/** @type {any} */ model) => model.name ?? model.key ?? model);
  return html`<div>
    <p class="quiet">Drop a measured record anywhere on the page (CSV, TDMS, MDF4, MATLAB), or</p>
    <label class="file">choose one <input type="file" accept=".csv,.tsv,.txt,.tdms,.mf4,.mdf,.mat" multiple
      onChange=${(/** @type {Event} */ event) => open(store, api,
        /** @type {HTMLInputElement} */ (event.currentTarget).files ?? [])} /></label>
    <ul class="records">
      ${state.records.map((record) => html`<${RecordRow} key=${record.id} store=${store} api=${api}
        record=${record} />`)}</ul>
    ${state.records.length > 0 &&
    html`<form class="row" onSubmit=${async (/** @type {SubmitEvent} */ event) => {
      event.preventDefault();
      const form = new FormData(/** @type {HTMLFormElement} */ (event.currentTarget));
      try {
        const body = { records: state.records.map(({ id }) => id), model: form.get("model") };
        await begin(store, api,
          { kind: "identify", title: `Identify ${state.records.map(({ name }) => name).join(", ")}`, study: {},
            ...body });
        setTold("");
      } catch (error) {
        setTold(/** @type {Error} */ (error).message);
      }
    }}>
      <label>Model <select name="model">
        ${models.map((/** @type {string} */ name) => html`<option key=${name}>${name}</option>`)}</select></label>
      <button class="main">Identify</button>
    </form>`}
    ${told && html`<p class="problem" role="alert">${told}</p>`}
    ${fits.map((job) => html`<${Fit} key=${job.id} store=${store} api=${api} job=${job} />`)}
  </div>`;
}

/** @param {{store: Store, api: Api, record: any}} props */
function RecordRow({ store, api, record }) {
  const channels = record.channels ?? [];
  const [picked, setPicked] = useState("");
  const channel = channels.find((/** @type {any} */ { name }) => name === picked) ?? channels[0];
  const curves = useMemo(() => (channel ? [{ label: channel.name, values: channel.values }] : []), [channel]);
  return html`<li><div class="row"><b>${record.name}</b> ${shown(record.samples)} samples, ${shown(record.duration)} s.
      ${channels.length > 0 && html`<label>Show <select value=${channel.name}
        onChange=${(/** @type {Event} */ event) =>
          setPicked(/** @type {HTMLSelectElement} */ (event.currentTarget).value)}>
            ${channels.map((/** @type {any} */ { name }) => html`<option key=${name}>${name}</option>`)}</select>
              </label>`}
      <button type="button" aria-label=${`Remove ${record.name}`}
        onClick=${() => forget(store, api, record.id)}>Remove</button></div>
    <ul>${(record.findings ?? []).map((/** @type {any} */ { severity, about, sentence }) => html`<li
      key=${`${about} ${sentence}`} class="finding" data-severity=${severity}>${sentence}</li>`)}
      ${(record.notes ?? []).map((/** @type {string} */ note) => html`<li key=${note} class="quiet">${note}</li>`)}</ul>
    ${channel && html`<${Plot} x=${channel.time} curves=${curves} xLabel="time [s]"
      yLabel=${withUnit(channel.name, channel.unit)} title=${`${channel.name} of ${record.name} over time`}
        theme=${store.get().view.theme} />`}</li>`;
}

/** @param {Store} store @param {Api} api @param {string} id */
async function forget(store, api, id) {
  await api.remove(`records/${id}`).catch(() => null); // the server may have begun afresh, without it
  store.dispatch({ type: "unrecorded", id });
}

/** @param {Store} store @param {Api} api @param {any} fit */
async function takeIn(store, api, fit) {
  const text = await takeFitted(store, api, fit, fit.device).catch((/** @type {Error} */ error) => error.message);
  store.dispatch({ type: "said", about: "device", text });
}

/** @param {{store: Store, api: Api, job: Job}} props */
function Fit({ store, api, job }) {
  const running = job.state === "waiting" || job.state === "running";
  const { result } = job;
  return html`<section class="fit" data-state=${job.state}>
    <div class="row"><b>${job.title}</b> <span class="state">${job.state}
      </span> <button type="button" onClick=${() => stop(store, api, job.id)}>${running ? "Stop" : "Forget"}</button>
        </div>
    ${running && html`<${Progress} job=${job} />`}
    ${job.sentence && html`<p class=${job.state === "failed" ? "problem" : "quiet"}>${job.sentence}</p>`}
    ${result &&
    html`<${Doubts} members=${[{ of: result.model, status: result.status }]} />
      <div class="scroll" tabindex="0" role="region" aria-label="Identified values"><table>
        <thead><tr><th scope="col"></th><th scope="col">value</th><th scope="col">95 % interval</th><th scope="col">
          </th></tr></thead>
        <tbody>${Object.entries(result.parameters ?? {}).map(([name, each]) => html`<tr key=${name}><th scope="row">
          ${name}</th><td class="number">${result.shown[name][0]}</td><td class="number">${result.shown[name][1]}</td>
            <td>${each.identified ? "" : each.sentence}</td></tr>`)}</tbody>
      </table></div>
      ${(result.notes ?? []).map((/** @type {any} */ note) => html`<p class="quiet">
        ${typeof note === "string" ? note : (note.sentence ?? "")}</p>`)}
      ${result.device
        ? html`<button type="button" class="main"
          onClick=${() => void takeIn(store, api, result)}>Take the device into the editor</button>`
        : html`<p>${withheld(result)}</p>`}
      <${Files} api=${api} job=${job} />`}
  </section>`;
}
