// The vehicle in motion, until `MotionPanel` of motion.js stands here.
import { html } from "../parts/html.js";
import { answerOf } from "../questions.js";
import { Motion } from "./motion.js";

/** @param {{store: import("../state/store.js").Store}} props */
export function MotionPanel({ store }) {
  const { value } = answerOf(store.get(), "history");
  const mechanism = answerOf(store.get(), "mechanism").value;
  return html`<section class="panel vehicle" aria-label="The vehicle in motion">
    ${value?.motion && mechanism && html`<${Motion} store=${store} motion=${value.motion} mechanism=${mechanism} />`}
  </section>`;
}
