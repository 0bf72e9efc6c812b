// Opening, undoing, sharing and downloading.

import { indicesOf } from "./answers.js";
import { bodyOf, comparedOf, designOf, shownDesigns } from "../questions.js";
import { html, useState } from "../parts/html.js";
import { download, linkTo, open } from "../remembering.js";
import { begin, openStudy } from "../working.js";

/** @import { Store } from "../state/store.js" */
/** @import { Api } from "../api.js" */

/** @param {{store: Store, api: Api}} props */
export function Menu({ store, api }) {
  const state = store.get();
  const [picked, setPicked] = useState("");
  const { history } = state;
  const { study } = history.present;
  const name = fileName(study.title);
  const blank = Object.keys(study).length === 0;
  /** @param {() => Promise<void>} work */
  const attempt = (work) => async () => {
    try {
      await work();
    } catch (error) {
      store.dispatch({ type: "said", text: /** @type {Error} */ (error).message });
    }
  };
  const theStudy = attempt(async () => download(new Blob([(await api.post("study/write", { study })).text], { type: "application/toml" }), `${name}.toml`));
  const theDesign = attempt(async () => download(new Blob([(await api.post("study/write", fixedDesign(store))).text], { type: "application/toml" }), `${name}-${fileName(history.present.layout)}.toml`));
  /** @param {string} panel */
  const csv = (panel) => attempt(async () => download(await api.blob("export/csv", { panel, request: bodyOf(store.get(), panel) }), panel === "indices" ? `${name}.csv` : `${name}-${panel}.csv`));
  const indices = indicesOf(state).map(({ symbol }) => symbol);
  const index = indices.includes(picked) ? picked : indices[0];
  /** @param {"svg" | "png"} format @param {string} kind @param {any[]} designs @param {object} more */
  const figure = (format, kind, designs, more = {}) => attempt(async () => download(await api.blob("figure", { kind, format, study, designs, ...more }), `${name}-${kind}.${format}`));
  /** @param {"svg" | "png"} format */
  const network = (format) => figure(format, "networks", [designOf(history.present)]);
  /** @param {"svg" | "png"} format */
  const response = (format) => figure(format, `response-${index}`, shownDesigns(history.present));
  /** @param {"svg" | "png"} format */
  const motion = (format) => figure(format, "history", [designOf(history.present)], { duration: state.view.seconds, seed: state.view.seed });
  const report = attempt(async () => {
    await begin(store, api, { kind: "run", title: `Report: ${study.title ?? "study"}`, study });
    store.dispatch({ type: "viewed", view: { tab: "work" } });
  });
  return html`<div class="row" role="group" aria-label="Memory">
    <button type="button" title="Undo (Ctrl+Z)" disabled=${history.past.length === 0} onClick=${() => store.dispatch({ type: "undone" })}>Undo</button>
    <button type="button" title="Redo (Ctrl+Shift+Z)" disabled=${history.future.length === 0} onClick=${() => store.dispatch({ type: "redone" })}>Redo</button>
    <${Open} store=${store} api=${api} />
    ${!blank && html`<details class="menu"><summary>Save</summary><div class="menu-body">
      <button type="button" onClick=${theStudy}>Study file (TOML)</button>
      <button type="button" onClick=${theDesign}>This design, values fixed (TOML)</button>
      <button type="button" onClick=${csv("indices")}>Indices (CSV)</button>
      <button type="button" onClick=${csv("response")}>Frequency response (CSV)</button>
      ${comparedOf(state).length > 1 && html`<button type="button" onClick=${csv("compare")}>Comparison (CSV)</button>`}
      <button type="button" onClick=${csv("history")}>On the road (CSV)</button>
      <button type="button" onClick=${network("svg")}>Network (SVG)</button>
      <button type="button" onClick=${network("png")}>Network (PNG)</button>
      ${index && html`<label>Response of <select value=${index} onChange=${(/** @type {Event} */ event) => setPicked(/** @type {HTMLSelectElement} */ (event.currentTarget).value)}>${indices.map((each) => html`<option key=${each}>${each}</option>`)}</select></label>
        <button type="button" onClick=${response("svg")}>Response (SVG)</button>
        <button type="button" onClick=${response("png")}>Response (PNG)</button>`}
      <button type="button" onClick=${motion("svg")}>On the road (SVG)</button>
      <button type="button" onClick=${motion("png")}>On the road (PNG)</button>
      <button type="button" onClick=${report}>Report: run the study</button>
    </div></details>
    <${Share} store=${store} />`}
  </div>`;
}

/** What is asked for the study of the present layout alone, fixed at the values of the page. @param {Store} store */
function fixedDesign(store) {
  const document = store.get().history.present;
  return { study: document.study, designs: [designOf(document)] };
}

/** @param {string | undefined} title */
const fileName = (title) => (title ?? "study").toLowerCase().replace(/[^a-z0-9]+/g, "-").replace(/^-+|-+$/g, "").slice(0, 60) || "study";

/** @param {{store: Store, api: Api}} props */
function Open({ store, api }) {
  const [examples, setExamples] = useState(/** @type {{name: string, title: string}[]} */ ([]));
  const close = (/** @type {Event} */ event) => /** @type {HTMLElement} */ (event.currentTarget).closest("details")?.removeAttribute("open");
  return html`<details class="menu" onToggle=${async (/** @type {Event} */ event) => {
    if (/** @type {HTMLDetailsElement} */ (event.currentTarget).open && examples.length === 0) setExamples((await api.get("examples").catch(() => ({ examples: [] }))).examples);
  }}><summary>Open</summary><div class="menu-body">
    <label class="file">A study file or record… <input type="file" multiple onChange=${(/** @type {Event} */ event) => {
      const input = /** @type {HTMLInputElement} */ (event.currentTarget);
      void open(store, api, [...(input.files ?? [])]);
      input.value = "";
      close(event);
    }} /></label>
    ${examples.map(({ name, title }) => html`<button type="button" key=${name} onClick=${async (/** @type {Event} */ event) => {
      close(event);
      const { study } = await api.get(`examples/${encodeURIComponent(name)}`);
      await openStudy(store, api, study);
    }}>${title || name}</button>`)}
  </div></details>`;
}

/** @param {{store: Store}} props */
function Share({ store }) {
  const [link, setLink] = useState("");
  const make = async () => {
    const { history, view } = store.get();
    const made = await linkTo(history.present, view);
    setLink(made);
    await navigator.clipboard?.writeText(made).then(() => store.dispatch({ type: "said", text: "The link is on the clipboard. It holds the whole state, and no token." }), () => {});
  };
  return html`<details class="menu" onToggle=${(/** @type {Event} */ event) => /** @type {HTMLDetailsElement} */ (event.currentTarget).open && make()}><summary>Link</summary><div class="menu-body">
    <label>A link that holds the whole state (and no token) <input id="shared-link" readonly value=${link} onFocus=${(/** @type {Event} */ event) => /** @type {HTMLInputElement} */ (event.currentTarget).select()} /></label>
  </div></details>`;
}
