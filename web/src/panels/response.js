// Frequency responses of the strut (solid) and of the baseline (dashed).
import { withUnit } from "../state/scale.js";
import { Being } from "../parts/clock.js";
import { Unchosen } from "../parts/doubts.js";
import { Plot } from "../plot.js";
import { answerOf, shownDesigns } from "../questions.js";
import { IndexChips, useChoice } from "../parts/controls.js";
import { html, useMemo } from "../parts/html.js";
import { problemsOf } from "./values.js";
import { useShown } from "../parts/shown.js";

/** @param {{store: import("../state/store.js").Store}} props */
export function ResponsePanel({ store }) {
  const state = store.get();
  const faulty = problemsOf(state).length > 0;
  const shown = answerOf(state, "response");
  const { value, sentence } = shown;
  /** @type {any[]} */
  const found = value?.curves ?? [];
  const indices = [...new Set(found.map((curve) => curve.index))];
  const [index, setIndex] = useChoice(indices);
  const document = state.history.present;
  const { layout } = document;
  const curves = useMemo(() => curvesOf(found.filter((curve) => curve.index === index), layout),
    [value, index, layout]);
  const first = found.find((curve) => curve.index === index);
  useShown("response", state);
  return html`<div class=${shown.before ? "stale" : ""} aria-busy=${shown.is === "coming"}>
    <${Being} shown=${shown} />
    <${Unchosen} state=${state} designs=${shownDesigns(document)} />
    ${sentence && html`<p class="problem">${faulty ? "There are no curves: see what is wrong with the study."
      : sentence}</p>`}
    <${IndexChips} indices=${indices} picked=${index} pick=${setIndex} />
    ${!first && html`<div class="plot empty"></div>`}
    ${first && html`<${Plot} x=${value.frequency} curves=${curves} xLabel="frequency [Hz]"
      yLabel=${withUnit("gain", first.unit)} log=${true} logY=${true} title=${`Frequency response of ${index}`}
        theme=${state.view.theme} />
      <p class="quiet">${first.title}: solid ${layout}, dashed the baseline.</p>`}
  </div>`;
}

const BASELINE = 1; // its colour

/** The gains of an index; where it has several outputs, each with its name and a colour of its own.
 * @param {any[]} found @param {string} layout */
function curvesOf(found, layout) {
  const outputs = [...new Set(found.map(({ label }) => label))];
  const several = outputs.length > 1;
  return found.map(({ name, label, layout: of, gain }) => {
    const number = outputs.indexOf(label);
    const dash = of !== layout;
    return { label: several ? `${name}, ${label.replaceAll("_", " ")}` : name, values: gain, dash, colour: number > 0
      ? number + BASELINE : dash && !several ? BASELINE : 0 };
  });
}
