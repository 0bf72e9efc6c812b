// All state in one place. What happens is dispatched, `reduce` gives the next state, and who subscribed is told; nothing else
// changes anything.

import { after, empty, isChange } from "./document.js";
import { beginning, changed, redone, rested, undone } from "./history.js";

/** @typedef {import("./document.js").Document} Document */
/** @typedef {import("./document.js").Change} Change */
/** @typedef {import("./history.js").History<Document>} DocumentHistory */
/** @typedef {import("../network/algebra.js").Path} Path */
/** @typedef {{key: string, value: any, sentence: string | null, waiting: boolean, of: string | null}} Answer  of a panel, and to which question */
/** @typedef {{id: string, kind: string, title: string, state: "waiting" | "running" | "done" | "stopped" | "failed", share: number | null, sentence: string | null, result: any}} Job */
/** @typedef {{path: Path, tab: string, theme: "auto" | "light" | "dark", method: string, index: string, speed: number, playing: boolean, compared: string[], against: string, seconds: number, seed: number, across: boolean}} View  `method`: by which is judged, the quick one where it is empty; `against`: what the others are compared with; `across`: the drawing over the width of the page */
/** @typedef {"connecting" | "compiling" | "ready" | "lost" | "refused"} Connection */
/** @typedef {{history: DocumentHistory, answers: {[panel: string]: Answer}, work: {[id: string]: Job}, quantities: {[key: string]: {value?: number, sentence?: string}}, records: any[], view: View, about: any, connection: Connection, message: string | null}} State */

/** @typedef {{type: "changed", change: Change, gesture: string | null}
 *  | {type: "began"} | {type: "rested"} | {type: "undone"} | {type: "redone"}
 *  | {type: "asked", panel: string, question: string}
 *  | {type: "answered", panel: string, question: string, value: any}
 *  | {type: "refused", panel: string, question: string, sentence: string}
 *  | {type: "measured", quantities: {[key: string]: {value?: number, sentence?: string}}}
 *  | {type: "worked", job: Partial<Job> & {id: string}}
 *  | {type: "dropped", id: string}
 *  | {type: "recorded", record: any}
 *  | {type: "unrecorded", id: string}
 *  | {type: "viewed", view: Partial<View>}
 *  | {type: "told", about: any}
 *  | {type: "connected", connection: Connection}
 *  | {type: "said", message: string | null}} Action */

/** @typedef {{get: () => State, dispatch: (action: Action) => void, change: (change: Change, gesture?: string | null) => void, subscribe: (told: () => void) => () => void}} Store */

/** @returns {State} */
export const initial = () => ({
  history: beginning(empty()),
  answers: {},
  work: {},
  quantities: {},
  records: [],
  view: { path: [], tab: "response", theme: "auto", method: "", index: "", speed: 1, playing: false, compared: [], against: "", seconds: 10, seed: 0, across: false },
  about: null,
  connection: "connecting",
  message: null,
});

/** @type {Answer} */
const NOTHING = { key: "", value: null, sentence: null, waiting: false, of: null };

/** @type {{[type: string]: (state: State, action: any) => State}} */
const STEPS = {
  changed: (state, { change, gesture }) => ({ ...state, history: changed(state.history, after(state.history.present, change), gesture) }),
  began: (state) => ({ ...state, history: beginning(state.history.present) }),
  rested: (state) => ({ ...state, history: rested(state.history) }),
  undone: (state) => ({ ...state, history: undone(state.history) }),
  redone: (state) => ({ ...state, history: redone(state.history) }),
  asked: (state, { panel, question }) => answer(state, panel, { key: question, waiting: true }),
  answered: (state, { panel, question, value }) => answer(state, panel, { of: question, value, sentence: null, waiting: question !== state.answers[panel]?.key }),
  refused: (state, { panel, question, sentence }) => answer(state, panel, { of: question, sentence, waiting: question !== state.answers[panel]?.key }),
  measured: (state, { quantities }) => ({ ...state, quantities: { ...state.quantities, ...quantities } }),
  worked: (state, { job }) => ({ ...state, work: { ...state.work, [job.id]: { ...state.work[job.id], ...job } } }),
  dropped: (state, { id }) => ({ ...state, work: Object.fromEntries(Object.entries(state.work).filter(([each]) => each !== id)) }),
  recorded: (state, { record }) => ({ ...state, records: [...state.records.filter(({ id }) => id !== record.id), record] }),
  unrecorded: (state, { id }) => ({ ...state, records: state.records.filter((each) => each.id !== id) }),
  viewed: (state, { view }) => ({ ...state, view: { ...state.view, ...view } }),
  told: (state, { about }) => ({ ...state, about }),
  connected: (state, { connection }) => (connection === state.connection ? state : { ...state, connection }),
  said: (state, { message }) => ({ ...state, message }),
};

/** @param {State} state @param {string} panel @param {Partial<Answer>} more @returns {State} */
const answer = (state, panel, more) => ({ ...state, answers: { ...state.answers, [panel]: { ...(state.answers[panel] ?? NOTHING), ...more } } });

/** @param {State} state @param {Action} action @returns {State} */
export const reduce = (state, action) => STEPS[action.type](state, action);

/** @param {State} [state] @returns {Store} */
export function createStore(state = initial()) {
  /** @type {Set<() => void>} */
  const listeners = new Set();
  /** @param {Action} action */
  function dispatch(action) {
    const next = reduce(state, action);
    if (next === state) return;
    state = next;
    for (const told of listeners) told();
  }
  return {
    get: () => state,
    dispatch,
    change: (change, gesture = null) => {
      if (isChange(change)) dispatch({ type: "changed", change, gesture });
    },
    subscribe: (told) => {
      listeners.add(told);
      return () => void listeners.delete(told);
    },
  };
}
