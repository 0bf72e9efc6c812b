// Every number of elements, vehicle and road: a slider on a logarithmic scale, exact entry in any unit, bounds, and
// whether it may vary; and the best values of what may.

import { enter, isBeingRead, wronglyTyped } from "../entering.js";
import { isSearched, judging, kindOf, layoutsWith, numbersOf, quickMethod, selectedElement, wrongIn }
  from "../library.js";
import { Moving } from "../parts/clock.js";
import { Name, Select, formHandler, textHandler } from "../parts/controls.js";
import { html, useState } from "../parts/html.js";
import { shortLabel } from "../network/drawing.js";
import { answerOf, bestOf, goalOf, isFitting, unitKey } from "../questions.js";
import { entryAt, isRange, own } from "../state/document.js";
import { STEPS, brief, briefIn, capital, completed, positionOf, printed, quantity, takenApart, valueAt }
  from "../state/scale.js";
import { TAKEN, toldOfValues } from "../state/store.js";
import { optimise } from "../working.js";

/** @import { Store, State } from "../state/store.js" */
/** @import { Api } from "../api.js" */
/** @import { Change, Document } from "../state/document.js" */
/** @import { NumberRow } from "../library.js" */
/** @import { Problem } from "../api.js" */

const DECADE = 10;
const [STEP, LARGE, FINE] = [0.01, 0.1, 0.001]; // by which an arrow key changes a value

/** A number of the document: its text, the bounds of its slider, and the change to another text.
 * `best`: the text that was found to be the best.
 * @typedef {{row: NumberRow, label: string, text: string, range: {from: string, to: string}, free: boolean,
 * best?: string, set: (text: string) => Change}} Amount */

const ELEMENTS = "elements";
const FEW = 8; // numbers of one table that stand below each other; more are folded away, and those in tables of tables
const SHORT = 3; // letters of a name that leave the slider long
const LONG = 14; // characters of a value that take the room of the check box too, or are smaller where there is one

/** @param {{store: Store, api: Api}} props */
export function ValuesPanel({ store, api }) {
  const state = store.get();
  const { study, layout } = state.history.present;
  const rows = numbersOf(state);
  const chosen = selectedElement(state);
  const elements = rows.filter(({ path }) => path[0] === ELEMENTS);
  const used = elements.filter(({ path }) => layoutsWith(state, path[1])?.includes(layout));
  const other = elements.filter((row) => !used.includes(row));
  const names = new Set(other.map(({ path }) => path[1]));
  const sections = [...new Set(rows.map(({ path }) => path[0]))].filter((section) => section !== ELEMENTS);
  /** @param {NumberRow[]} several */
  const amounts = (several) => several.map((row) => html`<${AmountRow} key=${`${layout} ${idOf(row)}`} store=${store}
    amount=${amountOf(state, row)} chosen=${chosen !== null && row.name === chosen}
    lit=${state.lit !== null && row.path[0] === ELEMENTS && row.path[1] === state.lit}
    wide=${several.some((each) => labelOf(each).length > SHORT)} />`);
  return html`<section class="panel values" aria-labelledby="values-title" data-keys="Values">
    <${FindBest} store=${store} api=${api} />
    <div class="inside">
    <h3>${layout && `Strut ${layout}`}<span>may vary</span></h3>
    ${amounts(used)}
    ${names.size > 0 &&
    html`<details><summary>${`Elements of other layouts (${names.size})`}</summary>${amounts(other)}</details>`}
    ${sections.map((section) => {
      const inside = rows.filter(({ path }) => path[0] === section);
      const tables = [...new Set(inside.map(tableOf))];
      return html`<section key=${section} id=${`${section}-values`}>
        <h3>${titleOf(section, study[section]?.model)}</h3>
        ${tables.map((table) => {
          const several = inside.filter((row) => tableOf(row) === table);
          return html`<${NumberTable} key=${table} table=${table} rows=${several}>${amounts(several)}<//>`;
        })}</section>`;
    })}</div>
  </section>`;
}

/** The best values of what may vary. @param {{store: Store, api: Api}} props */
function FindBest({ store, api }) {
  const state = store.get();
  const { study, layout } = state.history.present;
  const goal = goalOf(state);
  const all = Object.keys(study.layouts ?? {}).filter((name) => !isSearched(state, name));
  const [searched, setSearched] = useState(/** @type {Document | null} */ (null));
  const here = judging(state);
  const method = here?.searches ? here : quickMethod(state);
  const isMain = !isSearched(state, layout) && !isFitting(state);
  const ready = goal && method && all.length > 0;
  return html`<form class="optimise" onSubmit=${formHandler(async (_, { submitter }) => {
    if (!ready) return;
    setSearched(state.history.present);
    const layouts = submitter?.getAttribute("value") === "one" ? [layout] : all;
    const text = await optimise(store, api, { study, layouts,
      index: goal, method: method.name });
    setSearched(null);
    if (store.get().history.present.study === study) store.say(text, TAKEN);
  })}>
    <div class="head"><h2 id="values-title">Values</h2>
      ${all.length > 1 && all.includes(layout) && html`<button value="one" disabled=${!ready}
        title="The others keep their values">Only ${shortLabel(layout)}</button>`}
      <button class=${isMain ? "main" : ""} id="find-best" disabled=${!ready}
        title="Of all layouts, so that they are compared at their best">Find best <kbd>O</kbd></button></div>
    <p role="status">${searched === state.history.present ? html`<${Moving} what="Searching" />`
      : toldOfValues(state)}</p>
  </form>`;
}

/** @param {NumberRow} row */
const idOf = ({ path }) => path.join(".");

/** @param {string} section @param {unknown} model  which one of its kind it is, if it says so */
function titleOf(section, model) {
  return capital(section) + (model ? `: ${String(model).replace("-", " ")}` : "");
}

/** The table of a section in which a number stands, if it is in one. @param {NumberRow} row */
const tableOf = ({ path }) => (path.length > 2 ? path[1] : "");

/** The numbers of one table. @param {{table: string, rows: NumberRow[], children: any}} props */
function NumberTable({ table, rows, children }) {
  if (table === "") return children;
  const deep = rows.some(({ path }) => path.length > 3);
  const open = !deep && rows.length <= FEW;
  const summary = `${table.replaceAll("_", " ")} (${rows.length})`;
  return html`<details class=${`table ${deep ? "deep" : ""}`} open=${open}>
    <summary>${summary}</summary>${children}
  </details>`;
}

/** @param {State} state @param {NumberRow} row @returns {Amount} */
function amountOf(state, row) {
  const { study, layout, values, ranges } = state.history.present;
  const { path, name, unit } = row;
  const entry = entryAt(study, path);
  const label = labelOf(row);
  if (isRange(entry)) {
    const text = own(own(values, layout), name) ?? middle(state, entry, unit);
    const set = (/** @type {string} */ value) =>
      /** @type {Change} */ ({ type: "valued", layout, values: { [name]: value } });
    return { row, label, text, range: entry, free: true, best: own(bestOf(state, layout), name), set };
  }
  const text = String(entry);
  const bare = typeof entry === "number" || unit === PURE || unit === "";
  const set = (/** @type {string} */ value) =>
    /** @type {Change} */ ({ type: "placed", place: path, value: bare ? written(value) : value });
  return { row, label, text, range: own(ranges, idOf(row)) ?? decade(text), free: false, set };
}

/** What a number is called below the title of its section, or of its table. An element has its own name, and its
 * further numbers theirs beside it. @param {NumberRow} row */
function labelOf({ path, place }) {
  if (path[0] === ELEMENTS) return place.replace(`${ELEMENTS}.`, "").replaceAll(".", ", ");
  return path.slice(path.length > 2 ? 2 : 1).join(", ").replaceAll("_", " ");
}

const PURE = "1"; // the unit of a mere number

/** What is a mere number is written as one. @param {string} value */
const written = (value) => (value !== "" && Number.isFinite(Number(value)) ? Number(value) : value);

/** The size of a text in SI, or null where it is not known.
 * @param {State} state @param {string} text @param {string} unit */
function sizeOf(state, text, unit) {
  const apart = takenApart(text);
  const one = apart && oneOf(state, apart.unit, unit);
  return apart && one !== null ? apart.number * one : null;
}

/** How much one of a unit is in another, or null where it is not known.
 * @param {State} state @param {string} own @param {string} unit */
function oneOf(state, own, unit) {
  const same = own === unit ? unit !== "" : own === "" && unit === PURE;
  return same ? 1 : (state.quantities[unitKey(own, unit)]?.value ?? null);
}

/** The geometric mean of the bounds, in the unit of the lower one.
 * @param {State} state @param {{from: string, to: string}} range @param {string} unit */
function middle(state, { from, to }, unit) {
  const [lower, upper] = [sizeOf(state, from, unit), sizeOf(state, to, unit)];
  return lower === null || upper === null ? "" : inUnitOf(state, from, unit, Math.sqrt(lower * upper));
}

/** A size as text in the unit of another.
 * @param {State} state @param {string} like @param {string} unit @param {number} size */
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

/** @param {{store: Store, amount: Amount, wide: boolean, chosen: boolean, lit: boolean}} props */
function AmountRow({ store, amount, wide, chosen, lit }) {
  const state = store.get();
  const { row, label, text, range, free, best, set } = amount;
  const { unit, path: place, name } = row;
  const id = idOf(row);
  const names = own(state.about?.named_values, unit);
  const named = Object.keys(names ?? {}).find((each) => names[each] === text);
  const note = place[0] === ELEMENTS && place.length === 2 && kindOf(state, place[1])?.unit_note;
  const [size, lower, upper] = [text, range.from, range.to].map((each) => sizeOf(state, each, unit));
  const usable = size !== null && lower !== null && upper !== null && lower * upper > 0
    && Math.abs(upper) > Math.abs(lower);
  const wrong = wronglyTyped(state, id);
  const problems = wrong ? [{ sentence: wrong }] : problemsOf(state).filter((problem) => isAt(problem, place));
  const { turn } = state;
  const gesture = `slide ${id}`;
  /** @param {number} next */
  const slide = (next) => {
    if (!free && !Object.hasOwn(state.history.present.ranges, id)) {
      store.change({ type: "ranged", place: id, from: range.from, to: range.to }, gesture);
    }
    store.change(set(inUnitOf(state, text, unit, next)), gesture);
  };
  const vary = () => store.change(free ? { type: "fixed", place, name, text }
    : { type: "freed", place, name, ...range, method: quickMethod(state)?.name });
  /** @param {KeyboardEvent} event */
  const onKey = (event) => {
    const up = { ArrowUp: 1, ArrowRight: 1, ArrowDown: -1, ArrowLeft: -1 }[event.key];
    if (up && usable && !event.ctrlKey && !event.metaKey) slide(size * (1 + up * (event.shiftKey ? LARGE
      : event.altKey ? FINE : STEP)));
    else if (event.key === "Home" && best !== undefined) store.change(set(best), gesture);
    else if (event.key.toLowerCase() === "x" && row.may_be_free) vary();
    else return;
    event.preventDefault();
  };
  const told = named ? `class ${named}` : free ? briefIn(state.about, text, unit) : brief(text, state.about, unit);
  const classes = ["amount", wide && "wide", told.length > LONG && "long", free && "free",
    (chosen || lit) && "chosen"].filter(Boolean);
  const light = (/** @type {string | null} */ element) => () => store.dispatch({ type: "lit", name: element });
  const found = best === undefined ? null : sizeOf(state, best, unit);
  const mark = found !== null && usable ? positionOf(found, lower, upper) / STEPS : null;
  return html`<div class=${classes.join(" ")} data-place=${id} aria-busy=${isBeingRead(state, id)}
      onPointerEnter=${place[0] === ELEMENTS && light(place[1])} onPointerLeave=${light(null)}>
    <${Bounds} store=${store} amount=${amount} />
    <input id=${`slider ${id}`} type="range" min="0" max=${STEPS} aria-label=${label}
      class=${mark === null ? "" : "marked"} style=${mark === null ? null : { "--best": mark }}
      title=${`${range.from} to ${range.to}${best === undefined ? "" : `; the best found is ${
        briefIn(store.get().about, best, unit)}`}`}
      value=${usable ? positionOf(size, lower, upper) : 0} disabled=${!usable} aria-valuetext=${text}
      onInput=${textHandler((position) => usable && slide(valueAt(Number(position), lower, upper)))}
      onKeyDown=${onKey} onKeyUp=${() => store.dispatch({ type: "rested" })}
      onChange=${() => store.dispatch({ type: "rested" })} />
    <${Entry} id=${`entry ${id}`} label=${`${label}, exactly`} text=${text} wrong=${problems.length > 0}
      names=${names} told=${told}
      drag=${usable && ((/** @type {PointerEvent} */ event) => dragged(event, size, slide, () =>
        store.dispatch({ type: "rested" })))}
      done=${(/** @type {string} */ value) => enter(store, { id, unit, before: text, turn }, value, set(value))} />
    ${row.may_be_free && html`<input type="checkbox" checked=${free} aria-label=${`${label} may vary`}
      onChange=${vary} />`}
    ${note && html`<p class="quiet">${note}</p>`}
    ${problems.map(({ sentence }) => html`<p class="problem" role="alert" ref=${wrong && showWhole}>${sentence}</p>`)}
  </div>`;
}

/** Shows what has come as a whole, of what scrolls as little as that needs. @param {Element | null} element */
const showWhole = (element) => element?.scrollIntoView({ block: "nearest" });

/** What a number is, and its bounds. @param {{store: Store, amount: Amount}} props */
function Bounds({ store, amount }) {
  const { row, label, text, range, free, set } = amount;
  const { path: place, sentence, words } = row;
  const [section, element] = place;
  const removable = section === ELEMENTS && layoutsWith(store.get(), element)?.length === 0;
  const id = place.join(".");
  const { turn, about } = store.get();
  const names = own(about?.named_values, row.unit);
  /** @param {string} value @param {"from" | "to"} end */
  const setEnd = (value, end) => {
    const next = { ...range, [end]: value };
    enter(store, { id, unit: row.unit, before: range[end], turn }, value, free ? { type: "placed", place, value: next }
      : { type: "ranged", place: id, ...next });
  };
  return html`<details class="bounds" onToggle=${(/** @type {ToggleEvent} */ { currentTarget: box }) =>
    /** @type {HTMLDetailsElement} */ (box).open && showWhole(/** @type {Element} */ (box).lastElementChild)}>
    <summary aria-label=${`${label}: bounds`} class=${section === ELEMENTS ? "symbol-name" : ""}
      title=${printed(sentence || words)}><${Name} label=${label} element=${section === ELEMENTS} /></summary>
    <div class="menu-body">
      <p class="quiet">${printed(sentence || words)}</p>
      ${names && html`<${Select} label="class" selected=${text} choices=${[["", "none"], ...classesOf(names)]}
        set=${(/** @type {string} */ value) => value && enter(store, { id, unit: row.unit, before: text, turn }, value,
          set(value))} />`}
      <label>from <${Entry} id=${`from ${place.join(".")}`} label="from" text=${range.from}
        done=${(/** @type {string} */ from) => setEnd(from, "from")} /></label>
      <label>to <${Entry} id=${`to ${place.join(".")}`} label="to" text=${range.to}
        done=${(/** @type {string} */ to) => setEnd(to, "to")} /></label>
      ${removable && html`<button type="button"
        onClick=${() => store.change({ type: "elementRemoved", name: element })}>Delete ${element}</button>`}
    </div>
  </details>`;
}

/** Named values to choose from, each with all its names. @param {{[name: string]: string}} names */
const classesOf = (names) => [...new Set(Object.values(names))].map((text) =>
  [text, Object.keys(names).filter((name) => names[name] === text).join(", ")]);

const [DRAGGED, PIXEL] = [4, 0.005]; // [px] from where a press is a drag, and by how much a pixel changes a number

/** Changes a number as the pointer is dragged sideways; a press that is none goes into the field.
 * @param {PointerEvent} event @param {number} size @param {(size: number) => void} slide @param {() => void} rested */
function dragged({ currentTarget, clientX: begun, pointerId, button, pointerType }, size, slide, rested) {
  const field = /** @type {HTMLInputElement} */ (currentTarget);
  if (button !== 0 || pointerType === "touch" || field === globalThis.document.activeElement) return;
  const over = new AbortController();
  let far = false;
  field.setPointerCapture(pointerId);
  field.addEventListener("mousedown", (event) => event.preventDefault(), { once: true, signal: over.signal });
  field.addEventListener("pointermove", ({ clientX, shiftKey, altKey }) => {
    far ||= Math.abs(clientX - begun) >= DRAGGED;
    if (far) slide(size * Math.exp((clientX - begun) * PIXEL * (shiftKey ? 10 : altKey ? 0.1 : 1)));
  }, { signal: over.signal });
  const end = () => {
    over.abort();
    if (far) rested();
    else field.focus();
  };
  for (const name of ["pointerup", "pointercancel"]) field.addEventListener(name, end, { signal: over.signal });
}

/** A text that is taken over with Enter or on leaving, to where it belonged when it was begun; while nobody is in
 * it, it shows what is `told`, with no more digits than fit, and can be dragged.
 * @param {{id: string, label: string, text: string, told?: string, wrong?: boolean, done: (text: string) => void,
 * names?: {[name: string]: string}, drag?: ((event: PointerEvent) => void) | false}} props */
export function Entry({ id, label, text, told = brief(text), wrong = false, done, drag = false, names }) {
  const [typed, setTyped] = useState(/** @type {{now: string, before: string, done: typeof done} | null} */ (null));
  const [inside, setInside] = useState(false);
  const finish = () => {
    if (typed !== null && typed.now.trim() !== typed.before) typed.done(completed(typed.now.trim(), typed.before,
      names));
    setTyped(null);
  };
  /** All digits, chosen at once: if they came with the next drawing, what the keyboard had chosen would be lost.
   * @param {Event} event */
  const enter = (event) => {
    const input = /** @type {HTMLInputElement} */ (event.currentTarget);
    input.value = text;
    input.select();
    setInside(true);
  };
  return html`<input class="entry" id=${id} aria-label=${label} title=${text}
    value=${typed?.now ?? (inside ? text : printed(told))}
    aria-invalid=${wrong} autocomplete="off" spellcheck=${false} onPointerDown=${drag}
    onInput=${textHandler((now) => setTyped({ before: text, done, ...typed, now }))} onFocus=${enter}
    onBlur=${() => {
      finish();
      setInside(false);
    }}
    onKeyDown=${(/** @type {KeyboardEvent} */ event) =>
      (event.key === "Enter" ? finish() : event.key === "Escape" && setTyped(null))} />`;
}

/** The problems of the study. @param {State} state @returns {Problem[]} */
export const problemsOf = (state) => answerOf(state, "check").value?.problems ?? [];

/** Why there are no curves. @param {{state: State, sentence: string | null}} props */
export const NoCurves = ({ state, sentence }) => sentence && html`<p class="problem">${problemsOf(state).length > 0
  ? "There are no curves: see what is wrong with the study." : sentence}</p>`;

/** The problems of the study that no field of the page tells. @param {State} state */
export function otherProblems(state) {
  const { layout } = state.history.present;
  const fields = [...numbersOf(state).map(({ path }) => path), ...(wrongIn(state) ? [["layouts", layout]] : [])];
  return problemsOf(state).filter((problem) => !fields.some((place) => isAt(problem, place)));
}

/** Whether a problem is at a place, or below it. @param {Problem} problem @param {string[]} place */
const isAt = (problem, place) => place.every((key, level) => problem.place[level] === key);
