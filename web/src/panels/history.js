// The simulated road: histories with stick and open gaps shaded, and the car in motion.

import { Plot } from "../plot.js";
import { unchosenIn } from "../library.js";
import { answerOf, designOf } from "../questions.js";
import { Being } from "../parts/clock.js";
import { Doubts, Unchosen } from "../parts/doubts.js";
import { Field } from "../parts/field.js";
import { html, useMemo, useState } from "../parts/html.js";
import { Motion } from "./motion.js";
import { shown, withUnit } from "../state/scale.js";

const SHADED = ["stick", "open"];

/** @param {{store: import("../state/store.js").Store}} props */
export function HistoryPanel({ store }) {
  const state = store.get();
  const document = state.history.present;
  const faulty = (answerOf(state, "check").value?.problems ?? []).length > 0;
  const answer = answerOf(state, "history");
  const { value, sentence } = answer;
  const mechanism = answerOf(state, "mechanism").value;
  const [picked, setPicked] = useState("");
  const signals = value?.signals ?? [];
  const signal = signals.find((/** @type {any} */ { name }) => name === picked) ?? signals[0];
  const bands = useMemo(
    () =>
      (value?.shaded ?? [])
        .filter((/** @type {any} */ each) => SHADED.includes(each.state))
        .flatMap((/** @type {any} */ each) => each.intervals.map((/** @type {[number, number]} */ [from, to]) =>
          ({ from, to, kind: each.state }))),
    [value],
  );
  const curves = useMemo(() => (signal ? [{ label: signal.label, values: signal.values }] : []), [signal]);
  /** @param {string} key @param {string} label @param {number} number @param {{min: number, max: number}} range */
  const setting = (key, label, number, range) => html`<label>
    ${label} <${Field} type="number" class="short" ...${range} text=${String(number)}
      done=${(/** @type {string} */ text) => {
    const entered = Number(text);
    if (entered >= range.min && entered <= range.max) store.dispatch({ type: "viewed", view: { [key]: entered } });
  }} /></label>`;
  return html`<div class=${answer.before ? "stale" : ""} aria-busy=${answer.is === "coming"}>
    <${Being} shown=${answer} />
    <${Unchosen} designs=${[{ name: document.layout, unchosen: unchosenIn(state, designOf(document)) }]} />
    <${Doubts} members=${[{ of: "the motion", status: value?.status, message: value?.message }]} />
    <div class="row">
      <label>Show <select value=${signal?.name ?? ""}
        onChange=${(/** @type {Event} */ event) =>
          setPicked(/** @type {HTMLSelectElement} */ (event.currentTarget).value)}>
        ${signals.map((/** @type {any} */ each) => html`<option key=${each.name} value=${each.name}>${each.label}
          </option>`)}
      </select></label>
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
    ${value?.motion && mechanism && html`<${Motion} store=${store} motion=${value.motion} mechanism=${mechanism} />`}
  </div>`;
}
