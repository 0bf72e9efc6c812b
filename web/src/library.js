// What the library says of the study that is edited: its networks as trees, its elements, its numbers. The newest
// answer stands until the next one comes; of what it names, what the document has no longer is left out.

import { partAt } from "./network/algebra.js";
import { entryAt, isRange, own, textOf } from "./state/document.js";

/** @import { State, Store } from "./state/store.js" */
/** @import { Tree } from "./network/algebra.js" */
/** A number that the document gives: the keys to its text, its place in sweeps, its SI unit, and its name where it may
 * be free. @typedef {{path: string[], place: string, words: string, sentence: string, unit: string,
 * value: number | null, may_be_free: boolean, name: string}} NumberRow */
/** @typedef {{path: string[], text: string, tree?: any, names?: string[], at?: [number, number], sentence?: string}}
 * NetworkRow */
/** @typedef {{networks: NetworkRow[], layouts: {[layout: string]: {elements: string[], free: string[],
 * free_networks: string[]}},
 * elements: {[name: string]: {kind: string | null, layouts: string[]}}, numbers: NumberRow[]}} Parts */

/** @typedef {{name: string, title: string, sees: "neither" | "friction" | "both", searches: boolean,
 * averages: boolean}} Method */

/** @type {Parts} */
const NOTHING = { networks: [], layouts: {}, elements: {}, numbers: [] };

/** @param {State} state */
const partsOf = ({ parts }) => parts ?? NOTHING;

/** @template T @param {{[key: string]: T}} table @param {string} key @returns {T | null} */
const at = (table, key) => own(table, key) ?? null;

/** The tree of a text, null where it is no network or not known yet. @param {State} state @param {string} text */
export const treeOf = ({ trees }, text) => at(trees, text);

/** The element that is selected in the drawing. @param {State} state */
export function selectedElement(state) {
  const tree = treeOf(state, textOf(state.history.present));
  const part = tree && partAt(tree, state.view.path);
  return part?.kind === "element" ? part.name : null;
}

/** The element that is pointed at, else the one that is selected. @param {State} state */
export const shownElement = (state) =>
  (own(state.history.present.study.elements, state.lit ?? "") === undefined ? selectedElement(state) : state.lit);

/** What is wrong with the network that is edited. @param {State} state
 * @returns {{at: [number, number], sentence: string} | null} */
export function wrongIn(state) {
  const text = textOf(state.history.present);
  const row = partsOf(state).networks.find((each) => each.text === text && each.sentence !== undefined);
  return row?.at && row.sentence !== undefined ? { at: row.at, sentence: row.sentence } : null;
}

/** The numbers that the document gives. @param {State} state @returns {NumberRow[]} */
export function numbersOf(state) {
  const { study } = state.history.present;
  return partsOf(state).numbers.filter(({ path }) => isAmount(entryAt(study, path)));
}

/** @param {unknown} entry */
const isAmount = (entry) => typeof entry === "string" || typeof entry === "number" || isRange(entry);

/** The elements in the networks of a layout. @param {State} state @param {string} layout @returns {string[]} */
export const elementsIn = (state, layout) => at(partsOf(state).layouts, layout)?.elements ?? [];

/** The layouts with a free network, which a search chooses. @param {State} state @returns {string[]} */
export const searchedLayouts = (state) => Object.keys(state.history.present.study.layouts ?? {})
  .filter((name) => isSearched(state, name));

/** Whether a layout has a free network, so that it is no design. @param {State} state @param {string} layout */
export const isSearched = (state, layout) => (at(partsOf(state).layouts, layout)?.free_networks.length ?? 0) > 0;

/** Whether an element is a free network. @param {State} state @param {string} name */
export const isFreeNetwork = (state, name) =>
  Object.values(partsOf(state).layouts).some(({ free_networks: free }) => free.includes(name));

/** The layouts that depend on an element, null where that is not known yet. @param {State} state
 * @param {string} name */
export const layoutsWith = (state, name) => at(partsOf(state).elements, name)?.layouts ?? null;

/** What is free in a layout. @param {State} state @param {string} layout @returns {string[]} */
export function freeIn(state, layout) {
  const { study } = state.history.present;
  const free = numbersOf(state)
    .filter(({ path }) => isRange(entryAt(study, path)))
    .map(({ name }) => name);
  return (at(partsOf(state).layouts, layout)?.free ?? []).filter((name) => free.includes(name));
}

/** The free values of a design that nobody has chosen yet: they are in the middle of their bounds. @param {State} state
 * @param {{layout: string, values: {[element: string]: string}}} design @returns {string[]} */
export const unchosenIn = (state, { layout, values }) =>
  freeIn(state, layout).filter((name) => own(values, name) === undefined);

/** The row of an element's kind. @param {State} state @param {string} name @returns {any} */
export const kindOf = (state, name) => kindNamed(state, at(partsOf(state).elements, name)?.kind);

/** The row of a kind. @param {Pick<State, "about">} state @param {string | null | undefined} known @returns {any} */
export const kindNamed = (state, known) =>
  (known ? state.about?.elements.find((/** @type {any} */ { key }) => key === known) : null);

/** The unit of a free value. @param {State} state @param {string} name @returns {string} */
export const unitOf = (state, name) => partsOf(state).numbers.find((row) => row.name === name)?.unit ?? "";

/** The methods that the server knows, told apart by what their rows say of them, never by a name.
 * @param {Pick<State, "about">} state @returns {Method[]} */
const methodsOf = ({ about }) => about?.methods ?? [];

/** Whether it sees neither friction nor gaps: its answers come at once. @param {Method | undefined} method */
export const isQuick = (method) => method?.sees === "neither";

/** The one with which the page searches while one waits. @param {Pick<State, "about">} state */
export const quickMethod = (state) => methodsOf(state).find((method) => isQuick(method) && method.searches);

/** The one of that name; without one of the name the quick one.
 * @param {Pick<State, "about">} state @param {string} name */
export const methodOf = (state, name) => methodsOf(state).find((method) => method.name === name) ?? quickMethod(state);

/** The one by which the page judges. @param {Pick<State, "about" | "view">} state */
export const judging = (state) => methodOf(state, state.view.method);

/** What chooses the one by which the page judges. @param {Store} store */
export const methodChoice = (store) => ({ value: judging(store.get())?.name,
  choices: methodsOf(store.get()).map((method) => [method.name, method.title]),
  set: (/** @type {string} */ method) => store.look({ method }) });

/** The suffixes of files of records. @param {State} state @returns {string[]} */
export const recordSuffixes = ({ about }) => about?.record_suffixes ?? [];

/** As which the library declares a vehicle to be drawn. @param {Pick<State, "about">} state @param {any} vehicle
 * @returns {string} */
export const outlineOf = ({ about }, vehicle) =>
  about?.vehicles?.find((/** @type {any} */ { key }) => key === vehicle?.model)?.outline ?? "";
