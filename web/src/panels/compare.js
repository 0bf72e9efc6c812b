// Two to four designs side by side: layouts of the study, and designs that were kept.

import { html, useState } from "../parts/html.js";
import { comparedDesign } from "../questions.js";
import { textsOf } from "../state/document.js";
import { shown, takenApart } from "../state/scale.js";
import { number } from "./answers.js";

const MOST = 4;

/** @param {{store: import("../state/store.js").Store}} props */
export function ComparePanel({ store }) {
  const state = store.get();
  const document = state.history.present;
  const { compared } = state.view;
  const choices = [...Object.keys(document.study.layouts ?? {}).map((name) => `layout ${name}`), ...document.designs.map(({ name }) => `kept ${name}`)];
  /** @param {string} key */
  const toggle = (key) => store.dispatch({ type: "viewed", view: { compared: compared.includes(key) ? compared.filter((each) => each !== key) : [...compared, key].slice(-MOST) } });
  const shownKeys = compared.filter((key) => choices.includes(key));
  return html`<div>
    <div class="row" role="group" aria-label="Designs to compare">
      ${choices.map((key) => html`<button type="button" class="chip" key=${key} aria-pressed=${compared.includes(key)} onClick=${() => toggle(key)}>${key.replace(/^(layout|kept) /, "")}${key.startsWith("kept ") ? html` <span class="quiet">kept</span>` : null}</button>`)}
    </div>
    <${Keep} store=${store} />
    ${shownKeys.length < 2 ? html`<p class="quiet">Choose two to four of them.</p>` : html`<${Table} state=${state} keys=${shownKeys} />`}
  </div>`;
}

/** @param {{state: import("../state/store.js").State, keys: string[]}} props */
function Table({ state, keys }) {
  const document = state.history.present;
  const columns = keys.map((key) => {
    const i = state.view.compared.indexOf(key);
    const answer = state.answers[`compare.${i}`];
    const design = comparedDesign(document, key);
    const asked = JSON.parse(answer?.of ?? "{}").designs?.[0];
    const fits = asked && JSON.stringify(asked) === JSON.stringify(design.design);
    return { ...design, told: fits ? answer?.value?.designs?.[0] : null, sentence: answer?.sentence };
  });
  const indices = [...new Set(columns.flatMap(({ told }) => told?.results.map((/** @type {any} */ { index }) => index) ?? []))];
  const elements = [...new Set(columns.flatMap(({ told }) => Object.keys(told?.values ?? {})))];
  /** @param {any} told @param {string} index */
  const find = (told, index) => told?.results.find((/** @type {any} */ each) => each.index === index);
  return html`<div class="scroll" tabindex="0" role="region" aria-label="Comparison"><table class="compared" style=${{ minWidth: `${9 * (columns.length + 1)}rem` }}>
    <thead><tr><th scope="col"></th>${columns.map(({ key, name }) => html`<th scope="col" key=${key} title=${name}>${name}</th>`)}</tr></thead>
    <tbody>
      <tr><th scope="row">network</th>${columns.map(({ key, study, design }) => html`<td key=${key}><code>${textsOf(study.layouts?.[design.layout]).join("; ")}</code></td>`)}</tr>
      ${elements.map((name) => html`<tr key=${name}><th scope="row">${name}</th>${columns.map(({ key, told }) => html`<td class="number" key=${key}>${valueText(told?.values?.[name])}</td>`)}</tr>`)}
      ${indices.map((index) => {
        const values = columns.map(({ told }) => find(told, index)?.value).filter((value) => typeof value === "number");
        const best = Math.min(...values);
        return html`<tr key=${index}><th scope="row">${index}</th>${columns.map(({ key, told, sentence }) => {
          const result = find(told, index);
          return html`<td key=${key} class=${`number ${result?.value === best ? "best" : ""}`}>${result ? html`${number(result)} <span class="unit">${result.unit}</span>` : (sentence ?? "…")}</td>`;
        })}</tr>`;
      })}
    </tbody>
  </table></div>`;
}

/** @param {{value: number, unit: string, text?: string} | undefined} told */
function valueText(told) {
  if (!told) return "–";
  const apart = takenApart(told.text ?? `${told.value} ${told.unit}`);
  return apart ? `${shown(apart.number)} ${apart.unit}` : told.text;
}

/** Keeping the design that is edited under a name, and taking kept ones back. @param {{store: import("../state/store.js").Store}} props */
function Keep({ store }) {
  const document = store.get().history.present;
  const [name, setName] = useState("");
  return html`<form class="row" onSubmit=${(/** @type {SubmitEvent} */ event) => {
    event.preventDefault();
    if (name.trim()) store.change({ type: "designKept", name: name.trim() });
    setName("");
  }}>
    <label>Keep this design as <input value=${name} autocomplete="off" onInput=${(/** @type {Event} */ event) => setName(/** @type {HTMLInputElement} */ (event.currentTarget).value)} /></label> <button disabled=${!name.trim()}>Keep</button>
  </form>
  ${document.designs.length > 0 &&
  html`<ul class="kept">${document.designs.map((design) => html`<li class="row" key=${design.name}><b>${design.name}</b>
    <button type="button" aria-label=${`Edit ${design.name}`} onClick=${() => store.change({ type: "designTaken", name: design.name })}>Edit it</button>
    <button type="button" aria-label=${`Delete ${design.name}`} onClick=${() => store.change({ type: "designRemoved", name: design.name })}>Delete</button></li>`)}</ul>`}`;
}
