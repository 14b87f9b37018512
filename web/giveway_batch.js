// giveway_batch.wasm for JavaScript: the functions of giveway_batch.h, in a page, a worker or Node.
//
//     const module = await WebAssembly.compile(bytes); // of giveway_batch.wasm
//     const library = Library.of(module); // on this thread
//     const run = library.run({ step_s: 0.001, step_count: 600, settings: { "testbed.slider.mass": 13.62 } });
//     run.metrics["peak force of the run"];
//
//     const workers = await Workers.start(module, url_of_this_file); // the same, beside this thread
//     const run = await workers.run(spec);
//
// Units are SI; names of variables are "testbed.slider.mass". What cannot be used is refused with an error that has the
// library's text. This file imports nothing, so that a page can hold it as it is.

/** @typedef {"real" | "integer" | "boolean"} Type */
/** @typedef {"parameter" | "input" | "output"} Causality */
/** @typedef {"event-exact" | "fixed-step"} Method */
/** @typedef {Float64Array | Int32Array | Uint8Array} Trace real, integer, boolean */

/**
 * @typedef {object} Variable
 * @property {string} name with its model: "testbed.slider.mass"
 * @property {number} model
 * @property {number} reference the FMUs' value reference
 * @property {Type} type
 * @property {Causality} causality
 * @property {number} minimum inclusive; infinite if there is none
 * @property {number} maximum
 */

/**
 * @typedef {object} Metric
 * @property {string} name
 * @property {string} unit
 * @property {boolean} has_truth
 * @property {number | null} decimals worth printing; null: judged by its exponent
 * @property {number} shown sum of GWB_OF_... of giveway_batch.h
 * @property {number} line order in which tables show them
 * @property {string} description
 */

/**
 * One run, as gwb_spec_t has it.
 * @typedef {object} Spec
 * @property {number} step_s
 * @property {number} step_count
 * @property {Readonly<Record<string, number | boolean>>} [settings] parameters by name; others keep their start values
 * @property {Float64Array} [plan] rows of x, y, theta, vx, vy, omega, ax, ay, alpha; none: rest at 0
 * @property {Float64Array} [push] rows of force x, y, point x, y; none, or at least step_count + 1 rows
 * @property {readonly string[]} [traces] inputs and outputs to record
 * @property {number} [transient_limit_n] limits of the body region that is hit
 * @property {number} [lasting_limit_n]
 * @property {Method} [method]
 * @property {number} [plant_step_s] of "fixed-step"; 0: as the design needs
 */

/**
 * @typedef {object} Run
 * @property {Method} method that it was computed with: not always the one that was asked for
 * @property {number} time_s how far it came
 * @property {number} plant_step_s of "fixed-step", else 0
 * @property {Record<string, number>} metrics by name; NaN for events that did not happen
 * @property {Record<string, number>} truths of the metrics that have one
 * @property {Record<string, Trace>} traces by name; row k is at time k step_s
 */

/**
 * What gwb_run_up is asked; its variables are the testbed's.
 * @typedef {object} RunUp
 * @property {number} end_speed_mps
 * @property {number} [duration_s] without the rope
 * @property {number} slider_mass
 * @property {number} slider_friction
 * @property {number} slider_friction_speed
 * @property {number} slider_damping
 * @property {number} rope_hanging_mass
 * @property {number} rope_stiffness
 * @property {number} rope_damping
 * @property {number} rope_drop_height
 * @property {boolean} rope_attached
 */

const MODELS = /** @type {const} */ (["controller", "testbed"]);
const TYPES = /** @type {const} */ (["real", "integer", "boolean"]);
const CAUSALITIES = /** @type {const} */ (["parameter", "input", "output"]);
const METHODS = /** @type {const} */ (["event-exact", "fixed-step"]);
const OK = 0;
const WRONG_SPEC = 2;
const NONE = 0xffffffff;
const PLAN_COLUMNS = 9;
const PUSH_COLUMNS = 4;
const MESSAGE_SIZE = 512;

/** An input that cannot be used. */
export class GivewayError extends Error {
  /**
   * @param {string} field what is wrong
   * @param {unknown} value the value found
   * @param {string} allowed the accepted values, in words
   * @param {string} [text] where the library has said it
   */
  constructor(field, value, allowed, text) {
    super(text ?? `${field} = ${value} is not allowed: ${allowed}`);
    this.name = "GivewayError";
    this.field = field;
    this.value = value;
    this.allowed = allowed;
  }
}

/** A model refused its parameters or failed in a step. */
export class SimulationError extends Error {
  /**
   * @param {string} text the library's
   * @param {number} time_s how far the run came
   */
  constructor(text, time_s) {
    super(text);
    this.name = "SimulationError";
    this.time_s = time_s;
  }
}

/**
 * What the module wants of a system. It is given a clock; whatever else it would do is an error, also in a page that
 * has a console: the library prints nothing and opens nothing.
 * @param {WebAssembly.Module} module
 * @param {() => WebAssembly.Memory} memory
 * @returns {WebAssembly.Imports}
 */
function system(module, memory) {
  /** @type {Record<string, Record<string, (...given: never[]) => number>>} */
  const imports = {};
  for (const { module: from, name } of WebAssembly.Module.imports(module)) {
    imports[from] ??= {};
    imports[from][name] = () => {
      throw new Error(`giveway_batch.wasm called ${name}, which it has no use for`);
    };
  }
  const wasi = imports.wasi_snapshot_preview1;
  if (wasi?.clock_time_get) {
    /** @param {number} _clock @param {bigint} _precision @param {number} at */
    const clock = (_clock, _precision, at) => {
      new DataView(memory().buffer).setBigUint64(at, BigInt(Math.round(performance.now() * 1e6)), true);
      return 0;
    };
    wasi.clock_time_get = clock;
  }
  return imports;
}

/** The library on this thread. It computes one run at a time, and keeps nothing of it. */
export class Library {
  /** @param {WebAssembly.Module} module giveway_batch.wasm */
  static of(module) {
    return new Library(module);
  }

  /** @param {WebAssembly.Module} module */
  constructor(module) {
    /** @type {any} functions of numbers, and the memory */
    this._wasm = {};
    this._wasm = new WebAssembly.Instance(module, system(module, () => this._wasm.memory)).exports;
    this._wasm._initialize();
    /** @type {number[]} memory that the present call has asked for */
    this._asked = [];
    /** The version of giveway. @type {string} */
    this.version = this._text(this._wasm.gwb_version());
    /** The plant's gravity, m/s2. @type {number} */
    this.gravity = this._wasm.gwb_gravity();
    /** Every variable, by model and then by reference. @type {readonly Variable[]} */
    this.variables = this._variables();
    this._by_name = new Map(this.variables.map((variable) => [variable.name, variable]));
    /** Every metric, by number. @type {readonly Metric[]} */
    this.metrics = this._metrics();
  }

  /**
   * Hash of a model's variable table, the FMUs' instantiation token.
   * @param {"controller" | "testbed"} model
   */
  token(model) {
    return this._text(this._wasm.gwb_token(MODELS.indexOf(model)));
  }

  /**
   * @param {string} name
   * @returns {Variable}
   */
  variable(name) {
    const found = this._by_name.get(name);
    if (!found) {
      throw new GivewayError("variable", name, "a variable of the controller or the testbed");
    }
    return found;
  }

  /** Windows of the metrics' definitions. */
  windows() {
    return this._call(() => {
      const at = this._memory(32);
      this._wasm.gwb_windows(at);
      const [cause_s = NaN, transient_s = NaN, contact_gap_s = NaN, peak_torque_s = NaN] = this._reals(at, 4);
      return { cause_s, transient_s, contact_gap_s, peak_torque_s };
    });
  }

  /**
   * Computes a run on this thread.
   * @param {Spec} spec
   * @returns {Run}
   */
  run(spec) {
    return this._call(() => {
      const method = METHODS.indexOf(spec.method ?? "event-exact");
      if (method < 0) {
        throw new GivewayError("method", spec.method, METHODS.join(" or "));
      }
      whole("step_count", spec.step_count);
      const settings = this._settings(spec.settings ?? {});
      const plan = this._table("plan", spec.plan, PLAN_COLUMNS);
      const push = this._table("push", spec.push, PUSH_COLUMNS);
      const columns = this._columns(spec.traces ?? [], (spec.traces ?? []).map(() => null), spec.step_count + 1);
      const at = this._memory(64);
      const view = this._view();
      view.setFloat64(at, spec.step_s, true);
      const numbers = [spec.step_count, settings.count, settings.at, plan.at, push.at, plan.rows, push.rows];
      [...numbers, columns.at, columns.all.length, 0].forEach((n, i) => view.setUint32(at + 8 + 4 * i, n, true));
      view.setFloat64(at + 48, spec.transient_limit_n ?? 0, true);
      view.setFloat64(at + 56, spec.lasting_limit_n ?? 0, true);
      const result = this._memory(this._result_size());
      if (method === 0) {
        if (spec.plant_step_s !== undefined) {
          throw new GivewayError("plant_step_s", spec.plant_step_s, "none with the method event-exact");
        }
        this._wasm.gwb_run(at, result);
      } else {
        this._start(at, result, method, spec.plant_step_s ?? 0);
      }
      return this._answer(result, columns);
    });
  }

  /**
   * The metrics of recorded traces: bit for bit those of the run that recorded them.
   * @param {object} recorded
   * @param {Float64Array} recorded.time_s
   * @param {Readonly<Record<string, Trace>>} recorded.traces
   * @param {Readonly<Record<string, number | boolean>>} [recorded.settings]
   * @param {number} [recorded.transient_limit_n]
   * @param {number} [recorded.lasting_limit_n]
   * @returns {{metrics: Record<string, number>, truths: Record<string, number>}}
   */
  evaluate(recorded) {
    return this._call(() => {
      const rows = recorded.time_s.length;
      const names = Object.keys(recorded.traces);
      const settings = this._settings(recorded.settings ?? {});
      const columns = this._columns(names, Object.values(recorded.traces), rows);
      const time = this._table("time_s", recorded.time_s, 1);
      const at = this._memory(48);
      const view = this._view();
      const numbers = [time.at, columns.at, settings.at, rows, names.length, settings.count, 0];
      numbers.forEach((number, i) => view.setUint32(at + 4 * i, number, true));
      view.setFloat64(at + 32, recorded.transient_limit_n ?? 0, true);
      view.setFloat64(at + 40, recorded.lasting_limit_n ?? 0, true);
      const result = this._memory(this._result_size());
      this._wasm.gwb_evaluate(at, result);
      const { metrics, truths } = this._answer(result, { at: 0, all: [] });
      return { metrics, truths };
    });
  }

  /**
   * Judges a contact force over time; a touch is a force above touch_n.
   * @param {Float64Array} time_s
   * @param {Float64Array} force_n
   * @param {number} touch_n
   */
  judge_force(time_s, force_n, touch_n) {
    return this._call(() => {
      if (time_s.length !== force_n.length) {
        throw new GivewayError("force_n", `${force_n.length} rows`, `as many as time_s has: ${time_s.length}`);
      }
      const [time, force] = [this._table("time_s", time_s, 1), this._table("force_n", force_n, 1)];
      const at = this._memory(48);
      if (!this._wasm.gwb_judge_force(time.at, force.at, time.rows, touch_n, at)) {
        throw new GivewayError("time_s or force_n", "such rows", "finite, times ascending, forces not negative");
      }
      const found = this._reals(at, 5);
      const [transient_n = NaN, transient_time_s = NaN, lasting_n = NaN, lasting_time_s = NaN] = found;
      const longest_contact_s = found[4] ?? NaN;
      const lasting_known = this._view().getUint32(at + 40, true) !== 0;
      return { transient_n, transient_time_s, lasting_n, lasting_time_s, longest_contact_s, lasting_known };
    });
  }

  /**
   * Where a slider starts that is to have a speed when it meets the robot.
   * @param {RunUp} asked
   * @param {Float64Array} [times_s] ascending: the travel then
   */
  run_up(asked, times_s = new Float64Array(0)) {
    return this._call(() => {
      const at = this._memory(128);
      const reals = [
        asked.end_speed_mps, asked.duration_s ?? 0, asked.slider_mass, asked.slider_friction,
        asked.slider_friction_speed, asked.slider_damping, asked.rope_hanging_mass, asked.rope_stiffness,
        asked.rope_damping, asked.rope_drop_height,
      ];
      const times = this._table("times_s", times_s, 1);
      const travels = this._memory(times_s.byteLength);
      new Float64Array(this._wasm.memory.buffer, at, reals.length).set(reals);
      const view = this._view();
      view.setUint32(at + 80, Number(asked.rope_attached), true);
      [times.rows, times.at, travels].forEach((number, i) => view.setUint32(at + 112 + 4 * i, number, true));
      const good = this._wasm.gwb_run_up(at, 1) === 1;
      const [duration_s = NaN] = this._reals(at + 8, 1);
      const [start_speed_mps = NaN, travel_m = NaN, reached_mps = NaN] = this._reals(at + 88, 3);
      if (!good) {
        const status = this._view().getUint32(at + 84, true);
        if (status === WRONG_SPEC) {
          throw new GivewayError("run_up", JSON.stringify(asked), "what gwb_run_up_t of giveway_batch.h says");
        }
        throw new SimulationError(`the slider reaches only ${reached_mps} m/s (status ${status})`, duration_s);
      }
      return { duration_s, start_speed_mps, travel_m, travels_m: this._reals(travels, times_s.length) };
    });
  }

  /**
   * Frees what `work` has asked for.
   * @template Found
   * @param {() => Found} work
   * @returns {Found}
   */
  _call(work) {
    try {
      return work();
    } finally {
      for (const at of this._asked.splice(0)) {
        this._wasm.free(at);
      }
    }
  }

  /** @param {number} size in bytes @returns {number} zeros */
  _memory(size) {
    const at = this._wasm.malloc(Math.max(size, 8));
    if (at === 0) {
      throw new SimulationError(`no memory for ${size} bytes`, 0);
    }
    this._asked.push(at);
    new Uint8Array(this._wasm.memory.buffer, at, size).fill(0);
    return at;
  }

  /** Of the memory as it is now: it moves when it grows. */
  _view() {
    return new DataView(this._wasm.memory.buffer);
  }

  /** @param {number} at @param {number} count @returns {Float64Array} a copy */
  _reals(at, count) {
    return new Float64Array(this._wasm.memory.buffer, at, count).slice();
  }

  /** @param {number} at @returns {string} up to its zero */
  _text(at) {
    const bytes = new Uint8Array(this._wasm.memory.buffer);
    return new TextDecoder().decode(bytes.subarray(at, bytes.indexOf(0, at)));
  }

  /** @returns {Variable[]} */
  _variables() {
    return this._call(() => {
      const at = this._memory(40);
      return MODELS.flatMap((of, model) =>
        Array.from({ length: this._wasm.gwb_variable_count(model) }, (_, index) => index).flatMap((index) => {
          this._wasm.gwb_variable_at(model, index, at);
          const view = this._view();
          const causality = CAUSALITIES[view.getUint32(at + 12, true)];
          const type = TYPES[view.getUint32(at + 8, true)];
          if (!causality || !type) {
            return []; // a state of the model
          }
          return {
            name: `${of}.${this._text(view.getUint32(at + 32, true))}`,
            model,
            reference: view.getUint32(at + 4, true),
            type,
            causality,
            minimum: view.getFloat64(at + 16, true),
            maximum: view.getFloat64(at + 24, true),
          };
        }),
      );
    });
  }

  /** @returns {Metric[]} */
  _metrics() {
    return this._call(() => {
      const at = this._memory(28);
      return Array.from({ length: this._wasm.gwb_metric_count() }, (_, number) => {
        this._wasm.gwb_metric_info(number, at);
        const view = this._view();
        const decimals = view.getInt32(at + 12, true);
        return {
          name: this._text(view.getUint32(at, true)),
          unit: this._text(view.getUint32(at + 4, true)),
          has_truth: view.getUint32(at + 8, true) !== 0,
          decimals: decimals < 0 ? null : decimals,
          shown: view.getUint32(at + 16, true),
          line: view.getUint32(at + 20, true),
          description: this._text(view.getUint32(at + 24, true)),
        };
      });
    });
  }

  /** @param {Readonly<Record<string, number | boolean>>} settings */
  _settings(settings) {
    const all = Object.entries(settings);
    const at = this._memory(16 * all.length);
    const view = this._view();
    all.forEach(([name, value], i) => {
      const { model, reference } = this.variable(name);
      view.setUint32(at + 16 * i, model, true);
      view.setUint32(at + 16 * i + 4, reference, true);
      view.setFloat64(at + 16 * i + 8, Number(value), true);
    });
    return { at, count: all.length };
  }

  /** @param {string} field @param {Float64Array | undefined} values @param {number} width of a row */
  _table(field, values, width) {
    if (!values || values.length === 0) {
      return { at: 0, rows: 0 };
    }
    if (values.length % width !== 0) {
      throw new GivewayError(field, `${values.length} numbers`, `rows of ${width}`);
    }
    const at = this._memory(values.byteLength);
    new Float64Array(this._wasm.memory.buffer, at, values.length).set(values);
    return { at, rows: values.length / width };
  }

  /**
   * @param {readonly string[]} names
   * @param {readonly (Trace | null)[]} values null: to be recorded
   * @param {number} rows
   */
  _columns(names, values, rows) {
    const all = names.map((name, i) => {
      const variable = this.variable(name);
      const kind = { real: Float64Array, integer: Int32Array, boolean: Uint8Array }[variable.type];
      const given = values[i];
      if (variable.causality === "parameter") {
        throw new GivewayError(name, "a parameter", "inputs and outputs as traces");
      }
      if (given && (!(given instanceof kind) || given.length !== rows)) {
        throw new GivewayError(name, `${given.length} values`, `a ${kind.name} of ${rows}`);
      }
      const at = this._memory(rows * kind.BYTES_PER_ELEMENT);
      if (given) {
        new kind(this._wasm.memory.buffer, at, rows).set(given);
      }
      return { variable, kind, at };
    });
    const at = this._memory(12 * all.length);
    const view = this._view();
    all.forEach((column, i) => {
      const { model, reference } = column.variable;
      [model, reference, column.at].forEach((number, k) => view.setUint32(at + 12 * i + 4 * k, number, true));
    });
    return { at, all };
  }

  _result_size() {
    return 64 + 16 * this.metrics.length + MESSAGE_SIZE;
  }

  /**
   * A batch of one run: gwb_start does it before it returns, as there are no threads.
   * @param {number} spec @param {number} result @param {number} method @param {number} plant_step_s
   */
  _start(spec, result, method, plant_step_s) {
    const [options, batch, message] = [this._memory(24), this._memory(4), this._memory(MESSAGE_SIZE)];
    const view = this._view();
    [1, method, 1].forEach((number, i) => view.setUint32(options + 4 * i, number, true));
    view.setFloat64(options + 16, plant_step_s, true);
    if (!this._wasm.gwb_start(spec, 1, options, result, batch, message)) {
      throw error_of(WRONG_SPEC, this._text(message), 0);
    }
    this._wasm.gwb_finish(this._view().getUint32(batch, true));
  }

  /**
   * @param {number} at gwb_result_t
   * @param {{at: number, all: {variable: Variable, kind: any, at: number}[]}} columns
   * @returns {Run}
   */
  _answer(at, columns) {
    const view = this._view();
    const [status = NONE, , , rows = 0, method = 0] = new Uint32Array(this._wasm.memory.buffer, at, 5);
    const [time_s = NaN, plant_step_s = NaN] = this._reals(at + 24, 2);
    const count = this.metrics.length;
    if (status !== OK) {
      throw error_of(status, this._text(at + 64 + 16 * count), time_s);
    }
    /** @type {Run} */
    const run = { method: METHODS[method] ?? "event-exact", time_s, plant_step_s, metrics: {}, truths: {}, traces: {} };
    this.metrics.forEach(({ name, has_truth }, i) => {
      run.metrics[name] = view.getFloat64(at + 64 + 8 * i, true);
      if (has_truth) {
        run.truths[name] = view.getFloat64(at + 64 + 8 * (count + i), true);
      }
    });
    for (const column of columns.all) {
      run.traces[column.variable.name] = new column.kind(this._wasm.memory.buffer, column.at, rows).slice();
    }
    return run;
  }
}

/** @param {string} field @param {number} value that the library takes as uint32_t */
function whole(field, value) {
  if (!Number.isInteger(value) || value < 0 || value >= NONE) {
    throw new GivewayError(field, value, "a whole number");
  }
}

/** @param {number} status @param {string} text the library's @param {number} time_s */
function error_of(status, text, time_s) {
  const said = /^(.*?) = (.*?) is not allowed: (.*)$/.exec(text);
  if (status !== WRONG_SPEC) {
    return new SimulationError(text, time_s);
  }
  return said ? new GivewayError(said[1] ?? "", said[2], said[3] ?? "", text) : new GivewayError("spec", text, "", text);
}

// Workers.

const LISTENING = -1; // the first thing that a worker says

/** @typedef {{id: number, run?: Run, error?: Record<string, unknown>}} Answer */

/**
 * In a worker: computes what it is sent.
 * @param {{postMessage: (answer: unknown, moved?: Transferable[]) => void}} port
 * @param {(heard: (data: any) => void) => void} listen
 */
export function serve(port, listen) {
  /** @type {Library | undefined} */
  let library;
  /** @type {WebAssembly.Module} */
  let compiled;
  listen(({ id, module, spec }) => {
    try {
      if (module) {
        compiled = module;
        library = Library.of(compiled);
        port.postMessage({ id });
      } else {
        library ??= Library.of(compiled);
        const run = library.run(spec);
        const moved = Object.values(run.traces).map((trace) => /** @type {ArrayBuffer} */ (trace.buffer));
        port.postMessage({ id, run }, moved);
      }
    } catch (error) {
      const thrown = /** @type {Error} */ (error);
      if (!(thrown instanceof GivewayError || thrown instanceof SimulationError)) {
        library = undefined; // its memory may be in any state: the next run has a new one
      }
      port.postMessage({ id, error: { ...thrown, name: thrown.name, message: thrown.message } });
    }
  });
  port.postMessage({ id: LISTENING });
}

/** @typedef {{post: (data: unknown) => void, end: () => unknown}} Started */

/**
 * A page that was opened from a file may start scripts that it has in itself, but no modules: so a worker is a script.
 * @param {string} code this file: its URL, or its text
 * @param {(answer: Answer) => void} heard
 * @param {(error: Error) => void} failed
 * @returns {Promise<Started>}
 */
async function start_worker(code, heard, failed) {
  const here = typeof Worker === "undefined" ? SERVE_IN_NODE : SERVE_IN_PAGE;
  const is_url = /^[a-z]+:\S*$/.test(code);
  const imported = `import(${JSON.stringify(code)}).then(({ serve }) => {${here}});`;
  const source = is_url ? imported : code.replace(/^export /gm, "") + here;
  if (typeof Worker === "undefined") {
    const node = "node:worker_threads"; // not for a bundler to find
    const { Worker: NodeWorker } = await import(node);
    const worker = new NodeWorker(source, { eval: true });
    worker.on("message", heard);
    worker.on("error", failed);
    return { post: (data) => worker.postMessage(data), end: () => worker.terminate() };
  }
  const url = URL.createObjectURL(new Blob([source], { type: "text/javascript" }));
  const worker = new Worker(url);
  worker.onmessage = ({ data }) => heard(data);
  worker.onerror = (event) => failed(new Error(event.message || "the worker could not be started"));
  return {
    post: (data) => worker.postMessage(data),
    end: () => {
      worker.terminate();
      URL.revokeObjectURL(url);
    },
  };
}

const SERVE_IN_NODE = `
const { parentPort } = require("node:worker_threads");
serve(parentPort, (heard) => parentPort.on("message", heard));`;
const SERVE_IN_PAGE = `
serve(self, (heard) => self.addEventListener("message", ({ data }) => heard(data)));`;

/** The library beside this thread: each worker computes one run at a time, the others wait. */
export class Workers {
  /**
   * @param {WebAssembly.Module} module giveway_batch.wasm
   * @param {string} code this file: its URL (import.meta.url), or its text, for a page that has it in itself
   * @param {number} [count] none: two where there are cores for them
   */
  static async start(module, code, count) {
    const cores = globalThis.navigator?.hardwareConcurrency ?? 2;
    const workers = new Workers();
    await Promise.all(Array.from({ length: count ?? Math.min(2, cores) }, () => workers._add(code, module)));
    return workers;
  }

  constructor() {
    /** @type {Started[]} */
    this._all = [];
    /** @type {Started[]} */
    this._idle = [];
    /** @type {{data: object, done: (run: any) => void, failed: (error: Error) => void, signal?: AbortSignal}[]} */
    this._waiting = [];
    /** @type {Map<number, {worker: Started, done: (run: any) => void, failed: (error: Error) => void}>} */
    this._asked = new Map();
    this._next = 0;
    /** @type {Error | undefined} why nothing is computed any more */
    this._ended = undefined;
  }

  /** How many there are. */
  get count() {
    return this._all.length;
  }

  /**
   * Computes a run in the next free worker. If `signal` is aborted before it has begun, it is not computed.
   * @param {Spec} spec
   * @param {AbortSignal} [signal]
   * @returns {Promise<Run>}
   */
  run(spec, signal) {
    return new Promise((done, failed) => {
      if (this._ended) {
        throw this._ended;
      }
      this._waiting.push({ data: { spec }, done, failed, signal });
      this._go_on();
    });
  }

  /** Ends the workers, whatever they do. */
  end() {
    const ended = new Error("the workers were ended");
    this._fail(ended);
    this._all.forEach((worker) => worker.end());
    this._all = this._idle = [];
  }

  /** @param {string} code @param {WebAssembly.Module} module */
  async _add(code, module) {
    /** @type {Started} */
    let worker;
    await new Promise((listens, failed) => {
      const heard = (/** @type {Answer} */ answer) => (answer.id === LISTENING ? listens(null) : this._heard(answer));
      const broken = (/** @type {Error} */ error) => (failed(error), this._fail(error));
      start_worker(code, heard, broken).then((started) => this._all.push((worker = started)), failed);
    });
    await new Promise((done, failed) => this._ask(worker, { module }, done, failed));
  }

  /**
   * @param {Started} worker
   * @param {object} data
   * @param {(run: any) => void} done
   * @param {(error: Error) => void} failed
   */
  _ask(worker, data, done, failed) {
    const id = this._next++;
    this._asked.set(id, { worker, done, failed });
    worker.post({ id, ...data });
  }

  _go_on() {
    while (this._idle.length > 0 && this._waiting.length > 0) {
      const { data, done, failed, signal } = /** @type {(typeof this._waiting)[0]} */ (this._waiting.shift());
      if (signal?.aborted) {
        failed(signal.reason);
      } else {
        this._ask(/** @type {Started} */ (this._idle.shift()), data, done, failed);
      }
    }
  }

  /** @param {Answer} answer */
  _heard({ id, run, error }) {
    const asked = this._asked.get(id);
    if (asked) {
      this._asked.delete(id);
      this._idle.push(asked.worker);
      error ? asked.failed(error_from(error)) : asked.done(run);
      this._go_on();
    }
  }

  /** @param {Error} error that ended a worker: there is no use in the others */
  _fail(error) {
    this._ended ??= error;
    for (const { failed } of [...this._asked.values(), ...this._waiting]) {
      failed(error);
    }
    this._asked.clear();
    this._waiting = [];
  }
}

/** @param {Record<string, any>} sent @returns {Error} the worker's, on this side */
function error_from({ name, message, field, value, allowed, time_s }) {
  if (name === "GivewayError") {
    return new GivewayError(field, value, allowed, message);
  }
  return name === "SimulationError" ? new SimulationError(message, time_s) : new Error(message);
}
