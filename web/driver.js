// What tests/web and web/bench.py ask of Node and of a page: runs in the form of JSON, answers with every bit.

/** @param {Uint8Array} bytes */
function base64(bytes) {
  let text = "";
  for (let i = 0; i < bytes.length; i += 0x8000) {
    text += String.fromCharCode(...bytes.subarray(i, i + 0x8000));
  }
  return btoa(text);
}

/** @param {string} text */
export function from_base64(text) {
  return Uint8Array.from(atob(text), (letter) => letter.charCodeAt(0));
}

/** @param {ArrayBufferView} values */
const bits = (values) => base64(new Uint8Array(values.buffer, values.byteOffset, values.byteLength));

/** @param {Record<string, ArrayBufferView>} named */
const all_bits = (named) => Object.fromEntries(Object.entries(named).map(([name, values]) => [name, bits(values)]));

/** @param {Record<string, number>} named */
const numbers = (named) => all_bits(Object.fromEntries(Object.entries(named).map(([n, v]) => [n, Float64Array.of(v)])));

/** @param {any} sent a spec whose tables are base64 */
function spec_of(sent) {
  const table = (/** @type {string} */ text) => new Float64Array(from_base64(text).buffer);
  return { ...sent, plan: sent.plan && table(sent.plan), push: sent.push && table(sent.push) };
}

/** @param {any} run */
const told = (run) => {
  return { ...run, metrics: numbers(run.metrics), truths: numbers(run.truths), traces: all_bits(run.traces) };
};

/**
 * @param {any} batch giveway_batch.js
 * @param {Uint8Array<ArrayBuffer>} bytes giveway_batch.wasm
 * @param {string} code of giveway_batch.js
 * @param {any[]} specs
 */
export async function compute(batch, bytes, code, specs) {
  const module = await WebAssembly.compile(bytes);
  const workers = await batch.Workers.start(module, code);
  const failed = (/** @type {any} */ e) => ({ ...e, name: e.name, message: e.message });
  const runs = await Promise.all(specs.map((sent) => workers.run(spec_of(sent)).then(told, failed)));
  const count = workers.count;
  const [plain, signal] = [{ step_s: 0.001, step_count: 10 }, AbortSignal.abort()];
  const all = Array.from({ length: 4 }, () => workers.run(plain));
  const taken_back = await workers.run(plain, signal).then(told, failed);
  await Promise.all(all);
  const running = workers.run({ ...plain, step_count: 1000000 }).then(told, failed);
  workers.end();
  const ended = await Promise.all([running, workers.run(plain).then(told, failed)]);
  const library = batch.Library.of(module);
  const again = specs.map((sent, i) => {
    const run = "name" in runs[i] ? null : library.run(spec_of(sent)); // an error has been compared
    if (run === null) {
      return null;
    }
    const { metrics, truths } = library.evaluate({
      ...sent,
      time_s: Float64Array.from({ length: sent.step_count + 1 }, (_, k) => k * sent.step_s),
      traces: run.traces,
    });
    return { ...told(run), evaluated: { metrics: numbers(metrics), truths: numbers(truths) } };
  });
  const { version, gravity, metrics } = library;
  // Infinity is no number of JSON.
  const variables = library.variables.map((/** @type {any} */ v) => ({ ...v, minimum: `${v.minimum}`, maximum: `${v.maximum}` }));
  const tokens = [library.token("controller"), library.token("testbed")];
  const tables = { version, gravity, tokens, windows: library.windows(), metrics };
  return { runs, again, workers: count, taken_back, ended, ...tables, variables };
}

/**
 * Milliseconds of each of `times` runs.
 * @param {any} batch
 * @param {Uint8Array<ArrayBuffer>} bytes
 * @param {any} spec
 * @param {number} times
 */
export async function time(batch, bytes, spec, times) {
  const library = batch.Library.of(await WebAssembly.compile(bytes));
  return Array.from({ length: times }, () => {
    const began = performance.now();
    library.run(spec_of(spec));
    return performance.now() - began;
  });
}

// In Node: {library, wasm, call, given} come on standard input, the answer goes to standard output.
if (typeof document === "undefined") {
  const files = "node:fs"; // types of Node are not needed for this
  const { readFileSync } = await import(files);
  const { library, wasm, call, given } = JSON.parse(readFileSync(0, "utf8"));
  const batch = await import(library);
  const bytes = new Uint8Array(readFileSync(wasm));
  const [first, times] = given;
  const answer = await (call === "time" ? time(batch, bytes, first, times) : compute(batch, bytes, library, first));
  const { process } = /** @type {any} */ (globalThis);
  process.stdout.write(JSON.stringify(answer));
}
