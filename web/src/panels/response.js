// Frequency responses of the strut (solid) and of the baseline (dashed).
import { withUnit } from "../state/scale.js";
import { Being } from "../parts/clock.js";
import { Unchosen } from "../parts/doubts.js";
import { Plot } from "../plot.js";
import { unchosenIn } from "../library.js";
import { answerOf, shownDesigns } from "../questions.js";
import { html, useMemo, useState } from "../parts/html.js";
import { useShown } from "../parts/shown.js";

/** @param {{store: import("../state/store.js").Store}} props */
export function ResponsePanel({ store }) {
  const state = store.get();
  const faulty = (answerOf(state, "check").value?.problems ?? []).length > 0;
  const shown = answerOf(state, "response");
  const { value, sentence } = shown;
  const indices = [...new Set((value?.curves ?? []).map((/** @type {any} */ { index }) => index))];
  const [picked, setPicked] = useState("");
  const index = indices.includes(picked) ? picked : indices[0];
  const document = state.history.present;
  const { layout } = document;
  const curves = useMemo(() => curvesOf((value?.curves ?? []).filter((/** @type {any} */ curve) =>
    curve.index === index), layout), [value, index, layout]);
  const first = value?.curves.find((/** @type {any} */ curve) => curve.index === index);
  useShown("response", state);
  return html`<div class=${shown.before ? "stale" : ""} aria-busy=${shown.is === "coming"}>
    <${Being} shown=${shown} />
    <${Unchosen}
      designs=${shownDesigns(document).map((design) => ({ ...design, unchosen: unchosenIn(state, design) }))} />
    ${sentence && html`<p class="problem">${faulty ? "There are no curves: see what is wrong with the study."
      : sentence}</p>`}
    <div class="row" role="group" aria-label="Index">
      ${indices.map((each) => html`<button type="button" class="chip" key=${each} aria-pressed=${each === index}
        onClick=${() => setPicked(String(each))}>${each}</button>`)}</div>
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
