// Long work: begun, watched, stopped, and found again after a reload of the page.

import { Lost, Refusal, postNow } from "./api.js";
import { freeIn, isQuick, layoutsWith, methodOf, quickMethod } from "./library.js";
import { showNewest } from "./parts/controls.js";
import { doubted, isOk } from "./parts/doubts.js";
import { questions, strutTexts } from "./questions.js";
import { indicesIn, nextLayout, own, textOf } from "./state/document.js";
import { listed, strutWords } from "./state/scale.js";
import { AMENDS, TAKEN } from "./state/store.js";

/** @import { Store, State } from "./state/store.js" */
/** @import { Api } from "./api.js" */
/** @import { Gesture } from "./state/history.js" */

const AGAIN = 1000; // [ms] until a server that does not answer is asked again
const LOOK = 300; // [ms] between two looks at work that goes on

/** The best values of layouts, taken into the document, and the best of several selected; returns what to tell.
 * @param {Store} store @param {Api} api
 * @param {{study: any, layouts: string[], index: string, method: string}} asked */
export async function optimise(store, api, asked) {
  const { study, layouts, index, method } = asked;
  const body = { study, layouts, indices: [index], method, methods: [method] };
  /** @param {any[]} designs */
  const takeBest = async (designs) => {
    const gesture = Symbol("best");
    const told = takeOptima(store, designs, gesture, study);
    if (layouts.length > 1) await selectBest(store, api, gesture).catch(() => {}); // the values are taken all the same
    return told;
  };
  try {
    const quick = isQuick(methodOf(store.get(), method));
    const { designs, at_speeds: speeds } = quick ? await whileWaiting(api, "optimise", body) : NONE;
    if (designs === null) {
      const id = await begin(store, api, { kind: "optimise", ...body });
      void ended(store, id).then((job) => {
        if (job?.result && store.get().history.present.study === study)
          void takeBest(job.result.designs).then((told) => store.say(told, TAKEN));
      });
      store.look({ tab: "work" });
      showNewest(".jobs .job");
      return "Under way: see Jobs. The values are taken when it is done, unless the study changes meanwhile.";
    }
    if (store.get().history.present.study !== study)
      return "The study was changed meanwhile, and the values are not taken. Press Find best again.";
    return withSpeeds(await takeBest(designs), speeds);
  } catch (error) {
    return /** @type {Error} */ (error).message;
  }
}

/** The values of optima become the present values of their layouts, in one step; returns what to tell, doubts first.
 * Where they are known to be of the study that is open, `of` is that study.
 * @param {Store} store @param {any[]} designs @param {Gesture} gesture
 * @param {import("./state/document.js").Study | null} of */
export function takeOptima(store, designs, gesture = null, of = null) {
  const { study } = store.get().history.present;
  const found = designs.map((best) => ({ best, values: best.texts ?? {} }));
  const chosen = found.filter(({ values }) => Object.keys(values).length > 0);
  const taken =
    of === study ? chosen : chosen.filter(({ best, values }) => isHere(store.get(), best.layout, Object.keys(values)));
  const doubts = doubted(designs.flatMap(membersOf));
  if (chosen.length === 0) return doubts || "No value may vary: tick the box of one under “may vary”.";
  if (taken.length === 0) {
    const [{ best, values }] = chosen;
    const other = `a layout ${best.layout} that has ${Object.keys(values).join(", ")} free`;
    return `${doubts}These are values of ${other}, which is not in the study that is open; nothing was changed.`;
  }
  const optima = Object.fromEntries(taken.map(({ best, values }) =>
    [best.layout, { problems: best.problem_digests ?? [], values }]));
  store.change({ type: "optimised", optima }, gesture);
  const names = listed(taken.map(({ best }) => best.layout + atBounds(best)));
  return `${doubts}The values of ${names} are the best found for ${taken[0].best.index}.`;
}

/** The values of an optimum become the present ones, and a message tells it. @param {Store} store @param {any} best */
export const takeAndTell = (store, best) => store.say(takeOptima(store, [best]), TAKEN);

/** What is told of optima, with what they become at other speeds: doubts first. @param {string} text
 * @param {{doubts: string[], others: string[]} | undefined} speeds */
export const withSpeeds = (text, speeds) => [...(speeds?.doubts ?? []), text, ...(speeds?.others ?? [])].join(" ");

/** Whether a layout has these values free.
 * @param {State} state @param {string} layout @param {string[]} values */
function isHere(state, layout, values) {
  const free = freeIn(state, layout);
  return values.every((name) => free.includes(name));
}

/** What an optimum is made of: its value by each method, or by one. @param {any} best
 * @returns {import("./parts/doubts.js").Member[]} */
export function membersOf({ layout, index, status, message }) {
  const of = [index, layout].filter(Boolean).join(" of ");
  const several = status !== null && typeof status === "object" ? Object.values(status) : [status];
  return several.map((each) => ({ of, status: each, message }));
}

/** @param {any} best */
function atBounds({ active_bounds: bounds }) {
  const names = Array.isArray(bounds) ? bounds : Object.keys(bounds ?? {});
  return names.length ? ` (at a bound: ${names.map((/** @type {any} */ each) => each.name ?? each).join(", ")})` : "";
}

/** Opens a study, with free values at their best for its first index by norms, and the layout of which the verdict
 * speaks: a fair beginning. Returns whether it is still open then.
 * @param {Store} store @param {Api} api @param {any} study */
export async function openStudy(store, api, study) {
  const gesture = Symbol("open");
  store.change({ type: "opened", study }, gesture);
  globalThis.scrollTo?.(0, 0);
  await beginAtBest(store, api, gesture, true);
  return store.get().history.present.study === study;
}

/** The values of what is free, while one waits; where that takes longer they stay in the middle of their bounds, of
 * which the page tells. A study that is changed meanwhile gets those of what it has become. @param {Store} store
 * @param {Api} api @param {Gesture} gesture @param {boolean} [selects] whether nobody has chosen a layout yet */
export async function beginAtBest(store, api, gesture, selects = false) {
  const { turn, history: { present: { study, layout } } } = store.get();
  const [index] = indicesIn(study);
  const method = quickMethod(store.get())?.name;
  if (!index || !method) return;
  store.dispatch({ type: "choosing", study });
  try {
    const layouts = Object.keys(study.layouts ?? {});
    const body = { study, layouts, indices: [index], method, methods: [method] };
    const { designs, left_out: others } = await untilFound(() => whileWaiting(api, "opening", body));
    const { present, future } = store.get().history;
    const late = future.length > 0 ? AMENDS : gesture; // a step that nobody asked for would end what can be redone
    const open = (designs ?? []).filter((each) => own(present.values, each.layout) === undefined); // nobody chose those
    if (open.length > 0 && present.study === study) {
      takeOptima(store, open, late, study);
      const doubts = doubted(open.flatMap(membersOf));
      if (doubts) store.say(doubts.trim());
    }
    const isAll = layouts.length > 1 && !others; // of which the verdict is
    if (selects && designs && isAll && present.layout === layout) await selectBest(store, api, late);
  } catch {
    // Then the values are the middles of their bounds, and what is wrong is told where it is asked for.
  } finally {
    store.dispatch({ type: "chosen", study });
  }
  const { present } = store.get().history;
  const isChanged = present.study !== study && store.get().turn === turn;
  if (isChanged && Object.keys(present.values).length === 0) await beginAtBest(store, api, gesture, selects);
}

/** Selects the layout of which the verdict speaks. @param {Store} store @param {Api} api @param {Gesture} gesture */
async function selectBest(store, api, gesture) {
  const { present } = store.get().history;
  const question = questions(store.get()).find(({ panel }) => panel === "decision");
  if (question === undefined) return;
  const { panel, key, path, body } = question;
  store.dispatch({ type: "asked", panel, question: key });
  const value = await postNow(api, path, "opening", body);
  store.dispatch({ type: "answered", panel, question: key, value });
  const [{ rank, layout }] = value.rows;
  if (rank === 1 && store.get().history.present === present) store.change({ type: "selected", layout }, gesture);
}

/** Optima, where these come while one waits; `designs` is null where they take longer. @param {Api} api
 * @param {string} name @param {object} body @returns {Promise<{designs: any[] | null, at_speeds?: any,
 * left_out?: object[]}>} */
const whileWaiting = (api, name, body) => postNow(api, "panel/optimise", name, { ...body, while_waiting: true });

/** @type {Awaited<ReturnType<typeof whileWaiting>>} */
const NONE = { designs: null };

const TRIES = 5; // of a server that does not answer, a second apart

/** What is found, asked again where the server does not answer. @template T @param {() => Promise<T>} find
 * @returns {Promise<T>} */
async function untilFound(find) {
  for (let tries = 1; ; tries += 1) {
    try {
      return await find();
    } catch (error) {
      if (!(error instanceof Lost) || tries === TRIES) throw error;
      await new Promise((resolve) => setTimeout(resolve, AGAIN));
    }
  }
}

/** A network that a search found takes the place of the free network in its layout; returns what to tell.
 * @param {Store} store @param {any} found @param {any} row */
export function takeNetwork(store, found, row) {
  const state = store.get();
  const { elements: known = {}, layouts = {} } = state.history.present.study;
  const { layout, free_networks: free } = found;
  if (!Object.hasOwn(layouts, layout) || free.some((/** @type {string} */ name) => !Object.hasOwn(known, name)))
    return `The study that is open has no layout ${layout} with ${free.join(", ")}; nothing was changed.`;
  const used = Object.keys(row.elements).filter((name) =>
    Object.hasOwn(known, name) && (layoutsWith(state, name) ?? []).some((each) => each !== layout));
  if (used.length > 0)
    return `Another layout has elements of the same names (${used.join(", ")}): rename them; nothing was changed.`;
  const { entry, elements, values } = row;
  store.change({ type: "networkTaken", layout, entry, elements, values });
  const doubts = doubted([{ of: row.network, status: row.status, message: row.message }]);
  return `${doubts}The layout ${layout} has the network ${row.network}.`;
}

/** A device, as the tables of a file have it, joins the strut that is edited, in a layout of its own for each way in
 * which it may; what would have the name of another element gets a new one. Returns what to tell.
 * @param {Store} store @param {Api} api
 * @param {{elements?: {[name: string]: any}, layouts?: {[layout: string]: any}}} device
 * @param {string} [strut] another strut than the one that is edited */
export async function takeDevice(store, api, { elements = {}, layouts = {} }, strut = "") {
  const texts = strutTexts(store.get());
  const document = store.get().history.present;
  if (document.layout === "") return "Open a study first: the device joins its strut.";
  /** @type {{elements: {[name: string]: any}, struts: {words: string, network: string}[]}} */
  const { elements: added, struts } = await api.post("study/device", { study: document.study,
    network: strut ? texts[strut] : textOf(document), device: { elements, layouts } });
  if (store.get().history.present !== document) return "The study was changed meanwhile; take the device again.";
  const gesture = Symbol("device");
  const told = struts.map(({ words, network }, number) => {
    const name = nextLayout(store.get().history.present);
    store.change({ type: "layoutAdded", name }, gesture);
    if (strut && number === 0) store.change({ type: "strutsParted", texts, strut }, gesture);
    store.change({ type: "drawn", text: network, added }, gesture);
    return { name, words };
  });
  store.change({ type: "selected", layout: told[0].name, strut: store.get().history.present.strut }, gesture);
  return `The device is in the new layout ${told.map(({ name, words }) => `${name}, ${words}`).join(", and in ")}. It ${
    ""}joins the ${strutWords([strut || "strut"])} of ${document.layout}; to join another strut, undo, select its ${
    ""}layout, and take the device again.`;
}

/** A fitted device joins the strut, if its values are given; returns what to tell, first whether it can be relied on.
 * @param {Store} store @param {Api} api @param {any} fit
 * @param {{elements?: {[name: string]: any}, layouts?: {[layout: string]: any}} | null} device
 * @param {string} [strut] */
export async function takeFitted(store, api, fit, device, strut) {
  if (isOk(fit.status) && device !== null)
    return `${unidentified(fit)}${await takeDevice(store, api, device, strut)}`;
  return `${doubted([{ of: "the fit", status: fit.status }])}${withheld(fit)}`;
}

/** What is told before a device that has values which no record supports. @param {any} fit */
function unidentified({ parameters }) {
  const names = Object.keys(parameters ?? {}).filter((name) => parameters[name].identified === false);
  return names.length === 0 ? ""
    : `Not identifiable: ${names.join(", ")}; the records do not support the values taken. `;
}

/** What is told in the place of a device: the values of a fit that is not to be relied on are not given.
 * @param {any} fit */
export const withheld = ({ parameters }) =>
  `There is no device to take: the fit withholds ${Object.keys(parameters ?? {}).join(", ") || "its values"}.`;

/** @param {Store} store @param {Api} api @param {{kind: string, [key: string]: any}} body */
export async function begin(store, api, body) {
  const job = await api.post("work", body);
  store.dispatch({ type: "worked", job: jobOf(job) });
  void watch(store, api);
  return job.id;
}

/** Begins work; gives the sentence why it cannot be begun, empty where it is begun.
 * @param {Store} store @param {Api} api @param {{kind: string, [key: string]: any}} body
 * @returns {Promise<string>} */
export const tryToBegin = (store, api, body) => begin(store, api, body).then(() => "", ({ message }) => message);

/** All work that the server knows, watched on. @param {Store} store @param {Api} api */
export async function findWork(store, api) {
  await look(store, api);
  void watch(store, api);
}

/** @param {any} job */
const jobOf = ({ id, kind, title, study, state, begun = null, total, done = 0, sentence, told, found }) => ({
  id, kind, title, study, state, begun, share: total ? (done ?? 0) / total : null, sentence: sentence || told || null,
  ...(found ? { found } : {}),
});

let watching = false;

/** Looks at the work until none goes on: one request at a time, however much there is. @param {Store} store
 * @param {Api} api */
async function watch(store, api) {
  if (watching) return;
  watching = true;
  try {
    while (Object.values(store.get().work).some(({ state }) => state === "waiting" || state === "running")) {
      await new Promise((resolve) => setTimeout(resolve, LOOK));
      await look(store, api);
    }
  } catch (error) {
    if (!(error instanceof Lost)) throw error;
    store.dispatch({ type: "connected", connection: "lost" });
  } finally {
    watching = false;
  }
}

/** Brings what the server says of its work; what began or was forgotten meanwhile it may not know.
 * @param {Store} store @param {Api} api */
async function look(store, api) {
  const before = Object.keys(store.get().work);
  const { work } = await api.get("work");
  const here = new Set(work.map((/** @type {any} */ { id }) => id));
  for (const id of before) if (!here.has(id)) store.dispatch({ type: "dropped", id });
  for (const job of work) {
    if (before.includes(job.id) && !store.get().work[job.id]) continue;
    store.dispatch({ type: "worked", job: jobOf(job) });
    if (job.state === "done" && !store.get().work[job.id].result)
      await ifKept(store, job.id, async () => {
        const result = await api.get(`work/${job.id}/result`);
        if (store.get().work[job.id]) store.dispatch({ type: "worked", job: { id: job.id, result } });
      });
  }
}

/** Asks about work, which goes from the page where the server has it no more, as when it was just forgotten.
 * @param {Store} store @param {string} id @param {() => Promise<void>} ask */
const ifKept = (store, id, ask) => ask().catch((error) => {
  if (!(error instanceof Refusal && error.status === 404)) throw error;
  store.dispatch({ type: "dropped", id });
});

/** Continues work that was stopped. @param {Store} store @param {Api} api @param {string} id */
export const resume = (store, api, id) => ifKept(store, id, async () => {
  store.dispatch({ type: "worked", job: jobOf(await api.post(`work/${id}/resume`, {})) });
  void watch(store, api);
});

/** @param {Store} store @param {Api} api @param {string} id */
export const stop = (store, api, id) => ifKept(store, id, async () => {
  const ended = ["done", "failed", "stopped"].includes(store.get().work[id]?.state);
  await api.remove(`work/${id}`);
  if (ended) store.dispatch({ type: "dropped", id });
});

/** A job once it has ended, undefined if it was dropped. @param {Store} store @param {string} id
 * @returns {Promise<import("./state/store.js").Job | undefined>} */
export const ended = (store, id) => new Promise((resolve) => {
  const leave = store.subscribe(() => {
    const job = store.get().work[id];
    if (job && !job.result && !["failed", "stopped"].includes(job.state)) return;
    leave();
    resolve(job);
  });
});
