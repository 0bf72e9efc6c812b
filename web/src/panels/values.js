// Every number of elements, vehicle and road: a slider on a logarithmic scale, exact entry in any unit, bounds, fixed or free.

import { isRange, namesIn } from "../state/document.js";
import { answerOf, namesOfVehicle, numbersOf, unitKey, valueAtPlace } from "../questions.js";
import { STEPS, brief, positionOf, quantity, takenApart, valueAt } from "../state/scale.js";
import { html, useState } from "../parts/html.js";
import { kindOf } from "../kinds.js";
import { quickMethod } from "../methods.js";

/** @typedef {import("../state/store.js").Store} Store */
/** @typedef {import("../state/store.js").State} State */

const DECADE = 10;

/** A number of the document. `unit` is null where the unit itself tells what it is; `set` gives the change to another text.
 * @typedef {{place: string[], label: string, sentence: string, unit: string | null, text: string, range: {from: string, to: string}, free: boolean, mayBeFree: boolean, own?: boolean, set: (text: string) => import("../state/document.js").Change}} Amount */

const FEW = 8; // numbers of one table of a vehicle that stand below each other; more are folded away, and those in tables of tables
const MANY = 14; // elements of a layout that stand below each other; of more some are scrolled, so that the rest of the page stays near

/** @param {{store: Store}} props */
export function ValuesPanel({ store }) {
  const state = store.get();
  const { study, layout } = state.history.present;
  const here = new Set([...namesIn(study, layout), ...namesOfVehicle(study)]);
  const elements = Object.keys(study.elements ?? {});
  const used = elements.filter((name) => here.has(name));
  const other = elements.filter((name) => !here.has(name));
  const rest = numbersOf(state.about, state.history.present);
  return html`<section class="panel values" aria-labelledby="values-title">
    <h2 id="values-title">Values</h2>
    <div class=${used.length > MANY ? "many" : ""}>${used.map((name) => html`<${ElementRow} key=${name} store=${store} name=${name} />`)}</div>
    ${other.length > 0 &&
    html`<details><summary>${`Elements of other layouts (${other.length})`}</summary>
      ${other.map((name) => html`<${ElementRow} key=${name} store=${store} name=${name} />`)}
    </details>`}
    ${["vehicle", "road"].map((section) => {
      const rows = rest.filter(({ place }) => place[0] === section);
      return rows.length > 0 && html`<h3 key=${section}>${section === "vehicle" ? `Vehicle: ${String(study.vehicle?.model ?? "").replace("-", " ")}` : "Road"}</h3>
        ${[...new Set(rows.map(tableOf))].map((table) => html`<${Numbers} key=${table} store=${store} table=${table} rows=${rows.filter((row) => tableOf(row) === table)} />`)}`;
    })}
  </section>`;
}

/** The table of vehicle or road in which a number stands, if it is in one. @param {import("../questions.js").NumberRow} row */
const tableOf = ({ place }) => (place.length > 2 ? place[1] : "");

/** The numbers of one table of vehicle or road. @param {{store: Store, table: string, rows: import("../questions.js").NumberRow[]}} props */
function Numbers({ store, table, rows }) {
  const amounts = rows.map((row) => html`<${AmountRow} key=${row.place.join(".")} store=${store} amount=${numberAmount(store.get(), row)} />`);
  const deep = rows.some(({ place }) => place.length > 3);
  return table === "" ? amounts : html`<details class=${`table ${deep ? "deep" : ""}`} open=${!deep && rows.length <= FEW}><summary>${`${table.replaceAll("_", " ")} (${rows.length})`}</summary>${amounts}</details>`;
}

/** @param {State} state @param {import("../questions.js").NumberRow} row @returns {Amount} */
function numberAmount(state, { place, unit, sentence, own, mayBeFree }) {
  const { study, layout, values, ranges } = state.history.present;
  const before = valueAtPlace(study, place);
  if (isRange(before)) {
    const name = place[1];
    const text = values[layout]?.[name] ?? middle(state, before, unit);
    return { place, label: name.replaceAll("_", " "), sentence, unit, text, range: before, free: true, mayBeFree, set: (value) => ({ type: "valued", layout, values: { [name]: value } }) };
  }
  const text = String(before);
  const label = place.slice(place.length > 2 ? 2 : 1).join(", ").replaceAll("_", " ");
  /** @param {string} value */
  const written = (value) => (typeof before === "number" && value !== "" && Number.isFinite(Number(value)) ? Number(value) : value);
  return { place, label, sentence, unit, text, own, range: ranges[place.join(".")] ?? decade(text), free: false, mayBeFree, set: (value) => ({ type: "placed", place, value: written(value) }) };
}

/** @param {{store: Store, name: string}} props */
function ElementRow({ store, name }) {
  const state = store.get();
  const { study, layout, values, ranges } = state.history.present;
  const entry = study.elements?.[name];
  const kind = kindOf(state, name);
  const sentence = kind ? `${kind.key}: ${kind.sentence}` : "";
  if (isRange(entry)) {
    const text = values[layout]?.[name] ?? middle(state, entry, null);
    /** @type {Amount} */
    const amount = { place: ["elements", name], label: name, sentence, unit: null, text, range: entry, free: true, mayBeFree: true, set: (value) => ({ type: "valued", layout, values: { [name]: value } }) };
    return html`<${AmountRow} store=${store} amount=${amount} />`;
  }
  const place = typeof entry === "object" && kind ? ["elements", name, kind.quantity] : ["elements", name];
  const text = String(valueAtPlace(study, place) ?? "");
  /** @type {Amount} */
  const amount = { place, label: name, sentence, unit: null, text, range: ranges[place.join(".")] ?? decade(text), free: false, mayBeFree: place.length === 2, set: (value) => ({ type: "placed", place, value }) };
  return html`<${AmountRow} store=${store} amount=${amount} removable=${![...namesOfVehicle(study), ...Object.keys(study.layouts ?? {}).flatMap((each) => namesIn(study, each))].includes(name)} />`;
}

/** The size of a text in SI, or null where it is not known. @param {State} state @param {string} text @param {string | null} unit */
export function sizeOf(state, text, unit) {
  const apart = takenApart(text);
  const one = apart && oneOf(state, apart.unit, unit);
  return apart && one !== null ? apart.number * one : null;
}

/** How much one of a unit is in another, or null where it is not known. @param {State} state @param {string} written @param {string | null} unit */
const oneOf = (state, written, unit) => (written === unit ? 1 : (state.quantities[unitKey(written, unit)]?.value ?? null));

/** The geometric mean of the bounds, in the unit of the lower one. @param {State} state @param {{from: string, to: string}} range @param {string | null} unit */
function middle(state, { from, to }, unit) {
  const [lower, upper] = [sizeOf(state, from, unit), sizeOf(state, to, unit)];
  return lower === null || upper === null ? "" : inUnitOf(state, from, unit, Math.sqrt(lower * upper));
}

/** A size as text in the unit of another. @param {State} state @param {string} like @param {string | null} unit @param {number} size */
function inUnitOf(state, like, unit, size) {
  const apart = takenApart(like);
  const one = apart && oneOf(state, apart.unit, unit);
  return apart && one ? quantity(size / one, apart.unit) : like;
}

/** A decade to either side; of what is negative, also in size. @param {string} text */
function decade(text) {
  const apart = takenApart(text);
  if (apart === null || apart.number === 0) return { from: text, to: text };
  return { from: quantity(apart.number / DECADE, apart.unit), to: quantity(apart.number * DECADE, apart.unit) };
}

/** @param {{store: Store, amount: Amount, removable?: boolean}} props */
function AmountRow({ store, amount, removable = false }) {
  const state = store.get();
  const { place, label, sentence, unit, text, range, free, own, set } = amount;
  const [refused, setRefused] = useState("");
  const id = place.join(".");
  const [size, lower, upper] = [text, range.from, range.to].map((each) => sizeOf(state, each, unit));
  const usable = size !== null && lower !== null && upper !== null && lower * upper > 0 && Math.abs(upper) > Math.abs(lower);
  const problems = problemsAt(state, place);
  const gesture = `slide ${id}`;
  /** @param {Event} event */
  function slide(event) {
    if (!usable) return;
    const position = Number(/** @type {HTMLInputElement} */ (event.currentTarget).value);
    if (!free && !(id in state.history.present.ranges)) store.change({ type: "ranged", place: id, from: range.from, to: range.to }, gesture);
    store.change(set(inUnitOf(state, text, unit, valueAt(position, /** @type {number} */ (lower), /** @type {number} */ (upper)))), gesture);
  }
  /** Another text; at a place that is known by its number alone, none without a number. @param {string} value */
  function enter(value) {
    const fits = !own || takenApart(value) !== null;
    setRefused(fits ? "" : `Got "${value}"; expected a number, such as ${text}.`);
    if (fits) store.change(set(value));
  }
  return html`<div class=${`amount ${problems.length ? "wrong" : ""}`} data-place=${id} title=${sentence}>
    <label for=${`slider ${id}`}>${label}</label>
    <input id=${`slider ${id}`} type="range" min="0" max=${STEPS} value=${usable ? positionOf(/** @type {number} */ (size), /** @type {number} */ (lower), /** @type {number} */ (upper)) : 0} disabled=${!usable} aria-valuetext=${text} onInput=${slide} onChange=${() => store.dispatch({ type: "rested" })} />
    <${Entry} id=${`entry ${id}`} label=${`${label}, exactly`} text=${text} wrong=${problems.length > 0} done=${enter} />
    <${Bounds} store=${store} amount=${amount} removable=${removable} />
    ${[refused, ...problems.map((problem) => problem.sentence)].filter(Boolean).map((sentence) => html`<p class="problem" role="alert">${sentence}</p>`)}
  </div>`;
}

/** @param {{store: Store, amount: Amount, removable: boolean}} props */
function Bounds({ store, amount, removable }) {
  const { place, label, text, range, free, mayBeFree } = amount;
  const name = place[1];
  const judging = quickMethod(store.get())?.name;
  /** @param {{from: string, to: string}} next */
  const setRange = (next) => (free ? store.change({ type: "placed", place, value: next }) : store.change({ type: "ranged", place: place.join("."), ...next }));
  return html`<details class="bounds">
    <summary aria-label=${`${label}: ${free ? "free" : "fixed"}, bounds`}>${free ? "free" : "fixed"}</summary>
    <div class="menu-body">
      ${mayBeFree &&
      html`<div class="row" role="group" aria-label=${`${label} is`}>
        <button type="button" class="chip" aria-pressed=${!free} onClick=${() => free && store.change({ type: "fixed", place, text })}>fixed</button>
        <button type="button" class="chip" aria-pressed=${free} onClick=${() => !free && store.change({ type: "freed", place, ...range, method: judging })}>free</button>
      </div>`}
      <label>from <${Entry} id=${`from ${place.join(".")}`} label="from" text=${range.from} done=${(/** @type {string} */ from) => setRange({ from, to: range.to })} /></label>
      <label>to <${Entry} id=${`to ${place.join(".")}`} label="to" text=${range.to} done=${(/** @type {string} */ to) => setRange({ from: range.from, to })} /></label>
      ${removable && html`<button type="button" onClick=${() => store.change({ type: "elementRemoved", name })}>Delete ${name}</button>`}
    </div>
  </details>`;
}

/** A text that is taken over with Enter or on leaving; while nobody is in it, it shows no more digits than fit. @param {{id: string, label: string, text: string, wrong?: boolean, done: (text: string) => void}} props */
export function Entry({ id, label, text, wrong = false, done }) {
  const [typed, setTyped] = useState(/** @type {string | null} */ (null));
  const [inside, setInside] = useState(false);
  const finish = () => {
    if (typed !== null && typed.trim() !== text) done(typed.trim());
    setTyped(null);
  };
  /** All digits, chosen at once: if they came with the next drawing, what the keyboard had chosen would be lost. @param {Event} event */
  const enter = (event) => {
    const input = /** @type {HTMLInputElement} */ (event.currentTarget);
    input.value = text;
    input.select();
    setInside(true);
  };
  return html`<input class="entry" id=${id} aria-label=${label} title=${text} value=${typed ?? (inside ? text : brief(text))} aria-invalid=${wrong} autocomplete="off" spellcheck=${false}
    onInput=${(/** @type {Event} */ event) => setTyped(/** @type {HTMLInputElement} */ (event.currentTarget).value)} onFocus=${enter}
    onBlur=${() => {
      finish();
      setInside(false);
    }}
    onKeyDown=${(/** @type {KeyboardEvent} */ event) => (event.key === "Enter" ? finish() : event.key === "Escape" && setTyped(null))} />`;
}

/** The problems of the study that no field of the page tells. @param {State} state @returns {import("../api.js").Problem[]} */
export function otherProblems(state) {
  const { about, history } = state;
  const { study } = history.present;
  const fields = [...Object.keys(study.elements ?? {}).map((name) => ["elements", name]), ...numbersOf(about, history.present).map(({ place }) => place)];
  return (answerOf(state, "check").value?.problems ?? []).filter((/** @type {any} */ problem) => !fields.some((place) => place.every((key, level) => problem.place[level] === key)));
}

/** The problems of the study at a place, or below it. @param {State} state @param {string[]} place @returns {import("../api.js").Problem[]} */
export function problemsAt(state, place) {
  const problems = answerOf(state, "check").value?.problems ?? [];
  return problems.filter((/** @type {any} */ problem) => place.every((key, level) => problem.place[level] === key));
}
