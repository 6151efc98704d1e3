// Lines over time on a canvas, in the page's colours.
'use strict';

// Round numbers (1, 2 or 5 times a power of ten) that take in low to high, about `most` intervals.
function roundTicks(low, high, most) {
  const span = high > low ? high - low : Math.abs(low) || 1, raw = span / most, power = 10 ** Math.floor(Math.log10(raw));
  const step = [1, 2, 5, 10].map((m) => m * power).find((s) => s >= raw * (1 - 1e-9));
  const slight = 0.05;  // of a step beyond a tick: no further one for that
  const first = Math.floor(low / step + slight), last = Math.max(first + 1, Math.ceil(high / step - slight)), ticks = [];
  for (let i = first; i <= last; ++i) ticks.push(i * step);
  return { low: first * step, high: last * step, step, ticks };
}

// A tick as text, with the digits that its step has.
function tickText(value, step) {
  if (Math.abs(value) < 1e-9 * step) return '0';
  const digits = Math.max(0, -Math.floor(Math.log10(step) + 1e-9));
  return digits > 4 || Math.abs(value) >= 1e5 ? Number(value.toPrecision(6)).toExponential() : value.toFixed(digits);
}

class Chart {
  // series: [{label, colour: a CSS variable's name}]; least: range that is shown at least; span: of time, none: all; fixed: always in `unit`
  constructor(canvas, title, unit, series, least, span, fixed) {
    Object.assign(this, { canvas, title, unit, series, least, span, fixed });
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
    const { canvas } = this, ratio = window.devicePixelRatio || 1;
    const w = canvas.clientWidth, h = canvas.clientHeight;
    if (!w || !h) return;
    if (canvas.width !== Math.round(w * ratio) || canvas.height !== Math.round(h * ratio)) {
      canvas.width = Math.round(w * ratio);
      canvas.height = Math.round(h * ratio);
    }
    const g = canvas.getContext('2d');
    g.setTransform(ratio, 0, 0, ratio, 0, 0);
    g.clearRect(0, 0, w, h);
    const end = this.times.length ? this.times[this.times.length - 1] : 0;
    const from = this.span ? end - this.span : this.times[0] || 0;
    const begin = Math.max(0, this.times.findIndex((t) => t >= from));
    const [least, most] = this.range(begin), scale = this.scaleOf(Math.max(Math.abs(least), Math.abs(most)));
    const ticks = roundTicks(scale.factor * least, scale.factor * most, h < 110 ? 2 : 4), foot = this.span ? 6 : 20;
    const x = (t) => 44 + (w - 54) * (t - from) / Math.max(1e-9, end - from);
    const tall = (v) => h - foot - (h - 18 - foot) * (v - ticks.low) / (ticks.high - ticks.low), y = (v) => tall(scale.factor * v);
    this.axes(g, w, ticks, tall, scale.unit);
    if (!this.span) this.timeAxis(g, h, from, end, x);
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
    return [low, high];
  }

  // Small forces in mN rather than with exponents.
  scaleOf(most) {
    const smaller = { N: ['mN', 'µN'], 'N/m': ['mN/m', 'µN/m'], 'mN m': ['µN m', 'nN m'], mm: ['µm', 'nm'] }[this.unit];
    if (this.fixed || !smaller || most >= 0.1) return { factor: 1, unit: this.unit };
    return most >= 1e-4 ? { factor: 1e3, unit: smaller[0] } : { factor: 1e6, unit: smaller[1] };
  }

  axes(g, w, { ticks, step }, y, unit) {
    g.font = '11px system-ui, sans-serif';
    g.strokeStyle = this.colour('--line');
    g.fillStyle = this.colour('--faint');
    g.lineWidth = 1;
    g.textAlign = 'right';
    for (const v of ticks) {
      g.beginPath(); g.moveTo(44, y(v)); g.lineTo(w - 6, y(v)); g.stroke();
      g.fillText(tickText(v, step), 40, y(v) + 4);
    }
    g.textAlign = 'left';
    let at = 44;
    const title = `${this.title}${unit && unit !== '1' ? ` [${unit}]` : ''}`;
    g.fillText(title, at, 11);
    at += g.measureText(title).width + 12;
    this.series.forEach((one) => {
      g.fillStyle = this.colour(one.colour);
      g.fillText(one.label, at, 11);
      at += g.measureText(one.label).width + 10;
    });
  }

  timeAxis(g, h, from, end, x) {
    if (!(end > from)) return;
    const { ticks, step } = roundTicks(from, end, 5);
    g.fillStyle = this.colour('--faint');
    g.textAlign = 'center';
    const shown = ticks.filter((t) => t >= from - 1e-9 * step && t <= end + 1e-9 * step);
    const right = x(end) + 10;  // the canvas ends there
    shown.forEach((t, k) => {
      const text = `${tickText(t, step)}${k === shown.length - 1 ? ' s' : ''}`;
      g.fillText(text, Math.min(x(t), right - g.measureText(text).width / 2 - 1), h - 4);
    });
    g.textAlign = 'left';
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
