// The page: its frame, what the keyboard does everywhere, and what is dropped on it.

import { isSearched } from "./library.js";
import { AnswersPanel } from "./panels/answers.js";
import { ComparePanel } from "./panels/compare.js";
import { DecisionLine, goTo } from "./panels/decision.js";
import { HistoryPanel } from "./panels/history.js";
import { MarginsPanel } from "./panels/margins.js";
import { Menu } from "./panels/memory.js";
import { NetworkPanel } from "./panels/network.js";
import { ResponsePanel } from "./panels/response.js";
import { RigPanel } from "./panels/rig.js";
import { SearchFirst } from "./panels/search.js";
import { Start } from "./panels/start.js";
import { TolerancePanel } from "./panels/tolerance.js";
import { ValuesPanel, otherProblems, problemsOf } from "./panels/values.js";
import { MotionPanel } from "./panels/motion.js";
import { WorkPanel } from "./panels/work.js";
import { Clock, Moving } from "./parts/clock.js";
import { Chip, Field, Select, bringIntoRow, formHandler } from "./parts/controls.js";
import { html, useEffect, useMemo, useState } from "./parts/html.js";
import { AllKeys, KeysOfFocus, isPressed, isTyped } from "./parts/keys.js";
import { answerOf } from "./questions.js";
import { open, studiesFirst } from "./remembering.js";
import { isBlank } from "./state/document.js";
import { messagesOf } from "./state/store.js";

/** @import { Store } from "./state/store.js" */
/** @import { Api } from "./api.js" */

/** What is below the vehicle in motion: a tab a row. Those `ofDesign` need the values of a network, which a free
 * network has not yet; those that are `long` are enlarged where work begins, and leave the vehicle its place again. */
const TABS = [
  { key: "response", title: "Response", Panel: ResponsePanel },
  { key: "history", title: "On the road", Panel: HistoryPanel, ofDesign: true },
  { key: "compare", title: "Compare", Panel: ComparePanel },
  { key: "margins", title: "Break-even", Panel: MarginsPanel, ofDesign: true },
  { key: "tolerance", title: "Tolerances", Panel: TolerancePanel, ofDesign: true },
  { key: "work", title: "Jobs", Panel: WorkPanel, long: true },
  { key: "rig", title: "Rig", Panel: RigPanel, long: true },
];

/** @param {{store: Store, api: Api, enter: (token: string) => void}} props */
export function Page({ store, api, enter }) {
  const [keys, setKeys] = useState(false);
  useEffect(() => listen(store, api, () => setKeys(true)), [store, api]);
  const state = store.get();
  const blank = isBlank(state.history.present);
  /** @param {any} Panel */
  const shown = (Panel) => html`<${Panel} store=${store} api=${api} />`;
  const { decision, check, margins } = state.answers;
  const unanswered = Object.values({ ...state, answers: null });
  // what an answer is not about is not drawn anew when it comes
  const menu = useMemo(() => shown(Menu), unanswered);
  const network = useMemo(() => shown(NetworkPanel), [...unanswered, check]);
  const [line, ranking, values] = useMemo(() => [DecisionLine, AnswersPanel, ValuesPanel].map(shown),
    [...unanswered, decision, check, margins]);
  return html`<a class="skip" href="#verdict">To the verdict</a>
    <header>
      <h1><span class="product">inerter</span> <${Title} store=${store} /></h1>
      ${menu}
      <button type="button" onClick=${() => setKeys(true)}>Keys <kbd>?</kbd></button>
      <${Theme} store=${store} />
    </header>
    ${line}
    <${Bar} store=${store} enter=${enter} />
    ${blank ? state.connection === "connecting" ? html`<main></main>` : html`<${Start} store=${store} api=${api} />`
      : html`<main>
          <div class="col left">${ranking}${network}</div>
          <div class=${`col middle ${state.view.tall ? "tall" : ""}`}>
            <${MotionPanel} store=${store} api=${api} /><${Tabs} store=${store} api=${api} /></div>
          <div class="col">${values}</div>
        </main>`}
    <footer class="keys"><${KeysOfFocus} about=${state.about} /><${Standing} store=${store} api=${api} /></footer>
    <${AllKeys} about=${state.about} open=${keys} close=${() => setKeys(false)} />`;
}

const ACTS = ["keydown", "click", "change", "submit"];

/** Whether an event is about a control that shows what was chosen before its change is told; a draw takes that back.
 * @param {Event} event */
const holdsChoice = ({ target }) =>
  target instanceof Element && target.matches("select, input[type=checkbox], input[type=radio]");

const PRESSED = "button, summary, a, label";

/** Draws the page whenever the state is another one, as soon as what happens is over, at most once a frame, so that
 * sixty steps of a slider draw what a screen can show. What a key or a button does is about what is drawn: what is due
 * comes before it, however late the frame is, but for a choice that a control already holds; and what it did is drawn
 * after it at once, before anything is typed into what is there no longer. A button that is pressed stays where it is
 * until it is released: with a message above it, it would be released beside it, and do nothing.
 * @param {Store} store @param {() => void} draw */
export function keepDrawing(store, draw) {
  let due = true;
  let drawn = false; // since the last frame
  let pressed = false;
  const now = () => {
    if (!due) return;
    due = false;
    if (!drawn) requestAnimationFrame(next);
    drawn = true;
    draw();
  };
  const unlessPressed = () => pressed || now();
  const next = () => {
    drawn = false;
    unlessPressed();
  };
  for (const act of ACTS) {
    addEventListener(act, (event) => holdsChoice(event) || now(), { capture: true });
    addEventListener(act, (event) => (holdsChoice(event) && act !== "change") || now());
  }
  addEventListener("pointerdown", ({ button, target }) => { // a menu of the browser may hide another button's release
    pressed = button === 0 && target instanceof Element && target.closest(PRESSED) !== null;
  }, { capture: true });
  for (const end of ["pointerup", "pointercancel"]) addEventListener(end, () => {
    pressed = false;
    setTimeout(now);
  }, { capture: true });
  store.subscribe(() => {
    if (!due && !drawn) setTimeout(unlessPressed);
    due = true;
  });
  now();
}

/** @param {{store: Store}} props */
function Title({ store }) {
  const { present } = store.get().history;
  if (isBlank(present)) return "No study yet";
  return html`<${Field} class="title" aria-label="Title of the study" placeholder="Untitled study"
    text=${present.study.title ?? ""}
    done=${(/** @type {string} */ title) => store.change({ type: "placed", place: ["title"], value: title
      || undefined })} />`;
}

/** @type {{[connection: string]: string}} */
const SAID = {
  connecting: "Connecting…",
  compiling: "The numerical kernels are being compiled, once for this machine; answers follow.",
  lost: "The server does not answer. Your work is here; the page continues when the server is back.",
  refused: "The server does not know this page. Paste the link that it printed, or its token:",
};

const AT_WORK = 1000; // [ms] that an answer may take before the page says that it waits
const LOOK = 500; // [ms]

/** Since when the server has been at work, whatever was asked, as soon as one waits. @param {Api} api */
function useWork(api) {
  const [since, setSince] = useState(/** @type {number | null} */ (null));
  useEffect(() => {
    const looking = setInterval(() => {
      const oldest = api.waiting();
      setSince(oldest !== null && Date.now() - oldest >= AT_WORK ? oldest : null);
    }, LOOK);
    return () => clearInterval(looking);
  }, [api]);
  return since;
}

/** How the answers stand, and how many messages there are. @param {{store: Store, api: Api}} props */
function Standing({ store, api }) {
  const state = store.get();
  const since = useWork(api);
  const { connection } = state;
  const { is } = answerOf(state, "decision");
  const count = messagesOf(state).length + problemsOf(state).length;
  const lost = connection === "lost" || connection === "refused";
  const blank = isBlank(state.history.present);
  const ready = blank ? "ready" : STANDING[is];
  const told = lost ? "no server" : connection === "ready" ? ready : connection;
  return html`<span role="status">${since !== null
      && html`<span class="at-work"><${Moving} key=${since} what="The server is at work" since=${since} /></span> · `}
    ${count > 0 && html`<b>${count === 1 ? "1 message" : `${count} messages`}</b> <kbd>F8</kbd> · `}
    <span class="dot" data-is=${lost ? "none" : blank ? "current" : is}></span>${told}</span>`;
}

/** @type {{[is: string]: string}} */
const STANDING = { current: "answers are of this study", coming: "computing", none: "no answer" };

/** What the page has to say: each stays until its cause is gone, or until it is closed.
 * @param {{store: Store, enter: (token: string) => void}} props */
function Bar({ store, enter }) {
  const state = store.get();
  const { connection, about } = state;
  const kernels = connection === "compiling" ? about?.kernels : null;
  const problems = otherProblems(state);
  return html`<div class="bar" aria-live="polite" data-connection=${connection}>
    ${connection !== "ready" && html`<p class=${`notice ${connection}`}><span>
      ${SAID[connection]} ${kernels?.title ?? ""} ${kernels?.total ? `(${kernels.number} of ${kernels.total})`
        : ""} ${connection !== "refused" && html`<${Clock} key=${connection} />`}</span></p>`}
    ${connection === "refused" &&
    html`<form class="row notice" onSubmit=${formHandler((form) => enter(String(form.get("token"))))}>
      <label>Link or token <input name="token" autocomplete="off" /></label> <button class="edged">Connect</button>
    </form>`}
    ${problems.length > 0 && html`<div class="problems" role="alert"><b>In the study</b><ul>
      ${problems.map(({ place, sentence }) => html`<li class="problem">${isNamed(place.join("."), sentence) ? ""
        : html`<code>${place.join(".")}</code> `}${sentence}</li>`)}</ul></div>`}
    ${messagesOf(state).map(({ about: key, text, offer, brief }) => html`<p class=${`notice ${brief ? "brief" : ""}`}
      key=${key}><span>${text}</span>
      ${offer && html`<button type="button" class="edged" onClick=${() => {
        store.dispatch({ type: "closed", about: key });
        offer.act();
      }}>${offer.label}</button>`}
      <button type="button" class="link" aria-label="Close the message"
        onClick=${() => store.dispatch({ type: "closed", about: key })}>✕</button></p>`)}
  </div>`;
}

/** Whether a sentence begins with its place, in which some names are quoted. @param {string} place
 * @param {string} sentence */
const isNamed = (place, sentence) => sentence.replaceAll('"', "").startsWith(place);

/** @param {{store: Store, api: Api}} props */
function Tabs({ store, api }) {
  const state = store.get();
  const { view, history: { present: { layout } } } = state;
  const shown = TABS.find(({ key }) => key === view.tab) ?? TABS[0];
  useEffect(() => bringIntoRow(document.getElementById(`tab-${shown.key}`)), [shown.key]);
  /** @param {typeof TABS[number]} tab */
  const turnTo = ({ key, long = false }) => store.look({ tab: key, tall: view.tall && (long || !shown.long) });
  /** @param {KeyboardEvent} event */
  function turn(event) {
    const step = { ArrowRight: 1, ArrowLeft: -1 }[event.key];
    if (step === undefined) return;
    const next = TABS[(TABS.indexOf(shown) + step + TABS.length) % TABS.length];
    turnTo(next);
    document.getElementById(`tab-${next.key}`)?.focus();
  }
  return html`<section class="panel tabs" data-keys="Tabs">
    <div class="head"><div role="tablist" aria-label="More answers" onKeyDown=${turn}>
      ${TABS.map((tab) => html`<button type="button" role="tab" id=${`tab-${tab.key}`} key=${tab.key}
        aria-selected=${tab === shown} aria-controls="tab-panel" tabindex=${tab === shown ? 0 : -1}
          onClick=${() => turnTo(tab)}>${tab.title}</button>`)}
    </div><${Chip} on=${view.tall} set=${() => store.look({ tall: !view.tall })}
      aria-label="Enlarge" title="Enlarge: the whole height">⤢<//></div>
    <div role="tabpanel" id="tab-panel" aria-labelledby=${`tab-${shown.key}`} key=${shown.key}>
      ${shown.ofDesign && isSearched(state, layout)
        ? html`<${SearchFirst} layout=${layout} />`
        : html`<${shown.Panel} store=${store} api=${api} />`}</div>
  </section>`;
}

const THEMES = /** @type {const} */ (["auto", "light", "dark"]);

const DARK = matchMedia("(prefers-color-scheme: dark)");

/** @param {{store: Store}} props */
function Theme({ store }) {
  const { theme } = store.get().view;
  useEffect(() => {
    const show = () => {
      document.documentElement.dataset.theme = theme !== "auto" ? theme : DARK.matches ? "dark" : "light";
    };
    show();
    DARK.addEventListener("change", show);
    return () => DARK.removeEventListener("change", show);
  }, [theme]);
  return html`<label class="theme"><${Select} value=${theme} aria-label="Colours" choices=${THEMES}
    set=${(/** @type {typeof THEMES[number]} */ chosen) => store.look({ theme: chosen })} /></label>`;
}

const MENUS = "details.menu[open], details.bounds[open]";

/** What the whole page listens to. @param {Store} store @param {Api} api @param {() => void} showKeys */
function listen(store, api, showKeys) {
  const off = new AbortController();
  const { signal } = off;
  addEventListener("keydown", (event) => {
    if (event.defaultPrevented) return;
    const act = event.ctrlKey || event.metaKey ? withControl(store, event) : alone(store, event, showKeys);
    if (!act) return;
    event.preventDefault();
    act();
  }, { signal });
  for (const kind of /** @type {const} */ (["dragenter", "dragover"])) addEventListener(kind, (event) =>
    event.dataTransfer?.types.includes("Files") && event.preventDefault(), { signal }); // both accept what is dropped
  addEventListener("drop", (event) => {
    if (!event.dataTransfer?.types.includes("Files")) return;
    event.preventDefault();
    filesOf(store, event.dataTransfer).then((files) => open(store, api, files))
      .catch((/** @type {Error} */ { message }) => store.say(`What was dropped cannot be read: ${message}`));
  }, { signal });
  addEventListener("click", (event) => {
    for (const menu of document.querySelectorAll(MENUS)) {
      if (!event.composedPath().includes(menu)) menu.removeAttribute("open"); // what was clicked may be gone
    }
  }, { signal });
  return () => off.abort();
}

/** What a key does with Ctrl. @param {Store} store @param {KeyboardEvent} event */
function withControl(store, { key, shiftKey }) {
  /** @type {{[key: string]: () => void}} */
  const acts = {
    z: () => store.dispatch({ type: shiftKey ? "redone" : "undone" }),
    y: () => store.dispatch({ type: "redone" }),
    o: () => openMenu("open-menu"),
    s: () => openMenu("save-menu"),
  };
  return acts[key.toLowerCase()];
}

/** What a key does alone; letters and digits only where no text is typed.
 * @param {Store} store @param {KeyboardEvent} event @param {() => void} showKeys */
function alone(store, { key, target, altKey }, showKeys) {
  const menu = /** @type {Element} */ (target).closest?.(MENUS);
  if (key === "Escape" && menu) return () => {
    menu.removeAttribute("open");
    menu.querySelector("summary")?.focus();
  };
  if (key === "F8") return nextMessage;
  if (key.startsWith("Arrow") && target === document.body)
    return () => /** @type {HTMLElement | null} */ (document.querySelector(".card"))?.focus();
  if (altKey || isTyped(target) || document.querySelector("dialog[open]")) return undefined;
  if (key === " ") return isPressed(target) ? undefined : () => store.look({ playing: !store.get().view.playing });
  if (["1", "2", "3", "4"].includes(key)) return () => goTo(store, Number(key));
  return { "?": showKeys, v: showVerdict, o: () => document.getElementById("find-best")?.click() }[key.toLowerCase()];
}

/** @param {string} id */
function openMenu(id) {
  const menu = document.getElementById(id);
  menu?.setAttribute("open", "");
  menu?.querySelector("summary")?.focus();
}

/** The verdict with all that speaks against it. */
function showVerdict() {
  document.querySelector("#verdict details")?.setAttribute("open", "");
  /** @type {HTMLElement | null} */ (document.querySelector("#caveats-all") ?? document.querySelector("#verdict"))
    ?.focus();
}

/** The focus goes to the next message, or to what is wrong. */
function nextMessage() {
  const all = [...document.querySelectorAll(".notice button, [aria-invalid=true]")];
  const next = all[(all.indexOf(/** @type {Element} */ (document.activeElement)) + 1) % all.length];
  /** @type {HTMLElement | undefined} */ (next)?.focus();
}

/** The files that were dropped, and of a folder the files in it that are of use. @param {Store} store
 * @param {DataTransfer} transfer @returns {Promise<File[]>} */
async function filesOf(store, transfer) {
  const entries = [...transfer.items].map((item) => item.webkitGetAsEntry?.()).filter((entry) => entry !== null
    && entry !== undefined);
  const found = (await Promise.all(entries.map(entriesIn))).flat();
  return found.length ? Promise.all(studiesFirst(store, found).map(fileOf)) : [...transfer.files];
}

/** A file, or the files in a folder. @param {any} entry @returns {Promise<any[]>} */
async function entriesIn(entry) {
  if (entry.isFile) return [entry];
  const reader = entry.createReader();
  /** @type {any[]} */
  const inside = [];
  // a hundred at a time
  for (let more = [entry]; more.length > 0; inside.push(...more)) more = await new Promise((resolve, reject) =>
    reader.readEntries(resolve, reject));
  return inside.filter(({ isFile }) => isFile);
}

/** @param {any} entry @returns {Promise<File>} */
const fileOf = (entry) => new Promise((resolve, reject) => entry.file(resolve, reject));
