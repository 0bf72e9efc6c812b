// The simulated road: histories with stick and open gaps shaded, and the car in motion.

import { Plot } from "../plot.js";
import { answerOf, designOf } from "../questions.js";
import { Being } from "../parts/clock.js";
import { Doubts, Unchosen } from "../parts/doubts.js";
import { Field } from "../parts/field.js";
import { Select, useChoice } from "../parts/controls.js";
import { html, useMemo } from "../parts/html.js";
import { problemsOf } from "./values.js";
import { shown, withUnit } from "../state/scale.js";

/** @import { Store } from "../state/store.js" */
/** @import { Band } from "../plot.js" */

const SHADED = ["stick", "open"];

/** @param {{store: Store}} props */
export function HistoryPanel({ store }) {
  const state = store.get();
  const document = state.history.present;
  const faulty = problemsOf(state).length > 0;
  const answer = answerOf(state, "history");
  const { value, sentence } = answer;
  /** @type {{name: string, label: string, unit: string, time: number[], values: number[]}[]} */
  const signals = value?.signals ?? [];
  const [picked, setPicked] = useChoice(signals.map(({ name }) => name));
  const signal = signals.find(({ name }) => name === picked);
  const bands = useMemo(() => bandsOf(value?.shaded ?? []), [value]);
  const curves = useMemo(() => (signal ? [{ label: signal.label, values: signal.values }] : []), [signal]);
  /** @param {string} key @param {string} label @param {number} number @param {{min: number, max: number}} range */
  const setting = (key, label, number, range) => html`<label>
    ${label} <${Field} type="number" class="short" ...${range} text=${String(number)}
      done=${(/** @type {string} */ text) => {
    const entered = Number(text);
    if (entered >= range.min && entered <= range.max) store.look({ [key]: entered });
  }} /></label>`;
  return html`<div class=${answer.before ? "stale" : ""} aria-busy=${answer.is === "coming"}>
    <${Being} shown=${answer} />
    <${Unchosen} state=${state} designs=${[designOf(document)]} />
    <${Doubts} members=${[{ of: "the motion", status: value?.status, message: value?.message }]} />
    <div class="row">
      <${Select} label="Show" value=${signal?.name ?? ""} choices=${signals.map(({ name, label }) => [name, label])}
        set=${setPicked} />
      ${setting("seconds", "for [s]", state.view.seconds, { min: 1, max: 120 })}
      ${setting("seed", "road no.", state.view.seed, { min: 0, max: 1e9 })}
    </div>
    ${sentence && html`<p class="problem">${faulty ? "There are no curves: see what is wrong with the study."
      : sentence}</p>`}
    ${!signal && html`<div class="plot empty"></div>`}
    ${signal &&
    html`<${Plot} x=${signal.time} curves=${curves} bands=${bands} xLabel="time [s]"
      yLabel=${withUnit(signal.label, signal.unit)} title=${`${signal.label} over time`} theme=${state.view.theme} />
      <p class="quiet">r.m.s. ${shown(value.rms?.[signal.name])} ${signal.unit},
        peak ${shown(value.peaks?.[signal.name])} ${signal.unit}.
        ${bands.length > 0 && html` <span class="key stick"></span> friction sticks, <span class="key open">
          </span> a gap is open.`}</p>`}
  </div>`;
}

/** The intervals in which friction sticks or a gap is open.
 * @param {{state: string, intervals: [number, number][]}[]} shaded @returns {Band[]} */
const bandsOf = (shaded) => shaded.filter(({ state }) => SHADED.includes(state)).flatMap(({ state, intervals }) =>
  intervals.map(([from, to]) => ({ from, to, kind: state })));
