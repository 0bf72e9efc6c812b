// What is asked of the study: its indices, and the limits that every design keeps.

import { numbersOf } from "../library.js";
import { Chip, Field, Select, textHandler, useChoice } from "../parts/controls.js";
import { enter, wronglyTyped } from "../entering.js";
import { html, useRef, useState } from "../parts/html.js";
import { freshName } from "../network/algebra.js";
import { answerOf, goalOf } from "../questions.js";
import { entryAt, indicesIn, own } from "../state/document.js";
import { capital, completed, printed } from "../state/scale.js";
import { indexName, ownIndex } from "./answers.js";
import { Entry } from "./values.js";

/** @import { Store, State } from "../state/store.js" */
/** @typedef {{path: string[], sense: string, value: string | number}} Limit  of what, as the keys of its table say
 * it */

/** A setting of an index: one of `options`, or a quantity.
 * @typedef {{key: string, sentence: string, options?: string[], example: string, unit: string}} Setting */

const PLACE = ["study", "subject_to"];

/** @param {{store: Store}} props */
export function AskedPanel({ store }) {
  const state = store.get();
  const asked = indicesIn(state.history.present.study);
  const possible = useLimitable(state).map(({ of }) => of); // what needs a road or settings of its own is none
  /** @param {string} symbol */
  const toggle = (symbol) => store.change({ type: "placed", place: ["study", "indices"], value: asked.includes(symbol)
    ? asked.filter((/** @type {string} */ each) => each !== symbol) : [...asked, symbol] });
  return html`<div class="asked"><b class="legend">Indices of the study</b>
    <div class="row" role="group" aria-label="Indices of the study">
      ${indexNames(state).filter(({ symbol }) => asked.includes(symbol) || possible.includes(symbol)).map((
        { symbol, title }) => html`<${Chip} key=${symbol} title=${title}
        on=${asked.includes(symbol)} disabled=${asked.length === 1 && asked[0] === symbol}
        set=${() => toggle(symbol)}>${indexName({ symbol, title })}<//>`)}
    </div>
    <${Constraints} store=${store} /></div>`;
}

/** The limits that every design keeps, also those of a search, and fields for a further one.
 * @param {{store: Store}} props */
export function Constraints({ store }) {
  const state = store.get();
  const { turn } = state;
  const goal = goalOf(state);
  // What is minimised stands last.
  const choices = useLimitable(state).toSorted((one, other) => Number(one.of === goal) - Number(other.of === goal));
  const [of = "", setOf] = useChoice(choices.map(({ of }) => of));
  /** @type {{key: string, words: string}[]} */
  const sides = state.about?.limit_sides ?? [];
  const [sense = "", setSense] = useChoice(sides.map(({ key }) => key));
  const [value, setValue] = useState("");
  /** @type {{of: string, sense: string, words: string}[]} */
  const told = (answerOf(state, "decision").value?.rows ?? [])
    .flatMap((/** @type {any} */ { limits }) => limits ?? []);
  /** @param {string} name */
  const named = (name) => choices.find((each) => each.of === name);
  const written = named(of)?.written ?? "";
  /** @param {string} id @param {string} before @param {string[]} place @param {string} text */
  const take = (id, before, place, text) => {
    const unit = named(place.slice(PLACE.length, -1).join("."))?.unit ?? "";
    enter(store, { id, unit, before, turn }, text,
      { type: "placed", place, value: unit === "" && text !== "" ? numberIn(text) : text });
  };
  const add = () => {
    const before = `1 ${written}`;
    if (value.trim()) take(ADDED, before, [...PLACE, ...of.split("."), sense], completed(value.trim(), before));
    setValue("");
  };
  return html`<b class="legend">Constraints on every design</b>
    ${limitsOf(state).map(({ path, sense, value }) => {
      const of = path.join(".");
      const label = told.find((each) => each.of === of && each.sense === sense)?.words
        ?? `${named(of)?.words ?? of} ${sides.find(({ key }) => key === sense)?.words}`;
      const id = `limit ${of} ${sense}`;
      return html`<p class="row" key=${id}>${label} <${Entry} id=${id} label=${label} text=${String(value)}
          done=${(/** @type {string} */ text) => take(id, String(value), [...PLACE, ...path, sense], text)} />
        <button type="button" aria-label=${`Delete the limit: ${label}`}
          onClick=${() => store.change({ type: "placed", place: PLACE,
            value: limited(entryAt(state.history.present.study, PLACE), [...path, sense], undefined) })}>
          Delete</button></p>
        <${Wrong} state=${state} id=${id} />`;
    })}
    <div class="row">
      <${Select} label="Add one on" name="of" value=${of} set=${setOf}
        choices=${choices.map(({ of, words }) => [of, capital(words)])} />
      <${Select} aria-label="Which side" name="sense" value=${sense} set=${setSense}
        choices=${sides.map(({ key, words }) => [key, words])} />
      <input class="entry" name="value" aria-label="How much, with its unit" autocomplete="off"
        placeholder=${written ? `in ${printed(written)}` : "how much"} value=${value} onInput=${textHandler(setValue)}
        onKeyDown=${(/** @type {KeyboardEvent} */ { key }) => key === "Enter" && add()} />
      <button type="button" class="edged" onClick=${add}>Add</button>
    </div>${named(of)?.note && html`<p class="quiet">${named(of)?.note}</p>`}<${Wrong} state=${state} id=${ADDED} />`;
}

const ADDED = "limit to be added"; // the field of one

/** A ratio as the file has it: a number, if it is one. @param {string} text */
const numberIn = (text) => (Number.isFinite(Number(text)) ? Number(text) : text);

/** What a constraint can be on, by the newest study without a fault. @param {State} state
 * @returns {{of: string, words: string, unit: string, written: string, note: string}[]} */
function useLimitable(state) {
  const known = useRef([]);
  const found = answerOf(state, "check").value?.limitable ?? [];
  if (found.length > 0) known.current = found;
  return known.current;
}

/** Settings of an index, as the library declares them: quantities, which an index that the file does not define has in
 * common with all others, and of the one that is minimised words to choose from.
 * @param {{store: Store, index: string, isGoal: boolean}} props */
export function IndexSettings({ store, index, isGoal }) {
  const state = store.get();
  const { study } = state.history.present;
  const isOwn = own(study.indices, index) !== undefined;
  const { choices = [], settings = [] } = kindOfIndex(state, index) ?? {};
  /** @param {string} key */
  const here = (key) => entryAt(study, ["indices", index, key]) ?? entryAt(study, ["study", key]) ?? "";
  /** @param {string} key @param {string} value @returns {import("../state/document.js").Change} */
  const change = (key, value) =>
    ({ type: "placed", place: isOwn ? ["indices", index, key] : ["study", key], value: value || undefined });
  /** @param {string} key @param {string} value */
  const choose = (key, value) => (isOwn ? store.change(change(key, value)) : define(store, index, key, value));
  /** @param {Setting} setting @param {string} typed */
  const take = ({ key, unit, example }, typed) => {
    const text = completed(typed.trim(), example);
    if (text === "") store.change(change(key, text));
    else enter(store, { id: `${key} of ${index}`, unit, before: example, turn: state.turn }, text, change(key, text));
  };
  return html`${isGoal && choices.map((/** @type {Setting} */ { key, sentence, options = [] }) => html`<p class="row"
      key=${key} title=${sentence}><${Select} label=${key} name=${key} value=${here(key)}
        choices=${[["", "none"], ...options]} set=${(/** @type {string} */ value) => choose(key, value)} /></p>`)}
    ${settings.map((/** @type {Setting} */ setting) => html`<p class="row" key=${setting.key} title=${setting.sentence}>
      <label>${setting.key.replaceAll("_", " ")} of ${index} <${Field} class="entry" text=${here(setting.key)}
        placeholder=${`such as ${setting.example}`}
        done=${(/** @type {string} */ text) => take(setting, text)} /></label></p>
      <${Wrong} state=${state} id=${`${setting.key} of ${index}`} />`)}`;
}

/** Why nothing was taken over from a field. @param {{state: State, id: string}} props */
function Wrong({ state, id }) {
  const sentence = wronglyTyped(state, id);
  return sentence === "" ? null : html`<p class="problem" role="alert">${sentence}</p>`;
}

/** Defines an index with a setting in the place of one that has none, in one step.
 * @param {Store} store @param {string} index @param {string} key @param {string} value */
function define(store, index, key, value) {
  const state = store.get();
  const { study } = state.history.present;
  const { words, title } = kindOfIndex(state, index);
  const name = freshName(title.split(" ").at(-1), [...Object.keys(study.indices ?? {}),
    ...state.about.indices.flatMap((/** @type {any} */ { symbol, words }) => [symbol, words])]);
  const lists = ["indices", "trade_off"].filter((list) => entryAt(study, ["study", list])?.includes(index));
  store.change([{ type: "placed", place: ["indices", name], value: { kind: words, [key]: value } },
    ...lists.map((list) => ({ type: /** @type {const} */ ("placed"), place: ["study", list],
      value: study.study?.[list].map((/** @type {string} */ each) => (each === index ? name : each)) }))]);
  store.look({ index: name });
}

/** What is chosen in words for an index, such as its weighting. @param {State} state @param {string} index
 * @returns {string[]} */
export const chosenFor = (state, index) => (kindOfIndex(state, index)?.choices ?? [])
  .flatMap((/** @type {Setting} */ { key }) => entryAt(state.history.present.study, ["indices", index, key]) ?? []);

/** The row of an index's kind. @param {State} state @param {string} index @returns {any} */
function kindOfIndex({ about, history }, index) {
  const kind = entryAt(history.present.study, ["indices", index, "kind"]) ?? index;
  return about?.indices.find((/** @type {any} */ { symbol, words }) => symbol === kind || words === kind);
}

/** The indices that there are, with those that the file has of its own. @param {State} state
 * @returns {{symbol: string, title: string}[]} */
function indexNames(state) {
  const { study } = state.history.present;
  const known = state.about?.indices ?? [];
  const others = [...Object.keys(study.indices ?? {}), ...indicesIn(study)].filter((symbol) =>
    !known.some((/** @type {any} */ each) => each.symbol === symbol));
  return [...known, ...[...new Set(others)].map(ownIndex)];
}

/** The limits of the study, as the library lists them. @param {State} state @returns {Limit[]} */
function limitsOf(state) {
  const { study } = state.history.present;
  const rows = numbersOf(state).filter(({ path }) => PLACE.every((key, level) => path[level] === key));
  return rows.map(({ path }) => ({
    path: path.slice(PLACE.length, -1),
    sense: path.at(-1) ?? "",
    value: entryAt(study, path),
  }));
}

/** The table of limits with another value at a place; without one, the limit and the tables that are then empty are
 * taken away. @param {any} table @param {string[]} path @param {string | undefined} value @returns {any} */
export function limited(table, [key, ...rest], value) {
  const inside = rest.length === 0 ? value : limited(table?.[key], rest, value);
  const next = Object.fromEntries(Object.entries({ ...table, [key]: inside }).filter(([, each]) => each !== undefined));
  return Object.keys(next).length === 0 ? undefined : next;
}
