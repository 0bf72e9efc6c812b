// The decision across the top: vehicle, goal, strut, what it bears, each with its present answer, and the verdict.

import { html, useEffect, useLayoutEffect, useRef, useState } from "../parts/html.js";
import { Select, bringIntoRow } from "../parts/controls.js";
import { allDesigns, answerOf, designOf, goalOf, soughtAnswer, staleLayouts } from "../questions.js";
import { isSearched, methodChoice, searchedLayouts, unchosenIn } from "../library.js";
import { isBlank } from "../state/document.js";
import { capital, quantity, takenApart } from "../state/scale.js";
import { isBeingChosen } from "../asking.js";
import { AskedPanel, IndexSettings, chosenFor } from "./asked.js";
import { indexWords, indicesOf, isInTitle } from "./answers.js";
import { marginTold } from "./margins.js";
import { problemsOf } from "./values.js";

/** @import { Store, State } from "../state/store.js" */
/** @typedef {{sentence: string, severity: string}} Caveat */

/** @param {{store: Store}} props */
export function DecisionLine({ store }) {
  const state = store.get();
  const blank = isBlank(state.history.present);
  const present = blank ? 1 : state.view.tab === "margins" ? 4 : 3;
  useEffect(() => bringIntoRow(document.querySelector(".step[aria-current]")), [present]);
  /** @param {number} number @param {string} title @param {string} answer */
  const step = (number, title, answer) => html`<div class="step"
    aria-current=${present === number ? "step" : undefined}><button type="button" id=${`step-${number}`}
      disabled=${blank && number > 1} onClick=${() => goTo(store, number)}><small>${number} ${title}</small><b
      title=${answer}>${answer}</b></button></div>`;
  return html`<nav class="decision" aria-label="Decision">
    ${step(1, "Vehicle", blank ? "Choose one" : vehicleOf(state))}
    ${blank ? step(2, "Goal", "Comfort or road holding") : html`<${Goal} store=${store} />`}
    ${step(3, "Strut", blank ? "Ranked" : strutOf(state))}
    ${step(4, "Break-even", blank ? "Friction, backlash" : marginTold(soughtAnswer(state, "margins").value))}
    <${Verdict} state=${state} blank=${blank} />
  </nav>`;
}

/** Shows the place where a step is changed, and gives it the focus. @param {Store} store @param {number} number */
export function goTo(store, number) {
  if (number === 4) store.look({ tab: "margins" });
  const place = ["", "#vehicle-values summary, .cards button", "#step-2", ".answers .on .pick", "#tab-margins"][number];
  requestAnimationFrame(() => {
    const found = /** @type {HTMLElement | null} */ (document.querySelector(place));
    found?.scrollIntoView({ block: "nearest" });
    found?.focus();
    if (number === 2) found?.click();
  });
}

/** The vehicle and its speed. @param {State} state */
function vehicleOf({ history }) {
  const { vehicle, road } = history.present.study;
  const model = capital(String(vehicle?.model ?? "own vehicle").replaceAll("-", " "));
  const apart = takenApart(road?.speed);
  const speed = apart && quantity(apart.number, apart.unit).replaceAll(" ", "\u00a0");
  return [model, speed].filter(Boolean).join(", ");
}

/** The strut that is edited, and its place in the ranking. @param {State} state */
function strutOf(state) {
  const document = state.history.present;
  if (document.layout === "") return "None";
  if (isSearched(state, document.layout)) return `${document.layout}, free`;
  if (unchosenIn(state, designOf(document)).length > 0) return `${document.layout}, not chosen`;
  const { is, value } = answerOf(state, "decision");
  /** @type {any[]} */
  const rows = value?.rows ?? [];
  const row = rows.find(({ layout }) => layout === document.layout);
  return is === "current" && row?.rank ? `${document.layout}, ${row.rank} of ${rows.length}` : document.layout;
}

/** What is to be least, by which method, and what is asked besides. @param {{store: Store}} props */
function Goal({ store }) {
  const state = store.get();
  const indices = indicesOf(state);
  const goal = indices.find(({ symbol }) => symbol === goalOf(state));
  const answer = goal ? [indexWords(goal, ", "), ...chosenFor(state, goal.symbol)].join(", ") : "None";
  return html`<details class="menu step">
    <summary id="step-2"><small>2 Goal</small><b title=${answer}>${answer}</b></summary>
    <div class="menu-body">
      <fieldset><legend>Index to be minimised</legend>
        ${indices.map(({ symbol, title }) => html`<label key=${symbol}><input type="radio" name="goal" value=${symbol}
          checked=${symbol === goal?.symbol} onChange=${() => store.look({ index: symbol })} />
          ${title} ${!isInTitle({ symbol, title }) && html`<b>${symbol}</b>`}</label>`)}</fieldset>
      ${indices.map(({ symbol }) => html`<${IndexSettings} key=${symbol} store=${store} index=${symbol}
        isGoal=${symbol === goal?.symbol} />`)}
      <${Select} label="Method" ...${methodChoice(store)} />
      <${AskedPanel} store=${store} />
    </div></details>`;
}

/** The verdict: a sentence of the library, and what speaks against it. @param {{state: State, blank: boolean}} props */
function Verdict({ state, blank }) {
  if (blank) return html`<section class="verdict wait" aria-label="Verdict" tabindex="-1" id="verdict">
    <b>No study is open</b></section>`;
  const { is, value, sentence, lost } = answerOf(state, "decision");
  const [problem] = problemsOf(state);
  /** @type {{sentence: string, severity: string, caveats: Caveat[]} | undefined} */
  const verdict = value?.verdict;
  const searched = searchedLayouts(state);
  const none = searched.length > 0 ? `Nothing to rank yet: search for the network of ${
    searched.length > 1 ? "the layouts" : "layout"} ${searched.join(", ")}.`
    : `Not computed: the study has no ${state.history.present.layout === "" ? "layout" : "index"}.`;
  const unsearched = searched.length > 0 && value?.rows.length < 2; // nothing is wrong with what stands alone
  const failed = is === "none" ? (problem?.sentence ?? sentence ?? none) : unsearched ? none : "";
  const isStale = !failed && verdict?.severity === "answer" && staleLayouts(state).length > 0;
  const isOpen = failed === none || (!failed && verdict?.severity === "none" && unchosenLayouts(state).length > 0);
  const kind = is === "coming" ? "wait" : isOpen ? "open" : failed ? "none" : isStale ? "doubt"
    : (verdict?.severity ?? "answer");
  const again = is === "coming" ? `${lost ? "Not computed" : "Computing again"}. Before: ` : "";
  const told = failed || (verdict ? `${again}${isStale ? "At values not re-optimised: " : ""}${verdict.sentence}`
    : lost ? "Not computed" : "Under way");
  return html`<section class=${`verdict ${kind}`} aria-label="Verdict" aria-live="polite" tabindex="-1" id="verdict"
    data-severity=${kind}><b title=${told}>${told}</b>
    <div class="row"><${ToOptimise} state=${state} />
      <${Caveats} caveats=${failed ? [] : (verdict?.caveats ?? [])} /></div></section>`;
}

/** The layouts with values that nobody has chosen. @param {State} state */
const unchosenLayouts = (state) => allDesigns(state.history.present).filter(({ layout, ...design }) =>
  !isSearched(state, layout) && unchosenIn(state, { layout, ...design }).length > 0).map(({ layout }) => layout);

/** That layouts are compared at values that nobody has chosen, or that are optimal for another problem, and the button
 * that optimises all of them. @param {{state: State}} props */
function ToOptimise({ state }) {
  const stale = staleLayouts(state);
  if (stale.length + unchosenLayouts(state).length === 0 || isBeingChosen(state)) return null;
  const title = stale.length > 0 && `Values of ${stale.join(", ")} were optimised before the study or goal changed.`;
  return html`<button type="button" class="stale" title=${title || undefined} onClick=${() =>
    /** @type {HTMLElement | null} */ (document.querySelector("#find-best"))?.click()}>
    <u>Optimise all layouts</u></button>`;
}

/** The caveats, as many as there is room for; the others by a button that counts them.
 * @param {{caveats: Caveat[]}} props */
function Caveats({ caveats }) {
  const line = useRef(/** @type {HTMLDivElement | null} */ (null));
  const [fit, setFit] = useState(caveats.length);
  const [isWrapped, setWrapped] = useState(false);
  useLayoutEffect(() => {
    const place = line.current;
    if (!place) return undefined;
    const look = () => {
      const fits = fitting(place);
      setFit(fits);
      setWrapped(fits === 0 && /** @type {HTMLElement} */ (place.closest(".verdict")?.firstChild).clientHeight < LINES);
    };
    const sized = new ResizeObserver(look);
    sized.observe(place);
    return () => sized.disconnect();
  }, [JSON.stringify(caveats)]);
  if (caveats.length === 0) return null;
  const left = fit === 0 ? 0 : caveats.length - fit;
  return html`<div class=${`caveats ${isWrapped ? "wrapped" : ""}`} ref=${line}>
    ${caveats.map(({ sentence, severity }, i) => html`<span class="caveat" key=${sentence} title=${sentence}
      data-severity=${severity} hidden=${i >= fit && i > 0}>${sentence}</span>`)}
    ${fit < caveats.length && html`<details class="menu more">
      <summary id="caveats-all">${left > 0 ? `${left} more` : "All"}</summary>
      <ul class="menu-body">${caveats.map(({ sentence, severity }) => html`<li key=${sentence}
        data-severity=${severity}>${sentence}</li>`)}</ul></details>`}</div>`;
}

const GAP = 6; // [px]
const LINES = 30; // [px] a verdict of one line leaves room for a caveat of two
const OTHERS = 64; // [px] of the button that counts those for which there is no room

/** How many caveats fit into the line as a whole. @param {HTMLElement} line */
function fitting(line) {
  const chips = /** @type {HTMLElement[]} */ ([...line.querySelectorAll(":scope > .caveat")]);
  const hidden = chips.map((chip) => chip.hidden);
  const { className } = line;
  line.className = "caveats"; // each on a line of its own
  for (const chip of chips) chip.hidden = false;
  const widths = chips.map((chip) => chip.scrollWidth + GAP);
  chips.forEach((chip, i) => { chip.hidden = hidden[i]; });
  line.className = className;
  const whole = widths.reduce((sum, width) => sum + width, 0) <= line.clientWidth;
  let room = line.clientWidth - OTHERS;
  const first = widths.findIndex((width) => (room -= width) < 0);
  return whole || first < 0 ? chips.length : first;
}
