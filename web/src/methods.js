// The methods that the server knows, told apart by what their rows say of them, never by a name.

/** @import { State, Store } from "./state/store.js" */
/** @typedef {{name: string, words?: string, sees: "neither" | "friction" | "both", searches: boolean,
 * averages: boolean}} Method */

/** @param {Pick<State, "about">} state @returns {Method[]} */
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
  choices: methodsOf(store.get()).map((method) => [method.name, methodTitle(method)]),
  set: (/** @type {string} */ method) => store.look({ method }) });

/** A method in words, with its name. @param {Method} method */
function methodTitle({ name, sees }) {
  const words = { neither: "no friction or gaps", friction: "with friction",
    both: "with friction and gaps" }[sees] ?? "";
  return `${words || name} (${name.replaceAll("-", " ")})`;
}
