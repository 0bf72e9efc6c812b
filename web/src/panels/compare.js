// Two to four designs side by side: layouts of the study, and designs that were kept.

import { withUnit } from "../state/scale.js";
import { html, useState } from "../parts/html.js";
import { Being } from "../parts/clock.js";
import { Doubts, Unchosen, isOk } from "../parts/doubts.js";
import { unchosenIn } from "../library.js";
import { answerOf, choicesOf, comparedOf } from "../questions.js";
import { Measured, membersOf, percent } from "./answers.js";

/** @import { Store, View, State } from "../state/store.js" */
/** @import { Choice } from "../questions.js" */

const [FEWEST, MOST] = [2, 4];

/** @param {{store: Store}} props */
export function ComparePanel({ store }) {
  const state = store.get();
  const choices = choicesOf(state.history.present);
  const compared = comparedOf(state);
  const keys = compared.map(({ key }) => key);
  /** @param {Partial<View>} view */
  const look = (view) => store.dispatch({ type: "viewed", view });
  /** @param {string} key */
  const toggle = (key) => look({ compared: keys.includes(key) ? keys.filter((each) => each !== key) : [...keys, key] });
  const full = compared.length === MOST;
  const answer = answerOf(state, "compare");
  return html`<div aria-busy=${answer.is === "coming"}>
    <div class="row" role="group" aria-label="Designs to compare">
      ${choices.map(({ key, name, kept }) => html`<button type="button" class="chip" key=${key}
        aria-pressed=${keys.includes(key)} disabled=${full && !keys.includes(key)} onClick=${() => toggle(key)}>
          ${name}${kept ? html` <span class="quiet">kept</span>` : null}</button>`)}
    </div>
    ${compared.length >= FEWEST &&
    html`<p class="row"><label>Compared with <select value=${keys[0]}
      onChange=${(/** @type {Event} */ event) =>
        look({ against: /** @type {HTMLSelectElement} */ (event.currentTarget).value })}>
        ${keys.toSorted((one, other) => order(choices, one) - order(choices, other)).map((key) => html`<option
          key=${key} value=${key}>${choices[order(choices, key)].name}${key.startsWith("kept ") ? " (kept)" : ""}
            </option>`)}
      </select></label> ${full && html`<span class="quiet">Four are the most: leave one out for another.</span>`}</p>`}
    <${Keep} store=${store} />
    ${compared.length < FEWEST ? html`<p class="quiet">Choose two to four of them.</p>`
      : html`<${Table} state=${state} answer=${answer} compared=${compared} />`}
  </div>`;
}

/** @param {Choice[]} choices @param {string} key */
const order = (choices, key) => choices.findIndex((choice) => choice.key === key);

/** @param {{state: State, answer: import("../state/answers.js").Shown,
 * compared: Choice[]}} props */
function Table({ state, answer, compared }) {
  const { value, sentence } = answer;
  // What is free in a design of another study, the answer alone tells.
  const designs = compared.map(({ name, kept, design }, i) => ({
    name,
    unchosen: kept ? (value?.designs[i]?.unchosen ?? []) : unchosenIn(state, design),
  }));
  const first = html`<${Being} shown=${answer} /><${Unchosen} designs=${designs} />
    <${Doubts} members=${membersOf(value)} />${sentence && html`<p class="problem" role="alert">${sentence}</p>`}`;
  if (!value) return first;
  const columns = value.designs;
  const known = [...new Set(columns.flatMap((/** @type {any} */ { numbers }) => Object.keys(numbers)))];
  const different = known.filter((name) => columns.some((/** @type {any} */ { numbers }) =>
    numbers[name] !== columns[0].numbers[name]));
  return html`${first}<div class="scroll" tabindex="0" role="region" aria-label="Comparison">
    <table class=${`compared ${answer.before ? "stale" : ""}`} style=${{ minWidth: `${9 * (columns.length + 1)}rem` }}>
    <thead><tr><th scope="col"></th>
      ${columns.map((/** @type {any} */ { name }, /** @type {number} */ i) => html`<th scope="col" key=${i}
        title=${name}>${name}</th>`)}</tr></thead>
    <tbody>
      <tr><th scope="row">network</th>
        ${columns.map((/** @type {any} */ { network }, /** @type {number} */ i) => html`<td key=${i}><code>
          ${[...new Set(typeof network === "string" ? [network] : Object.values(network))].join("; ")}</code></td>`)}
            </tr>
      ${different.map((name) => html`<tr key=${name}><th scope="row">${name}</th>
        ${columns.map((/** @type {any} */ { numbers }, /** @type {number} */ i) => html`<td class="number" key=${i}>
          ${numbers[name] ?? "–"}</td>`)}</tr>`)}
      ${columns[0].results.map((/** @type {any} */ first, /** @type {number} */ row) => html`<tr key=${first.index}>
        <th scope="row"><b>${first.index}</b> <span class="quiet">${withUnit(first.title, first.unit)}</span></th>
        ${columns.map((/** @type {any} */ { results, unchosen }, /** @type {number} */ i) => html`<${Value} key=${i}
          result=${results[row]} first=${i === 0}
            unchosen=${unchosen.length > 0 || columns[0].unchosen.length > 0} />`)}</tr>`)}
    </tbody>
  </table></div>
  <p class="quiet">In per cent of ${columns[0].name}, all on the road of this study, and on the same roads where it
    is simulated; ± is the standard error of a difference itself. Bold: the best, and what is as good.</p>`;
}

/** A value, and what lies between it and the first one's.
 * @param {{result: any, first: boolean, unchosen: boolean}} props */
function Value({ result, first, unchosen }) {
  const { value, best, message } = result;
  return html`<td class=${`number ${best ? "best" : ""}`} title=${message} data-value=${value}>
    <${Measured} result=${result} />${!first && html`<${Difference} result=${result} unchosen=${unchosen} />`}</td>`;
}

/** What lies between them, first what makes that doubtful. @param {{result: any, unchosen: boolean}} props */
function Difference({ result: { improvement_percent: better, improvement_error_percent: error,
  improvement_status: status, tie }, unchosen }) {
  if (unchosen) return html`<div class="difference quiet">not chosen yet</div>`;
  if (typeof better !== "number") return null;
  const doubt = isOk(status) ? "" : `${status}: `;
  if (tie) return html`<div class="difference quiet">${doubt}as good${error ? `, ${percent(better, error)}` : ""}
    </div>`;
  const word = better > 0 ? "better" : "worse";
  return html`<div class=${`difference ${doubt ? "quiet" : better > 0 ? "good" : "bad"}`}>
    ${doubt}${percent(Math.abs(better), error)} ${word}</div>`;
}

/** Keeping the design that is edited under a name, and taking kept ones back.
 * @param {{store: Store}} props */
function Keep({ store }) {
  const document = store.get().history.present;
  const [name, setName] = useState("");
  return html`<form class="row" onSubmit=${(/** @type {SubmitEvent} */ event) => {
    event.preventDefault();
    if (name.trim()) store.change({ type: "designKept", name: name.trim() });
    setName("");
  }}>
    <label>Keep this design as <input value=${name} autocomplete="off"
      onInput=${(/** @type {Event} */ event) => setName(/** @type {HTMLInputElement} */ (event.currentTarget).value)} />
        </label> <button disabled=${!name.trim()}>Keep</button>
  </form>
  ${document.designs.length > 0 &&
  html`<ul class="kept">${document.designs.map((design) => html`<li class="row" key=${design.name}><b>${design.name}</b>
    <button type="button" aria-label=${`Edit ${design.name}`}
      onClick=${() => store.change({ type: "designTaken", name: design.name })}>Edit it</button>
    <button type="button" aria-label=${`Delete ${design.name}`}
      onClick=${() => store.change({ type: "designRemoved", name: design.name })}>Delete</button></li>`)}</ul>`}`;
}
