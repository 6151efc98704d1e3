// The live page: frames in, wishes out, and everything around the picture.
'use strict';

const $ = (id) => document.getElementById(id);
const state = { scene: null, viewer: null, fluoroscope: null, last: null, frames: 0, drawn: 0, fps: 0, instrument: 0, wish: { push: 0, turn: 0 }, keys: new Set(), pad: null, socket: null, fluoro: false, contrast: 0, old: null, exam: false, seen: false, attempts: [] };
window.seldinger = state;  // for tests

const speeds = { push: 0.03, turn: 3, fast: 3 };  // [m/s], [rad/s]

function message(text) {
  $('message').textContent = text || '';
  $('message').hidden = !text;
}

// ---- frames ----

function readFrame(buffer) {
  const view = new DataView(buffer), length = view.getUint32(0, true);
  const numbers = JSON.parse(new TextDecoder().decode(new Uint8Array(buffer, 4, length)));
  const nodes = [];
  let at = 4 + length;
  for (let k = 0; k < numbers.instruments.length; ++k) {
    const count = view.getUint32(at, true);
    nodes.push(new Float32Array(buffer, at + 4, 4 * count));
    at += 4 + 16 * count;
  }
  return { numbers, nodes };
}

function take(frame) {
  ++state.frames;
  state.last = frame;
  const n = frame.numbers, own = n.instruments[state.instrument] || n.instruments[0];
  keepAttempt(n);
  state.forces.add(n.time, [own.force, own.wire_force, own.wall]);
  state.torques.add(n.time, [1e3 * own.torque]);
  state.fluoro = n.fluoro;
  $('fluoro').setAttribute('aria-pressed', n.fluoro);
  $('pause').setAttribute('aria-pressed', n.paused);
  message(n.stopped ? 'The last step found no state: reset to go on.' : n.paused ? 'Paused' : state.viewer ? '' : noPicture);
  state.dirty = true;
}

// A reset ends an attempt. Seen: the vessel was in view during it.
function keepAttempt(n) {
  const old = state.attempt;
  if (old && n.resets !== old.resets) {
    if (old.score.time > 0) state.attempts.push({ ...old.score, seen: state.seen });
    state.seen = false;
    state.forces.clear(), state.torques.clear();
    if (state.fluoroscope) state.fluoroscope.blank();
    showAttempts();
  }
  if (!state.exam && n.score.time > 0) state.seen = true;
  state.attempt = n;
}

const verdictOf = (s) => s.failed ? 'failed' : s.reached ? 'passed' : s.distance < 0 ? 'ended' : 'not reached';

function showAttempts() {
  $('attempts').hidden = !state.attempts.length;
  $('attempts').replaceChildren(...state.attempts.map((s) => {
    const item = document.createElement('li');
    item.textContent = `${verdictOf(s)}, ${s.time.toFixed(1)} s, peak ${newtons(s.wall_max)} N${s.seen ? '' : ', exam'}`;
    return item;
  }));
  $('attempts').scrollTop = $('attempts').scrollHeight;
}

function connect() {
  const socket = new WebSocket(`${location.protocol === 'https:' ? 'wss' : 'ws'}://${location.host}/ws${location.search}`);
  state.socket = socket;
  socket.binaryType = 'arraybuffer';
  socket.onmessage = (event) => take(readFrame(event.data));
  socket.onclose = () => {
    state.old = null;
    pace('not connected', 'bad');
    setTimeout(connect, 1000);
  };
}

function send(wish) {
  if (state.socket && state.socket.readyState === WebSocket.OPEN) state.socket.send(JSON.stringify(wish));
}

// ---- what is shown ----

function pace(text, kind) {
  const pill = $('pace');
  if (pill.textContent !== text) pill.textContent = text;
  pill.className = `pill ${kind}`;
}

// Once a second: session time against the clock, late steps, frames drawn.
function watchPace() {
  state.fps = state.drawn;
  state.drawn = 0;
  const frame = state.last;
  if (!frame || state.socket.readyState !== WebSocket.OPEN) return;
  const n = frame.numbers, old = state.old;
  state.old = n;
  if (!old || n.paused || n.stopped || n.clock <= old.clock) return;
  const share = (n.time - old.time) / (n.clock - old.clock), late = (n.late - old.late) / Math.max(1, n.step - old.step);
  const cut = (n.cut_short - old.cut_short) / Math.max(1, n.step - old.step);
  if (share > 0.99) pace(`real time, ${(100 * late).toFixed(1)} % late${cut > 0 ? `, ${(100 * cut).toFixed(1)} % cut short` : ''}`, 'good');
  else pace(`time stretched: ${share.toFixed(2)} of real time`, 'bad');
}

const calm = (value, digits) => (Math.abs(value) < 0.5 / 10 ** digits ? 0 : value).toFixed(digits);  // no minus before a zero
const newtons = (value) => calm(value, 3);  // one unit on the whole page, the charts' too

function row(table, what, value, over) {
  const tr = table.insertRow();
  const th = document.createElement('th');
  th.textContent = what;
  tr.append(th);
  tr.insertCell().textContent = value;
  if (over) tr.className = 'over';
}

function reasonOf(s, limits) {
  if (limits.time && s.time > limits.time) return `longer than ${limits.time} s`;
  if (limits.fluoroscopy && s.fluoroscopy > limits.fluoroscopy) return `more than ${limits.fluoroscopy} s of fluoroscopy`;
  return limits.patch_force && s.patch_max > limits.patch_force ? `more than ${limits.patch_force} N on one patch` : `more than ${limits.wall_force} N on the wall`;
}

function showSheet(n) {
  const s = n.score, limits = state.scene.limits, table = document.createElement('table');
  table.id = 'sheet';
  const most = (value, limit, unit) => `${value} ${unit}${limit ? ` of ${limit}` : ''}`;
  row(table, 'Time', most(s.time.toFixed(1), limits.time, 's'), limits.time && s.time > limits.time);
  // one short row for the tip: the sheet fits on 1280 x 720
  if (s.distance >= 0) row(table, 'To the target', s.reached ? 'reached' : `${(1e3 * s.distance).toFixed(0)} mm`);
  else if (n.branch >= 0 && state.scene.branches.length > 1) row(table, 'Tip in', `${state.scene.branches[n.branch]}, ${(1e3 * n.branch_depth).toFixed(0)} mm`);
  row(table, 'Wall force', most(newtons(s.wall), limits.wall_force, 'N'), limits.wall_force && s.wall > limits.wall_force);
  row(table, 'its peak, mean', `${newtons(s.wall_max)}, ${newtons(s.wall_mean)} N`, limits.wall_force && s.wall_max > limits.wall_force);
  row(table, `On ${1e3 * limits.patch} mm of wall`, most(newtons(s.patch), limits.patch_force, 'N'), limits.patch_force && s.patch > limits.patch_force);
  row(table, 'its peak', `${newtons(s.patch_max)} N`, limits.patch_force && s.patch_max > limits.patch_force);
  row(table, 'Time above the limit', `${s.above.toFixed(2)} s`, s.above > 0);
  row(table, 'Path of the tip', `${(100 * s.path).toFixed(1)} cm`);
  row(table, 'Pushed', `${(100 * s.advanced).toFixed(1)} cm, ${s.pushes} strokes`);
  row(table, 'Pulled back', `${(100 * s.back).toFixed(1)} cm, ${s.backs} strokes`);
  row(table, 'Fluoroscopy', most(s.fluoroscopy.toFixed(1), limits.fluoroscopy, 's'), limits.fluoroscopy && s.fluoroscopy > limits.fluoroscopy);
  row(table, 'Contrast', `${s.contrast.toFixed(1)} ml`);
  $('sheet').replaceWith(table);
  const verdict = s.failed ? 'failed' : s.reached ? 'passed' : '';
  $('verdict').textContent = verdict === 'failed' ? `Task: failed, ${reasonOf(s, limits)}` : verdict ? `Task: ${verdict}` : 'Task';
  $('verdict').className = verdict;
  const it = n.instruments[state.instrument] || n.instruments[0];
  const count = state.scene.instruments.length, name = state.scene.instruments[state.instrument]?.name || 'Instrument';
  if (count > 1) $('instrument').style.borderLeft = `0.5em solid var(${instrumentColour(state.instrument, count)})`;
  $('instrument').textContent = `${name}${count > 1 ? ` (${state.instrument + 1} of ${count})` : ''}: ${(100 * it.advance).toFixed(1)} cm in, turned ${calm(it.turn / 2 / Math.PI, 2)} rev, ${newtons(it.force)} N, ${it.contacts} contacts`;
  $('watchers').hidden = n.clients < 2;
  $('watchers').textContent = `${n.clients} watch`;
}

// Contrast comes with the pedal and washes out.
function washContrast(n) {
  const now = performance.now(), passed = Math.min(0.2, (now - (state.washed || now)) / 1000);
  state.washed = now;
  state.contrast = n.contrast ? Math.min(1, state.contrast + 2 * passed) : state.contrast * Math.exp(-passed / 1.5);
  if (state.contrast < 0.01) state.contrast = 0;
}

// Pulses, as a C-arm's: twelve a second while the pedal is down; else the last picture stays, but for the arm's moves.
let lastPulse = 0;
function exposed(n) {
  if (!n.fluoro && !state.fluoroscope.moved) return false;
  const now = performance.now();
  if (now - lastPulse < 80) return false;
  lastPulse = now;
  return true;
}

let sheetDrawn = 0;
function draw() {
  requestAnimationFrame(draw);
  const frame = state.last;
  if (frame && state.dirty) {
    state.dirty = false;
    if (state.viewer) state.viewer.show(frame.nodes);
    washContrast(frame.numbers);
    if (state.fluoroscope && exposed(frame.numbers)) {
      if (frame.numbers.fluoro) {
        state.fluoroscope.contrast = state.contrast;
        state.fluoroscope.show(frame.nodes);
      }
      state.fluoroscope.draw();
    }
    if (performance.now() - sheetDrawn > 150) {
      sheetDrawn = performance.now();
      showSheet(frame.numbers);
      state.forces.draw();
      state.torques.draw();
    }
  }
  if (state.viewer && state.viewer.draw()) ++state.drawn;
}

// ---- the hand ----

function wish() {
  const keys = state.keys, fast = keys.has('Shift') ? speeds.fast : 1;
  let push = ((keys.has('ArrowUp') ? 1 : 0) - (keys.has('ArrowDown') ? 1 : 0)) * speeds.push * fast;
  let turn = ((keys.has('ArrowRight') ? 1 : 0) - (keys.has('ArrowLeft') ? 1 : 0)) * speeds.turn * fast;
  if (state.pad) { push += state.pad.push; turn += state.pad.turn; }
  return { push: Math.max(-0.2, Math.min(0.2, push)), turn: Math.max(-20, Math.min(20, turn)) };
}

// Said again while it lasts: a page that falls silent pushes no more.
let said = { push: 0, turn: 0 }, saidAt = 0;
function sayWish() {
  const now = wish();
  if (now.push === 0 && now.turn === 0 && said.push === 0 && said.turn === 0) return;
  said = now;
  saidAt = performance.now();
  send({ instrument: state.instrument, ...now });
}

function act(what) {
  const pressed = (id) => $(id).getAttribute('aria-pressed') === 'true';
  if (what === 'pause') send({ pause: !pressed('pause') });
  if (what === 'fluoro') send({ fluoro: !state.fluoro });
  if (what === 'reset') send({ reset: true });
  if (what === 'contrast') send({ contrast: true });
  if (what === 'no contrast') send({ contrast: false });
  if (what === 'exam') setExam(!state.exam);
  if (what === 'near' && state.viewer && state.viewer.near) {
    state.viewer.near.visible = !state.viewer.near.visible;
    state.viewer.moved = true;
    $('near').setAttribute('aria-pressed', state.viewer.near.visible);
  }
}

// As in the room: what can be seen of the vessel is its X-ray. A new attempt, since what was seen cannot be unseen.
function setExam(on) {
  if (on && !state.fluoroscope) { message('An exam needs the X-ray, which this browser does not draw.'); return; }
  state.exam = on;
  document.body.classList.toggle('exam', on);
  $('exam').setAttribute('aria-pressed', on);
  if (on) $('scene').append($('xray'));
  else document.querySelector('.column.side').prepend($('xray'));
  state.fluoroscope.resize(on ? 900 : 360);
  state.fluoroscope.moved = state.dirty = true;
  if (state.viewer) state.viewer.moved = true;
  if (on) act('reset');
}

const actions = { ' ': 'pause', f: 'fluoro', r: 'reset', c: 'contrast', w: 'near', e: 'exam' };

function nextInstrument() {
  state.instrument = (state.instrument + 1) % state.scene.instruments.length;
  state.dirty = true;
}

function listenToKeys() {
  const typing = (event) => event.target instanceof HTMLInputElement || (event.target instanceof HTMLButtonElement && (event.key === ' ' || event.key === 'Enter'));
  addEventListener('keydown', (event) => {
    if (typing(event) || event.ctrlKey || event.metaKey || event.altKey) return;
    const key = event.key.length === 1 ? event.key.toLowerCase() : event.key;
    if (key === 'Tab' && event.target === $('view') && state.scene.instruments.length > 1) {
      nextInstrument();
    } else if (key.startsWith('Arrow') || key === 'Shift') state.keys.add(key);
    else if (actions[key]) { if (!event.repeat) act(actions[key]); }
    else return;
    if (key !== 'Shift') event.preventDefault();
    sayWish();
  });
  addEventListener('keyup', (event) => {
    const key = event.key.length === 1 ? event.key.toLowerCase() : event.key;
    if (key === 'c') act('no contrast');
    state.keys.delete(key);
    sayWish();
  });
  addEventListener('blur', () => { state.keys.clear(); state.pad = null; sayWish(); });
}

function listenToPad() {
  const pad = $('pad');
  let from = null;
  const end = () => { from = null; state.pad = null; pad.classList.remove('held'); sayWish(); };
  pad.addEventListener('pointerdown', (event) => { from = [event.clientX, event.clientY]; pad.setPointerCapture(event.pointerId); pad.classList.add('held'); });
  pad.addEventListener('pointermove', (event) => {
    if (!from) return;
    state.pad = { push: (from[1] - event.clientY) / 60 * speeds.push, turn: (event.clientX - from[0]) / 60 * speeds.turn };
    if (performance.now() - saidAt > 30) sayWish();  // a finger is reported up to 120 times a second, as often as the server listens
  });
  pad.addEventListener('pointerup', end);
  pad.addEventListener('pointercancel', end);
}

function listenToButtons() {
  for (const id of ['pause', 'reset', 'fluoro', 'near', 'exam']) $(id).addEventListener('click', () => act(id));
  if (state.scene.instruments.length > 1) {  // a finger has no Tab
    $('instrument').setAttribute('role', 'button');
    $('instrument').title = 'the next instrument (Tab)';
    $('instrument').tabIndex = 0;
    $('instrument').addEventListener('click', nextInstrument);
    $('instrument').addEventListener('keydown', (event) => { if (event.key === 'Enter') nextInstrument(); });
  }
  $('contrast').addEventListener('pointerdown', () => act('contrast'));
  for (const event of ['pointerup', 'pointerleave', 'pointercancel']) $('contrast').addEventListener(event, () => act('no contrast'));
  for (const id of ['lao', 'cra'])
    $(id).addEventListener('input', () => {
      $(`${id}-value`).textContent = `${$(id).value}°`;
      if (state.fluoroscope) state.fluoroscope.aim(Number($('lao').value), Number($('cra').value));
      state.dirty = true;
    });
}

// ---- start ----

function readMesh(buffer) {
  const [vertices, triangles] = new Uint32Array(buffer, 0, 2);
  return { positions: new Float32Array(buffer, 8, 3 * vertices), indices: new Uint32Array(buffer, 8 + 12 * vertices, 3 * triangles) };
}

async function start() {
  const get = async (path) => { const answer = await fetch(path + location.search); if (!answer.ok) throw new Error(await answer.text()); return answer; };
  state.scene = await (await get('scene.json')).json();
  const mesh = readMesh(await (await get('mesh.bin')).arrayBuffer());
  document.title = state.scene.name;
  $('name').textContent = state.scene.name;
  $('task-text').textContent = state.scene.task;
  const shown = { ...mesh, radii: state.scene.instruments.map((it) => it.radius), head: state.scene.head, front: state.scene.front, target: state.scene.target, most: 4096 };
  state.forces = new Chart($('forces'), 'Force', 'N', [{ label: 'hand', colour: '--accent' }, { label: 'wire', colour: '--faint' }, { label: 'wall', colour: '--force' }], 0.02, 15, true);
  state.torques = new Chart($('torques'), 'Torque', 'mN m', [{ label: 'hand', colour: '--accent' }], 0.01, 15, true);
  state.viewer = makeViewer($('view'), shown, $('message'));
  if (state.viewer) showLegend($('legend'), state.scene.instruments.map((it) => it.name));
  try {
    if (state.viewer) {
      state.fluoroscope = new Fluoroscope($('fluoroscope'), shown);
      state.fluoroscope.aim(0, 0);
    }
  } catch (error) {
    $('xray').hidden = true;
  }
  listenToKeys();
  listenToPad();
  listenToButtons();
  $('view').focus();
  setInterval(sayWish, 100);
  setInterval(watchPace, 1000);
  connect();
  draw();
}

start().catch((error) => message(error.message));
