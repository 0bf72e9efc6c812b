// A search for the best network: its ranking, which fills while it goes on; each network can be taken into the editor.

import { Select, Table } from "../parts/controls.js";
import { Doubts, isOk } from "../parts/doubts.js";
import { html } from "../parts/html.js";
import { searchedLayouts } from "../library.js";
import { printed, rounded, shown } from "../state/scale.js";
import { takeNetwork } from "../working.js";
import { indexChoices, indicesOf, percent } from "./answers.js";
import { Files } from "./files.js";

/** @import { State, Store, Job } from "../state/store.js" */
/** @import { Api } from "../api.js" */

/** @param {{state: State}} props */
export function SearchForm({ state }) {
  const layouts = searchedLayouts(state);
  if (layouts.length === 0) return html`<span class="quiet">No layout has a free network.</span>`;
  return html`<${Select} label="layout" name="layout" choices=${layouts} />
    ${" "}<${Select} label="index" name="index" choices=${indexChoices(indicesOf(state))} />`;
}

/** @param {State} _ @param {FormData} form */
export const searchBody = (_, form) => ({ layouts: chosen(form, "layout"), indices: chosen(form, "index") });

/** @param {FormData} form @param {string} name */
const chosen = (form, name) => [form.get(name) ?? []].flat();

/** The best networks, also of a search that goes on or was stopped.
 * @param {{store: Store, api: Api, job: Job}} props */
export function SearchResult({ store, api, job }) {
  const found = job.result ?? job.found;
  const { index, baseline, complete, networks } = found;
  /** @type {any[]} */
  const ranking = found.ranking;
  const compared = complete && baseline !== null;
  const heads = ["", "network", index, ...(compared ? [["better by", `than ${baseline}`]] : []), "values", ""];
  return html`<${Doubts} members=${ranking.map(({ network, status, message }) => ({ of: network, status, message }))} />
    <p class="quiet">The best ${ranking.length} ${complete ? `of ${networks} networks` : "so far"} (* at a bound)</p>
    <${Table} label="Ranking" heads=${heads}>
      ${ranking.map((row, i) => html`<tr key=${row.network} data-network=${row.network}>
        <td class="number">${i + 1}</td>
        <td><code>${row.network}</code></td>
        <td class="number">${!isOk(row.status) && html`<div class="doubt">${row.status}</div>`}
          ${shown(row.value)} <span class="unit">${printed(row.unit)}</span></td>
        ${compared && html`<td class="number">${percent(row.improvement_percent)}</td>`}
        <td>${valuesOf(row)}</td>
        <td><button type="button"
          onClick=${() => store.say(takeNetwork(store, found, row), "taken")}>Into the editor</button></td>
      </tr>`)}
    <//>
    ${job.result && html`<${Files} api=${api} job=${job} />`}`;
}

/** The values of a network, and those of what else is free. @param {any} row */
const valuesOf = ({ elements, values, active_bounds: bounds }) =>
  Object.entries({ ...elements, ...values }).map(([name, text]) =>
    `${name} = ${rounded(String(text))}${name in bounds ? "*" : ""}`).join(", ");
