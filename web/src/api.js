// The JSON interface of the server: requests with the token, refusals as values that carry their sentence.

/** @typedef {{place: string[], sentence: string, fault?: string, got?: string, expected?: string, hint?: string}}
 * Problem */

export class Refusal extends Error {
  /** @param {number} status @param {{sentence?: string, problems?: Problem[], outdated?: boolean}} body */
  constructor(status, body) {
    const problems = body.problems ?? [];
    super(body.sentence || problems.map(({ sentence }) => sentence).join(" ") || `The server answered ${status}.`);
    this.status = status;
    this.problems = problems;
    this.outdated = body.outdated === true;
  }
}

/** What is thrown where no server answers. */
export class Lost extends Error {}

/** `waiting`: since when the oldest request has waited for its answer [ms since 1970], or null.
 * @typedef {{waiting: () => number | null, get: (path: string) => Promise<any>,
 * post: (path: string, body: unknown) => Promise<any>, remove: (path: string) => Promise<any>,
 * upload: (path: string, file: Blob) => Promise<any>, blob: (path: string, body?: unknown) => Promise<Blob>,
 * events: (path: string, told: (event: string, data: any) => void, signal?: AbortSignal) => Promise<void>}} Api */

/** This window, as the server tells it from others: what it asks outdates nothing that another one has asked. */
export const CLIENT = crypto.randomUUID?.() ?? String(Math.random());

let sequence = 0;

/** Asks as of now in the name of a part of the page: what was asked in that name before is outdated.
 * @param {Api} api @param {string} path @param {string} name @param {object} body */
export const postNow = (api, path, name, body) =>
  api.post(path, { ...body, client: `${CLIENT}.${name}`, sequence: (sequence += 1) });

/** @param {() => string} token @returns {Api} */
export function createApi(token) {
  /** @type {Map<object, number>} */
  const begun = new Map();
  /** @param {string} method @param {string} path @param {BodyInit} [body] @param {AbortSignal} [signal] */
  async function request(method, path, body, signal) {
    /** @type {Record<string, string>} */
    const headers = { Authorization: `Bearer ${token()}` };
    if (typeof body === "string") headers["Content-Type"] = "application/json";
    const me = {};
    begun.set(me, Date.now());
    let response;
    try {
      response = await fetch(`/api/${path}`, { method, headers, body, signal, cache: "no-store", credentials: "omit" });
    } catch (error) {
      if (signal?.aborted) throw error;
      throw new Lost("The server does not answer.");
    } finally {
      begun.delete(me);
    }
    if (!response.ok) throw new Refusal(response.status, await response.json().catch(() => ({})));
    return response;
  }
  /** @param {Response} response */
  const json = (response) => (response.status === 204 ? null : response.json().catch(() => null));
  return {
    waiting: () => (begun.size === 0 ? null : Math.min(...begun.values())),
    get: async (path) => json(await request("GET", path)),
    post: async (path, body) => json(await request("POST", path, JSON.stringify(body))),
    remove: async (path) => json(await request("DELETE", path)),
    upload: async (path, file) => json(await request("POST", path, file)),
    blob: async (path, body) =>
      (await (body === undefined ? request("GET", path) : request("POST", path, JSON.stringify(body)))).blob(),
    events: async (path, told, signal) => {
      const { body } = await request("GET", path, undefined, signal);
      if (body === null) return;
      try {
        await eachEvent(body, told);
      } catch (error) {
        if (!signal?.aborted) throw new Lost("The server went away.");
      }
    },
  };
}

/** @param {ReadableStream<Uint8Array>} body @param {(event: string, data: any) => void} told */
async function eachEvent(body, told) {
  const reader = body.pipeThrough(/** @type {any} */ (new TextDecoderStream())).getReader();
  let rest = "";
  for (;;) {
    const { value, done } = await reader.read();
    if (done) return;
    const blocks = (rest + String(value).replace(/\r\n/g, "\n")).split("\n\n");
    rest = blocks.pop() ?? "";
    for (const block of blocks) {
      const fields = { event: "message", data: "" };
      for (const line of block.split("\n")) {
        if (line.startsWith("event:")) fields.event = line.slice(6).trim();
        if (line.startsWith("data:")) fields.data += line.slice(5).trim();
      }
      if (fields.data !== "") told(fields.event, JSON.parse(fields.data));
    }
  }
}
