// The design that is edited in the formats of other programs: the library declares the kinds.

import { whenChosen } from "../asking.js";
import { elementsIn, isSearched, kindOf } from "../library.js";
import { DropDown } from "../parts/controls.js";
import { Unchosen } from "../parts/doubts.js";
import { html, useState } from "../parts/html.js";
import { designOf, goalOf } from "../questions.js";
import { download, fileName } from "../remembering.js";
import { SearchFirst } from "./search.js";

/** @typedef {{key: string, description: string, suffixes: string[], requires: string,
 *   takes: string[]}} ExportKind */

const ABOUT = "export"; // messages

/** @param {{store: import("../state/store.js").Store, api: import("../api.js").Api}} props */
export function ExportMenu({ store, api }) {
  const state = store.get();
  const { study, layout } = state.history.present;
  const design = designOf(state.history.present);
  const [isLinearWanted, setLinearWanted] = useState(false);
  const isNonlinear = elementsIn(state, layout).some((name) => kindOf(state, name)?.switches);
  const linear = isNonlinear && isLinearWanted;
  const kinds = (state.about?.exports ?? []).filter((/** @type {ExportKind} */ kind) => !linear
    || kind.takes.includes("linear"));
  /** @param {Event} event @param {ExportKind} kind @param {string} suffix */
  const save = async ({ currentTarget }, { key: kind }, suffix) => {
    /** @type {Element} */ (currentTarget).closest("details")?.removeAttribute("open");
    store.dispatch({ type: "closed", about: ABOUT });
    try {
      const document = await whenChosen(store);
      if (document === null) return;
      const file = await api.blob("export/design", { kind, suffix, study: document.study, design: designOf(document),
        index: goalOf(state), linear });
      download(file, `${fileName(study.title)}-${fileName(layout)}${suffix}`);
    } catch (error) {
      store.say(/** @type {Error} */ (error).message, ABOUT);
    }
  };
  return html`<${DropDown} title="Export" id="export-menu">
    <b>${layout} for other programs</b>
    ${isSearched(state, layout) ? html`<${SearchFirst} layout=${layout} />`
      : html`<${Unchosen} state=${state} designs=${[design]} />
      ${study.conditions?.length > 0 && html`<p class="quiet">${state.about?.export_note}</p>`}
      ${isNonlinear && html`<label><input type="checkbox" checked=${linear}
        onChange=${() => setLinearWanted(!linear)} /> linear: without friction and gaps</label>`}
      <ul class="exports">${kinds.map((/** @type {ExportKind} */ kind) => html`<li
        key=${kind.key}><span>${kind.description}${kind.requires
          && html` <span class="quiet">requires ${kind.requires}</span>`}</span>
        ${kind.suffixes.map((suffix) => html`<button type="button" key=${suffix} class="edged"
          aria-label=${`${kind.description} (${suffix})`}
          onClick=${(/** @type {Event} */ event) => save(event, kind, suffix)}>${suffix}</button>`)}
      </li>`)}</ul>`}<//>`;
}
