// A pen that writes an SVG file instead of a canvas: the same drawing, with text that stays text.

import type { Pen } from "./scatter";

const round = (value: number) => Number(value.toFixed(2));
const escaped = (text: string) =>
  text.replace(/[&<>"]/g, (letter) => ({ "&": "&amp;", "<": "&lt;", ">": "&gt;", '"': "&quot;" })[letter] ?? "");

class SvgPen implements Pen {
  fillStyle: unknown = "#000";
  strokeStyle: unknown = "#000";
  lineWidth = 1;
  globalAlpha = 1;
  font = "12px sans-serif";
  textAlign: CanvasTextAlign = "start";
  textBaseline: CanvasTextBaseline = "alphabetic";
  readonly parts: string[] = [];
  private _path = "";
  private _dash = "";
  private readonly _groups: number[] = [];
  private _open = 0;
  private readonly _measure = document.createElement("canvas").getContext("2d");

  beginPath(): void {
    this._path = "";
  }
  moveTo(x: number, y: number): void {
    this._path += `M${round(x)} ${round(y)}`;
  }
  lineTo(x: number, y: number): void {
    this._path += `${this._path ? "L" : "M"}${round(x)} ${round(y)}`;
  }
  /** Only whole circles. */
  arc(x: number, y: number, radius: number): void {
    const r = round(radius);
    this._path += `M${round(x - radius)} ${round(y)}a${r} ${r} 0 1 0 ${2 * r} 0a${r} ${r} 0 1 0 ${-2 * r} 0z`;
  }
  rect(x: number, y: number, width: number, height: number): void {
    this._path += `M${round(x)} ${round(y)}h${round(width)}v${round(height)}h${round(-width)}z`;
  }
  stroke(): void {
    const dash = this._dash ? ` stroke-dasharray="${this._dash}"` : "";
    const paint = `stroke="${this.strokeStyle}" stroke-opacity="${this.globalAlpha}" stroke-width="${this.lineWidth}"`;
    this.parts.push(`<path d="${this._path}" fill="none" ${paint}${dash}/>`);
  }
  fill(): void {
    this.parts.push(`<path d="${this._path}" fill="${this.fillStyle}" fill-opacity="${this.globalAlpha}"/>`);
  }
  fillText(text: string, x: number, y: number): void {
    const anchor = { center: "middle", right: "end", end: "end" }[this.textAlign as string] ?? "start";
    const base = { top: "hanging", middle: "central", bottom: "text-after-edge" }[this.textBaseline as string] ?? "auto";
    const place = `x="${round(x)}" y="${round(y)}" text-anchor="${anchor}" dominant-baseline="${base}"`;
    this.parts.push(`<text ${place} fill="${this.fillStyle}">${escaped(text)}</text>`);
  }
  save(): void {
    this._groups.push(this._open);
    this._open = 0;
  }
  restore(): void {
    this.parts.push("</g>".repeat(this._open));
    this._open = this._groups.pop() ?? 0;
  }
  translate(x: number, y: number): void {
    this._group(`transform="translate(${round(x)} ${round(y)})"`);
  }
  rotate(angle: number): void {
    this._group(`transform="rotate(${round((angle * 180) / Math.PI)})"`);
  }
  /** What follows, until `restore`, stays within the path. */
  clip(): void {
    const name = `clip${this.parts.length}`;
    this.parts.push(`<clipPath id="${name}"><path d="${this._path}"/></clipPath>`);
    this._group(`clip-path="url(#${name})"`);
  }
  setLineDash(dash: number[]): void {
    this._dash = dash.join(" ");
  }
  measureText(text: string): TextMetrics {
    if (this._measure === null) {
      throw new Error("this browser has no canvas");
    }
    this._measure.font = this.font;
    return this._measure.measureText(text);
  }
  private _group(attribute: string): void {
    this.parts.push(`<g ${attribute}>`);
    this._open++;
  }
}

/** The text of an SVG file with what `draw` draws. */
export function drawn_svg(width: number, height: number, draw: (pen: Pen) => void): string {
  const pen = new SvgPen();
  draw(pen);
  const paper = getComputedStyle(document.documentElement).getPropertyValue("--card").trim() || "#fff";
  return (
    `<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 ${round(width)} ${round(height)}" ` +
    `width="${round(width)}" height="${round(height)}" font-family="system-ui, sans-serif" font-size="12">\n` +
    `<rect width="100%" height="100%" fill="${paper}"/>\n${pen.parts.join("\n")}\n</svg>\n`
  );
}
