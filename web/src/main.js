// Where the page begins: the token of its first link, what it knew before, the server's answers from then on.

import { render } from "preact";
import "./page.css";
import "./vehicles/vehicles.css";
import "./plots/plots.css";
import { CLIENT, Lost, createApi } from "./api.js";
import { isUnauthorised, keepAsking } from "./asking.js";
import { Page, keepDrawing } from "./page.js";
import { html } from "./parts/html.js";
import { fromAddress, keepRemembering, remembered, unpacked } from "./remembering.js";
import { createStore } from "./state/store.js";
import { begunWith, isBegunWith, watchFile } from "./watching.js";
import { beginAtBest, findWork } from "./working.js";

const TOKEN = "inerter.token";
const AGAIN = 1000; // [ms]

const store = createStore();
const api = createApi(() => sessionStorage.getItem(TOKEN) ?? "");
const windows = new BroadcastChannel("inerter");
const address = fromAddress(location.hash);

if (address.token) sessionStorage.setItem(TOKEN, address.token);
history.replaceState(null, "", location.pathname);
windows.onmessage = ({ data }) => {
  const token = sessionStorage.getItem(TOKEN);
  if (data.ask && token) windows.postMessage({ token });
  if (data.token && !token) enter(data.token);
};

/** Goes on with a token that was pasted, or that another window of this page gave. @param {string} text */
function enter(text) {
  sessionStorage.setItem(TOKEN, fromAddress(text.split("#")[1] ?? "").token ?? text.trim());
  void connect();
}

/** The document to begin with: that of the link, that of before a reload, that of the command line.
 * @param {{study: any, stamp: string}} start
 * @returns {Promise<import("./state/document.js").Document | {study: any, values?: undefined} | null>} */
async function firstDocument({ study, stamp }) {
  const linked = address.state === null ? null : await unpacked(address.state);
  if (linked) {
    watchFile(store, api, undefined);
    store.look(linked.view);
    return linked.document;
  }
  unread = address.state !== null;
  const before = remembered();
  const same = isBegunWith(study);
  watchFile(store, api, before === null || same || address.token ? stamp : null);
  if (before && (same || !address.token)) return before;
  begunWith(study);
  return study && Object.keys(study).length > 0 ? { study } : before;
}

let begun = false;
let unread = false; // whether the link holds a state that is none

async function connect() {
  try {
    const [about, start] = await Promise.all([api.get("about"), begun ? null : api.get("start")]);
    store.dispatch({ type: "told", about });
    const first = start === null ? null : await begin(start);
    const fresh = first !== null && Object.keys(first.values ?? {}).length === 0;
    if (!about.kernels.ready) await compiled();
    begun = true;
    const best = fresh ? beginAtBest(store, api, "first", !("layout" in first)) : null;
    store.dispatch({ type: "connected", connection: "ready" });
    await best;
    const { past, future } = store.get().history;
    if (fresh && past.length <= 1 && future.length === 0) store.dispatch({ type: "began" });
    await findWork(store, api);
  } catch (error) {
    if (isUnauthorised(error)) {
      windows.postMessage({ ask: true });
      store.dispatch({ type: "connected", connection: "refused" });
    } else if (error instanceof Lost) {
      store.dispatch({ type: "connected", connection: begun ? "lost" : "connecting" });
      setTimeout(connect, AGAIN);
    } else throw error;
  }
}

/** Brings the first document, where undoing ends, and returns it.
 * @param {{study: any, stamp: string}} start */
async function begin(start) {
  const document = await firstDocument(start);
  if (document !== null) {
    store.change("layout" in document ? { type: "restored", document } : { type: "opened", study: document.study });
    store.dispatch({ type: "began" });
  }
  if (unread) store.say("The link holds no state that this page can read.");
  return document;
}

/** Waits until the kernels are compiled, and tells which one is under way. */
async function compiled() {
  store.dispatch({ type: "connected", connection: "compiling" });
  await api.events("ready", (event, data) => {
    const kernels = { ...data, ready: false };
    if (event === "kernels") store.dispatch({ type: "told", about: { ...store.get().about, kernels } });
  });
}

const place = /** @type {HTMLElement} */ (document.getElementById("page"));
keepDrawing(store, () => render(html`<${Page} store=${store} api=${api} enter=${enter} />`, place));
keepAsking(store, api, CLIENT, () => findWork(store, api));
keepRemembering(store);
void connect();
