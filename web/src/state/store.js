// All state in one place. What happens is dispatched, `reduce` gives the next state, and who subscribed is told;
// nothing else changes anything.

import { answered, asked, panelOf, turned } from "./answers.js";
import { after, empty, isChange, without } from "./document.js";
import { canonical } from "../network/algebra.js";
import { beginning, changed, redone, rested, undone } from "./history.js";

/** @import { Document, Change, Study } from "./document.js" */
/** @import { Path, Tree } from "../network/algebra.js" */
/** @import { Parts } from "../library.js" */
/** @import { Answers } from "./answers.js" */
/** @import { Typed } from "../entering.js" */
/** @import { Gesture } from "./history.js" */
/** @typedef {import("./history.js").History<Document>} DocumentHistory */
/** What the page has to say: `about` tells which message a newer one replaces, `offer` what a button beside it does,
 * `of` the document to which it was said.
 * @typedef {{label: string, act: () => void}} Offer */
/** @typedef {{about: string, text: string, of: Document, offer?: Offer, brief?: boolean}} Message */
/** @typedef {{id: string, kind: string, title: string, study: string,
 * state: "waiting" | "running" | "done" | "stopped" | "failed", begun: number | null, share: number | null,
 * sentence: string | null, found?: any, result: any}} Job  `study`: its title; `begun`: in seconds since 1970, by the
 * clock of the server; `found`: a result so far */
/** @typedef {{path: Path, tab: string, theme: "auto" | "light" | "dark", method: string, index: string, speed: number,
 * playing: boolean, compared: string[] | null, against: string, seconds: number, seed: number, output: string,
 * across: boolean, tall: boolean, ghosts: string[], response: string}} View  `index`: by which layouts are ranked, the
 * first of the study where it is none of them; `response`: the index whose response is drawn, likewise; `output`: of
 * the motion, the first where it is empty; `ghosts`: designs whose responses are drawn too; `method`: by which is
 * judged, the quick one where it is empty; `against`: what others are compared with; `across`: the drawing over the
 * width of the page; `tall`: the tabs over the height of it */
/** @typedef {"connecting" | "compiling" | "ready" | "lost" | "refused"} Connection */
/** `sought`: what was last asked by a button of a panel, beside the design. `choosing`: the study whose free values
 * are being chosen just now. `parts`: what the library last said that a study is made of; `trees`: networks that are
 * known, by their texts. `turn`: how many documents have taken the place of another one. `lit`: the element that is
 * pointed at; `typed`: what was typed into fields, one each, and is not taken over.
 * @typedef {{history: DocumentHistory, answers: {[panel: string]: Answers}, sought: {[panel: string]: any},
 * choosing: Study | null, work: {[id: string]: Job}, quantities: {[key: string]: {value?:
 * number, sentence?: string}}, parts: Parts | null, trees: {[text: string]: Tree}, turn: number,
 * lit: string | null, records: any[], view: View,
 * about: any, connection: Connection, messages: Message[], typed: Typed[]}} State */

/** @typedef {{type: "changed", change: Change, gesture: Gesture}
 *  | {type: "began"} | {type: "rested"} | {type: "undone"} | {type: "redone"}
 *  | {type: "asked", panel: string, question: string}
 *  | {type: "answered", panel: string, question: string, value: any}
 *  | {type: "refused", panel: string, question: string, sentence: string}
 *  | {type: "forgotten"}
 *  | {type: "sought", panel: string, parameters: any}
 *  | {type: "choosing", study: Study}
 *  | {type: "chosen", study: Study}
 *  | {type: "lit", name: string | null}
 *  | {type: "measured", quantities: {[key: string]: {value?: number, sentence?: string}}}
 *  | {type: "parted", parts: Parts}
 *  | {type: "planted", text: string, tree: Tree}
 *  | {type: "worked", job: Partial<Job> & {id: string}}
 *  | {type: "dropped", id: string}
 *  | {type: "recorded", record: any}
 *  | {type: "unrecorded", id: string}
 *  | {type: "viewed", view: Partial<View>}
 *  | {type: "told", about: any}
 *  | {type: "connected", connection: Connection}
 *  | {type: "said", text: string, about?: string, offer?: Offer, brief?: boolean}
 *  | {type: "closed", about: string}
 *  | {type: "typed", typed: Typed}
 *  | {type: "read", typed: Typed, sentence?: string}} Action */

/** `change` changes the document: several changes, or those of one gesture, are one step; `look` changes what of it is
 * shown; `say` gives a message.
 * @typedef {{get: () => State, dispatch: (action: Action) => void, subscribe: (told: () => void) => () => void,
 * change: (changes: Change | Change[], gesture?: Gesture) => void, look: (view: Partial<View>) => void,
 * say: (text: string, about?: string, offer?: Offer) => void}} Store */

/** @returns {State} */
export const initial = () => ({
  history: beginning(empty()), answers: {}, sought: {}, choosing: null, work: {}, quantities: {},
  parts: null, trees: {}, turn: 0, lit: null, records: [], about: null, connection: "connecting", messages: [],
  typed: [],
  view: {
    path: [], tab: "response", theme: "auto", method: "", index: "", speed: 0.5, playing: true,
    compared: null, against: "", seconds: 10, seed: 0, output: "", across: false, tall: false, ghosts: [], response: "",
  },
});

const MOST = 5; // messages that stand below each other

/** What messages on values that were taken are about: they stand with the values, as long as these are present. */
export const TAKEN = "taken";

/** Messages of the whole page, newest first. @param {State} state */
export const messagesOf = ({ messages }) => messages.filter(({ about }) => about !== TAKEN).toReversed();

/** What is told of the present values. @param {State} state */
export const toldOfValues = ({ messages, history: { present } }) =>
  messages.find(({ about, of }) => about === TAKEN && of === present)?.text ?? "";

/** The gesture of what comes late and of itself: it is no step, and ends nothing that can be redone. */
export const AMENDS = Symbol("amends");
const ELSEWHERE = ["opened", "restored", "designTaken"]; // what brings another study

/** The state with another document in it: nothing that was said or answered of the one before is about it.
 * @param {State} state @param {DocumentHistory} history @returns {State} */
const elsewhere = (state, history) =>
  ({ ...state, history, turn: state.turn + 1, answers: turned(state.answers), messages: [], typed: [] });

/** @type {{[type: string]: (state: State, action: any) => State}} */
const STEPS = {
  changed: (state, { change, gesture }) => {
    const next = after(state.history.present, change);
    const history = gesture === AMENDS ? { ...state.history, present: next } : changed(state.history, next, gesture);
    if (ELSEWHERE.includes(change.type)) return elsewhere(state, history);
    const waiting = state.typed.filter((each) => isWaiting(each) && targetOf(each.change) !== targetOf(change));
    return { ...state, history, typed: waiting };
  },
  began: (state) => ({ ...state, history: beginning(state.history.present) }),
  rested: (state) => ({ ...state, history: rested(state.history) }),
  undone: (state) => {
    const last = state.typed.filter(isWaiting).at(-1);
    return last ? { ...state, typed: state.typed.filter((each) => each !== last) }
      : elsewhere(state, undone(state.history));
  },
  redone: (state) => elsewhere(state, redone(state.history)),
  asked: (state, { panel, question }) => answers(state, panel, asked(state.answers[panel], question)),
  answered: (state, { panel, question, value }) =>
    answers(state, panel, answered(state.answers[panel], { question, value, sentence: null })),
  refused: (state, { panel, question, sentence }) =>
    answers(state, panel, answered(state.answers[panel], { question, value: null, sentence })),
  forgotten: (state) => ({ ...state, answers: {} }),
  sought: (state, { panel, parameters }) => ({ ...state, sought: { ...state.sought, [panel]: parameters } }),
  choosing: (state, { study }) => ({ ...state, choosing: study }),
  chosen: (state, { study }) => (state.choosing === study ? { ...state, choosing: null } : state),
  lit: (state, { name }) => (state.lit === name ? state : { ...state, lit: name }),
  measured: (state, { quantities }) => ({ ...state, quantities: { ...state.quantities, ...quantities } }),
  parted: (state, { parts }) => ({ ...state, parts, trees: { ...treesIn(parts), ...state.trees } }),
  planted: (state, { text, tree }) => ({ ...state, trees: { ...state.trees, [text]: tree } }),
  worked: (state, { job }) => ({ ...state, work: { ...state.work, [job.id]: { ...state.work[job.id], ...job } } }),
  dropped: (state, { id }) => ({ ...state, work: without(state.work, id) }),
  recorded: (state, { record }) =>
    ({ ...state, records: [...state.records.filter(({ id }) => id !== record.id), record] }),
  unrecorded: (state, { id }) => ({ ...state, records: state.records.filter((each) => each.id !== id) }),
  viewed: (state, { view }) => ({ ...state, view: { ...state.view, ...view } }),
  told: (state, { about }) => ({ ...state, about }),
  connected: (state, { connection }) => (connection === state.connection ? state : { ...state, connection }),
  said: (state, { type, text, about = text, ...more }) =>
    ({ ...state, messages: [...others(state, about), { about, text, of: state.history.present, ...more }]
      .slice(-MOST) }),
  closed: (state, { about }) => ({ ...state, messages: others(state, about) }),
  typed: (state, { typed }) => ({ ...state, typed: [...state.typed.filter(({ id }) => id !== typed.id), typed],
    answers: without(state.answers, panelOf(typed)) }),
  read: (state, { typed, sentence }) => {
    if (!state.typed.includes(typed)) return state;
    return sentence ? { ...state, typed: state.typed.map((each) => (each === typed ? { ...typed, sentence } : each)) }
      : reduce(state, { type: "changed", change: typed.change, gesture: null });
  },
};

/** Whether what was typed was not found wrong so far. @param {Typed} typed */
const isWaiting = ({ sentence }) => sentence === undefined;

/** What a change gives another value. @param {any} change */
const targetOf = ({ type, place, layout, values }) => JSON.stringify([type, place, layout, Object.keys(values ?? {})]);

/** The trees of networks, by their texts. @param {Parts} parts @returns {{[text: string]: Tree}} */
const treesIn = ({ networks }) =>
  Object.fromEntries(networks.flatMap(({ text, tree }) => (tree ? [[text, canonical(tree)]] : [])));

/** The messages about other things. @param {State} state @param {string} about */
const others = ({ messages }, about) => messages.filter((each) => each.about !== about);

/** @param {State} state @param {string} panel @param {Answers} those @returns {State} */
const answers = (state, panel, those) => ({ ...state, answers: { ...state.answers, [panel]: those } });

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
    change: (changes, gesture = Array.isArray(changes) ? Symbol("step") : null) => {
      for (const change of [changes].flat().filter(isChange)) dispatch({ type: "changed", change, gesture });
    },
    look: (view) => dispatch({ type: "viewed", view }),
    say: (text, about, offer) => dispatch({ type: "said", text, about, ...(offer && { offer }) }),
    subscribe: (told) => {
      listeners.add(told);
      return () => void listeners.delete(told);
    },
  };
}
