// The files of long work: reports, tables and figures, to download.

import { html, useState } from "../parts/html.js";
import { download } from "../remembering.js";
import { shown } from "../state/scale.js";

/** @param {{api: import("../api.js").Api, job: import("../state/store.js").Job}} props */
export function Files({ api, job }) {
  const [files, setFiles] = useState(/** @type {{name: string, size: number}[] | null} */ (null));
  /** @param {string} name */
  const save = async (name) => download(await api.blob(`work/${job.id}/files/${name}`), name.split("/").at(-1) ?? name);
  return files === null
    ? html`<button type="button"
      onClick=${async () => setFiles((await api.get(`work/${job.id}/files`)).files)}>Files…</button>`
    : html`<ul class="files">${files.map(({ name, size }) => html`<li key=${name}>
      <button type="button" class="link" onClick=${() => save(name)}>${name}</button>
      ${" "}<span class="quiet">${shown(size / 1000, 3)} kB</span></li>`)}</ul>`;
}
