// The file of the command line: that another program has changed it is told, and the page offers to read it again. That
// no server answers any more is found here too, while nothing else is asked.

import { Lost } from "./api.js";
import { openStudy } from "./working.js";

/** @import { Store } from "./state/store.js" */
/** @import { Api } from "./api.js" */

const LOOK = 2000; // [ms] between two looks at the file
const ABOUT = "the file of the command line";
const BEGUN = "inerter.begun"; // the study of the file that this tab has opened last

/** Remembers the study of the file that is open. @param {unknown} study */
export const begunWith = (study) => sessionStorage.setItem(BEGUN, JSON.stringify(study));

/** Whether a study is the one of the file that this tab has opened last. @param {unknown} study */
export const isBegunWith = (study) => sessionStorage.getItem(BEGUN) === JSON.stringify(study);

let watching = false;

/** Looks at the file of the command line as long as the page is shown. @param {Store} store @param {Api} api
 * @param {string | null | undefined} stamp  of the file when the study that is open was read; null where it was another
 * one; undefined where the study is not of that file */
export function watchFile(store, api, stamp) {
  if (watching) return;
  watching = true;
  let known = stamp;
  let looking = false; // one look at a time: of two, the older one might be answered last
  const look = async () => {
    if (looking || document.hidden || store.get().connection !== "ready") return;
    looking = true;
    try {
      const { name, stamp: now } = await api.get("start/stamp");
      if (known === undefined || now === known || name === "") return;
      known = now;
      tell(store, api, await api.get("start"));
    } catch (error) {
      // A server that was begun again with another token is told of where the next question is asked.
      if (error instanceof Lost) store.dispatch({ type: "connected", connection: "lost" });
    } finally {
      looking = false;
    }
  };
  setInterval(look, LOOK);
  addEventListener("focus", look);
}

/** @param {Store} store @param {Api} api @param {{name: string, study: any, problems: {sentence: string}[],
 * stamp: string}} file */
function tell(store, api, { name, study, problems, stamp }) {
  if (stamp === "") return store.say(`${name} was removed or renamed; the page keeps its study.`, ABOUT);
  if (study === null) return store.say(`${name} has changed, and cannot be read: ${
    problems[0]?.sentence ?? ""}`, ABOUT);
  if (JSON.stringify(study) === JSON.stringify(store.get().history.present.study)) {
    store.dispatch({ type: "closed", about: ABOUT });
    return;
  }
  const reload = async () => {
    begunWith(study);
    await openStudy(store, api, study);
  };
  store.say(`${name} has changed; the page shows its former content.`, ABOUT,
    { label: `Reload ${name}`, act: () => void reload() });
}
