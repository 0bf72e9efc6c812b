// Questions to the server follow from the state; this asks them. Of each panel one request is under way at a time, and when it is
// answered the newest question is asked next, so that what is shown at last belongs to the last step.

import { Lost, Refusal } from "./api.js";
import { questions } from "./questions.js";

/** @typedef {import("./state/store.js").Store} Store */
/** @typedef {import("./api.js").Api} Api */

const AGAIN = 1000; // [ms] until a lost server is asked again

/** Keeps answers up to date with the state. @param {Store} store @param {Api} api @param {string} client @param {() => Promise<void>} found what is done when a lost server is back */
export function keepAsking(store, api, client, found = async () => {}) {
  /** @type {{[panel: string]: string}} */
  const underWay = {};
  /** @type {{[panel: string]: string}} */
  const settled = {};
  let sequence = 0;
  let waking = false;

  function look() {
    const state = store.get();
    if (state.connection === "lost") lose();
    if (state.connection !== "ready" && state.connection !== "compiling") return;
    for (const { panel, path, body, learnt } of questions(state)) {
      const question = JSON.stringify(body);
      if (panel in underWay || settled[panel] === question) continue;
      void ask({ panel, path, body, learnt }, question);
    }
  }

  /** @param {import("./questions.js").Question} asked @param {string} question */
  async function ask({ panel, path, body, learnt }, question) {
    underWay[panel] = question;
    store.dispatch({ type: "asked", panel, question });
    sequence += 1;
    try {
      const sent = path.startsWith("panel/") ? { ...body, client: `${client}.${panel}`, sequence } : body;
      const value = await api.post(path, sent);
      settled[panel] = question;
      store.dispatch({ type: "answered", panel, question, value});
      if (learnt) store.dispatch(learnt(value));
    } catch (error) {
      if (error instanceof Lost) lose();
      else {
        if (!(error instanceof Refusal && error.outdated)) settled[panel] = question;
        const refusal = /** @type {Refusal} */ (error);
        if (refusal.status === 401) store.dispatch({ type: "connected", connection: "refused" });
        else if (!refusal.outdated) store.dispatch({ type: "refused", panel, question, sentence: refusal.message });
      }
    } finally {
      delete underWay[panel];
      schedule();
    }
  }

  function lose() {
    if (waking) return;
    store.dispatch({ type: "connected", connection: "lost" });
    for (const panel of Object.keys(settled)) delete settled[panel];
    void wake();
  }

  async function wake() {
    if (waking) return;
    waking = true;
    while (store.get().connection === "lost") {
      await new Promise((resolve) => setTimeout(resolve, AGAIN));
      try {
        store.dispatch({ type: "told", about: await api.get("about") });
        store.dispatch({ type: "connected", connection: "ready" });
        await found();
      } catch (error) {
        if (error instanceof Refusal && error.status === 401) store.dispatch({ type: "connected", connection: "refused" });
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
