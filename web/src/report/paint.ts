// What the canvases of a study's page share: sharp pixels, the theme's colours, thousands of points at once.

import { theme } from "../parts/page";

/** A canvas that fills its place, in CSS pixels; `draw` is called when it has another size or the theme changes. */
export class Surface {
  readonly canvas: HTMLCanvasElement;
  readonly pen: CanvasRenderingContext2D;
  width = 0;
  height = 0;
  ratio = 1;

  constructor(where: HTMLElement, label: string, draw: () => void) {
    this.canvas = document.createElement("canvas");
    this.canvas.setAttribute("role", "img");
    this.canvas.setAttribute("aria-label", label);
    this.canvas.className = "surface";
    where.append(this.canvas);
    const pen = this.canvas.getContext("2d");
    if (pen === null) {
      throw new Error("this browser has no canvas");
    }
    this.pen = pen;
    const fitted = () => {
      this.fit();
      draw();
    };
    new ResizeObserver(fitted).observe(this.canvas);
    matchMedia("(prefers-color-scheme: dark)").addEventListener("change", () => requestAnimationFrame(fitted));
  }

  /** Takes the size that the page gives. */
  fit(): void {
    this.ratio = window.devicePixelRatio || 1;
    this.width = this.canvas.clientWidth;
    this.height = this.canvas.clientHeight;
    const [width, height] = [Math.round(this.width * this.ratio), Math.round(this.height * this.ratio)];
    if (this.canvas.width !== width || this.canvas.height !== height) {
      this.canvas.width = width;
      this.canvas.height = height;
    }
  }

  /** Where an event is, in CSS pixels. */
  place(event: MouseEvent): [number, number] {
    const box = this.canvas.getBoundingClientRect();
    return [event.clientX - box.left, event.clientY - box.top];
  }
}

const themed = new Map<string, string>();
matchMedia("(prefers-color-scheme: dark)").addEventListener("change", () => themed.clear());

/** A colour of the theme, as it is now: asked for once, as a frame needs it hundreds of times. */
export function colour(name: string): string {
  const found = themed.get(name) ?? theme(name);
  themed.set(name, found);
  return found;
}

/** Pixels that are drawn above what is there; kept, so that a frame makes no new ones. */
export class Layer {
  image = new ImageData(1, 1);
  pixels = new Uint32Array(this.image.data.buffer);
  private readonly _canvas = new OffscreenCanvas(1, 1);

  /** Empty, and so large. */
  clear(width: number, height: number): Uint32Array {
    if (this.image.width !== width || this.image.height !== height) {
      this.image = new ImageData(width, height);
      this.pixels = new Uint32Array(this.image.data.buffer);
      [this._canvas.width, this._canvas.height] = [width, height];
    } else {
      this.pixels.fill(0);
    }
    return this.pixels;
  }

  /** What is in the pixels is what is drawn from now on. */
  keep(): void {
    this._canvas.getContext("2d")?.putImageData(this.image, 0, 0);
  }

  draw(pen: CanvasRenderingContext2D): void {
    pen.save();
    pen.setTransform(1, 0, 0, 1, 0, 0);
    pen.drawImage(this._canvas, 0, 0, pen.canvas.width, pen.canvas.height);
    pen.restore();
  }
}

/** A drawing that seldom changes: made when its key does, and copied in every frame. */
export class Stencil {
  private readonly _canvas = new OffscreenCanvas(1, 1);
  private _key = "";

  draw(surface: Surface, key: string, drawn: (pen: OffscreenCanvasRenderingContext2D) => void): void {
    const { width, height } = surface.canvas;
    const whole = `${key} ${width} ${height} ${colour("ink")}`;
    if (this._key !== whole) {
      this._key = whole;
      [this._canvas.width, this._canvas.height] = [width, height];
      const pen = this._canvas.getContext("2d");
      if (pen) {
        pen.setTransform(surface.ratio, 0, 0, surface.ratio, 0, 0);
        drawn(pen);
      }
    }
    surface.pen.save();
    surface.pen.setTransform(1, 0, 0, 1, 0, 0);
    surface.pen.drawImage(this._canvas, 0, 0);
    surface.pen.restore();
  }
}

const known = new Map<string, [number, number, number]>();

/** Red, green and blue of a CSS colour, 0 to 255. */
export function rgb(text: string): [number, number, number] {
  const found = known.get(text);
  if (found) {
    return found;
  }
  const one = document.createElement("canvas");
  one.width = one.height = 1;
  const pen = one.getContext("2d", { willReadFrequently: true });
  let answer: [number, number, number] = [136, 136, 136];
  if (pen) {
    pen.fillStyle = text;
    pen.fillRect(0, 0, 1, 1);
    const [red = 0, green = 0, blue = 0] = pen.getImageData(0, 0, 1, 1).data;
    answer = [red, green, blue];
  }
  known.set(text, answer);
  return answer;
}

/** A colour as the four bytes of a pixel; `share`: how opaque. */
export function pixel_of(text: string, share = 1): number {
  const [red, green, blue] = rgb(text);
  return ((Math.round(255 * share) << 24) | (blue << 16) | (green << 8) | red) >>> 0;
}
