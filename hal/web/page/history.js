// Memories that do not grow: the oldest makes room for the newest.

export class Ring {
  constructor(capacity) {
    this.capacity = capacity;
    this.items = [];
    this.first = 0;
  }
  get length() {
    return this.items.length;
  }
  push(item) {
    if (this.items.length < this.capacity) {
      this.items.push(item);
    } else {
      this.items[this.first] = item;
      this.first = (this.first + 1) % this.capacity;
    }
  }
  // From the oldest on; a negative index counts from the newest.
  at(index) {
    if (index < 0) index += this.items.length;
    return this.items[(this.first + index) % this.items.length];
  }
  clear() {
    this.items.length = 0;
    this.first = 0;
  }
}

// The way that was driven, thinned out to points that are `apart_mm` from each other.
export class Track {
  constructor(capacity, apart_mm) {
    this.xs = new Float32Array(capacity);
    this.ys = new Float32Array(capacity);
    this.apart_mm = apart_mm;
    this.clear();
  }
  clear() {
    this.first = 0;
    this.length = 0;
  }
  // NaN is a gap: the way goes on elsewhere.
  add(x, y) {
    if (this.length > 0) {
      const last = (this.first + this.length - 1) % this.xs.length;
      const far = Math.hypot(x - this.xs[last], y - this.ys[last]);
      if (far < this.apart_mm || (Number.isNaN(x) && Number.isNaN(this.xs[last]))) return;
    }
    const next = (this.first + this.length) % this.xs.length;
    this.xs[next] = x;
    this.ys[next] = y;
    if (this.length < this.xs.length) this.length += 1;
    else this.first = (this.first + 1) % this.xs.length;
  }
  gap() {
    this.add(NaN, NaN);
  }
  forEach(visit) {
    for (let i = 0; i < this.length; i += 1) {
      const at = (this.first + i) % this.xs.length;
      visit(this.xs[at], this.ys[at]);
    }
  }
}
