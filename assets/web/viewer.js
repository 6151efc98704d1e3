// Vessel, instruments and contacts in three dimensions, and the same as a C-arm sees them. For the live page and for reports.
'use strict';

const css = (name) => getComputedStyle(document.documentElement).getPropertyValue(name).trim();

// The CSS variable of an instrument's colour: steel for one alone, a colour each for several.
const instrumentColour = (k, count) => count > 1 ? `--instrument-${k % 8 + 1}` : '--wire';

// Says which colour is which instrument; nothing where there is one alone.
function showLegend(list, names) {
  list.hidden = names.length < 2;
  const add = (text, colour, kind) => {
    const item = document.createElement('li'), swatch = document.createElement('i');
    swatch.style.background = `var(${colour})`;
    swatch.className = kind;
    item.append(swatch, text);
    list.append(item);
  };
  names.forEach((name, k) => add(name, instrumentColour(k, names.length), ''));
  add('contact', '--force', 'dot');
}

// Whether the browser draws on the processor, where smooth edges cost more than all the rest.
function softwareOnly() {
  const gl = document.createElement('canvas').getContext('webgl'), info = gl && gl.getExtension('WEBGL_debug_renderer_info');
  return Boolean(info) && /swiftshader|llvmpipe|software/i.test(gl.getParameter(info.UNMASKED_RENDERER_WEBGL));
}

// Fans over the openings, so that the lumen is a closed body for X-rays.
function withCaps(positions, indices) {
  const open = new Map();
  const count = positions.length / 3;
  const key = (a, b) => a * count + b;
  for (let t = 0; t < indices.length; t += 3)
    for (let k = 0; k < 3; ++k) {
      const a = indices[t + k], b = indices[t + (k + 1) % 3];
      if (!open.delete(key(b, a))) open.set(key(a, b), [a, b]);
    }
  const next = new Map();
  for (const [a, b] of open.values()) next.set(b, a);  // the cap runs the other way
  const points = Array.from(positions), faces = Array.from(indices);
  while (next.size) {
    const loop = [];
    for (let at = next.keys().next().value; next.has(at);) { const to = next.get(at); next.delete(at); loop.push(at); at = to; }
    if (loop.length < 3) continue;
    const centre = [0, 1, 2].map((c) => loop.reduce((sum, i) => sum + positions[3 * i + c], 0) / loop.length);
    const hub = points.length / 3;
    points.push(...centre);
    loop.forEach((a, k) => faces.push(a, loop[(k + 1) % loop.length], hub));
  }
  return [new Float32Array(points), new Uint32Array(faces)];
}

// A tube about a line of nodes, made anew for every frame in the same memory.
class Tube {
  constructor(most) {
    this.around = 6;
    this.geometry = new THREE.BufferGeometry();
    const make = (n) => { const a = new THREE.BufferAttribute(new Float32Array(n), 3); a.setUsage ? a.setUsage(THREE.DynamicDrawUsage) : (a.dynamic = true); return a; };
    for (const name of ['position', 'normal', 'color']) this.geometry.setAttribute(name, make(3 * most * this.around));
    const index = new Uint32Array(6 * (most - 1) * this.around);
    for (let i = 0, at = 0; i + 1 < most; ++i)
      for (let k = 0; k < this.around; ++k) {
        const a = i * this.around + k, b = i * this.around + (k + 1) % this.around, c = a + this.around, d = b + this.around;
        index.set([a, c, b, b, c, d], at);
        at += 6;
      }
    this.geometry.setIndex(new THREE.BufferAttribute(index, 1));
    this.most = most;
  }

  // nodes: Float32Array [n][x, y, z, force]; radius: of a node; tint(force) -> THREE.Color
  update(nodes, radius, tint) {
    const n = Math.min(this.most, nodes.length / 4), p = new THREE.Vector3(), t = new THREE.Vector3(), u = new THREE.Vector3(), v = new THREE.Vector3();
    const [position, normal, colour] = ['position', 'normal', 'color'].map((name) => this.geometry.attributes[name]);
    const at = (i, out) => out.set(nodes[4 * i], nodes[4 * i + 1], nodes[4 * i + 2]);
    const ahead = new THREE.Vector3(), behind = new THREE.Vector3();
    for (let i = 0; i < n; ++i) {
      at(i, p);
      t.copy(at(Math.min(n - 1, i + 1), ahead)).sub(at(Math.max(0, i - 1), behind)).normalize();
      if (i === 0) u.set(Math.abs(t.x) < 0.9 ? 1 : 0, Math.abs(t.x) < 0.9 ? 0 : 1, 0);
      u.addScaledVector(t, -u.dot(t)).normalize();
      v.crossVectors(t, u);
      const r = radius(p), c = tint(nodes[4 * i + 3]);
      for (let k = 0; k < this.around; ++k) {
        const a = 2 * Math.PI * k / this.around, s = Math.sin(a), o = Math.cos(a), j = i * this.around + k;
        const nx = o * u.x + s * v.x, ny = o * u.y + s * v.y, nz = o * u.z + s * v.z;
        normal.setXYZ(j, nx, ny, nz);
        position.setXYZ(j, p.x + r * nx, p.y + r * ny, p.z + r * nz);
        colour.setXYZ(j, c.r, c.g, c.b);
      }
    }
    this.geometry.setDrawRange(0, n > 1 ? 6 * (n - 1) * this.around : 0);
    for (const attribute of [position, normal, colour]) attribute.needsUpdate = true;
  }
}

class Viewer {
  // scene: {positions, indices, radii, head, front, target, most}
  constructor(canvas, scene) {
    this.canvas = canvas;
    // the wall has a canvas of its own behind the instruments', which is drawn when the eye moves: most frames draw wires alone
    this.back = document.createElement('canvas');
    this.back.className = 'back';
    canvas.before(this.back);
    const antialias = !softwareOnly();
    this.most = antialias ? 2 : 0.75;  // pixels drawn per pixel shown
    this.wallRenderer = new THREE.WebGLRenderer({ canvas: this.back, antialias, alpha: true });
    this.renderer = new THREE.WebGLRenderer({ canvas, antialias, alpha: true });
    this.scene = new THREE.Scene();
    this.wallScene = new THREE.Scene();
    this.camera = new THREE.PerspectiveCamera(32, 1, 0.001, 10);
    this.light = new THREE.DirectionalLight(0xffffff, 0.8);
    this.wallLight = this.light.clone();
    this.scene.add(new THREE.AmbientLight(0xffffff, 0.55), this.light);
    this.wallScene.add(new THREE.AmbientLight(0xffffff, 0.55), this.wallLight);
    this.radii = scene.radii;
    this.addVessel(scene);
    this.tubes = scene.radii.map(() => this.addTube(scene.most || 2048));
    this.addContacts();
    this.addTip();
    if (scene.target) this.addTarget(scene.target);
    this.aim(scene);
    this.listen();
    this.recolour();
    matchMedia('(prefers-color-scheme: dark)').addEventListener('change', () => this.recolour());
  }

  addVessel({ positions, indices }) {
    this.box = new THREE.Box3();
    this.walls = [];
    if (!indices.length) { this.box.set(new THREE.Vector3(-0.05, -0.05, -0.05), new THREE.Vector3(0.05, 0.05, 0.05)); return; }
    const geometry = new THREE.BufferGeometry();
    geometry.setAttribute('position', new THREE.BufferAttribute(positions, 3));
    geometry.setIndex(new THREE.BufferAttribute(indices, 1));
    geometry.computeVertexNormals();
    this.box.setFromBufferAttribute(geometry.attributes.position);
    // normals point into the lumen: what faces the eye is the far wall, seen from inside; what turns its back is the near one
    const wall = (side, opacity) => new THREE.Mesh(geometry, new THREE.MeshLambertMaterial({ side, transparent: true, opacity, depthWrite: false }));
    this.far = wall(THREE.FrontSide, 0.55);
    this.near = wall(THREE.BackSide, 0.16);
    this.near.visible = false;
    this.near.renderOrder = 1;
    this.walls = [this.far, this.near];
    this.wallScene.add(this.far, this.near);
  }

  addTube(most) {
    const tube = new Tube(most);
    // several are flat, so that each has the very colour that the legend gives it
    const Material = this.radii.length > 1 ? THREE.MeshBasicMaterial : THREE.MeshLambertMaterial;
    const mesh = new THREE.Mesh(tube.geometry, new Material({ vertexColors: THREE.VertexColors, side: THREE.DoubleSide }));
    mesh.frustumCulled = false;
    mesh.renderOrder = 1;
    this.scene.add(mesh);
    return tube;
  }

  addContacts() {
    const geometry = new THREE.BufferGeometry();
    for (const name of ['position', 'color']) geometry.setAttribute(name, new THREE.BufferAttribute(new Float32Array(3 * 4096), 3));
    this.contacts = new THREE.Points(geometry, new THREE.PointsMaterial({ size: 7, sizeAttenuation: false, vertexColors: THREE.VertexColors, depthTest: false }));
    this.contacts.frustumCulled = false;
    this.contacts.renderOrder = 2;
    this.scene.add(this.contacts);
  }

  // On a narrow screen the tip's bend is a few pixels long: the last centimetres again, larger, in a corner.
  addTip() {
    this.tip = { scene: new THREE.Scene(), camera: new THREE.PerspectiveCamera(32, 1, 0.001, 10), tube: new Tube(512), length: 0.04, frame: document.createElement('div'), corner: [true, true], at: new THREE.Vector3() };
    const mesh = new THREE.Mesh(this.tip.tube.geometry, new THREE.MeshLambertMaterial({ vertexColors: THREE.VertexColors, side: THREE.DoubleSide }));
    mesh.frustumCulled = false;
    this.tip.light = this.light.clone();
    this.tip.scene.add(new THREE.AmbientLight(0xffffff, 0.55), this.tip.light, mesh);
    this.tip.frame.className = 'tip-frame';
    this.tip.frame.textContent = `tip, ${100 * this.tip.length} cm`;
    this.tip.frame.hidden = true;
    this.canvas.after(this.tip.frame);
  }

  addTarget({ point, radius }) {
    this.target = new THREE.Mesh(new THREE.SphereGeometry(radius, 20, 14), new THREE.MeshBasicMaterial({ color: 0x2f9e44, wireframe: true, transparent: true, opacity: 0.5 }));
    this.target.position.set(...point);
    this.wallScene.add(this.target);
  }

  // From the front, head up.
  aim({ head, front }) {
    this.up = new THREE.Vector3(...(head || [0, 0, 1])).normalize();
    this.camera.up.copy(this.up);
    this.centre = this.box.getCenter(new THREE.Vector3());
    this.size = this.box.getSize(new THREE.Vector3()).length();
    const away = new THREE.Vector3(...(front || [0, -1, 0])).normalize();
    const side = new THREE.Vector3().crossVectors(this.up, away).normalize();
    this.basis = [side, new THREE.Vector3().crossVectors(side, this.up), this.up];  // right, front, head
    const corner = this.box.getSize(new THREE.Vector3()).multiplyScalar(0.5), half = (v) => Math.abs(v.x) * corner.x + Math.abs(v.y) * corner.y + Math.abs(v.z) * corner.z;
    this.spans = [half(side) + 0.25 * half(this.basis[1]), half(this.up)].map((s) => 1.15 * s);
    this.turn = 0.25;
    this.tilt = 0.12;
    this.distance = 1.75 * this.size;
    this.moved = true;
  }

  listen() {
    const held = new Map();
    let pinch = 0;
    const move = (event) => {
      if (!held.has(event.pointerId)) return;
      const [x, y, button] = held.get(event.pointerId);
      held.set(event.pointerId, [event.clientX, event.clientY, button]);
      if (held.size === 2) {
        const [a, b] = [...held.values()], gap = Math.hypot(a[0] - b[0], a[1] - b[1]);
        if (pinch) this.distance *= pinch / gap;
        pinch = gap;
      } else if (button === 2 || event.shiftKey) this.pan(event.clientX - x, event.clientY - y);
      else {
        this.turn -= 0.006 * (event.clientX - x);
        this.tilt = Math.max(-1.5, Math.min(1.5, this.tilt + 0.006 * (event.clientY - y)));
      }
      this.moved = true;
    };
    const end = (event) => { held.delete(event.pointerId); pinch = 0; };
    this.canvas.addEventListener('pointerdown', (event) => { held.set(event.pointerId, [event.clientX, event.clientY, event.button]); this.canvas.setPointerCapture(event.pointerId); });
    this.canvas.addEventListener('pointermove', move);
    this.canvas.addEventListener('pointerup', end);
    this.canvas.addEventListener('pointercancel', end);
    this.canvas.addEventListener('contextmenu', (event) => event.preventDefault());
    this.canvas.addEventListener('wheel', (event) => { event.preventDefault(); this.distance *= Math.exp(0.001 * event.deltaY); this.moved = true; }, { passive: false });
  }

  pan(dx, dy) {
    const scale = this.distance * 0.57 / this.canvas.clientHeight;
    const right = new THREE.Vector3().setFromMatrixColumn(this.camera.matrix, 0), up = new THREE.Vector3().setFromMatrixColumn(this.camera.matrix, 1);
    this.centre.addScaledVector(right, -scale * dx).addScaledVector(up, scale * dy);
  }

  recolour() {
    this.walls.forEach((wall) => wall.material.color.set(css('--wall')));
    this.steel = this.radii.map((_, k) => new THREE.Color(css(instrumentColour(k, this.radii.length))));
    this.hot = new THREE.Color(css('--force'));
    this.moved = true;
    if (this.shown) this.show(this.shown);
  }

  // instruments: Float32Arrays [n][x, y, z, force], tip first
  show(instruments) {
    this.shown = instruments;
    const pixel = this.distance * 0.57 / Math.max(1, this.canvas.clientHeight), colour = new THREE.Color();
    const tint = (k) => (force) => colour.copy(this.steel[k]).lerp(this.hot, Math.min(1, Math.sqrt(force / 0.2)));
    const [position, colours] = [this.contacts.geometry.attributes.position, this.contacts.geometry.attributes.color];
    let points = 0;
    instruments.forEach((nodes, k) => {
      // where they are too thin to be seen, one inside another stays the thinner
      const radius = Math.max(this.radii[k], (1.6 + 0.9 * this.radii.filter((r) => r < this.radii[k]).length) * pixel), own = tint(k);
      this.tubes[k].update(nodes, () => radius, own);
      for (let i = 0; i < nodes.length && points < 4096; i += 4) {
        if (nodes[i + 3] < 2e-3) continue;
        position.setXYZ(points, nodes[i], nodes[i + 1], nodes[i + 2]);
        own(nodes[i + 3]);
        colours.setXYZ(points++, colour.r, colour.g, colour.b);
      }
    });
    this.contacts.geometry.setDrawRange(0, points);
    position.needsUpdate = colours.needsUpdate = true;
    if (this.narrow()) this.showTip(instruments[0], tint(0));
    this.changed = true;
  }

  narrow() { return this.canvas.clientWidth < 500; }

  // The wire's own shape: seen across the plane that its end bends in, as far as that is known.
  showTip(nodes, own) {
    let end = 4, way = 0;
    for (; end < nodes.length && way < this.tip.length; end += 4) way += Math.hypot(nodes[end] - nodes[end - 4], nodes[end + 1] - nodes[end - 3], nodes[end + 2] - nodes[end - 2]);
    const at = (i) => new THREE.Vector3(nodes[i], nodes[i + 1], nodes[i + 2]), first = at(0), last = at(end - 4), chord = first.clone().sub(last);
    const across = new THREE.Vector3();
    let most = 0;
    for (let i = 4; i + 4 < end; i += 4) {
      const off = new THREE.Vector3().crossVectors(at(i).sub(last), chord);
      if (off.lengthSq() > most) { most = off.lengthSq(); across.copy(off); }
    }
    // straight: as the large picture sees it
    const eye = this.camera.position.clone().sub(this.centre).normalize();
    if (most <= (1e-3 * chord.lengthSq()) ** 2) across.copy(eye);
    if (across.dot(eye) < 0) across.negate();
    const middle = first.clone().add(last).multiplyScalar(0.5), { camera, light } = this.tip;
    camera.up.copy(chord.lengthSq() > 0 ? chord.normalize() : this.up);
    camera.position.copy(middle).addScaledVector(across.normalize(), 0.62 * this.tip.length / Math.tan(16 * Math.PI / 180));
    camera.near = 0.1 * this.tip.length;
    camera.far = 20 * this.tip.length;
    camera.updateProjectionMatrix();
    camera.lookAt(middle);
    light.position.copy(camera.position);
    this.tip.tube.update(nodes.subarray(0, end), () => Math.max(this.radii[0], 0.012 * this.tip.length), own);
    this.tip.at.copy(first);
    this.tip.shown = true;
  }

  // Over the large picture, in a corner; in the farthest one from the tip as soon as the tip would lie under it.
  drawTip(w, h) {
    const side = Math.round(Math.min(0.4 * w, 0.4 * h)), gap = 8, r = this.renderer, seen = this.tip.at.clone().project(this.camera);
    const x = 0.5 * w * (1 + seen.x), y = 0.5 * h * (1 + seen.y);
    const place = () => this.tip.corner.map((far, d) => far ? (d ? h : w) - side - gap : gap);
    const [left, bottom] = place();
    if (x > left - gap && x < left + side + gap && y > bottom - gap && y < bottom + side + gap) this.tip.corner = [x < 0.5 * w, y < 0.5 * h];
    const [cornerX, cornerY] = place();
    Object.assign(this.tip.frame.style, { width: `${side}px`, height: `${side}px`, left: `${cornerX}px`, bottom: `${cornerY}px` });
    r.setScissorTest(true);
    r.setScissor(cornerX, cornerY, side, side);
    r.setViewport(cornerX, cornerY, side, side);
    r.setClearColor(new THREE.Color(css('--card')), 0.9);
    r.clear();
    r.setClearAlpha(0);
    r.autoClear = false;
    r.render(this.tip.scene, this.tip.camera);
    r.autoClear = true;
    r.setScissorTest(false);
    r.setViewport(0, 0, w, h);
  }

  draw() {
    const w = this.canvas.clientWidth, h = this.canvas.clientHeight, ratio = Math.min(this.most, window.devicePixelRatio || 1);
    if (this.canvas.width !== Math.round(w * ratio) || this.canvas.height !== Math.round(h * ratio)) {
      for (const renderer of [this.renderer, this.wallRenderer]) {
        renderer.setPixelRatio(ratio);
        renderer.setSize(w, h, false);
      }
      this.camera.aspect = w / Math.max(1, h);
      this.moved = true;
    }
    if (!this.changed && !this.moved) return false;
    this.changed = false;
    if (this.moved) this.look();
    this.renderer.render(this.scene, this.camera);
    this.tip.frame.hidden = !this.narrow() || !this.tip.shown;
    if (!this.tip.frame.hidden) this.drawTip(w, h);
    return true;
  }

  // The eye has moved: the camera, and the wall as it sees it.
  look() {
    this.moved = false;
    const [side, front, up] = this.basis, flat = Math.cos(this.tilt);
    // on a narrow screen as near as the vessel, seen from the front, allows
    const fit = this.camera.aspect > 1.1 ? 1 : Math.min(1.1 / this.camera.aspect, Math.max(this.spans[1], this.spans[0] / this.camera.aspect) / (0.5 * this.size));
    const away = new THREE.Vector3().addScaledVector(side, Math.sin(this.turn) * flat).addScaledVector(front, Math.cos(this.turn) * flat).addScaledVector(up, Math.sin(this.tilt));
    this.camera.position.copy(this.centre).addScaledVector(away, this.distance * fit);
    this.camera.near = 0.02 * this.distance;
    this.camera.far = 20 * this.distance;
    this.camera.updateProjectionMatrix();
    this.camera.lookAt(this.centre);
    this.light.position.copy(this.camera.position).addScaledVector(this.up, this.size);
    this.wallLight.position.copy(this.light.position);
    this.wallRenderer.render(this.wallScene, this.camera);
  }
}

// What a C-arm shows: exp(-sum of mu L), L by back faces less front faces of closed bodies, in half floats. The lumen shows where
// contrast is in it. The vessel's part is kept until the arm moves.
class Fluoroscope {
  constructor(canvas, scene) {
    this.canvas = canvas;
    const context = canvas.getContext('webgl2', { alpha: false });
    if (!context || !context.getExtension('EXT_color_buffer_float')) throw new Error('WebGL 2 with float targets is needed for fluoroscopy');
    this.renderer = new THREE.WebGLRenderer({ canvas, context });
    this.renderer.autoClear = false;
    this.renderer.setSize(canvas.width, canvas.height, false);
    this.camera = new THREE.PerspectiveCamera(1, 1, 0.1, 3);
    const target = () => new THREE.WebGLRenderTarget(canvas.width, canvas.height, { type: THREE.HalfFloatType, format: THREE.RGBAFormat, minFilter: THREE.NearestFilter, magFilter: THREE.NearestFilter, depthBuffer: false });
    this.lumen = target();
    this.metal = target();
    this.lao = this.cra = 0;
    this.contrast = 0;
    this.moved = true;
    this.addBodies(scene);
    this.addScreen();
  }

  // Side of the picture [pixels].
  resize(side) {
    if (this.canvas.width === side) return;
    this.renderer.setSize(side, side, false);
    for (const target of [this.lumen, this.metal]) target.setSize(side, side);
    this.moved = true;
  }

  // mu [1/m]; which way a body's faces look shows in the sign of the sum, which is left aside
  material(mu) {
    return new THREE.ShaderMaterial({
      uniforms: { mu: { value: mu }, middle: { value: 0.8 } },
      vertexShader: 'varying vec3 at; void main() { vec4 p = modelViewMatrix * vec4(position, 1.0); at = p.xyz; gl_Position = projectionMatrix * p; }',
      fragmentShader: 'uniform float mu; uniform float middle; varying vec3 at; void main() { float d = length(at) - middle; gl_FragColor = vec4(mu * (gl_FrontFacing ? -d : d), 0.0, 0.0, 1.0); }',
      side: THREE.DoubleSide, depthTest: false, depthWrite: false, transparent: true,
      blending: THREE.CustomBlending, blendEquation: THREE.AddEquation, blendSrc: THREE.OneFactor, blendDst: THREE.OneFactor,
    });
  }

  addBodies({ positions, indices, radii, head, front, most }) {
    this.vessel = new THREE.Scene();
    this.wires = new THREE.Scene();
    const box = new THREE.Box3();
    if (indices.length) {
      const [points, faces] = withCaps(positions, indices), geometry = new THREE.BufferGeometry();
      geometry.setAttribute('position', new THREE.BufferAttribute(points, 3));
      geometry.setIndex(new THREE.BufferAttribute(faces, 1));
      box.setFromBufferAttribute(geometry.attributes.position);
      this.vessel.add(new THREE.Mesh(geometry, this.material(38)));  // blood with iodine less blood at 60 keV
    } else box.set(new THREE.Vector3(-0.05, -0.05, -0.05), new THREE.Vector3(0.05, 0.05, 0.05));
    this.radii = radii;
    this.tubes = radii.map(() => new Tube(most || 2048));
    this.tubes.forEach((tube) => { const mesh = new THREE.Mesh(tube.geometry, this.material(947)); mesh.frustumCulled = false; this.wires.add(mesh); });
    this.isocentre = box.getCenter(new THREE.Vector3());
    this.field = Math.max(0.05, 0.78 * box.getSize(new THREE.Vector3()).length());
    this.up = new THREE.Vector3(...(head || [0, 0, 1])).normalize();
    this.front = new THREE.Vector3(...(front || [0, -1, 0])).normalize();
  }

  addScreen() {
    this.screen = new THREE.Scene();
    this.exposure = new THREE.ShaderMaterial({
      uniforms: { lumen: { value: this.lumen.texture }, metal: { value: this.metal.texture }, contrast: { value: 0 }, seed: { value: 0 } },
      vertexShader: 'varying vec2 uv2; void main() { uv2 = 0.5 * position.xy + 0.5; gl_Position = vec4(position.xy, 0.0, 1.0); }',
      fragmentShader: `uniform sampler2D lumen; uniform sampler2D metal; uniform float contrast; uniform float seed; varying vec2 uv2;
        float noise(vec2 p) { return fract(sin(dot(p, vec2(12.9898, 78.233)) + seed) * 43758.5453) - 0.5; }
        void main() {
          vec2 c = uv2 - 0.5;
          float body = 0.55 + 0.9 * smoothstep(0.62, 0.1, length(c * vec2(1.0, 0.75)));
          float sum = abs(texture2D(metal, uv2).r) + contrast * abs(texture2D(lumen, uv2).r);
          float dose = exp(-sum - 0.35 * body);
          float grey = 0.92 * dose + 0.06 * sqrt(dose) * noise(gl_FragCoord.xy);
          gl_FragColor = vec4(vec3(grey) * step(length(c), 0.5), 1.0);
        }`,
      depthTest: false, depthWrite: false,
    });
    this.screen.add(new THREE.Mesh(new THREE.PlaneBufferGeometry(2, 2), this.exposure));
    this.flat = new THREE.OrthographicCamera(-1, 1, 1, -1, 0, 1);
  }

  // Source behind the patient, detector before; the picture as one looks at the patient, so mirrored from the source's.
  aim(lao, cra) {
    this.lao = lao;
    this.cra = cra;
    const left = new THREE.Vector3().crossVectors(this.up, this.front);
    const a = lao * Math.PI / 180, b = cra * Math.PI / 180;
    const out = new THREE.Vector3().addScaledVector(this.front, Math.cos(a) * Math.cos(b)).addScaledVector(left, Math.sin(a) * Math.cos(b)).addScaledVector(this.up, Math.sin(b));
    this.camera.up.copy(this.up);
    this.camera.position.copy(this.isocentre).addScaledVector(out, -0.8);
    this.camera.lookAt(this.isocentre);
    this.camera.fov = 2 * Math.atan(0.5 * this.field / 0.8) * 180 / Math.PI;
    this.camera.updateProjectionMatrix();
    this.camera.projectionMatrix.elements[0] *= -1;
    this.camera.projectionMatrixInverse.getInverse(this.camera.projectionMatrix);
    this.moved = true;
  }

  // Nothing has been exposed yet.
  blank() {
    this.exposed = false;
    this.renderer.setRenderTarget(null);
    this.renderer.setClearColor(0x000000, 1);
    this.renderer.clear();
  }

  show(instruments) {
    this.exposed = true;
    const half = 0.35 * this.field / this.canvas.width, white = new THREE.Color(1, 1, 1);
    instruments.forEach((nodes, k) => this.tubes[k].update(nodes, () => Math.max(this.radii[k], half), () => white));
  }

  draw() {
    if (!this.exposed) { this.blank(); return; }
    const r = this.renderer;
    r.setClearColor(0x000000, 0);
    if (this.moved) {
      r.setRenderTarget(this.lumen);
      r.clear();
      r.render(this.vessel, this.camera);
      this.moved = false;
    }
    r.setRenderTarget(this.metal);
    r.clear();
    r.render(this.wires, this.camera);
    r.setRenderTarget(null);
    this.exposure.uniforms.contrast.value = this.contrast;
    this.exposure.uniforms.seed.value = Math.random() * 100;
    r.render(this.screen, this.flat);
  }
}

const noPicture = 'This browser shows no WebGL, so there is no picture; forces, task and controls work.';

// Viewer or, where there is no WebGL, its message in its place.
function makeViewer(canvas, scene, message) {
  try {
    return new Viewer(canvas, scene);
  } catch (error) {
    message.textContent = noPicture;
    message.hidden = false;
    return null;
  }
}
