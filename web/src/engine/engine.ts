// The batch library in a page: from the module that the page has in itself, in workers beside it.
import worker_text from "giveway:worker";
import { Library, Workers } from "../../giveway_batch.js";
import { from_base64 } from "../parts/page";

export type Spec = import("../../giveway_batch.js").Spec;
export type Run = import("../../giveway_batch.js").Run;
export type Trace = import("../../giveway_batch.js").Trace;

/** The compiled module of the page, and workers that compute with it. */
export class Engine {
  private here: Library | undefined;

  constructor(
    private readonly module: WebAssembly.Module,
    private readonly workers: Workers,
  ) {}

  /** The library on the page's own thread: its tables, and what is quick. */
  get library(): Library {
    this.here ??= Library.of(this.module);
    return this.here;
  }

  /** Computes a run in the next free worker. */
  run(spec: Spec, signal?: AbortSignal): Promise<Run> {
    return this.workers.run(spec, signal);
  }
}

let started: Promise<Engine> | undefined;

/** The page's engine, started when it is first asked for. */
export function engine(): Promise<Engine> {
  started ??= start();
  return started;
}

async function start(): Promise<Engine> {
  const held = document.getElementById("engine")?.textContent;
  if (!held) {
    throw new Error("this page was written without the batch library");
  }
  const packed = new Blob([from_base64(held.trim())]).stream();
  const bytes = await new Response(packed.pipeThrough(new DecompressionStream("gzip"))).arrayBuffer();
  const module = await WebAssembly.compile(bytes);
  return new Engine(module, await Workers.start(module, worker_text));
}

/** One line of requests: the newest wins, what still waits is taken back. */
export class Latest {
  private busy = false;
  private waiting: (() => void) | undefined;
  private give_up: (() => void) | undefined;

  constructor(private readonly engine: Engine) {}

  /** The run; nothing if a newer request came before it was begun. */
  async run(spec: Spec): Promise<Run | undefined> {
    this.give_up?.();
    if (this.busy) {
      const mine = await new Promise<boolean>((go) => {
        this.waiting = () => go(true);
        this.give_up = () => go(false);
      });
      if (!mine) {
        return undefined;
      }
    }
    this.busy = true;
    try {
      return await this.engine.run(spec);
    } finally {
      this.busy = false;
      const next = this.waiting;
      this.waiting = this.give_up = undefined;
      next?.();
    }
  }
}
