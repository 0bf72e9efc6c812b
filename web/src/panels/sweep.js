// The best designs over one number of the study: values of an index, or its reduction relative to the baseline.

import { Chip, IndexChips, Select, useChoice } from "../parts/controls.js";
import { Doubts, isOk } from "../parts/doubts.js";
import { html, useMemo, useState } from "../parts/html.js";
import { numbersOf } from "../library.js";
import { Plot } from "../plot.js";
import { coloursOf } from "../plots/colours.js";
import { printed, quantity, shown, times, unitFor, valuesIn, withUnit } from "../state/scale.js";
import { TAKEN } from "../state/store.js";
import { membersOf, takeOptima } from "../working.js";
import { indexAxis, indicesOf } from "./answers.js";
import { Files } from "./files.js";

/** @import { Store, Job } from "../state/store.js" */
/** @import { Api } from "../api.js" */
/** @import { WrittenUnit } from "../state/scale.js" */
/** @import { Declaration, Point as Place } from "../plots/layout.js" */
/** A number that is swept: its unit as it is written with the size of that in the SI unit, and its value in the study.
 * @typedef {{name: string, words: string, unit: string, own?: number | null,
 * written?: {unit: string, factor: number}}} Swept */
/** @typedef {any} Row  a design with its index and value, and with the swept numbers by their names */

const TAKE = "take it into the editor";

/** @param {{store: Store, api: Api, job: Job}} props */
export function SweepResult({ store, api, job }) {
  const { result } = job;
  /** @type {Row[]} */
  const rows = result.designs;
  /** @type {Swept[]} */
  const [of, also] = result.swept;
  const indices = [...new Set(rows.map(({ index }) => index))];
  const [index, setIndex] = useChoice(indices);
  const steps = also ? [...new Set(rows.map((row) => String(row[also.name])))] : [];
  const [step, setStep] = useChoice(steps);
  const methods = [...new Set(rows.map(({ method }) => method))];
  const [method, setMethod] = useChoice(methods);
  const [relative, setRelative] = useState(true);
  const own = useMemo(() => rows.filter((row) => row.index === index && row.method === method
    && (!also || String(row[also.name]) === step)), [rows, index, method, step]);
  const isRelative = relative && own.some(({ layout, improvement_percent: part }) =>
    layout !== result.baseline && typeof part === "number");
  const { about } = store.get();
  const { title = "" } = indicesOf(store.get()).find(({ symbol }) => symbol === index) ?? {};
  const written = useMemo(() => unitFor(about, own.map(({ value }) => value), own[0]?.unit ?? ""), [about, own]);
  const plot = useMemo(() => declared(about, own, { of, baseline: result.baseline, isRelative, written, title }),
    [own, of, isRelative, written, title]);
  const [picked, look] = useState(/** @type {number | null} */ (null));
  return html`<${Doubts} members=${rows.flatMap(membersOf)} />
    <${Plot} plot=${plot} table=${tableOf(own, of, written, result.units ?? {})} picked=${picked} look=${look}
      take=${(/** @type {Place} */ place) => takeSwept(store, of, place.of)} switches=${["x"]}>
      <${IndexChips} indices=${indices} picked=${index} pick=${setIndex} />
      ${methods.length > 1 && html`<${Select} aria-label="Method" value=${method} choices=${methods}
        set=${setMethod} />`}
      ${also && html`<${Select} label=${also.words} value=${step} set=${setStep}
        choices=${steps.map((each) => [each, writtenOf(Number(each), also)])} />`}
      <div class="segmented" role="group" aria-label="What is drawn">
        <${Chip} on=${!isRelative} set=${() => setRelative(false)}>value<//>
        <${Chip} on=${isRelative} set=${() => setRelative(true)}>relative to ${result.baseline}<//></div>
    <//>
    <p class="quiet">Click a point to take its design, with its value of ${of.words}, into the editor.</p>
    <${Files} store=${store} api=${api} job=${job} />`;
}

/** @param {number} value @param {Swept} of */
const writtenOf = (value, { unit, written }) => quantity(value / (written?.factor ?? 1), written?.unit ?? unit);

/** @param {any} about @param {Row[]} rows
 * @param {{of: Swept, baseline: string, isRelative: boolean, written: WrittenUnit, title: string}} how
 * @returns {Declaration & {points: Place[]}} */
function declared(about, rows, { of, baseline, isRelative, written: { unit, factor }, title }) {
  const layouts = [...new Set(rows.map(({ layout }) => layout))];
  const colours = coloursOf(layouts, baseline);
  const { index = "" } = rows[0] ?? {};
  /** @param {Row} row */
  const valueOf = (row) => (isRelative ? row.improvement_percent : row.value);
  const sorted = layouts.map((layout) => rows.filter((row) => row.layout === layout)
    .toSorted((one, other) => one[of.name] - other[of.name]));
  const places = sorted.flat().map((row) => row[of.name]);
  const isInside = typeof of.own === "number" && of.own >= Math.min(...places) && of.own <= Math.max(...places);
  return {
    title: `${index} over ${of.words}`,
    x: { what: of.words, unit: of.written?.unit ?? of.unit, size: of.written?.factor, padded: true },
    y: isRelative ? { what: `reduction of ${index} relative to ${baseline}`, unit: "%", zero: true, padded: true }
      : { what: title ? indexAxis(index, title) : index, unit, size: 1 / factor },
    curves: layouts.map((layout, i) => ({ name: layout, colour: colours[layout], dash: layout === baseline,
      x: sorted[i].map((row) => row[of.name]), y: sorted[i].map((row) => numberOr(valueOf(row))) })),
    marks: isInside ? [{ x: Number(of.own), text: `study: ${writtenOf(Number(of.own), of)}` }] : [],
    points: sorted.flatMap((own, curve) => (isRelative && layouts[curve] === baseline ? [] : own.flatMap((row) => {
      const value = numberOr(valueOf(row));
      if (value === null) return [];
      const values = valuesIn(about, row.texts ?? {});
      const reduced = typeof row.improvement_percent === "number" && row.layout !== baseline
        ? `, ${shown(row.improvement_percent, 3)} % below ${baseline}` : "";
      const doubt = isOk(row.status) ? "" : `${row.status}: `;
      const read = `${index} ${shown(times(row.value, factor), 4)} ${printed(unit)}${reduced}`;
      const here = `${doubt}${row.layout} at ${of.name} = ${writtenOf(row[of.name], of)}`;
      return [{ curve, x: row[of.name], y: value, doubtful: !isOk(row.status), of: row,
        lines: [here, read, values].filter(Boolean),
        label: `${here}: ${read}; ${values}; ${TAKE}`,
      }];
    }))),
  };
}

/** @param {unknown} value */
const numberOr = (value) => (typeof value === "number" ? value : null);

/** @param {Row[]} rows @param {Swept} of @param {WrittenUnit} written @param {{[name: string]: string}} units */
function tableOf(rows, of, { unit, factor }, units) {
  const names = [...new Set(rows.flatMap((row) => Object.keys(row.parameters ?? {})))];
  return {
    heads: [withUnit(of.words, of.written?.unit ?? of.unit), "layout", withUnit(rows[0]?.index ?? "", unit),
      "below the baseline [%]", "status", ...names.map((name) => withUnit(name, units[name]))],
    rows: rows.map((row) => [row[of.name] / (of.written?.factor ?? 1), row.layout, times(numberOr(row.value), factor),
      numberOr(row.improvement_percent), String(row.status), ...names.map((name) => row.parameters?.[name] ?? "")]),
  };
}

/** A design of a sweep becomes the present one, with what is swept at its value: one step to undo.
 * @param {Store} store @param {Swept} of @param {Row} row */
function takeSwept(store, of, row) {
  const { present } = store.get().history;
  const number = numbersOf(store.get()).find(({ place }) => place === of.name);
  if (number === undefined || !(row.layout in (present.study.layouts ?? {})))
    return store.say(`The open study has no layout ${row.layout} with ${of.name}; nothing was changed.`, TAKEN);
  const gesture = Symbol("sweep");
  const free = Object.keys(row.parameters ?? {}).length > 0;
  const told = free ? takeOptima(store, [row], gesture) : "";
  if (free && store.get().history.present === present) return store.say(told, TAKEN);
  const { unit, factor } = of.written ?? { unit: of.unit, factor: 1 };
  const text = `${Number((row[of.name] / factor).toPrecision(15))} ${unit}`.trim();
  store.change({ type: "placed", place: number.path, value: text }, gesture);
  store.change({ type: "selected", layout: row.layout }, gesture);
  return store.say(`${of.name} = ${text}. ${told}`.trim(), TAKEN);
}
