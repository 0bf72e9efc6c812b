// The files of long work: reports, tables and figures, to download.

import { html, useState } from "../parts/html.js";
import { download } from "../remembering.js";
import { shown } from "../state/scale.js";

/** @param {{store: import("../state/store.js").Store, api: import("../api.js").Api,
 * job: import("../state/store.js").Job}} props */
export function Files({ store, api, job: { id } }) {
  const [files, setFiles] = useState(/** @type {{name: string, size: number}[] | null} */ (null));
  const tell = (/** @type {Error} */ { message }) => store.say(message);
  /** @param {string} name */
  const save = (name) => api.blob(`work/${id}/files/${name}`).then((file) =>
    download(file, name.split("/").at(-1) ?? name), tell);
  const list = () => api.get(`work/${id}/files`).then((found) => setFiles(found.files), tell);
  return files === null
    ? html`<button type="button" onClick=${list}>Files…</button>`
    : html`<ul class="files">${files.map(({ name, size }) => html`<li key=${name}>
      <button type="button" class="link" onClick=${() => save(name)}>${name}</button>
      ${" "}<span class="quiet">${shown(size / 1000, 3)} kB</span></li>`)}</ul>`;
}
