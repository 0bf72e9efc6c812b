// Tells the window when an answer is on the screen, and whether it is that to the newest question.
import { answerOf } from "../questions.js";
import { useLayoutEffect } from "./html.js";

/** @param {string} panel @param {import("../state/store.js").State} state */
export function useShown(panel, state) {
  const { is, value } = answerOf(state, panel);
  useLayoutEffect(() => {
    dispatchEvent(new CustomEvent("inerter:shown", { detail: { panel, newest: is === "current" } }));
  }, [is, value]);
}
