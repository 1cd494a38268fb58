// Which part of the floor the map shows: millimetres, y upwards, to CSS pixels, y downwards.

const kFinest_px_mm = 2;
const kCoarsest_px_mm = 0.004;
const kMargin = 1.15;

export class Viewport {
  constructor() {
    this.width = 1;
    this.height = 1;
    this.x_mm = 0;
    this.y_mm = 0;
    this.px_mm = 0.12;
  }
  x(x_mm) {
    return this.width / 2 + (x_mm - this.x_mm) * this.px_mm;
  }
  y(y_mm) {
    return this.height / 2 - (y_mm - this.y_mm) * this.px_mm;
  }
  floor(x, y) {
    return {
      x_mm: this.x_mm + (x - this.width / 2) / this.px_mm,
      y_mm: this.y_mm - (y - this.height / 2) / this.px_mm,
    };
  }
  pan(dx, dy) {
    this.x_mm -= dx / this.px_mm;
    this.y_mm += dy / this.px_mm;
  }
  // What is under the point stays there.
  zoom(factor, x = this.width / 2, y = this.height / 2) {
    const before = this.floor(x, y);
    this.px_mm = Math.min(Math.max(this.px_mm * factor, kCoarsest_px_mm), kFinest_px_mm);
    const after = this.floor(x, y);
    this.x_mm += before.x_mm - after.x_mm;
    this.y_mm += before.y_mm - after.y_mm;
  }
  fit({ left, right, bottom, top }) {
    this.x_mm = (left + right) / 2;
    this.y_mm = (bottom + top) / 2;
    const fits = Math.min(this.width / (right - left || 1), this.height / (top - bottom || 1));
    this.px_mm = Math.min(Math.max(fits / kMargin, kCoarsest_px_mm), kFinest_px_mm);
  }
  // Moves as little as is needed to have the point well inside.
  follow(x_mm, y_mm) {
    const far_x = (0.35 * this.width) / this.px_mm;
    const far_y = (0.35 * this.height) / this.px_mm;
    this.x_mm = Math.min(Math.max(this.x_mm, x_mm - far_x), x_mm + far_x);
    this.y_mm = Math.min(Math.max(this.y_mm, y_mm - far_y), y_mm + far_y);
  }
}

export class Bounds {
  constructor() {
    this.left = this.bottom = Infinity;
    this.right = this.top = -Infinity;
  }
  get empty() {
    return this.left > this.right;
  }
  add(x, y, around = 0) {
    if (Number.isNaN(x)) return;
    this.left = Math.min(this.left, x - around);
    this.right = Math.max(this.right, x + around);
    this.bottom = Math.min(this.bottom, y - around);
    this.top = Math.max(this.top, y + around);
  }
}
