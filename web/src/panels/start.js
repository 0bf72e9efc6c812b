// The first screen: begin with a question, with a vehicle, with a file, or with what was open before.

import { Moving } from "../parts/clock.js";
import { html, useEffect, useState } from "../parts/html.js";
import { canonical } from "../network/algebra.js";
import { kindNamed, outlineOf, recordSuffixes } from "../library.js";
import { drawing, pathOf } from "../network/drawing.js";
import { open, openedBefore } from "../remembering.js";
import { openStudy } from "../working.js";
import { symbolPath } from "./sketch.js";

/** @import { Store } from "../state/store.js" */
/** @import { Api } from "../api.js" */
/** An example with its question or title as `heading`, its largest network, and what its elements are.
 * @typedef {{name: string, title: string, heading: string, study: any, tree: any, kinds: {[name: string]: string}}}
 * Example */
/** `vehicles`: which example to begin with. @typedef {{examples: Example[], vehicles: {title: string,
 * name: string}[]}} Found */

/** @param {{store: Store, api: Api}} props */
export function Start({ store, api }) {
  const [{ examples, vehicles }, setFound] = useState(/** @type {Found} */ ({ examples: [], vehicles: [] }));
  const { about } = store.get();
  const ready = about !== null;
  useEffect(() => {
    let shown = true;
    if (ready) api.get("examples").then((found) => shown && setFound(found), () => {}); // told elsewhere
    return () => { shown = false; };
  }, [ready]);
  /** @param {any} study */
  const begin = (study) => openStudy(store, api, study);
  return html`<main class="blank">
    <section class="panel" aria-labelledby="questions-title" data-keys="Questions">
      <div class="head"><h2 id="questions-title">Begin with a question</h2>
        <small>Each opens complete, and all of it can be changed.</small></div>
      <div class="inside">
        ${ready && examples.length === 0 && html`<p class="pad"><${Moving} what="Reading the examples" /></p>`}
        <div class="cards" onKeyDown=${walk}>
        ${examples.map((example) => html`<button type="button" class="card" key=${example.name}
          data-example=${example.name} onClick=${() => begin(example.study)}>
          <${Picture} about=${about} example=${example} />
          <span><b>${example.heading}</b>${example.heading !== example.title
            && html`<small>${example.title}</small>`}</span></button>`)}
      </div></div></section>
    <div class="col">
      <section class="panel" aria-labelledby="vehicles-title"><div class="inside">
        <div class="head"><h2 id="vehicles-title">Begin with a vehicle</h2></div>
        ${vehicles.map(({ title, name }) => html`<button type="button" class="list-row" key=${name}
          onClick=${() => begin(examples.find((each) => each.name === name)?.study)}><span>${title}</span></button>`)}
        <div class="head"><h2>Or with a file</h2></div>
        <div class="drop">Drop a study file (.toml), a record (${recordSuffixes(store.get()).join(", ")}) or a folder of
          results anywhere on the page, or<br /><label class="file">choose a file <kbd>Ctrl O</kbd>
            <input type="file" multiple onChange=${(/** @type {Event} */ event) => open(store, api,
              /** @type {HTMLInputElement} */ (event.currentTarget).files ?? [])} /></label></div>
        ${openedBefore().length > 0 && html`<div class="head"><h2>Opened before</h2></div>
          ${openedBefore().map(({ title, at, study }) => html`<button type="button" class="list-row" key=${at}
            onClick=${() => begin(study)}><span>${title}</span>
            <small>${new Date(at).toLocaleDateString()}</small></button>`)}`}
        <p class="quiet pad"><small>Nothing leaves this machine. An inerter is a two-terminal element whose force is
          proportional to the relative acceleration of its terminals.</small></p>
      </div></section></div>
  </main>`;
}

/** Arrow keys go from card to card, across and down. @param {KeyboardEvent} event */
function walk(event) {
  const cards = [.../** @type {Element} */ (event.currentTarget).querySelectorAll(".card")];
  const at = cards.indexOf(/** @type {Element} */ (event.target));
  const [{ top }] = cards.map((card) => card.getBoundingClientRect());
  const across = cards.filter((card) => card.getBoundingClientRect().top === top).length;
  const step = { ArrowRight: 1, ArrowLeft: -1, ArrowDown: across, ArrowUp: -across }[event.key];
  const next = step && cards[at + step];
  if (!next) return;
  event.preventDefault();
  /** @type {HTMLElement} */ (next).focus();
}

const GROUND = 104;

/** A picture of a vehicle: its bodies as paths, where its wheels and struts are.
 * @typedef {{bodies: string[], wheels: number[], radius: number, struts: number[], top: number, bottom: number,
 * width: number}} Outline */

/** @type {Outline} */
const BLOCK = { bodies: ["M56 14h88q6 0 6 6v14q0 6 -6 6h-88q-6 0 -6 -6v-14q0 -6 6 -6z"], wheels: [], radius: 0,
  struts: [100], top: 40, bottom: GROUND, width: 120 };
/** @type {Outline} */
const CAR = { bodies: ["M10 62q2-16 20-18l22-4q14-20 40-20h26q24 0 40 20l26 5q14 3 14 17z"], wheels: [48, 152],
  radius: 13, struts: [48, 152], top: 46, bottom: 78, width: 44 };
/** @type {Outline} */
const COACH = { bodies: ["M20 8h160q6 0 6 6v22q0 6 -6 6h-160q-6 0 -6 -6v-22q0 -6 6 -6z", "M28 78h48v6h-48z",
  "M124 78h48v6h-48z"], wheels: [38, 66, 134, 162], radius: 9, struts: [52, 148], top: 42, bottom: 78, width: 60 };
/** @type {{[outline: string]: Outline}} */
const OUTLINES = {
  corner: { ...BLOCK, wheels: [100], radius: 13, bottom: 78 }, car: CAR,
  absorber: { ...BLOCK, bodies: ["M76 8h48q6 0 6 6v8q0 6 -6 6h-48q-6 0 -6 -6v-8q0 -6 6 -6z",
    "M68 92V104M132 92V104M50 68h100q6 0 6 6v12q0 6 -6 6h-100q-6 0 -6 -6v-12q0 -6 6 -6z"], top: 28, bottom: 68 },
};

/** @param {any} about @param {any} vehicle */
const pictureOf = (about, vehicle) => OUTLINES[outlineOf({ about }, vehicle)]
  ?? (Object.keys(vehicle?.tyres ?? {}).length > 2 ? COACH : BLOCK);

/** A strut below what it carries. @param {{about: any, example: Example}} props */
function Picture({ about, example: { study, tree, kinds } }) {
  const { bodies, wheels, radius, struts, ...place } = pictureOf(about, study.vehicle);
  return html`<svg viewBox="0 0 200 112" aria-hidden="true">
    <path d=${`M0 ${GROUND}H200`} stroke="var(--road)" stroke-width="2" />
    ${bodies.map((path) => html`<path key=${path} d=${path} fill="var(--body)" stroke="var(--ink)" />`)}
    ${wheels.map((x) => html`<circle cx=${x} cy=${GROUND - radius - 1} r=${radius} fill="var(--tyre)"
      stroke="var(--ink2)" /><circle cx=${x} cy=${GROUND - radius - 1} r=${0.54 * radius} fill="var(--body)" />`)}
    ${tree && struts.map((x) => html`<${Strut} key=${x} about=${about} tree=${canonical(tree)} kinds=${kinds} x=${x}
      ...${place} />`)}
  </svg>`;
}

/** @param {{about: any, tree: any, kinds: {[name: string]: string}, x: number, top: number, bottom: number,
 * width: number}} props */
function Strut({ about, tree, kinds, x, top, bottom, width }) {
  const plan = drawing(tree);
  const scale = Math.min((bottom - top) / plan.height, width / (plan.left + plan.right));
  const tall = (bottom - top) / plan.height;
  return html`<g class="sketch" transform=${`translate(${x} ${top}) scale(${scale} ${tall})`} color="var(--ink)">
    <path d=${pathOf(plan.lines)} />
    ${plan.placed.map(({ name, path, x: left, y }) => html`<path key=${path.join()}
      transform=${`translate(${left} ${y})`} d=${symbolPath(kindNamed({ about }, kinds[name]))} />`)}</g>`;
}
