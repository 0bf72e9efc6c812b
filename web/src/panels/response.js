// Frequency responses of the strut and of the baseline, and of other struts and kept designs: gain and phase.

import { Being, useLate, useShown } from "../parts/clock.js";
import { Chip, DropDown, Select, useChoice } from "../parts/controls.js";
import { Unchosen } from "../parts/doubts.js";
import { html, useMemo, useState } from "../parts/html.js";
import { Plot } from "../plot.js";
import { layoutColours, numberedColour } from "../plots/colours.js";
import { answerOf, baselineOf, choicesOf, drawnIndex, ghostPanel, ghostsOf, isRightStill, shownDesigns }
  from "../questions.js";
import { indicesIn } from "../state/document.js";
import { NoCurves } from "./values.js";

/** @import { Store, State } from "../state/store.js" */
/** @import { Document } from "../state/document.js" */
/** @import { Curve, Declaration } from "../plots/layout.js" */
/** @typedef {{name: string, layout: string, index: string, title: string, unit: string, label: string,
 * gain: (number | null)[], phase: (number | null)[]}} Response */
/** @typedef {{frequency: number[], responses: Response[], pale: boolean}} Answered  `pale`: of a kept design */

const ALL = "all";
const PARTS = ["gain", "phase", "both"];

/** @param {{store: Store}} props */
export function ResponsePanel({ store }) {
  const state = store.get();
  const document = state.history.present;
  const shown = answerOf(state, "response");
  const { value, sentence } = shown;
  /** @type {Response[]} */
  const found = value?.curves ?? [];
  const ghosts = ghostsOf(state).map(({ key, kept }) => ({ ...answerOf(state, ghostPanel(key)), kept }));
  const index = drawnIndex(state);
  const labels = [...new Set(found.filter((each) => each.index === index).map(({ label }) => label))];
  const [label, setLabel] = useChoice(labels.length > 1 ? [...labels, ALL] : labels);
  const [parts, setParts] = useState(PARTS[0]);
  const [at, read] = useState(/** @type {number | null} */ (null));
  const isRight = useLate(shown.before) ? isRightStill(state, "response") : () => true;
  const stale = [...new Set(found.map(({ layout }) => layout))].filter((layout) => !isRight(layout));
  const { layout, study: { layouts } } = document;
  const baseline = baselineOf(document).layout;
  const plots = useMemo(() => {
    const others = ghosts.flatMap(({ value: of, kept }) =>
      (of ? [{ frequency: of.frequency, responses: of.curves, pale: kept }] : []));
    const answers = [{ frequency: value?.frequency ?? [], responses: found, pale: false }, ...others];
    return declared(answers, { index: index ?? "", label: label ?? "", document, stale });
  }, [value, index, label, layouts, layout, baseline, stale.join(), ...ghosts.map((ghost) => ghost.value)]);
  useShown("response", state);
  const both = parts === "both";
  const current = [shown, ...ghosts].every(({ is }) => is === "current");
  const controls = html`<${Select} aria-label="Index" value=${index} choices=${indicesIn(document.study)}
      set=${(/** @type {string} */ response) => store.look({ response })} />
    ${labels.length > 1 && html`<${Select} aria-label="Output" value=${label} set=${setLabel}
      choices=${[...labels.map((each) => [each, wordsOf(each)]), [ALL, "all outputs"]]} />`}
    <div class="segmented" role="group" aria-label="What is drawn">${PARTS.map((each) =>
      html`<${Chip} key=${each} on=${each === parts} set=${() => setParts(each)}>${each}<//>`)}</div>
    <${Others} store=${store} />
    <${Being} shown=${shown} />`;
  return html`<div class="plot-panel" aria-busy=${shown.is === "coming"}>
    <${Unchosen} state=${state} designs=${shownDesigns(document)} />
    <${NoCurves} state=${state} sentence=${sentence} />
    ${both && html`<div class="row plot-tools">${controls}</div>`}
    <div class=${both ? "plots two" : "plots"}>
      ${parts !== "phase" && html`<${Plot} key="gain" plot=${plots?.gain ?? null} current=${current}
        switches=${["x", "y"]} at=${at} read=${read}>${both ? null : controls}<//>`}
      ${parts !== "gain" && html`<${Plot} key="phase" plot=${plots?.phase ?? null} current=${current}
        switches=${["x"]} at=${at} read=${read}>${parts === "phase" ? controls : null}<//>`}
    </div>
  </div>`;
}

/** Other struts and kept designs, each of which can be drawn too. @param {{store: Store}} props */
function Others({ store }) {
  const { history: { present: document }, view: { ghosts } } = store.get();
  const drawn = shownDesigns(document).map(({ layout }) => `layout ${layout}`);
  const choices = choicesOf(document).filter(({ key }) => !drawn.includes(key));
  if (choices.length === 0) return null;
  return html`<${DropDown} title="More curves">${choices.map(({ key, name, kept }) => html`<label key=${key}>
    <input type="checkbox" checked=${ghosts.includes(key)} onChange=${() => store.look({ ghosts: ghosts.includes(key)
      ? ghosts.filter((each) => each !== key) : [...ghosts, key] })} /> ${name}${kept ? ", kept" : ""}</label>`)}<//>`;
}

/** An output as a person calls it. @param {string} label */
const wordsOf = (label) => label.replaceAll("_", " ").replaceAll(" x ", " × ");

/** Names without their factors and the word in which all end. @param {string[]} names */
function shortened(names) {
  const bare = names.map((name) => name.replace(/ × .*$/, ""));
  const last = / [^ ]+$/.exec(bare[0] ?? "")?.[0];
  return last && bare.every((name) => name.endsWith(last)) ? bare.map((name) => name.slice(0, -last.length)) : bare;
}

/** The plots of gain and of phase. @param {Answered[]} answers
 * @param {{index: string, label: string, document: Document, stale: string[]}} how  `stale`: layouts that were changed
 * @returns {{gain: Declaration, phase: Declaration} | null} */
function declared(answers, { index, label, document, stale }) {
  const labels = [...new Set(answers[0].responses.filter((each) => each.index === index).map((each) => each.label))];
  const first = answers[0].responses.find((each) => each.index === index && (label === ALL || each.label === label));
  if (first === undefined) return null;
  const colours = layoutColours(document);
  const baseline = baselineOf(document).layout;
  const several = label === ALL;
  const short = shortened(labels.map(wordsOf));
  /** @param {"gain" | "phase"} what @returns {Curve[]} */
  const curves = (what) => answers.flatMap(({ frequency, responses, pale }) => responses
    .filter((each) => each.index === index && (several || each.label === label))
    .map((each) => ({
      name: several ? `${each.name} ${short[labels.indexOf(each.label)]}` : each.name,
      unnamed: several && each.layout === baseline && each.layout !== document.layout,
      x: frequency,
      y: what === "gain" ? each.gain : each.phase.map((angle) => angle && (180 / Math.PI) * angle),
      turn: what === "gain" ? undefined : 360,
      colour: several && each.layout !== baseline ? numberedColour(labels.indexOf(each.label))
        : colours[each.layout] ?? "s4",
      dash: !pale && each.layout === baseline,
      strong: !pale && each.layout === document.layout,
      pale,
      stale: !pale && stale.includes(each.layout),
    }))).toSorted((one, other) => Number(one.strong) - Number(other.strong));
  const x = { what: "frequency", unit: "Hz", log: true };
  const title = several ? `${index}, all outputs, dashed ${baseline}` : first.title;
  const gain = curves("gain");
  const phase = curves("phase");
  const known = phase.some(({ y }) => y.some((each) => each !== null));
  return {
    gain: { title: `Frequency response of ${index}: ${title}`, x, curves: gain,
      y: { what: title, unit: first.unit, zero: true } },
    phase: { title: `Phase of ${index}: ${title}`, x, curves: phase, y: { what: known ? `phase: ${title}`
      : "no phase: several independent sources excite", unit: known ? "°" : "", from: -180, to: 180,
    ticks: [-180, -90, 0, 90, 180] } },
  };
}
