// The page: its parts, what the keyboard does everywhere, and what is dropped on it.

import { AnswersPanel } from "./panels/answers.js";
import { ComparePanel } from "./panels/compare.js";
import { HistoryPanel } from "./panels/history.js";
import { Menu } from "./panels/memory.js";
import { NetworkPanel } from "./panels/network.js";
import { ResponsePanel } from "./panels/response.js";
import { RigPanel } from "./panels/rig.js";
import { TolerancePanel } from "./panels/tolerance.js";
import { ValuesPanel } from "./panels/values.js";
import { WorkPanel } from "./panels/work.js";
import { Clock, Moving } from "./parts/clock.js";
import { Field } from "./parts/field.js";
import { Select, formHandler } from "./parts/controls.js";
import { html, useEffect, useState } from "./parts/html.js";
import { open } from "./remembering.js";
import { openStudy } from "./working.js";

/** @import { Store } from "./state/store.js" */
/** @import { Api } from "./api.js" */

/** What is below the strut and its answers: a tab a row. */
const TABS = [
  { key: "response", title: "Frequency response", Panel: ResponsePanel },
  { key: "history", title: "On the road", Panel: HistoryPanel },
  { key: "compare", title: "Compare", Panel: ComparePanel },
  { key: "tolerance", title: "Tolerances", Panel: TolerancePanel },
  { key: "work", title: "Work", Panel: WorkPanel },
  { key: "rig", title: "Rig", Panel: RigPanel },
];

/** @param {{store: Store, api: Api, enter: (token: string) => void}} props */
export function Page({ store, api, enter }) {
  const [, setState] = useState(store.get());
  useEffect(() => {
    const { soon, now } = inFrames(() => setState(store.get()));
    for (const act of ACTS) addEventListener(act, now, { capture: true });
    const leave = store.subscribe(soon);
    return () => {
      leave();
      for (const act of ACTS) removeEventListener(act, now, { capture: true });
    };
  }, [store]);
  useEffect(() => listen(store, api), [store, api]);
  const state = store.get();
  const { study } = state.history.present;
  const blank = Object.keys(study).length === 0;
  return html`<a class="skip" href="#answers-title">To the answers</a>
    <header>
      <h1><span class="product">inerter</span> <${Title} store=${store} /></h1>
      <${Menu} store=${store} api=${api} />
      <${Theme} store=${store} />
    </header>
    <${Bar} store=${store} api=${api} enter=${enter} />
    ${blank
      ? html`<main class="blank"><h2>No study is open</h2>
        <p>Open an example or a study file above, drop one anywhere on this page, or start a quarter car:</p>
        <button class="main" type="button" onClick=${() => start(store, api)}>Start with a quarter car</button></main>`
      : html`<main>
          <div class="columns">
            <${NetworkPanel} store=${store} api=${api} />
            <${ValuesPanel} store=${store} />
            <${AnswersPanel} store=${store} api=${api} />
          </div>
          <${Tabs} store=${store} api=${api} />
        </main>`}`;
}

const ACTS = ["keydown", "click", "change", "submit"];

/** At most one call a frame, so that sixty steps of a slider draw what a screen can show. What a key or a button
 * does is about what is drawn: a call that is due comes before it, `now`, however late the frame is.
 * @param {() => void} told */
function inFrames(told) {
  let due = false;
  const now = () => {
    if (!due) return;
    due = false;
    told();
  };
  const soon = () => {
    if (!due) requestAnimationFrame(now);
    due = true;
  };
  return { soon, now };
}

/** @param {Store} store @param {Api} api */
async function start(store, api) {
  const { examples } = await api.get("examples");
  const first = examples.find((/** @type {any} */ { name }) => name === "quarter-car") ?? examples[0];
  if (first) await openStudy(store, api, (await api.get(`examples/${encodeURIComponent(first.name)}`)).study);
}

/** @param {{store: Store}} props */
function Title({ store }) {
  const { study } = store.get().history.present;
  if (Object.keys(study).length === 0) return null;
  return html`<${Field} class="title" aria-label="Title of the study" placeholder="Untitled study"
    text=${study.title ?? ""}
    done=${(/** @type {string} */ title) => store.change({ type: "placed", place: ["title"], value: title
      || undefined })} />`;
}

/** @type {{[connection: string]: string}} */
const SAID = {
  connecting: "Connecting…",
  compiling: "The numerical kernels are compiled, once for this machine; answers come then.",
  lost: "The server does not answer. Your work is here; the page continues when the server is back.",
  refused: "The server does not know this page. Paste the link that it printed, or its token:",
};

const AT_WORK = 1000; // [ms] that an answer may take before the page says that it waits
const LOOK = 500; // [ms]

/** That the server is at work, whatever was asked, as soon as one waits. @param {{api: Api}} props */
function AtWork({ api }) {
  const [since, setSince] = useState(/** @type {number | null} */ (null));
  useEffect(() => {
    const looking = setInterval(() => {
      const oldest = api.waiting();
      setSince(oldest !== null && Date.now() - oldest >= AT_WORK ? oldest : null);
    }, LOOK);
    return () => clearInterval(looking);
  }, [api]);
  return since !== null && html`<p class="at-work">
    <${Moving} key=${since} what="The server is at work" since=${since} /></p>`;
}

/** @param {{store: Store, api: Api, enter: (token: string) => void}} props */
function Bar({ store, api, enter }) {
  const { connection, messages, about } = store.get();
  const kernels = connection === "compiling" ? about?.kernels : null;
  return html`<div class="bar" aria-live="polite" data-connection=${connection}>
    ${connection !== "ready" && html`<p class="notice">
      ${SAID[connection]} ${kernels?.title ?? ""} ${kernels?.total ? `(${kernels.number} of ${kernels.total})`
        : ""} ${connection !== "refused" && html`<${Clock} key=${connection} />`}</p>`}
    ${connection === "refused" &&
    html`<form class="row" onSubmit=${formHandler((form) => enter(String(form.get("token"))))}>
      <label>Link or token <input name="token" autocomplete="off" /></label> <button>Connect</button></form>`}
    ${messages.map(({ about: key, text, offer }) => html`<p class="notice" key=${key}>
      ${text} ${offer && html`<button type="button" onClick=${() => {
        store.dispatch({ type: "closed", about: key });
        offer.act();
      }}>${offer.label}</button> `}<button type="button" class="link" aria-label="Close the message"
        onClick=${() => store.dispatch({ type: "closed", about: key })}>✕</button></p>`)}
  </div><${AtWork} api=${api} />`;
}

/** @param {{store: Store, api: Api}} props */
function Tabs({ store, api }) {
  const { view } = store.get();
  const shown = TABS.find(({ key }) => key === view.tab) ?? TABS[0];
  /** @param {KeyboardEvent} event */
  function turn(event) {
    const step = { ArrowRight: 1, ArrowLeft: -1 }[event.key];
    if (step === undefined) return;
    const next = TABS[(TABS.indexOf(shown) + step + TABS.length) % TABS.length];
    store.look({ tab: next.key });
    document.getElementById(`tab-${next.key}`)?.focus();
  }
  return html`<section class="panel tabs">
    <div role="tablist" aria-label="More answers" onKeyDown=${turn}>
      ${TABS.map(({ key, title }) => html`<button type="button" role="tab" id=${`tab-${key}`} key=${key}
        aria-selected=${key === shown.key} aria-controls="tab-panel" tabindex=${key === shown.key ? 0 : -1}
          onClick=${() => store.look({ tab: key })}>${title}</button>`)}
    </div>
    <div role="tabpanel" id="tab-panel" aria-labelledby=${`tab-${shown.key}`} key=${shown.key}>
      <${shown.Panel} store=${store} api=${api} /></div>
  </section>`;
}

const THEMES = /** @type {const} */ (["auto", "light", "dark"]);

/** @param {{store: Store}} props */
function Theme({ store }) {
  const { theme } = store.get().view;
  useEffect(() => {
    document.documentElement.dataset.theme = theme;
  }, [theme]);
  return html`<label class="theme">Colours <${Select} value=${theme} choices=${THEMES}
    set=${(/** @type {typeof THEMES[number]} */ chosen) => store.look({ theme: chosen })} /></label>`;
}

/** What the whole page listens to. @param {Store} store @param {Api} api */
function listen(store, api) {
  const off = new AbortController();
  const { signal } = off;
  addEventListener("keydown", (event) => {
    const menu = event.key === "Escape"
      && /** @type {Element} */ (event.target).closest("details.menu[open], details.bounds[open]");
    if (menu) {
      menu.removeAttribute("open");
      menu.querySelector("summary")?.focus();
    }
    const key = event.key.toLowerCase();
    if (!(event.ctrlKey || event.metaKey) || !["z", "y"].includes(key)) return;
    event.preventDefault();
    store.dispatch({ type: key === "y" || event.shiftKey ? "redone" : "undone" });
  }, { signal });
  addEventListener("dragover", (event) => event.dataTransfer?.types.includes("Files") && event.preventDefault(),
    { signal });
  addEventListener("drop", (event) => {
    if (!event.dataTransfer?.types.includes("Files")) return;
    event.preventDefault();
    void filesOf(event.dataTransfer).then((files) => open(store, api, files));
  }, { signal });
  addEventListener("click", (event) => {
    for (const menu of document.querySelectorAll("details.menu[open], details.bounds[open]")) {
      if (!menu.contains(/** @type {Node} */ (event.target))) menu.removeAttribute("open");
    }
  }, { signal });
  return () => off.abort();
}

/** The files that were dropped, and of a folder the files in it. @param {DataTransfer} transfer
 * @returns {Promise<File[]>} */
async function filesOf(transfer) {
  const entries = [...transfer.items].map((item) => item.webkitGetAsEntry?.()).filter((entry) => entry !== null
    && entry !== undefined);
  const found = await Promise.all(entries.map(filesIn));
  return found.length ? found.flat() : [...transfer.files];
}

/** @param {any} entry @returns {Promise<File[]>} */
async function filesIn(entry) {
  if (entry.isFile) return [await fileOf(entry)];
  const reader = entry.createReader();
  /** @type {any[]} */
  const inside = [];
  // a hundred at a time
  for (let more = [entry]; more.length > 0; inside.push(...more)) more = await new Promise((resolve, reject) =>
    reader.readEntries(resolve, reject));
  return Promise.all(inside.filter(({ isFile }) => isFile).map(fileOf));
}

/** @param {any} entry @returns {Promise<File>} */
const fileOf = (entry) => new Promise((resolve, reject) => entry.file(resolve, reject));
