// What kind of element a name stands for.

import { fieldsOfVehicle, unitKey } from "./questions.js";
import { isRange } from "./state/document.js";
import { takenApart } from "./state/scale.js";

/** @typedef {import("./state/store.js").State} State */

/** The row of an element's kind, told by its entry. @param {State} state @param {string} name @returns {any} */
export function kindOf(state, name) {
  const entry = state.history.present.study.elements?.[name];
  if (entry === undefined) return null;
  const rows = state.about?.elements ?? [];
  if (typeof entry === "object" && "kind" in entry) return rows.find((/** @type {any} */ { key }) => key === entry.kind);
  const written = takenApart(isRange(entry) ? entry.from : entry);
  const size = written && state.quantities[unitKey(written.unit, null)];
  return size ? rows.find((/** @type {any} */ { key, unit }) => key === /** @type {any} */ (size).key || (!("key" in size) && unit === written.unit)) : null;
}


/** The unit of a free value: of an element by its kind, else of a number of the vehicle. @param {State} state @param {string} name @returns {string} */
export function unitOf(state, name) {
  const rows = /** @type {any[]} */ (fieldsOfVehicle(state.about, state.history.present));
  return kindOf(state, name)?.unit ?? rows.find(({ key }) => key === name)?.unit ?? "";
}
