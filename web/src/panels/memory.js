// Opening, undoing, sharing and downloading.

import { whenChosen } from "../asking.js";
import { indicesOf } from "./answers.js";
import { ExportMenu } from "./exports.js";
import { bodyOf, comparedOf, designOf, shownDesigns } from "../questions.js";
import { DropDown, Select, useChoice } from "../parts/controls.js";
import { html, useState } from "../parts/html.js";
import { download, fileName, linkTo, noteOpened, open } from "../remembering.js";
import { begin, ended, openStudy } from "../working.js";
import { isBlank } from "../state/document.js";

/** @import { Store } from "../state/store.js" */
/** @import { Api } from "../api.js" */
/** @import { Document } from "../state/document.js" */

/** @param {{store: Store, api: Api}} props */
export function Menu({ store, api }) {
  const state = store.get();
  const { history } = state;
  const { study, layout } = history.present;
  const name = fileName(study.title);
  const blank = isBlank(history.present);
  /** @param {(document: Document) => Promise<void>} work */
  const attempt = (work) => () => whenChosen(store).then((document) => document && work(document))
    .catch((/** @type {Error} */ { message }) => store.say(message));
  /** @param {string} called @param {(document: Document) => Promise<Blob>} made */
  const save = (called, made) => attempt(async (document) => download(await made(document), called));
  /** @param {string} called @param {(document: Document) => object} body */
  const file = (called, body) => save(`${called}.toml`, async (document) =>
    new Blob([(await api.post("study/write", body(document))).text], { type: "application/toml" }));
  /** @param {string} panel */
  const csv = (panel) => save(panel === "indices" ? `${name}.csv` : `${name}-${panel}.csv`, () =>
    api.blob("export/csv", { panel, request: bodyOf(store.get(), panel) }));
  const indices = indicesOf(state).map(({ symbol }) => symbol);
  const [index, setIndex] = useChoice(indices);
  /** Buttons that save a figure in both formats. @param {string} title @param {string} kind
   * @param {(document: Document) => any[]} designs @param {object} [more] */
  const figures = (title, kind, designs, more) => ["svg", "png"].map((format) => html`<button type="button"
    onClick=${save(`${name}-${kind}.${format}`, (document) =>
    api.blob("figure", { kind, format, study: document.study, designs: designs(document), ...more }))}>
    ${title} (${format.toUpperCase()})</button>`);
  const whole = attempt(() => runStudy(store, api));
  const page = attempt((document) => saveReport(store, api, document, `${name}-report.html`));
  /** @param {Document} document */
  const alone = (document) => [designOf(document)];
  return html`<div class="row" role="group" aria-label="Memory">
    <button type="button" title="Undo (Ctrl+Z)" disabled=${history.past.length === 0}
      onClick=${() => store.dispatch({ type: "undone" })}>Undo</button>
    <button type="button" title="Redo (Ctrl+Shift+Z)" disabled=${history.future.length === 0}
      onClick=${() => store.dispatch({ type: "redone" })}>Redo</button>
    <${Open} store=${store} api=${api} />
    ${!blank && html`<${DropDown} title="Save" id="save-menu">
      <button type="button" onClick=${file(name, (document) => ({ study: document.study }))}>Study file (TOML)</button>
      <button type="button" onClick=${file(`${name}-${fileName(layout)}`, (document) =>
        ({ study: document.study, designs: alone(document) }))}>This design, values fixed (TOML)</button>
      <button type="button" onClick=${csv("indices")}>Indices (CSV)</button>
      <button type="button" onClick=${csv("response")}>Frequency response (CSV)</button>
      ${comparedOf(state).length > 1
        && html`<button type="button" onClick=${csv("compare")}>Comparison (CSV)</button>`}
      <button type="button" onClick=${csv("history")}>On the road (CSV)</button>
      ${figures("Network", "networks", alone)}
      ${index && html`<${Select} label="Response of" value=${index} choices=${indices} set=${setIndex} />
        ${figures("Response", `response-${index}`, shownDesigns)}`}
      ${figures("On the road", "history", alone, { duration: state.view.seconds, seed: state.view.seed })}
      <button type="button" onClick=${page}>Report of these designs (HTML)</button>
      <button type="button" onClick=${whole}>Report: run the study</button>
    <//>
    <${ExportMenu} store=${store} api=${api} />
    <${Share} store=${store} />`}
  </div>`;
}

/** Begins the run of the whole study, a job. @param {Store} store @param {Api} api */
async function runStudy(store, api) {
  const { study } = store.get().history.present;
  await begin(store, api, { kind: "run", study });
  store.look({ tab: "work" });
}

/** Saves the report of the design that is edited and of the baseline, once its job has ended.
 * @param {Store} store @param {Api} api @param {Document} document @param {string} called */
async function saveReport(store, api, document, called) {
  const { study } = document;
  store.say("The report is being made: see Jobs.", "report");
  const job = await ended(store, await begin(store, api, { kind: "report", study,
    designs: shownDesigns(document) }));
  store.dispatch({ type: "closed", about: "report" });
  if (!job?.result) throw new Error(job?.sentence || "The report was stopped.");
  download(await api.blob(`work/${job.id}/files/${job.result.file}`), called);
}

/** @param {{store: Store, api: Api}} props */
function Open({ store, api }) {
  const [examples, setExamples] = useState(/** @type {{name: string, title: string, study: any}[]} */ ([]));
  const look = async () => {
    if (examples.length === 0) setExamples((await api.get("examples").catch(() => ({ examples: [] }))).examples);
  };
  /** Closes the menu in which something happened. @param {Event} event */
  const close = ({ currentTarget }) =>
    /** @type {HTMLElement} */ (currentTarget).closest("details")?.removeAttribute("open");
  /** @param {Event} event */
  const openFiles = (event) => {
    const input = /** @type {HTMLInputElement} */ (event.currentTarget);
    void open(store, api, [...(input.files ?? [])]);
    input.value = "";
    close(event);
  };
  /** @param {Event} event @param {any} study */
  const openExample = (event, study) => {
    close(event);
    void openStudy(store, api, study);
  };
  /** @param {Event} event */
  const leave = (event) => {
    noteOpened(store.get().history.present);
    openExample(event, {});
  };
  return html`<${DropDown} title="Open" id="open-menu" onOpen=${look}>
    <label class="file">A study file or record… <input type="file" multiple onChange=${openFiles} /></label>
    ${!isBlank(store.get().history.present) && html`<button type="button" onClick=${leave}>The first screen</button>`}
    ${examples.length > 0 && html`<b class="legend">Examples</b>`}
    ${examples.map(({ name, title, study }) => html`<button type="button" key=${name}
      onClick=${(/** @type {Event} */ event) => openExample(event, study)}>${title}</button>`)}
  <//>`;
}

/** @param {{store: Store}} props */
function Share({ store }) {
  const [link, setLink] = useState("");
  const make = async () => {
    const { history, view } = store.get();
    const made = await linkTo(history.present, view);
    setLink(made);
    await navigator.clipboard?.writeText(made).then(
      () => store.say("The link is on the clipboard. It holds the whole state, and no token."), () => {});
  };
  /** @param {FocusEvent} event */
  const select = ({ currentTarget }) => /** @type {HTMLInputElement} */ (currentTarget).select();
  return html`<${DropDown} title="Share" onOpen=${make}>
    <label>A link that holds the whole state (and no token)
      ${" "}<input id="shared-link" readonly value=${link} onFocus=${select} /></label>
  <//>`;
}
