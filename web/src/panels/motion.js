// The vehicle in motion on its road: a picture that follows the clock, which is that of the plot of the motion too.

import { isSearched, numbersOf, outlineOf, shownElement } from "../library.js";
import { layoutColour } from "../plots/colours.js";
import { Chip } from "../parts/controls.js";
import { html, useEffect, useMemo, useRef } from "../parts/html.js";
import { useLate } from "../parts/clock.js";
import { answerOf, baselineOf, designOf } from "../questions.js";
import { clock } from "../state/clock.js";
import { captions } from "../vehicles/captions.js";
import { layout, rangeOf } from "../vehicles/layout.js";
import { REST, momentOf, passing, pastOf } from "../vehicles/moments.js";
import { paint, stylesOf } from "../vehicles/paint.js";
import { posed, trail } from "../vehicles/posed.js";
import { scene } from "../vehicles/scene.js";
import { toSearch } from "./search.js";

/** @import { Store, State } from "../state/store.js" */
/** @import { Layout, Motion } from "../vehicles/layout.js" */
/** @import { Shape } from "../vehicles/symbols.js" */
/** What is drawn: the answers, and what follows from them.
 * @typedef {{motion: Motion | null, other: Motion | null, shaded: any[], scene: import("../vehicles/scene.js").Scene,
 * speed: number, own: string, names: {own: string, other: string} | null}} Shown */

const SPEED = "road.speed"; // which moves the road along
const SPEEDS = /** @type {[number, string][]} */ ([[0.25, "¼"], [0.5, "½"], [1, "1"]]);
const LONGEST = 100; // [ms] that the clock goes on between two frames
const SCRUB = 1 / 200; // [s] of a pixel that the picture is dragged
const NUDGE = 1 / 60; // [s] of a key
const SMALLEST = 40; // [px] of a picture

/** The whole panel. @param {{store: Store, api?: unknown}} props */
export function MotionPanel({ store }) {
  const state = store.get();
  const mechanism = answerOf(state, "mechanism");
  const history = answerOf(state, "history");
  const found = useMemo(() => shownOf(state, mechanism.value, history.value), [mechanism.value, history.value]);
  const last = useRef(found);
  // of the same study the picture stands until the next mechanism comes
  const isKept = found === null && mechanism.is === "coming" && (state.answers.mechanism?.recent ?? false);
  const shown = isKept ? last.current : found;
  last.current = shown;
  const { playing, speed } = state.view;
  const reduced = useReduced(store);
  const why = whyStill(mechanism, history);
  return html`<section class="panel vehicle" aria-label="The vehicle in motion" data-being=${history.is}>
    ${shown && html`<div class="over">
      <div class="segmented" role="group" aria-label="Speed">
        ${SPEEDS.map(([share, words]) => html`<${Chip} key=${words} on=${speed === share}
          title=${`${words} of the true speed`} set=${() => store.look({ speed: share })}>
          ${speed === share ? `${words} speed` : words}<//>`)}
      </div>
      <button type="button" aria-pressed=${!playing} onClick=${() => store.look({ playing: !playing })}>
        ${playing ? "Hold" : "Run"} <kbd>space</kbd></button>
    </div>`}
    <div class=${`picture ${useLate(history.before || isKept) ? "stale" : ""}`} aria-busy=${history.is === "coming"}>
      ${shown && html`<${Picture} store=${store} shown=${shown} reduced=${reduced} />`}
    </div>
    ${isSearched(state, state.history.present.layout) && html`<${ToSearch} store=${store} />`}
    ${why && html`<p class=${`why ${why.doubt ? "doubt" : ""}`}>${why.words}</p>`}
  </section>`;
}

/** What stands in the place of the vehicle where a search is to find the network. @param {{store: Store}} props */
function ToSearch({ store }) {
  const { layout } = store.get().history.present;
  return html`<div class="to-search">
    <p><b>${layout}</b> has a free network: it stands for every network of some springs, dampers and inerters. A search
      optimises and ranks them all, and any of them goes into the editor.</p>
    <button type="button" class="main" onClick=${() => toSearch(store)}>Search for the best network</button></div>`;
}

/** What there is to draw. @param {State} state @param {any} mechanism @param {any} history @returns {Shown | null} */
function shownOf(state, mechanism, history) {
  if (!mechanism) return null;
  const document = state.history.present;
  const [design, baseline] = [designOf(document), baselineOf(document)];
  const other = history?.baseline?.motion ?? null;
  return {
    motion: history?.motion?.time?.length > 1 ? history.motion : null,
    other,
    shaded: history?.shaded ?? [],
    scene: scene(mechanism, document.study.vehicle?.model, outlineOf(state, document.study.vehicle)),
    speed: numbersOf(state).find(({ place }) => place === SPEED)?.value ?? 0,
    own: layoutColour(document, design.layout),
    names: other ? { own: design.name, other: baseline.name } : null,
  };
}

/** Sentences of the server without the name of a file that nobody has seen. @param {string} sentences */
const withoutFile = (sentences) => sentences.replace(/\bstudy\.toml: /g, "");

/** Why the vehicle stands still, or its motion is no good. @param {any} mechanism @param {any} history
 * @returns {{words: string, doubt: boolean} | null} */
function whyStill(mechanism, history) {
  const { value, sentence, is } = history;
  if (!mechanism.value) return mechanism.sentence ? { words: withoutFile(mechanism.sentence), doubt: false } : null;
  if (sentence) return { words: `At rest. ${withoutFile(sentence)}`, doubt: false };
  if (value && value.status !== "ok") return { words: value.message, doubt: true };
  if (!value && is === "coming") return { words: "At rest; its motion is being simulated.", doubt: false };
  return null;
}

/** Whether motion is to be reduced; then the vehicle is held, until it is told to run. @param {Store} store */
function useReduced(store) {
  const query = useMemo(() => matchMedia("(prefers-reduced-motion: reduce)"), []);
  useEffect(() => {
    if (query.matches) store.look({ playing: false });
  }, [query, store]);
  return query.matches;
}

/** @param {{store: Store, shown: Shown, reduced: boolean}} props */
function Picture({ store, shown, reduced }) {
  const canvas = useRef(/** @type {HTMLCanvasElement | null} */ (null));
  const drawn = useRef(/** @type {Film | null} */ (null));
  useEffect(() => {
    const film = filmOn(/** @type {HTMLCanvasElement} */ (canvas.current), store);
    drawn.current = film;
    return film.end;
  }, [store]);
  useEffect(() => drawn.current?.show(shown), [shown]);
  const end = endOf(shown);
  /** @param {KeyboardEvent} event */
  function step(event) {
    const way = { ArrowRight: 1, ArrowLeft: -1 }[event.key];
    if (way === undefined || end === 0) return;
    event.preventDefault();
    store.look({ playing: false });
    clock.set(within(clock.get() + way * NUDGE * (event.shiftKey ? 10 : 1), end));
  }
  return html`<canvas ref=${canvas} role="slider" tabindex="0" aria-label="Time of the motion" aria-valuemin="0"
    aria-valuemax=${end} aria-valuenow=${0} aria-valuetext=${end === 0 ? "at rest" : `of ${end.toPrecision(3)} s`}
    aria-disabled=${end === 0} data-reduced=${reduced} onKeyDown=${step} onPointerDown=${(
      /** @type {PointerEvent} */ event) => scrub(event, end)}></canvas>`;
}

/** @param {Shown} shown */
const endOf = ({ motion }) => (motion ? motion.time[motion.time.length - 1] : 0);

/** @param {number} at @param {number} end */
const within = (at, end) => (end > 0 ? ((at % end) + end) % end : 0);

let dragging = false;

/** Moves the clock with the pointer. @param {PointerEvent} event @param {number} end */
function scrub(event, end) {
  if (end === 0 || event.button !== 0) return;
  const canvas = /** @type {HTMLCanvasElement} */ (event.currentTarget);
  canvas.setPointerCapture(event.pointerId);
  const [from, began] = [event.clientX, clock.get()];
  dragging = true;
  /** @param {PointerEvent} moved */
  const move = ({ clientX }) => clock.set(within(began + (clientX - from) * SCRUB, end));
  const stop = () => {
    dragging = false;
    canvas.removeEventListener("pointermove", move);
  };
  canvas.addEventListener("pointermove", move);
  canvas.addEventListener("pointerup", stop, { once: true });
  canvas.addEventListener("pointercancel", stop, { once: true });
}

/** Draws until it is ended. @typedef {{show: (shown: Shown) => void, end: () => void}} Film */
/** What a film has at hand: `due` where it must draw, `seen` where somebody sees it.
 * @typedef {{shown: Shown | null, made: Layout | null, styles: {[kind: string]: import("../vehicles/paint.js").Style},
 * chosen: string | null, state: State | null, theme?: string, last: number, frames: number, due: boolean,
 * seen: boolean}} Stage  `theme`: the colours that `styles` are of */

/** A picture that follows the clock, and that moves the clock while it is not held.
 * @param {HTMLCanvasElement} canvas @param {Store} store @returns {Film} */
function filmOn(canvas, store) {
  /** @type {Stage} */
  const stage = { shown: null, made: null, styles: stylesOf(canvas), chosen: null, state: null,
    last: performance.now(), frames: 0, due: true, seen: true };
  let range = /** @type {import("../vehicles/layout.js").Range | null} */ (null);
  const fit = () => range && fitTo(canvas, stage, range);
  /** @param {number} now */
  function tick(now) {
    frame = requestAnimationFrame(tick);
    look(canvas, stage, store.get());
    goOn(stage, now);
    if (stage.due && stage.seen) render(canvas, stage);
  }
  let frame = requestAnimationFrame(tick);
  const leave = clock.subscribe(() => {
    stage.due = true;
  });
  const sized = new ResizeObserver(fit);
  sized.observe(canvas);
  const looking = new IntersectionObserver(([{ isIntersecting }]) => {
    stage.seen = isIntersecting;
  });
  looking.observe(canvas);
  return {
    show: (next) => {
      stage.shown = next;
      stage.styles = stylesOf(canvas, next.own);
      range = rangeOf(next.scene, [next.motion ?? [], next.other ?? []].flat());
      fit();
    },
    end: () => {
      cancelAnimationFrame(frame);
      leave();
      sized.disconnect();
      looking.disconnect();
    },
  };
}

/** Lays the scene out anew, and draws it. @param {HTMLCanvasElement} canvas @param {Stage} stage
 * @param {import("../vehicles/layout.js").Range} range */
function fitTo(canvas, stage, range) {
  const { clientWidth: width, clientHeight: height } = canvas;
  const { shown, made } = stage;
  if (!shown || width < SMALLEST || height < SMALLEST) return;
  const ratio = globalThis.devicePixelRatio || 1;
  canvas.width = Math.round(width * ratio);
  canvas.height = Math.round(height * ratio);
  const before = made && made.scene.model === shown.scene.model ? made.times : 0;
  stage.made = layout(shown.scene, { width, height }, range, before);
  render(canvas, stage); // at once: what has another size is empty, and the next frame too late
}

/** Sees what has changed of the page: the selected element, whether it is held, the colours.
 * @param {HTMLCanvasElement} canvas @param {Stage} stage @param {State} state */
function look(canvas, stage, state) {
  if (state !== stage.state) {
    const next = shownElement(state);
    stage.due ||= next !== stage.chosen || state.view.playing !== stage.state?.view.playing;
    stage.chosen = next;
    stage.state = state;
  }
  stage.frames += 1;
  const { theme } = document.documentElement.dataset;
  if (theme === stage.theme) return;
  stage.theme = theme;
  stage.styles = stylesOf(canvas, stage.shown?.own);
  stage.due = true;
}

/** Moves the clock, unless it is held. @param {Stage} stage @param {number} now [ms] */
function goOn(stage, now) {
  const { shown, state, last, seen } = stage;
  const end = shown ? endOf(shown) : 0;
  stage.last = now;
  if (!state?.view.playing || dragging || end === 0 || !seen) return;
  clock.set(within(clock.get() + (Math.min(now - last, LONGEST) / 1000) * state.view.speed, end));
}

/** Draws the present time. @param {HTMLCanvasElement} canvas @param {Stage} stage */
function render(canvas, stage) {
  const { shown, made, styles, chosen, state, frames } = stage;
  if (!shown || !made) return;
  stage.due = false;
  const pen = /** @type {CanvasRenderingContext2D} */ (canvas.getContext("2d", { alpha: false }));
  const ratio = canvas.width / made.width;
  pen.setTransform(ratio, 0, 0, ratio, 0, 0);
  pen.fillStyle = styles.ground.fill ?? "";
  pen.fillRect(0, 0, made.width, made.height);
  paint(pen, shapesOf(shown, made, Math.min(clock.get(), endOf(shown)), chosen), styles);
  canvas.dataset.frames = String(frames);
  if (!state?.view.playing || dragging) canvas.setAttribute("aria-valuenow", clock.get().toFixed(3));
}

/** Everything in the picture at one time. @param {Shown} shown @param {Layout} made @param {number} at [s]
 * @param {string | null} chosen @returns {Shape[]} */
function shapesOf({ motion, other, shaded, speed, names, scene: { column } }, made, at, chosen) {
  if (!motion) return posed(made, { ...REST, chosen });
  const moment = { ...momentOf(made, motion, at, { speed, shaded }), chosen };
  const beside = other ? momentOf(made, other, at, { speed }) : null;
  const trails = column ? [...(other ? trail(made, pastOf(made, other, at, speed), "other trail") : []),
    ...trail(made, pastOf(made, motion, at, speed), "own")] : [];
  return [...posed(made, moment, { other: beside }), ...trails,
    ...captions(made, { moment, motion }, names)];
}
