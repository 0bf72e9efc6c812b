// The simulated road: histories with stick and open gaps shaded, and the car in motion, at one time.

import { Being, useLate } from "../parts/clock.js";
import { Doubts, Unchosen } from "../parts/doubts.js";
import { Field, Select } from "../parts/controls.js";
import { html, useMemo } from "../parts/html.js";
import { Plot } from "../plot.js";
import { layoutColours } from "../plots/colours.js";
import { answerOf, designOf } from "../questions.js";
import { clock } from "../state/clock.js";
import { aligned, printed } from "../state/scale.js";
import { NoCurves } from "./values.js";

/** @import { Store } from "../state/store.js" */
/** @import { Document } from "../state/document.js" */
/** @import { Declaration } from "../plots/layout.js" */
/** @typedef {{name: string, label: string, unit: string, time: number[], values: number[]}} Signal */
/** The times in a state; `words` are a verb. @typedef {{element: string, state: string, words: string,
 * intervals: [number, number][]}} Shaded */

/** @param {{store: Store}} props */
export function HistoryPanel({ store }) {
  const state = store.get();
  const document = state.history.present;
  const answer = answerOf(state, "history");
  const { value, sentence } = answer;
  /** @type {{name: string, label: string}[]} */
  const outputs = value?.outputs ?? [];
  const { output } = state.view;
  const plot = useMemo(() => declared(value, document), [value, document]);
  /** @param {string} key @param {string} label @param {number} number @param {{min: number, max: number}} range */
  const setting = (key, label, number, range) => html`<label>
    ${label} <${Field} type="number" class="short" ...${range} text=${String(number)}
      done=${(/** @type {string} */ text) => {
    const entered = Number(text);
    if (entered >= range.min && entered <= range.max) store.look({ [key]: entered });
  }} /></label>`;
  const controls = html`${outputs.length > 0 && html`<${Select} aria-label="Show"
      choices=${outputs.map(({ name, label }) => [name, label])}
      value=${outputs.some(({ name }) => name === output) ? output : outputs[0].name}
      set=${(/** @type {string} */ name) => store.look({ output: name })} />`}
    ${setting("seconds", "for [s]", state.view.seconds, { min: 1, max: 120 })}
    ${setting("seed", "road no.", state.view.seed, { min: 0, max: 1e9 })}
    <${Being} shown=${answer} />`;
  return html`<div class=${`plot-panel${useLate(answer.before) ? " stale" : ""}`} aria-busy=${answer.is === "coming"}>
    <${Unchosen} state=${state} designs=${[designOf(document)]} />
    <${Doubts} members=${[{ of: "the motion", status: value?.status, message: value?.message }]} />
    <${NoCurves} state=${state} sentence=${sentence} />
    <${Plot} plot=${plot} current=${answer.is === "current"} cursor=${clock}>${controls}<//>
  </div>`;
}

/** The history of a signal, of the design and, where the answer has it, of the baseline on the same road.
 * @param {any} value @param {Document} document @returns {Declaration | null} */
function declared(value, document) {
  /** @type {Signal | undefined} */
  const signal = value?.signals?.[0];
  if (signal === undefined) return null;
  /** @param {any} of @returns {Signal | undefined} */
  const signalOf = (of) => of?.signals?.find((/** @type {Signal} */ { name }) => name === signal.name);
  const colours = layoutColours(document);
  const compared = [value.baseline].flatMap((of) => (signalOf(of) ? [{ ...of, dash: true }] : []));
  const other = compared.map(({ name, layout }) => `; dashed ${name ?? layout}`).join("");
  const [rms, peak] = [value.rms, value.peaks].map((of) => of?.[signal.name] ?? Number.NaN);
  return {
    title: `${signal.label} over time, ${value.name ?? value.layout}`,
    x: { what: "time", unit: "s", from: 0, to: value.duration },
    y: { what: signal.label, unit: signal.unit },
    curves: [...compared, value].map((of) => {
      const { time, values } = /** @type {Signal} */ (signalOf(of));
      return { name: of.name ?? of.layout, x: time, y: values, colour: of.dash ? "s1" : colours[of.layout] ?? "s3",
        dash: of.dash, unnamed: true };
    }),
    ...shadesOf(value.shaded ?? []),
    note: ({ size, unit }) => `${value.name ?? value.layout}: r.m.s. ${aligned(rms / size, 4)}, peak ${
      aligned(peak / size, 4)} ${printed(unit)}${other}`,
  };
}

/** What is shaded, with its names: the states that the library has words for. @param {Shaded[]} shaded */
function shadesOf(shaded) {
  const seen = shaded.filter(({ words, intervals }) => words !== "" && intervals.length > 0);
  const found = [...new Set(seen.map(({ state }) => state))].map((state) =>
    ({ state, those: seen.filter((each) => each.state === state) }));
  return {
    bands: found.flatMap(({ state, those }) => those.flatMap(({ intervals }) =>
      intervals.map(([from, to]) => ({ from, to, kind: state })))),
    keys: found.map(({ state, those }) =>
      ({ kind: state, text: `${those.map(({ element }) => element).join(" or ")} ${those[0].words}` })),
  };
}
