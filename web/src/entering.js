// What is typed into the field of a number: a text in a unit whose size is known becomes its value at once, any other
// when the server has read it. What is no quantity of that unit changes nothing, and its sentence stands at the field.

import { unitKey } from "./questions.js";
import { panelOf } from "./state/answers.js";
import { takenApart } from "./state/scale.js";

/** @import { Store, State } from "./state/store.js" */
/** @import { Change } from "./state/document.js" */
/** A text that was typed into a field, by its id; `change` is what it does if it is a quantity of `unit`, and
 * `sentence` why it is none. @typedef {{id: string, text: string, unit: string, change: Change,
 * sentence?: string}} Typed */

/** Takes over what was typed in the place of `before`, unless another document has come since `turn`.
 * @param {Store} store @param {{id: string, unit: string, before: string, turn: number}} field
 * @param {string} text @param {Change} change */
export function enter(store, { id, unit, before, turn }, text, change) {
  if (turn !== store.get().turn) return;
  if (isOf(store.get(), unit, before, text)) store.change(change);
  else store.dispatch({ type: "typed", typed: { id, text, unit, change } });
}

const PURE = "1"; // the unit of a mere number

/** Whether a text is known to be in a unit. @param {State} state @param {string} unit @param {string} before
 * @param {string} text */
function isOf({ quantities }, unit, before, text) {
  if (unit === "" || unit === PURE) return true;
  const apart = takenApart(text);
  if (apart === null || apart.unit === "") return false;
  const units = [unit, takenApart(before)?.unit];
  return units.includes(apart.unit) || quantities[unitKey(apart.unit, unit)]?.value !== undefined;
}

/** What was typed into a field and is not taken over. @param {State} state @param {string} id */
const typedInto = ({ typed }, id) => typed.find((each) => each.id === id);

/** Why nothing was taken over from a field; empty where nothing is wrong. @param {State} state @param {string} id */
export function wronglyTyped(state, id) {
  const typed = typedInto(state, id);
  return typed ? (typed.sentence ?? state.answers[panelOf(typed)]?.kept[0]?.sentence ?? "") : "";
}

/** Whether the server is reading what was typed into a field. @param {State} state @param {string} id */
export const isBeingRead = (state, id) => typedInto(state, id) !== undefined && wronglyTyped(state, id) === "";
