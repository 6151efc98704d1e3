// A batch's report: the answer, a plot for each varied key, the ranking, a picture of each run's final shape, the table.
'use strict';

const prefixes = { N: ['N', 'mN', 'µN'], 'N m': ['N m', 'mN m', 'µN m'], m: ['m', 'mm', 'µm'], s: ['s', 'ms', 'µs'], J: ['J', 'mJ', 'µJ'], 'N/m': ['N/m', 'mN/m', 'µN/m'] };

// A factor and a unit in which the largest of these is no small fraction.
function scaleOf(unit, values) {
  const most = Math.max(0, ...values.filter(Number.isFinite).map(Math.abs)), names = prefixes[unit];
  if (!names || most === 0) return [1, unit];
  const k = most >= 0.1 ? 0 : most >= 1e-4 ? 1 : 2;
  return [1000 ** k, names[k]];
}

const cssColour = (name) => getComputedStyle(document.documentElement).getPropertyValue(name).trim();

// "patch_force_max_n" as words with a unit.
const titleOf = (name, unit) => `${name.replace(/_(n|m|s|j|nm|pa|rad|n_per_m|m2)$/, '').replaceAll('_', ' ')}${unit ? ` [${unit}]` : ''}`;

function withBand(value, band) {
  if (!Number.isFinite(value)) return '';
  if (!(band > 1e-9 * Math.abs(value))) return String(Number(value.toPrecision(band === 0 ? 5 : 3)));  // a band of rounding is none
  const exponent = Math.floor(Math.log10(band)), digits = Math.max(0, -exponent + (band / 10 ** exponent < 2 ? 1 : 0));
  return `${value.toFixed(digits)} ± ${band.toFixed(digits)}`;
}

class Batch {
  constructor(data) {
    this.data = data;
    this.table = data.table;
    this.columns = data.columns;
    this.count = this.columns.length ? this.table[this.columns[0]].length : 0;
    this.units = {}, this.groups = {};
    (data.units.column || []).forEach((name, k) => { this.units[name] = data.units.unit[k]; this.groups[name] = data.units.group[k]; });
    this.keys = this.columns.filter((name) => this.groups[name] === 'varied');
    this.task = data.summary.task || null;
    this.outcomes = this.task ? [['passed', '--good'], ['over a limit', '--force'], ['not reached', '--bad'], ['stopped', '--faint']]
      : [...new Set(this.table.branch || [])].sort((a, b) => a - b).map((b) => [b ? `branch ${b}` : 'before any branch', `--instrument-${b % 8 + 1}`]).concat([['left the vessel', '--bad'], ['stopped', '--faint']]);
    this.outcomes = this.outcomes.filter(([name]) => this.runs().some((k) => this.outcome(k) === name));
  }

  runs() { return Array.from({ length: this.count }, (_, k) => k); }

  number(name, k) { const value = this.table[name] ? this.table[name][k] : NaN; return typeof value === 'number' ? value : NaN; }

  outcome(k) {
    if (this.table.status[k] !== 'done') return 'stopped';
    if (this.task) return this.number('passed', k) ? 'passed' : this.number('reached', k) ? 'over a limit' : 'not reached';
    if (this.number('left_through', k)) return 'left the vessel';
    const branch = this.number('branch', k);
    return branch ? `branch ${branch}` : 'before any branch';
  }

  colour(k) { const found = this.outcomes.find(([name]) => name === this.outcome(k)); return cssColour(found ? found[1] : '--faint'); }

  label(k) {
    const said = (key) => { const text = String(this.table[key][k]); return text.length > 48 ? `${text.slice(0, 48)} …` : text; };
    return this.keys.length === 1 && typeof this.table[this.keys[0]][k] === 'string' ? said(this.keys[0]) : this.keys.map((key) => `${key.split('.').pop()} ${said(key)}`).join(', ');
  }

  // What sets run k apart, as options of `seldinger run`: of a design what its file sets.
  settings(k) { return this.keys.flatMap((key) => (key === 'design' && this.data.designs[this.table[key][k]]) || [`${key}=${this.table[key][k]}`]).map((setting) => ` --set '${setting}'`).join(''); }

  // Readings that a plot may show: the least force first that the task is judged by.
  responses() {
    const able = this.columns.filter((name) => ['outcome', 'largest', 'last'].includes(this.groups[name]) && !name.endsWith('_band') &&
      !['branch', 'left_through', 'reached', 'passed', 'status'].includes(name) && this.runs().some((k) => Number.isFinite(this.number(name, k))));
    const first = ['until_patch_force_max_n', 'patch_force_max_n'].find((name) => able.includes(name));
    return first ? [first, ...able.filter((name) => name !== first)] : able;
  }

  ranked() {
    const name = this.responses()[0], last = this.outcomes.map(([of]) => of);
    const value = (k) => { const v = this.number(name, k); return Number.isFinite(v) ? v : Infinity; };
    return this.runs().sort((a, b) => last.indexOf(this.outcome(a)) - last.indexOf(this.outcome(b)) || value(a) - value(b) || a - b);
  }
}

// ---- plots ----

// In the logarithm where positive numbers span more than 30, so that small ones are told apart beside large ones.
function valueAxis(lows, highs) {
  const least = Math.min(...lows), most = Math.max(...highs);
  if (!(least > 0 && most / least > 30)) {
    const round = roundTicks(Math.min(0, least), Math.max(0, most), 4);
    return { low: round.low, high: round.high, at: (v) => v, ticks: round.ticks.map((t) => [t, tickText(t, round.step)]) };
  }
  const low = Math.floor(Math.log10(least)), high = Math.ceil(Math.log10(most)), ticks = [];
  for (let e = low; e <= high; ++e) for (const m of high - low > 2 || e === high ? [1] : [1, 3]) ticks.push([e + Math.log10(m), String(Number((m * 10 ** e).toPrecision(1)))]);
  return { low, high, at: (v) => Math.log10(Math.max(v, 10 ** low)), ticks };
}

class KeyPlot {
  constructor(batch, key, canvas) { Object.assign(this, { batch, key, canvas }); }

  // Where a run stands along the key: numbers by value, in the logarithm where they span more than 30; words by their order.
  axis() {
    const values = this.batch.table[this.key], numeric = values.every((v) => typeof v === 'number');
    if (!numeric) {
      const words = [...new Set(values.map(String))];
      return { at: (k) => words.indexOf(String(values[k])), low: -0.5, high: words.length - 0.5, ticks: words.map((word, i) => [i, word]), unit: '' };
    }
    const least = Math.min(...values), most = Math.max(...values), unit = this.batch.units[this.key] || '';
    if (least > 0 && most / least > 30) {
      const low = Math.floor(Math.log10(least)), high = Math.ceil(Math.log10(most)), ticks = [];
      for (let e = low; e <= high; ++e) ticks.push([e, `1e${e}`]);
      return { at: (k) => Math.log10(values[k]), low, high, ticks, unit };
    }
    const [factor, named] = scaleOf(unit, values), round = roundTicks(factor * least, factor * most, 5), pad = 0.03 * (round.high - round.low);
    return { at: (k) => factor * values[k], low: round.low - pad, high: round.high + pad, ticks: round.ticks.map((t) => [t, tickText(t, round.step)]), unit: named };
  }

  draw(response) {
    const { canvas, batch } = this, ratio = window.devicePixelRatio || 1, w = canvas.clientWidth, h = canvas.clientHeight;
    if (!w || !h) return;
    canvas.width = Math.round(w * ratio), canvas.height = Math.round(h * ratio);
    const g = canvas.getContext('2d');
    g.setTransform(ratio, 0, 0, ratio, 0, 0);
    const runs = batch.runs().filter((k) => Number.isFinite(batch.number(response, k)));
    const [factor, unit] = scaleOf(batch.units[response] || '', runs.map((k) => batch.number(response, k)));
    const value = (k) => factor * batch.number(response, k), band = (k) => factor * (batch.number(`${response}_band`, k) || 0);
    const x = this.axis(), y = valueAxis(runs.map((k) => value(k) - band(k)), runs.map((k) => value(k) + band(k)));
    const left = 48, right = w - 8, top = 22, bottom = h - 34;
    const px = (v) => left + (right - left) * (v - x.low) / Math.max(1e-12, x.high - x.low), py = (v) => bottom - (bottom - top) * (y.at(v) - y.low) / (y.high - y.low);
    this.drawAxes(g, x, y, { left, right, top, bottom, px, py, w }, titleOf(response, unit));
    const beside = new Map();  // runs at one place stand beside each other
    for (const k of runs) {
      const at = x.at(k), many = (beside.get(at) || 0);
      beside.set(at, many + 1);
      const cx = px(at) + (many % 2 ? 1 : -1) * 3 * Math.ceil(many / 2) % 24, cy = py(value(k));
      g.strokeStyle = g.fillStyle = batch.colour(k);
      g.lineWidth = 1.4;
      if (band(k) > 0) { g.beginPath(); for (const end of [-1, 1]) { g.moveTo(cx, cy); const to = py(value(k) + end * band(k)); g.lineTo(cx, to); g.moveTo(cx - 4, to); g.lineTo(cx + 4, to); } g.stroke(); }
      g.beginPath(); g.arc(cx, cy, 3.5, 0, 2 * Math.PI); g.fill();
    }
  }

  drawAxes(g, x, y, box, title) {
    const { left, right, top, bottom, px, py } = box;
    g.font = '11px system-ui, sans-serif';
    g.lineWidth = 1;
    g.strokeStyle = cssColour('--line');
    g.fillStyle = cssColour('--faint');
    g.textAlign = 'right';
    for (const [at, text] of y.ticks) {
      const row = bottom - (bottom - top) * (at - y.low) / (y.high - y.low);
      g.beginPath(); g.moveTo(left, row); g.lineTo(right, row); g.stroke();
      g.fillText(text, left - 4, row + 4);
    }
    const room = (right - left) / Math.max(1, x.ticks.length);
    let end = -Infinity;
    for (const [at, text] of x.ticks) {
      let said = text;
      while (said.length > 3 && g.measureText(said).width > Math.max(room - 4, 24)) said = `${said.slice(0, -2).replace(/…$/, '')}…`;
      const half = g.measureText(said).width / 2, cx = Math.min(right - half, Math.max(left + half, px(at)));
      if (cx - half < end + 4) continue;
      end = cx + half;
      g.textAlign = 'center';
      g.fillText(said, cx, bottom + 14);
    }
    g.fillText(`${this.key}${x.unit ? ` [${x.unit}]` : ''}`, (left + right) / 2, bottom + 28);
    g.textAlign = 'left';
    g.fillText(title, left, 12);
  }
}

// ---- pictures ----

// Two views across the direction `up`, the axis nearest to the head: from where the shapes and the vessel are widest, and from the side.
function viewsOf(points, head, front) {
  const size = [0, 1, 2].map((c) => Math.max(...points.map((p) => p[c])) - Math.min(...points.map((p) => p[c])));
  const thin = size.indexOf(Math.min(...size)), others = [0, 1, 2].filter((c) => c !== thin);
  const up = Math.abs(head[others[0]]) > Math.abs(head[others[1]]) ? others[0] : others[1], across = others.find((c) => c !== up);
  const right = (head[(across + 1) % 3] * front[(across + 2) % 3] - head[(across + 2) % 3] * front[(across + 1) % 3]) < 0 ? -1 : 1;  // head x front
  const high = head[up] < 0 ? -1 : 1, near = front[thin] < 0 ? -1 : 1;
  return [(p) => [right * p[across], high * p[up]], (p) => [near * p[thin], high * p[up]]];
}

class ContactSheet {
  constructor(batch, vessel, shapes, head, front) {
    this.batch = batch, this.vessel = vessel, this.shapes = shapes;
    const points = vessel.length ? vessel : [...shapes.values()].flat(2), bound = (flat, c, most) => flat.reduce((so, p) => most(so, p[c]), most === Math.min ? Infinity : -Infinity);
    this.views = viewsOf(points, head, front).map((project) => {
      const flat = points.map(project);
      return { project, low: [0, 1].map((c) => bound(flat, c, Math.min)), high: [0, 1].map((c) => bound(flat, c, Math.max)) };
    });
  }

  draw(canvas, k) {
    const ratio = window.devicePixelRatio || 1, w = canvas.clientWidth, h = canvas.clientHeight;
    if (!w || !h) return;
    canvas.width = Math.round(w * ratio), canvas.height = Math.round(h * ratio);
    const g = canvas.getContext('2d'), wide = this.views.map((v) => v.high[0] - v.low[0] || 1e-3), tall = this.views[0].high[1] - this.views[0].low[1] || 1e-3;
    const gap = 0.06 * w, scale = 0.94 * Math.min((w - gap) / (wide[0] + wide[1]), h / tall);
    g.setTransform(ratio, 0, 0, ratio, 0, 0);
    let left = (w - gap - scale * (wide[0] + wide[1])) / 2;
    this.views.forEach((view, i) => { this.drawView(g, view, k, scale, left, h / 2); left += scale * wide[i] + gap; });
  }

  drawView(g, { project, low, high }, k, scale, left, middle) {
    const place = (p) => { const [x, y] = project(p); return [left + scale * (x - low[0]), middle - scale * (y - (low[1] + high[1]) / 2)]; };
    g.fillStyle = cssColour('--wall');
    g.globalAlpha = 0.13;
    for (const p of this.vessel) { const [px, py] = place(p); g.fillRect(px - 1, py - 1, 2, 2); }
    g.globalAlpha = 1;
    (this.shapes.get(this.batch.table.run[k]) || []).forEach((line, i, all) => {
      g.strokeStyle = cssColour(instrumentColour(i, all.length));
      g.lineWidth = 1.8;
      g.beginPath();
      line.forEach((p) => g.lineTo(...place(p)));
      g.stroke();
      if (i) return;
      const [tx, ty] = place(line[0]);
      g.fillStyle = this.batch.colour(k);
      g.beginPath(); g.arc(tx, ty, 3.5, 0, 2 * Math.PI); g.fill();
    });
  }
}

// Shapes as [run -> [instrument -> [points]]].
function shapesOf(table) {
  const runs = new Map(), names = [...new Set(table.instrument || [])];
  (table.run || []).forEach((run, k) => {
    if (!runs.has(run)) runs.set(run, names.map(() => []));
    runs.get(run)[names.indexOf(table.instrument[k])].push([table.x_m[k], table.y_m[k], table.z_m[k]]);
  });
  return runs;
}

// ---- the page ----

function linkTo(run, text) { const a = document.createElement('a'); a.href = `#run-${run}`; a.textContent = text; return a; }

function showBatch(batch, mostPictures = 60) {
  const $ = (id) => document.getElementById(id), data = batch.data;
  for (const id of ['scene', 'player']) $(id).hidden = true;
  $('runs').hidden = false;
  $('verdicts').hidden = !data.summary.answer && !batch.outcomes.length;
  $('graphs').classList.add('of-batch');
  $('answer').textContent = data.summary.answer || '';
  showOutcomes($('outcomes'), batch);
  const responses = batch.responses(), select = $('response');
  responses.forEach((name) => { const option = document.createElement('option'); option.value = name, option.textContent = titleOf(name, batch.units[name]); select.append(option); });
  const plots = responses.length ? batch.keys.map((key) => { const canvas = document.createElement('canvas'); $('graphs').append(canvas); return new KeyPlot(batch, key, canvas); }) : [];
  $('choose').hidden = !plots.length;
  showRanking($('ranking'), batch, responses[0]);
  $('ranks').hidden = !responses.length;
  const shapes = shapesOf(data.shapes), sheet = shapes.size ? new ContactSheet(batch, data.vessel, shapes, data.head, data.front) : null;
  const pictures = sheet ? showPictures($('sheet-of-runs'), batch, mostPictures) : [];
  $('pictures').hidden = !pictures.length;
  $('pictures-of').textContent = batch.count > pictures.length ? `the first ${pictures.length} of ${batch.count}` : '';
  const redraw = () => { plots.forEach((plot) => plot.draw(select.value)); pictures.forEach(([canvas, k]) => sheet.draw(canvas, k)); };
  select.addEventListener('change', redraw);
  addEventListener('resize', redraw);
  matchMedia('(prefers-color-scheme: dark)').addEventListener('change', redraw);
  redraw();
  return { plots, pictures };
}

function showOutcomes(list, batch) {
  list.hidden = !batch.outcomes.length;
  for (const [name, colour] of batch.outcomes) {
    const item = document.createElement('li'), dot = document.createElement('i');
    dot.className = 'dot';
    dot.style.background = `var(${colour})`;
    item.append(dot, `${name} (${batch.runs().filter((k) => batch.outcome(k) === name).length})`);
    list.append(item);
  }
}

function showRanking(table, batch, response, most = 20) {
  if (!response) return;
  const ranked = batch.ranked(), [factor, unit] = scaleOf(batch.units[response] || '', ranked.map((k) => batch.number(response, k)));
  const head = table.insertRow();
  for (const text of ['', 'run', ...batch.keys, 'outcome', titleOf(response, unit)]) { const th = document.createElement('th'); th.textContent = text; head.append(th); }
  ranked.slice(0, most).forEach((k, place) => {
    const tr = table.insertRow();
    tr.insertCell().textContent = batch.outcome(k) === batch.outcomes[0][0] || !batch.task ? place + 1 : '';
    tr.insertCell().append(linkTo(batch.table.run[k], batch.table.run[k]));
    for (const key of batch.keys) tr.insertCell().textContent = String(batch.table[key][k]).length > 48 ? `${batch.table[key][k].slice(0, 48)} …` : batch.table[key][k];
    const cell = tr.insertCell();
    cell.textContent = batch.outcome(k);
    cell.style.color = batch.colour(k);
    tr.insertCell().textContent = withBand(factor * batch.number(response, k), factor * batch.number(`${response}_band`, k));
  });
}

function showPictures(list, batch, most) {
  return batch.ranked().slice(0, most).map((k) => {
    const figure = document.createElement('figure'), canvas = document.createElement('canvas'), caption = document.createElement('figcaption');
    const more = document.createElement('details'), head = document.createElement('summary'), command = document.createElement('code');
    figure.id = `run-${batch.table.run[k]}`;
    head.textContent = 'this run alone';
    command.textContent = `seldinger run scene.toml${batch.settings(k)} -o run-${batch.table.run[k]}`;
    more.append(head, command);
    caption.append(`run ${batch.table.run[k]} (${batch.label(k)}): ${batch.outcome(k)}`, more);
    figure.append(canvas, caption);
    list.append(figure);
    return [canvas, k];
  });
}
