// Two to four designs side by side: layouts of the study, and designs that were kept.

import { scaled, unitFor, withUnit } from "../state/scale.js";
import { Chip, Select, Table, formHandler, textHandler } from "../parts/controls.js";
import { html, useState } from "../parts/html.js";
import { Being, useLate } from "../parts/clock.js";
import { Doubts, Unchosen } from "../parts/doubts.js";
import { answerOf, comparable, comparedOf } from "../questions.js";
import { Against, Measured, better, membersOf } from "./answers.js";

/** @import { Store, State } from "../state/store.js" */
/** @import { Choice } from "../questions.js" */
/** @import { Shown } from "../state/answers.js" */

const [FEWEST, MOST] = [2, 4];

/** @param {{store: Store}} props */
export function ComparePanel({ store }) {
  const state = store.get();
  const choices = comparable(state);
  const compared = comparedOf(state);
  const keys = compared.map(({ key }) => key);
  /** @param {string} key */
  const toggle = (key) =>
    store.look({ compared: keys.includes(key) ? keys.filter((each) => each !== key) : [...keys, key] });
  const full = compared.length === MOST;
  const answer = answerOf(state, "compare");
  return html`<div aria-busy=${answer.is === "coming"}>
    <div class="row">
      <div class="row" role="group" aria-label="Designs to compare">
        ${choices.map(({ key, name, kept }) => html`<${Chip} key=${key} on=${keys.includes(key)}
          disabled=${full && !keys.includes(key)} set=${() => toggle(key)}>
            ${name}${kept ? html` <span class="quiet">kept</span>` : null}<//>`)}
      </div>
      ${compared.length >= FEWEST &&
      html`<${Select} label="compared with" value=${keys[0]}
        choices=${choices.filter(({ key }) => keys.includes(key)).map(({ key, name, kept }) =>
          [key, kept ? `${name} (kept)` : name])}
        set=${(/** @type {string} */ against) => store.look({ against })} />
        ${full && html`<span class="quiet">Four are the most: leave one out for another.</span>`}`}</div>
    ${compared.length < FEWEST ? html`<p class="quiet">Choose two to four of them.</p>`
      : html`<${Comparison} state=${state} answer=${answer} compared=${compared} />`}
    <${Keep} store=${store} />
  </div>`;
}

/** @param {{state: State, answer: Shown, compared: Choice[]}} props */
function Comparison({ state, answer, compared }) {
  const { value, sentence } = answer;
  const late = useLate(answer.before);
  // What is free in a design of another study, the answer alone tells.
  const designs = compared.map(({ kept, design }, i) =>
    (kept ? { ...design, unchosen: value?.designs[i]?.unchosen ?? [] } : design));
  const first = html`<${Being} shown=${answer} /><${Unchosen} state=${state} designs=${designs} />
    <${Doubts} members=${membersOf(value)} />${sentence && html`<p class="problem" role="alert">${sentence}</p>`}`;
  if (!value) return first;
  /** @type {{name: string, network: any, numbers: {[name: string]: string}, results: any[], unchosen: string[]}[]} */
  const columns = value.designs;
  const known = [...new Set(columns.flatMap(({ numbers }) => Object.keys(numbers)))];
  const different = known.filter((name) => columns.some(({ numbers }) => numbers[name] !== columns[0].numbers[name]));
  return html`${first}<${Table} label="Comparison" class=${`compared ${late ? "stale" : ""}`}
    style=${{ minWidth: `${9 * (columns.length + 1)}rem` }}
    heads=${["", ...columns.map(({ name }) => [name, name])]}>
      <tr><th scope="row">network</th>
        ${columns.map(({ network }, i) => html`<td key=${i}><code>
          ${[...new Set(typeof network === "string" ? [network] : Object.values(network))].join("; ")}</code></td>`)}
      </tr>
      ${columns[0].results.map((first, row) => {
        const { unit, factor } = unitFor(state.about, columns.map(({ results }) => results[row].value), first.unit);
        return html`<tr key=${first.index}>
          <th scope="row"><b>${first.index}</b> <span class="quiet">${withUnit(first.title, unit)}</span></th>
          ${columns.map(({ results, unchosen }, i) => html`<${Value} key=${i} result=${results[row]} factor=${factor}
            first=${i === 0} unchosen=${unchosen.length > 0 || columns[0].unchosen.length > 0} />`)}</tr>`;
      })}
      ${different.map((name) => html`<tr key=${name}><th scope="row">${name}</th>
        ${columns.map(({ numbers }, i) => html`<td class="number" key=${i}>${numbers[name] ?? "–"}</td>`)}</tr>`)}
  <//>
  <p class="quiet">Improvements on ${columns[0].name}: + is better. All designs are on the road of this study, and where
    they are simulated on the same roads; ± is the standard error of the improvement. Bold: the best, and what is as
    good.</p>`;
}

/** A value, and how much better it is than the first one's.
 * @param {{result: any, factor: number, first: boolean, unchosen: boolean}} props */
function Value({ result, factor, first, unchosen }) {
  const { value, best, message } = result;
  return html`<td class=${`number ${best ? "best" : ""}`} title=${message} data-value=${value}>
    <${Measured} result=${scaled(result, factor)} />${!first && html`<div class=${`difference ${
      unchosen ? "" : better(result)}`}><${Against} row=${{ ...result, status: null }} unchosen=${unchosen} /></div>`}
    </td>`;
}

/** Keeping the design that is edited under a name, and taking kept ones back.
 * @param {{store: Store}} props */
function Keep({ store }) {
  const document = store.get().history.present;
  const [name, setName] = useState("");
  return html`<form class="row" onSubmit=${formHandler(() => {
    if (name.trim()) store.change({ type: "designKept", name: name.trim() });
    setName("");
  })}>
    <label>Keep this design as <input value=${name} autocomplete="off" onInput=${textHandler(setName)} /></label>
    ${" "}<button class="edged" disabled=${!name.trim()}>Keep</button>
  </form>
  ${document.designs.length > 0 &&
  html`<ul class="kept">${document.designs.map((design) => html`<li class="row" key=${design.name}><b>${design.name}</b>
    <button type="button" aria-label=${`Edit ${design.name}`}
      onClick=${() => store.change({ type: "designTaken", name: design.name })}>Edit it</button>
    <button type="button" aria-label=${`Delete ${design.name}`}
      onClick=${() => store.change({ type: "designRemoved", name: design.name })}>Delete</button></li>`)}</ul>`}`;
}
