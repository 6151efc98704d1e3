// Lines over time on a canvas, in the page's colours.
'use strict';

class Chart {
  // series: [{label, colour: a CSS variable's name}]; least: range that is shown at least; span: of time, none: all
  constructor(canvas, title, unit, series, least, span) {
    Object.assign(this, { canvas, title, unit, series, least, span });
    this.times = [];
    this.values = series.map(() => []);
    this.mark = null;
  }

  add(time, values) {
    const last = this.times[this.times.length - 1];
    if (this.times.length && time <= last) { if (time === last) return; this.clear(); }
    this.times.push(time);
    values.forEach((value, k) => this.values[k].push(value));
    const excess = this.span ? this.times.findIndex((t) => t >= time - this.span) : 0;
    if (excess > 200) { this.times.splice(0, excess); this.values.forEach((list) => list.splice(0, excess)); }
  }

  clear() { this.times.length = 0; this.values.forEach((list) => { list.length = 0; }); }

  colour(name) { return getComputedStyle(document.documentElement).getPropertyValue(name).trim(); }

  draw() {
    const { canvas } = this, scale = window.devicePixelRatio || 1;
    const w = canvas.clientWidth, h = canvas.clientHeight;
    if (!w || !h) return;
    if (canvas.width !== Math.round(w * scale) || canvas.height !== Math.round(h * scale)) {
      canvas.width = Math.round(w * scale);
      canvas.height = Math.round(h * scale);
    }
    const g = canvas.getContext('2d');
    g.setTransform(scale, 0, 0, scale, 0, 0);
    g.clearRect(0, 0, w, h);
    const end = this.times.length ? this.times[this.times.length - 1] : 0;
    const from = this.span ? end - this.span : this.times[0] || 0;
    const begin = Math.max(0, this.times.findIndex((t) => t >= from));
    const [low, high] = this.range(begin);
    const x = (t) => 44 + (w - 50) * (t - from) / Math.max(1e-9, end - from), y = (v) => h - 6 - (h - 24) * (v - low) / (high - low);
    this.axes(g, w, h, low, high, y);
    this.values.forEach((list, k) => this.line(g, list, begin, x, y, this.colour(this.series[k].colour)));
    if (this.mark !== null) {
      g.strokeStyle = this.colour('--accent');
      g.beginPath(); g.moveTo(x(this.mark), 18); g.lineTo(x(this.mark), h - 4); g.stroke();
    }
  }

  range(begin) {
    let low = 0, high = 0;
    for (const list of this.values) for (let i = begin; i < list.length; ++i) { low = Math.min(low, list[i]); high = Math.max(high, list[i]); }
    if (high - low < this.least) high = low + this.least;
    return [low, high + 0.05 * (high - low)];
  }

  axes(g, w, h, low, high, y) {
    g.font = '11px system-ui, sans-serif';
    g.strokeStyle = this.colour('--line');
    g.fillStyle = this.colour('--faint');
    g.lineWidth = 1;
    g.textAlign = 'right';
    for (const v of [low, (low + high) / 2, high]) {
      g.beginPath(); g.moveTo(44, y(v)); g.lineTo(w - 6, y(v)); g.stroke();
      g.fillText(Math.abs(v) < 1e-3 * (high - low) ? '0' : Number(v.toPrecision(2)).toString(), 40, y(v) + 4);
    }
    g.textAlign = 'left';
    let at = 44;
    g.fillText(`${this.title} [${this.unit}]`, at, 11);
    at += g.measureText(`${this.title} [${this.unit}]`).width + 12;
    this.series.forEach((one) => {
      g.fillStyle = this.colour(one.colour);
      g.fillText(one.label, at, 11);
      at += g.measureText(one.label).width + 10;
    });
  }

  line(g, list, begin, x, y, colour) {
    g.strokeStyle = colour;
    g.lineWidth = 1.6;
    g.beginPath();
    const step = Math.max(1, Math.floor((list.length - begin) / 1200));
    for (let i = begin; i < list.length; i += step) g.lineTo(x(this.times[i]), y(list[i]));
    g.stroke();
  }
}
