// A report: playback of a run with its plots, or a batch's table, from what is in the page itself.
'use strict';

const $ = (id) => document.getElementById(id);
const data = JSON.parse($('data').textContent);
const report = { data, frame: 0, viewer: null, charts: [], still: [] };  // still: plots left out, 0 throughout
window.seldinger = report;  // for tests

function bytes(text) {
  const raw = atob(text), out = new Uint8Array(raw.length);
  for (let i = 0; i < raw.length; ++i) out[i] = raw.charCodeAt(i);
  return out.buffer;
}

function row(table, cells, tag = 'td') {
  const tr = table.insertRow();
  cells.forEach((text, k) => { const cell = document.createElement(k ? tag : 'th'); cell.textContent = text; tr.append(cell); });
}

const short = (value) => typeof value === 'number' ? (Number.isInteger(value) ? String(value) : value.toPrecision(5)) : Array.isArray(value) ? value.map(short).join(', ') : value === null ? '' : String(value);

// Every value that is nested in others with its path: "task.ranking.0.label".
function* leaves(value, path) {
  const isNested = (one) => one !== null && typeof one === 'object';
  if (isNested(value) && !(Array.isArray(value) && !value.some(isNested))) for (const [key, inner] of Object.entries(value)) yield* leaves(inner, path ? `${path}.${key}` : key);
  else yield [path, value];
}

// What the machine did and how fast comes last: it is of no interest to the question.
const ofMachine = ['wall_s', 'steps_per_s', 'realtime_factor', 'stage_ms', 'device', 'version', 'resumes', 'worlds', 'wire_steps', 'wire_steps_per_s', 'threads', 'results', 'state_hash', 'wall_made_s', 'wall_factor_s', 'wall_memory_mb'];

function showSummary() {
  $('name').textContent = data.name;
  document.title = `${data.name}: report`;
  $('version').textContent = data.summary.version ? `version ${data.summary.version}` : data.kind;
  $('hash').textContent = data.summary.state_hash || '';
  $('hash').hidden = !data.summary.state_hash;
  const keys = Object.keys(data.summary), inOrder = [...keys.filter((key) => !ofMachine.includes(key)), ...keys.filter((key) => ofMachine.includes(key))];
  for (const key of inOrder) for (const [path, value] of leaves(data.summary[key], key)) row($('summary'), [path, short(value)]);
  $('settings').textContent = data.settings;
}

function addChart(title, unit, series, columns, scale, least, trace = data.trace) {
  const there = columns.filter((name) => trace[name]);
  if (!there.length || !trace.time_s.length) return;
  if (there.every((name) => trace[name].every((value) => !Number(value)))) { report.still.push(title.toLowerCase()); return; }
  const canvas = document.createElement('canvas');
  $('graphs').append(canvas);
  const chart = new Chart(canvas, title, unit, series, least);
  trace.time_s.forEach((time, k) => chart.add(time, there.map((name) => scale * (Number(trace[name][k]) || 0))));
  report.charts.push(chart);
}

// A column of every instrument's own trace in one plot, each in its colour.
function addInstrumentsChart(title, unit, column, scale, least) {
  const traces = data.traces, together = { time_s: traces[0].time_s };
  traces.forEach((trace, k) => { together[k] = trace[column]; });
  const series = data.playback.instruments.map((it, k) => ({ label: it.name, colour: instrumentColour(k, traces.length) }));
  addChart(title, unit, series, traces.map((_, k) => k), scale, least, together);
}

function addCharts() {
  if (data.traces.length) {
    addInstrumentsChart('Hand force', 'N', 'hand_force_n', 1, 1e-3);
    addInstrumentsChart('Hand torque', 'mN m', 'hand_torque_nm', 1e3, 1e-4);
    addInstrumentsChart('Inserted', 'mm', 'inserted_m', 1e3, 1);
    addInstrumentsChart('Wall force', 'N', 'normal_n', 1, 1e-3);
  } else {
    addChart('Force', 'N', [{ label: 'hand', colour: '--accent' }, { label: 'wall', colour: '--force' }, { label: 'friction', colour: '--good' }], ['hand_force_n', 'normal_n', 'friction_n'], 1, 1e-3);
    addChart('Torque', 'mN m', [{ label: 'hand', colour: '--accent' }], ['hand_torque_nm'], 1e3, 1e-4);
    addChart('Inserted', 'mm', [{ label: 'wire', colour: '--accent' }], ['inserted_m'], 1e3, 1);
  }
  if (data.trace.force_per_length_max_n_per_m) {
    addChart('Force per length, largest', 'N/m', [{ label: 'wall', colour: '--force' }], ['force_per_length_max_n_per_m'], 1, 0.1);
    addChart('Force on one patch, largest', 'N', [{ label: 'wall', colour: '--force' }], ['patch_force_max_n'], 1, 1e-3);
    addChart('Length in contact', 'mm', [{ label: 'wire', colour: '--force' }], ['contact_extent_m'], 1e3, 1);
    addChart('Places in contact', '1', [{ label: 'places', colour: '--force' }], ['contact_regions'], 1, 1);
  } else addChart('Contact samples', '1', [{ label: 'samples', colour: '--force' }], ['contacts'], 1, 1);
}

function addPlayer() {
  const frames = data.playback.frames.map((frame) => ({ time: frame.time, nodes: frame.nodes.map((nodes) => new Float32Array(bytes(nodes))) }));
  const instruments = data.playback.instruments;
  const mesh = bytes(data.playback.mesh), [vertices, triangles] = new Uint32Array(mesh, 0, 2);
  report.viewer = makeViewer($('view'), {
    positions: new Float32Array(mesh, 8, 3 * vertices), indices: new Uint32Array(mesh, 8 + 12 * vertices, 3 * triangles),
    radii: instruments.map((it) => it.radius), head: data.head, front: data.front, target: data.target,
    most: frames.reduce((most, frame) => frame.nodes.reduce((all, nodes) => Math.max(all, nodes.length / 4), most), 2),
  }, $('message'));
  showLegend($('legend'), instruments.map((it) => it.name));
  const show = (k) => {
    report.frame = k;
    $('time').value = k;
    $('clock').textContent = `${frames[k].time.toFixed(2)} s`;
    if (report.viewer) report.viewer.show(frames[k].nodes);
    report.charts.forEach((chart) => { chart.mark = frames[k].time; chart.draw(); });
  };
  $('time').max = frames.length - 1;
  $('time').addEventListener('input', () => show(Number($('time').value)));
  let playing = false, last = 0;
  $('play').addEventListener('click', () => {
    playing = !playing;
    $('play').setAttribute('aria-pressed', playing);
    $('play').textContent = playing ? 'Pause' : 'Play';
    if (playing && report.frame === frames.length - 1) show(0);
  });
  const tick = (now) => {
    requestAnimationFrame(tick);
    if (playing && now - last > 50) {
      last = now;
      if (report.frame + 1 < frames.length) show(report.frame + 1);
      else $('play').click();
    }
    if (report.viewer) report.viewer.draw();
  };
  const redraw = () => report.charts.forEach((chart) => chart.draw());
  addEventListener('resize', redraw);
  matchMedia('(prefers-color-scheme: dark)').addEventListener('change', redraw);
  show(frames.length - 1);
  requestAnimationFrame(tick);
}

// What the command printed at the end: the answer, which is its last line, and the lines before it.
function showClosing() {
  const lines = (data.closing || '').split('\n').map((line) => line.trim()).filter(Boolean).slice(1);  // the first is the page's title
  const answer = lines.length && !lines[lines.length - 1].includes('summary.json') ? lines.pop() : '';
  $('answer').textContent = answer;
  lines.filter((line) => !line.includes('summary.json')).forEach((line) => { const item = document.createElement('li'); item.textContent = line; $('closing').append(item); });
  $('said').hidden = !$('closing').children.length;
  $('verdicts').hidden = !answer;
  $('still').hidden = !report.still.length;
  $('still').firstChild.textContent = `0 throughout: ${report.still.join(', ')}.`;
}

// The runs by group of columns: the varied keys, then outcome or largest or last readings, or all. A band stands beside its value.
function showRuns(batch, group) {
  const table = $('rows'), isShown = (name) => !name.endsWith('_band') && (batch.groups[name] === 'varied' || name === 'run' || name === 'status' || group === 'all' || batch.groups[name] === group);
  const names = batch.columns.filter(isShown), scales = new Map(names.map((name) => [name, batch.groups[name] === 'varied' ? [1, batch.units[name]] : scaleOf(batch.units[name] || '', batch.runs().map((k) => batch.number(name, k)))]));
  table.replaceChildren();
  row(table, names.map((name) => batch.groups[name] === 'varied' ? name : titleOf(name, scales.get(name)[1])), 'th');
  for (const k of batch.runs())
    row(table, names.map((name) => {
      const value = batch.table[name][k], [factor] = scales.get(name), band = batch.number(`${name}_band`, k);
      return typeof value !== 'number' ? short(value) : band > 0 ? withBand(factor * value, factor * band) : short(factor * value);
    }));
}

function addTable(batch) {
  const groups = ['outcome', 'largest', 'last', 'effort', 'all'].filter((group) => group === 'all' || batch.columns.some((name) => batch.groups[name] === group));
  groups.forEach((group) => { const option = document.createElement('option'); option.value = option.textContent = group; $('groups').append(option); });
  $('groups').addEventListener('change', () => showRuns(batch, $('groups').value));
  showRuns(batch, groups[0]);
}

showSummary();
if (data.kind === 'run') { addCharts(); addPlayer(); showClosing(); } else {
  report.batch = new Batch(data);
  Object.assign(report, showBatch(report.batch));
  addTable(report.batch);
}
$('graphs').hidden = !$('graphs').children.length;
