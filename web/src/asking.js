// Questions to the server follow from the state; this asks them. Of each panel one request is under way at a time, and
// when it is answered the newest question is asked next, so that what is shown at last belongs to the last step.

import { Lost, Refusal, postNow } from "./api.js";
import { questions, soughtOf } from "./questions.js";
import { AWAITED, settledOn, shownOf } from "./state/answers.js";

/** @import { Store, State } from "./state/store.js" */
/** @import { Api } from "./api.js" */

const AGAIN = 1000; // [ms] until a lost server is asked again

/** Keeps answers up to date with the state. @param {Store} store @param {Api} api @param {string} client
 * @param {() => Promise<void>} found what is done when a lost server is back */
export function keepAsking(store, api, client, found = async () => {}) {
  /** @type {Set<string>} */
  const underWay = new Set();
  let sequence = 0;
  let waking = false;

  function look() {
    const state = store.get();
    if (state.connection === "lost") lose();
    if (state.connection !== "ready" && state.connection !== "compiling") return;
    for (const question of questions(state)) {
      const { panel, key, ofDesigns } = question;
      const settled = settledOn(state.answers[panel], key);
      if (settled) learn(question, settled);
      if (underWay.has(panel) || settled || (ofDesigns && isBeingChosen(state))) continue;
      if (rests(question, state)) void ask(question);
    }
  }

  /** The last question of each panel whose answer has told something else too. @type {Map<string, string>} */
  const learnt = new Map();

  /** Takes over what an answer tells besides, also that of a study which is there again.
   * @param {import("./questions.js").Question} question @param {import("./state/answers.js").Kept} kept */
  function learn(question, { value, sentence }) {
    const { panel, key } = question;
    if (!question.learnt || sentence !== null || learnt.get(panel) === key) return;
    learnt.set(panel, key);
    store.dispatch(question.learnt(value));
  }

  /** When the newest question of a panel that waits came up. @type {Map<string, {key: string, at: number}>} */
  const raised = new Map();

  /** The panels that are looked at again: a single timer for each, however often its question changes meanwhile.
   * @type {Set<string>} */
  const resting = new Set();

  /** Whether a question has been the same for as long as it must; the first of a panel need not.
   * @param {import("./questions.js").Question} question @param {State} state */
  function rests({ panel, key, rest = 0, ofSteps = false }, { answers }) {
    if (rest === 0 || answers[panel] === undefined) return true;
    if (ofSteps && !shownOf(answers[panel], key).before) return true;
    const now = Date.now();
    if (raised.get(panel)?.key !== key) raised.set(panel, { key, at: now });
    const left = rest - (now - (raised.get(panel)?.at ?? now));
    if (left > 0 && !resting.has(panel)) {
      resting.add(panel);
      setTimeout(() => {
        resting.delete(panel);
        schedule();
      }, left);
    }
    return left <= 0;
  }

  /** @param {import("./questions.js").Question} question */
  async function ask(question) {
    const { panel, key, path, body } = question;
    underWay.add(panel);
    store.dispatch({ type: "asked", panel, question: key });
    sequence += 1;
    try {
      const sent = path.startsWith("panel/") ? { ...body, client: `${client}.${panel}`, sequence } : body;
      const value = await api.post(path, sent);
      store.dispatch({ type: "answered", panel, question: key, value });
      learnt.delete(panel);
      learn(question, { question: key, value, sentence: null });
    } catch (error) {
      if (error instanceof Lost) lose();
      else if (isUnauthorised(error)) store.dispatch({ type: "connected", connection: "refused" });
      else {
        const { message, outdated } = /** @type {Refusal} */ (error);
        if (!outdated) store.dispatch({ type: "refused", panel, question: key, sentence: message });
      }
    } finally {
      underWay.delete(panel);
      schedule();
    }
  }

  function lose() {
    if (waking) return;
    store.dispatch({ type: "connected", connection: "lost" });
    void wake();
  }

  async function wake() {
    if (waking) return;
    waking = true;
    while (store.get().connection === "lost") {
      await new Promise((resolve) => setTimeout(resolve, AGAIN));
      try {
        store.dispatch({ type: "told", about: await api.get("about") });
        store.dispatch({ type: "forgotten" }); // another server may know other files
        store.dispatch({ type: "connected", connection: "ready" });
        await found();
      } catch (error) {
        if (isUnauthorised(error)) store.dispatch({ type: "connected", connection: "refused" });
      }
    }
    waking = false;
  }

  let scheduled = false;
  function schedule() {
    if (scheduled) return;
    scheduled = true;
    queueMicrotask(() => {
      scheduled = false;
      look();
    });
  }

  store.subscribe(schedule);
  schedule();
  return { lose };
}

/** Whether the server does not know the token. @param {unknown} error */
export const isUnauthorised = (error) => error instanceof Refusal && error.status === 401;

/** Whether the free values of the study that is open are being chosen: questions about its designs come then.
 * @param {State} state */
export const isBeingChosen = ({ choosing, history }) => choosing !== null && choosing === history.present.study;

/** Waits until the study that is open has the values that it begins with, so that what is asked then is about them;
 * gives the document as it is then, or null if another one has been opened. @param {Store} store
 * @returns {Promise<import("./state/document.js").Document | null>} */
export const whenChosen = (store) => new Promise((resolve) => {
  const { turn } = store.get();
  const look = () => {
    const state = store.get();
    if (state.connection === "compiling" || isBeingChosen(state)) return;
    leave();
    resolve(state.turn === turn ? state.history.present : null);
  };
  const leave = store.subscribe(look);
  look();
});

/** Asks what a button of a panel asks, with parameters of its form, once its design has values; the answer stands in
 * the state. @param {Store} store @param {string} panel @param {any} parameters
 * @param {(question: import("./questions.js").Question) => Promise<any>} answer */
export async function seek(store, panel, parameters, answer) {
  store.dispatch({ type: "sought", panel, parameters });
  store.dispatch({ type: "asked", panel, question: AWAITED });
  const question = (await whenChosen(store)) && soughtOf(store.get(), panel);
  if (question === null) return;
  const { key } = question;
  store.dispatch({ type: "asked", panel, question: key });
  try {
    store.dispatch({ type: "answered", panel, question: key, value: await answer(question) });
  } catch (error) {
    store.dispatch({ type: "refused", panel, question: key, sentence: /** @type {Error} */ (error).message });
  }
}

/** The same of a panel that answers at once. @param {Store} store @param {Api} api @param {string} panel
 * @param {any} parameters */
export const seekNow = (store, api, panel, parameters) =>
  seek(store, panel, parameters, ({ path, body }) => postNow(api, path, panel, body));
