// The collision from above, one or two beside each other: robot, slider, forces, the estimate against the truth.
import { element, each_frame, on_scheme, theme } from "./page";
import type { Point, RobotShape } from "./shapes";

export interface Motion {
  title: string;
  time_s: ArrayLike<number>;
  /** By full name; those of SCENE_TRACES. */
  traces: Readonly<Record<string, ArrayLike<number>>>;
  robot: RobotShape;
  /** When something first touched, and when it was noticed after that, on the axis of `time_s`; NaN if not. */
  contact_s: number;
  detected_s: number;
}

const TRUTH = ["x", "y", "theta", "nose_x", "nose_y", "bumper_compression", "contact_force_x", "contact_force_y",
  "contact_point_x", "contact_point_y"] as const;
const FELT = ["estimate.force_x", "estimate.force_y", "estimate.point_x", "estimate.point_y", "estimate.valid",
  "detection.force_x", "detection.force_y", "detection.point_x", "detection.point_y"] as const;

/** What a motion needs. */
export const SCENE_TRACES: readonly string[] = [
  ...TRUTH.map((name) => `testbed.truth.${name}`), ...FELT.map((name) => `controller.${name}`),
];

const METRES_PER_NEWTON = 0.004;
const SMALLEST_FORCE = 2;
const LONGEST_ARROW = 0.45;
const SPEEDS = [1, 0.5, 0.2, 0.1, 0.05] as const;

type Turn = (vector: Point) => Point;

export class Scene {
  /** Hears the time that is shown, s. */
  on_time: ((time_s: number) => void) | undefined;
  /** Draws more, in world coordinates of each motion: m, y up. */
  on_draw: ((pen: CanvasRenderingContext2D, index: number, scale: number) => void) | undefined;
  readonly canvas: HTMLCanvasElement;
  private motions: Motion[] = [];
  private box = { left: -1, bottom: -1, right: 1, top: 1 };
  private size: [number, number] = [0, 0];
  private now = 0;
  private playing = false;
  private before = 0;
  private readonly play_button: HTMLButtonElement;
  private readonly seeker: HTMLInputElement;
  private readonly clock = element("output", { "aria-label": "time shown" });
  private readonly speed: HTMLSelectElement;
  private readonly redraw = each_frame(() => this.draw());

  constructor(where: HTMLElement, options: { label: string; height?: number }) {
    this.canvas = element("canvas", { tabindex: 0, role: "img", "aria-label": options.label });
    this.canvas.style.height = `${options.height ?? 400}px`;
    this.play_button = element("button", { type: "button", class: "main", click: () => (this.playing ? this.pause() : this.play()) }, "Play");
    this.seeker = element("input", { type: "range", min: 0, max: 1000, step: 1, value: 0, "aria-label": "time", input: () => this.scrub() });
    const speeds = SPEEDS.map((one) => element("option", { value: one, selected: one === 0.2 }, one === 1 ? "real time" : `1/${1 / one}`));
    this.speed = element("select", { "aria-label": "speed of playing" }, ...speeds);
    const bar = element("p", { class: "buttons" }, this.play_button, this.seeker, this.clock, this.speed);
    where.append(element("div", { class: "scene" }, this.canvas, bar));
    this.size = [this.canvas.clientWidth, this.canvas.clientHeight];
    this.canvas.addEventListener("keydown", (event) => this.key(event));
    new ResizeObserver(() => this.resize()).observe(this.canvas);
    on_scheme(() => this.draw());
  }

  /** Shows these motions at once, the time as it is. `keep`: the part of the floor that is in view, too. */
  set(motions: Motion[], keep = false): void {
    this.motions = motions;
    if (!keep) {
      this.box = steady(this.box, limits(motions));
    }
    this.now = Math.min(this.now, this.last);
    this.draw();
  }

  /** Shows a time, s. */
  seek(time_s: number): void {
    this.now = Math.min(Math.max(time_s, this.first), this.last);
    this.redraw();
    this.on_time?.(this.now);
  }

  get time_s(): number {
    return this.now;
  }

  play(): void {
    if (this.motions.length === 0 || this.playing) {
      return;
    }
    if (this.now >= this.last) {
      this.now = this.first;
    }
    this.playing = true;
    this.play_button.textContent = "Pause";
    this.before = performance.now();
    requestAnimationFrame((stamp) => this.frame(stamp));
  }

  pause(): void {
    this.playing = false;
    this.play_button.textContent = "Play";
  }

  /** Where a point of the page is on the floor of the first motion, m. */
  floor(client_x: number, client_y: number): Point {
    const bounds = this.canvas.getBoundingClientRect();
    const { scale, centre } = this.view();
    const { left, right, top, bottom } = this.box;
    return [
      (client_x - bounds.left - centre(0)[0]) / scale + (left + right) / 2,
      -(client_y - bounds.top - centre(0)[1]) / scale + (top + bottom) / 2,
    ];
  }

  private get first(): number {
    return this.motions[0]?.time_s[0] ?? 0;
  }

  private get last(): number {
    return Math.max(0, ...this.motions.map(({ time_s }) => time_s[time_s.length - 1] ?? 0));
  }

  private frame(stamp: number): void {
    if (!this.playing) {
      return;
    }
    this.now += (Math.max(0, stamp - this.before) / 1000) * Number(this.speed.value);
    this.before = stamp;
    if (this.now >= this.last) {
      this.now = this.last;
      this.pause();
    }
    this.draw();
    this.on_time?.(this.now);
    requestAnimationFrame((next) => this.frame(next));
  }

  private scrub(): void {
    this.pause();
    this.seek(this.first + (Number(this.seeker.value) / 1000) * (this.last - this.first));
  }

  private key(event: KeyboardEvent): void {
    const step = event.shiftKey ? 0.05 : 0.005;
    const done: Record<string, () => void> = {
      " ": () => (this.playing ? this.pause() : this.play()),
      ArrowLeft: () => (this.pause(), this.seek(this.now - step)),
      ArrowRight: () => (this.pause(), this.seek(this.now + step)),
      Home: () => this.seek(this.first),
      End: () => this.seek(this.last),
    };
    if (done[event.key]) {
      done[event.key]?.();
      event.preventDefault();
    }
  }

  private resize(): void {
    this.size = [this.canvas.clientWidth, this.canvas.clientHeight];
    this.draw();
  }

  private view() {
    const [width, height] = this.size;
    const [cell, top] = [width / Math.max(1, this.motions.length), 46];
    const { box } = this;
    const scale = Math.min((cell - 16) / (box.right - box.left), (height - top - 10) / (box.top - box.bottom));
    const centre = (index: number): Point => [(index + 0.5) * cell, top + (height - top - 10) / 2];
    return { width, height, cell, scale, centre };
  }

  private draw(): void {
    const ratio = devicePixelRatio || 1;
    const { width, height, cell, scale, centre } = this.view();
    if (width === 0) {
      return;
    }
    const [wide, high] = [Math.round(width * ratio), Math.round(height * ratio)];
    if (this.canvas.width !== wide || this.canvas.height !== high) {
      [this.canvas.width, this.canvas.height] = [wide, high];
    }
    const pen = this.canvas.getContext("2d") as CanvasRenderingContext2D;
    pen.setTransform(ratio, 0, 0, ratio, 0, 0);
    pen.clearRect(0, 0, width, height);
    this.motions.forEach((motion, index) => {
      pen.save();
      pen.beginPath();
      pen.rect(index * cell, 0, cell, height);
      pen.clip();
      pen.save();
      pen.translate(...centre(index));
      pen.scale(scale, -scale);
      pen.translate(-(this.box.left + this.box.right) / 2, -(this.box.bottom + this.box.top) / 2);
      new Picture(pen, motion, this.now, scale).draw(this.box);
      this.on_draw?.(pen, index, scale);
      pen.restore();
      this.words(pen, motion, index * cell + 12, cell - 20);
      pen.restore();
      if (index > 0) {
        pen.fillStyle = theme("line");
        pen.fillRect(index * cell, 0, 1, height);
      }
    });
    this.measure(pen, width, height, scale);
    this.clock.textContent = `${(1000 * this.now).toFixed(0)} ms`;
    this.seeker.value = String((1000 * (this.now - this.first)) / Math.max(1e-9, this.last - this.first));
    this.seeker.setAttribute("aria-valuetext", this.clock.textContent);
  }

  private words(pen: CanvasRenderingContext2D, motion: Motion, x: number, room: number): void {
    pen.fillStyle = theme("ink");
    pen.font = "600 14px system-ui, sans-serif";
    pen.fillText(motion.title, x, 20, room);
    pen.font = "13px system-ui, sans-serif";
    pen.fillStyle = theme("quiet");
    pen.fillText(what_happens(motion, this.now), x, 38, room);
  }

  private measure(pen: CanvasRenderingContext2D, width: number, height: number, scale: number): void {
    const length = 0.25 * scale;
    pen.strokeStyle = pen.fillStyle = theme("quiet");
    pen.lineWidth = 2;
    pen.beginPath();
    pen.moveTo(width - 14 - length, height - 12);
    pen.lineTo(width - 14, height - 12);
    pen.stroke();
    pen.font = "12px system-ui, sans-serif";
    pen.textAlign = "right";
    pen.fillText("0.25 m", width - 14, height - 18);
    pen.textAlign = "left";
  }
}

/** The first row at or after a time. */
function row_at(time_s: ArrayLike<number>, now: number): number {
  let [low, high] = [0, time_s.length - 1];
  while (low < high) {
    const middle = (low + high) >> 1;
    if ((time_s[middle] as number) < now - 1e-9) low = middle + 1;
    else high = middle;
  }
  return low;
}

const value_of = (motion: Motion, name: string, row: number): number => Number(motion.traces[name]?.[row] ?? 0);

function what_happens(motion: Motion, now: number): string {
  const { contact_s, detected_s } = motion;
  const row = row_at(motion.time_s, now);
  const force = Math.hypot(value_of(motion, "testbed.truth.contact_force_x", row), value_of(motion, "testbed.truth.contact_force_y", row));
  const newtons = force >= SMALLEST_FORCE ? `, ${force.toFixed(0)} N` : "";
  if (!(now >= contact_s)) {
    return Number.isNaN(contact_s) ? "nothing touches the robot" : "before the contact";
  }
  if (now >= detected_s) {
    return `noticed after ${(1000 * (detected_s - contact_s)).toFixed(1)} ms${newtons}`;
  }
  return `contact${newtons}${Number.isNaN(detected_s) ? ", not noticed" : ""}`;
}

interface Box {
  left: number;
  bottom: number;
  right: number;
  top: number;
}

/** The floor in view stays where it is as long as all is in it, and it is not much too large. */
function steady(old: Box, needed: Box): Box {
  const inside = old.left <= needed.left && old.right >= needed.right && old.bottom <= needed.bottom && old.top >= needed.top;
  const size = ({ left, right, bottom, top }: Box) => Math.max(right - left, top - bottom);
  return inside && size(old) < 1.5 * size(needed) ? old : needed;
}

/** All that moves must be in view. */
function limits(motions: readonly Motion[]): Box {
  const box = { left: Infinity, bottom: Infinity, right: -Infinity, top: -Infinity };
  const add = (x: number, y: number, r: number) => {
    box.left = Math.min(box.left, x - r);
    box.right = Math.max(box.right, x + r);
    box.bottom = Math.min(box.bottom, y - r);
    box.top = Math.max(box.top, y + r);
  };
  for (const motion of motions) {
    const { robot, time_s } = motion;
    const corners = robot.outline.map(([x, y]) => Math.hypot(x, y));
    const reach = Math.max(robot.wheel.distance + robot.wheel.radius, ...corners);
    for (let row = 0; row < time_s.length; row += 5) {
      add(value_of(motion, "testbed.truth.x", row), value_of(motion, "testbed.truth.y", row), reach);
      if (robot.obstacle) {
        const { rail, body } = robot.obstacle;
        const [x, y] = [value_of(motion, "testbed.truth.nose_x", row), value_of(motion, "testbed.truth.nose_y", row)];
        add(x - rail[0] * (body + 0.14), y - rail[1] * (body + 0.14), 0.08);
      }
    }
  }
  return Number.isFinite(box.left) ? box : { left: -1, bottom: -1, right: 1, top: 1 };
}

/** One motion at one moment, in the pen's world of metres. */
class Picture {
  private readonly row: number;
  private readonly pose: readonly [number, number, number];
  private readonly turn: Turn;

  constructor(
    private readonly pen: CanvasRenderingContext2D, private readonly motion: Motion, private readonly now: number,
    private readonly scale: number,
  ) {
    this.row = row_at(motion.time_s, now);
    this.pose = [this.truth("x"), this.truth("y"), this.truth("theta")];
    const [c, s] = [Math.cos(this.pose[2]), Math.sin(this.pose[2])];
    this.turn = ([x, y]) => [c * x - s * y, s * x + c * y];
  }

  draw(box: Box): void {
    this.grid(box);
    const compression = this.truth("bumper_compression");
    this.slider(compression);
    this.robot(compression);
    const force: Point = [this.truth("contact_force_x"), this.truth("contact_force_y")];
    if (Math.hypot(...force) >= SMALLEST_FORCE) {
      const at: Point = [this.truth("contact_point_x"), this.truth("contact_point_y")];
      this.arrow(at, force, theme("truth"), 5);
      this.dot(at, theme("truth"), 5, true);
    }
    this.felt();
  }

  private truth(name: string): number {
    return value_of(this.motion, `testbed.truth.${name}`, this.row);
  }

  private said(name: string): number {
    return value_of(this.motion, `controller.${name}`, this.row);
  }

  /** What the robot makes of it: the estimate, and once it has noticed the hit, that. */
  private felt(): void {
    const { contact_s, detected_s } = this.motion;
    const noticed = this.now >= detected_s;
    if (!(this.now >= contact_s) || !(noticed || this.said("estimate.valid"))) {
      return;
    }
    const [kind, colour] = noticed ? ["detection", theme("second")] : ["estimate", theme("estimate")];
    const point = this.turn([this.said(`${kind}.point_x`), this.said(`${kind}.point_y`)]);
    const at: Point = [point[0] + this.pose[0], point[1] + this.pose[1]];
    this.arrow(at, this.turn([this.said(`${kind}.force_x`), this.said(`${kind}.force_y`)]), colour, 2.5);
    this.dot(at, colour, 6, false);
  }

  private line(points: readonly Point[], closed = false): void {
    this.pen.beginPath();
    points.forEach(([x, y], i) => (i ? this.pen.lineTo(x, y) : this.pen.moveTo(x, y)));
    if (closed) this.pen.closePath();
  }

  private grid(box: Box): void {
    const { pen } = this;
    pen.strokeStyle = theme("grid");
    pen.lineWidth = 1 / this.scale;
    const step = box.right - box.left > 6 ? 1 : 0.25;
    const margin = 4;
    pen.beginPath();
    for (let x = Math.ceil((box.left - margin) / step) * step; x < box.right + margin; x += step) {
      pen.moveTo(x, box.bottom - margin);
      pen.lineTo(x, box.top + margin);
    }
    for (let y = Math.ceil((box.bottom - margin) / step) * step; y < box.top + margin; y += step) {
      pen.moveTo(box.left - margin, y);
      pen.lineTo(box.right + margin, y);
    }
    pen.stroke();
  }

  private robot(compression: number): void {
    const { pen } = this;
    const { wheel, outline, plate } = this.motion.robot;
    pen.save();
    pen.translate(this.pose[0], this.pose[1]);
    pen.rotate(this.pose[2]);
    pen.fillStyle = theme("steel");
    for (let i = 0; i < 3; i++) {
      pen.save();
      pen.rotate((i * 2 * Math.PI) / 3);
      pen.fillRect(wheel.distance - wheel.width / 2, -wheel.radius, wheel.width, 2 * wheel.radius);
      pen.restore();
    }
    this.line(outline, true);
    pen.globalAlpha = 0.85;
    pen.fillStyle = theme("body");
    pen.fill();
    pen.globalAlpha = 1;
    pen.strokeStyle = pen.fillStyle = theme("ink");
    pen.lineWidth = 1.8 / this.scale;
    pen.stroke();
    this.line([[0.07, 0], [-0.02, 0.03], [-0.02, -0.03]], true);
    pen.fill();
    if (plate) {
      const moved = ([x, y]: Point): Point => [x + plate.inward[0] * compression, y + plate.inward[1] * compression];
      const [one, other] = [moved(plate.ends[0]), moved(plate.ends[1])];
      this.spring(plate.foot, [(one[0] + other[0]) / 2, (one[1] + other[1]) / 2], true);
      this.line([one, other]);
      pen.strokeStyle = theme("ink");
      pen.lineWidth = 4 / this.scale;
      pen.stroke();
    }
    pen.restore();
  }

  private slider(compression: number): void {
    const { pen } = this;
    const { obstacle } = this.motion.robot;
    if (!obstacle) {
      return;
    }
    const [x, y] = obstacle.rail;
    const tip: Point = [this.truth("nose_x"), this.truth("nose_y")];
    const at = (back: number, left: number): Point => [tip[0] - x * back - y * left, tip[1] - y * back + x * left];
    const body = obstacle.body - (obstacle.sprung ? compression : 0);
    pen.strokeStyle = theme("line");
    pen.lineWidth = 3 / this.scale;
    this.line([at(body + 0.14, 0), at(3, 0)]);
    pen.stroke();
    this.spring(at(obstacle.front, 0), at(body, 0), obstacle.sprung);
    this.line([at(body, 0.06), at(body + 0.14, 0.06), at(body + 0.14, -0.06), at(body, -0.06)], true);
    pen.fillStyle = theme("steel");
    pen.fill();
    pen.strokeStyle = pen.fillStyle = theme("ink");
    pen.lineWidth = 1.2 / this.scale;
    pen.stroke();
    if (obstacle.edge) {
      this.line([at(0, 0.6), at(0.06, 0.6), at(0.06, -0.6), at(0, -0.6)], true);
    } else {
      pen.beginPath();
      pen.arc(...at(obstacle.radius, 0), Math.max(obstacle.radius, 0.004), 0, 7);
    }
    pen.fill();
  }

  /** A zigzag between two points, or a bar if it does not give. */
  private spring(from: Point, to: Point, gives: boolean): void {
    const [dx, dy] = [to[0] - from[0], to[1] - from[1]];
    const length = Math.max(Math.hypot(dx, dy), 1e-9);
    const points = Array.from({ length: 11 }, (_, k): Point => {
      const side = !gives || k % 10 === 0 ? 0 : k % 2 ? 0.022 : -0.022;
      return [from[0] + (dx * k) / 10 - (dy / length) * side, from[1] + (dy * k) / 10 + (dx / length) * side];
    });
    this.line(points);
    this.pen.strokeStyle = theme("steel");
    this.pen.lineWidth = (gives ? 1.6 : 6) / this.scale;
    this.pen.stroke();
  }

  private arrow(at: Point, force: Point, colour: string, width: number): void {
    const { pen, scale } = this;
    const size = Math.hypot(...force);
    if (size < SMALLEST_FORCE) {
      return;
    }
    const length = Math.min(LONGEST_ARROW, size * METRES_PER_NEWTON);
    const [ux, uy] = [force[0] / size, force[1] / size];
    const tail: Point = [at[0] - ux * length, at[1] - uy * length];
    const head = Math.min(length, 12 / scale);
    pen.strokeStyle = pen.fillStyle = colour;
    pen.lineWidth = width / scale;
    this.line([tail, [at[0] - ux * head * 0.8, at[1] - uy * head * 0.8]]);
    pen.stroke();
    const side = head * 0.5;
    this.line([at, [at[0] - ux * head - uy * side, at[1] - uy * head + ux * side], [at[0] - ux * head + uy * side, at[1] - uy * head - ux * side]], true);
    pen.fill();
  }

  private dot(at: Point, colour: string, size: number, full: boolean): void {
    const { pen, scale } = this;
    pen.beginPath();
    pen.arc(at[0], at[1], size / scale, 0, 7);
    pen.fillStyle = pen.strokeStyle = colour;
    pen.lineWidth = 2 / scale;
    if (full) pen.fill();
    else pen.stroke();
  }
}
