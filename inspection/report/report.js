'use strict';
// Reads the data that the page carries, draws the scene, the plots and the tables. three.js is on the page before this.

const data = JSON.parse(document.getElementById('data').textContent);
const result = data.result;
const byId = id => document.getElementById(id);
const SVG = 'http://www.w3.org/2000/svg';

// ---- small helpers -------------------------------------------------------------------------------------------------

const isNumber = x => typeof x === 'number' && isFinite(x);
const mm = (x, digits = 4) => isNumber(x) ? x.toFixed(digits) : '\u2013';
const short = x => isNumber(x) ? Number(x.toPrecision(3)).toString() : '\u2013';
const scaled = (k, x) => isNumber(x) ? mm(k * x) : '\u2013';
const percent = x => isNumber(x) ? x.toFixed(1) + ' %' : '\u2013';

function element(tag, attributes = {}, ...children) {
  const node = document.createElement(tag);
  for (const [key, value] of Object.entries(attributes)) {
    if (key === 'on') for (const [event, handler] of Object.entries(value)) node.addEventListener(event, handler);
    else node.setAttribute(key, value);
  }
  node.append(...children);
  return node;
}
function drawing(tag, attributes = {}, text = '') {
  const node = document.createElementNS(SVG, tag);
  for (const [key, value] of Object.entries(attributes)) node.setAttribute(key, value);
  node.textContent = text;
  return node;
}
// Rows are lists of cells: a text, or {text, kind}; the first `words` columns are aligned as text.
function table(headings, rows, words = 1, rowAttributes = () => ({})) {
  const cell = (tag, content, column) => {
    const text = content && content.text !== undefined ? content.text : content;
    const kind = content && content.kind ? content.kind : '';
    return element(tag, {class: (column < words ? 'text ' : '') + kind}, String(text));
  };
  return element('table', {},
    element('thead', {}, element('tr', {}, ...headings.map((h, c) => cell('th', h, c)))),
    element('tbody', {}, ...rows.map((row, r) => element('tr', rowAttributes(r), ...row.map((x, c) => cell('td', x, c))))));
}
function bytes(text) {
  const binary = atob(text), array = new Uint8Array(binary.length);
  for (let i = 0; i < binary.length; ++i) array[i] = binary.charCodeAt(i);
  return array.buffer;
}
const escaped = text => element('span', {}, text).innerHTML;

// ---- data ------------------------------------------------------------------------------------------------------------

function matrixOf(pose) {
  const [w, x, y, z] = pose.rotation_wxyz;
  return new THREE.Matrix4().compose(new THREE.Vector3(...pose.translation_mm), new THREE.Quaternion(x, y, z, w), new THREE.Vector3(1, 1, 1));
}
// What a view's points are at the pose of all views together: the rigid motion from its own pose to that.
function atJointPose(cloud, position) {
  if (!cloud.deviation_together || !result.joint) return null;
  const view = result.views.find(v => v.view === cloud.view);
  const motion = matrixOf(result.joint.pose).multiply(new THREE.Matrix4().getInverse(matrixOf(view.pose)));
  const moved = new Float32Array(position.length), at = new THREE.Vector3();
  for (let i = 0; i < position.length; i += 3) at.fromArray(position, i).applyMatrix4(motion).toArray(moved, i);
  return {position: moved, deviation: new Float32Array(bytes(cloud.deviation_together)), outlier: new Uint8Array(bytes(cloud.outlier_together))};
}
const clouds = data.clouds.map(cloud => {
  const alone = {position: new Float32Array(bytes(cloud.position)), deviation: new Float32Array(bytes(cloud.deviation)), outlier: new Uint8Array(bytes(cloud.outlier))};
  return Object.assign({
    view: cloud.view, toCamera: cloud.to_camera, up: cloud.up, surface: new Uint32Array(bytes(cloud.surface)),
    snr: new Float32Array(bytes(cloud.snr)), visible: true, poses: {alone, together: atJointPose(cloud, alone.position)}
  }, alone);
});
const hasJointPose = clouds.length > 0 && clouds.every(cloud => cloud.poses.together);
const part = data.part && {
  nodes: new Float32Array(bytes(data.part.nodes)), facets: new Uint32Array(bytes(data.part.facets)),
  surface: new Uint32Array(bytes(data.part.surface))
};
const tolerance = result.run.tolerance_mm;
const state = {
  map: result.run.colour_map, limit: result.run.colour_limit_mm, bands: false, band: 'all', surface: -1,
  outliers: true, size: 4, interpolate: false
};

// ---- colours -----------------------------------------------------------------------------------------------------------

function scaleColour(deviation) {
  const anchors = data.colours[state.map];
  const place = 0.5 * (Math.min(1, Math.max(-1, deviation / state.limit)) + 1) * (anchors.length - 1);
  const lower = Math.min(Math.floor(place), anchors.length - 2), t = place - lower;
  return anchors[lower].map((c, k) => Math.round(c + t * (anchors[lower + 1][k] - c)));
}
function limits() { return tolerance || [-state.limit / 2, state.limit / 2]; }
// Six bands: three within the tolerance, three beyond it, from the ends of the map in use.
function bandColour(deviation) {
  const [low, high] = limits(), middle = 0.5 * (low + high), half = 0.5 * (high - low);
  const place = (deviation - middle) / half;
  const step = Math.abs(place) > 1 ? 1 : Math.abs(place) > 0.75 ? 0.5 : 0;
  const limit = state.limit;
  state.limit = 1;
  const colour = scaleColour(Math.sign(place) * step);
  state.limit = limit;
  return colour;
}
const colourOf = deviation => state.bands ? bandColour(deviation) : scaleColour(deviation);
const css = c => `rgb(${c[0]},${c[1]},${c[2]})`;

function isShown(cloud, i) {
  if (!cloud.visible || (cloud.outlier[i] && !state.outliers)) return false;
  if (state.surface >= 0 && cloud.surface[i] !== state.surface) return false;
  const d = cloud.deviation[i], [low, high] = limits();
  switch (state.band) {
    case 'within': return d >= low && d <= high;
    case 'over': return d > high;
    case 'under': return d < low;
    case 'outside': return d < low || d > high;
  }
  return true;
}

// ---- scene ---------------------------------------------------------------------------------------------------------------

const scene = {available: false};

function makeScene() {
  const canvas = byId('canvas');
  let renderer;
  try {
    renderer = new THREE.WebGLRenderer({canvas, antialias: true, preserveDrawingBuffer: true});
  } catch (problem) {
    byId('scene').append(element('div', {class: 'none'}, 'This browser offers no WebGL: the 3-D view cannot be drawn. Everything below can.'));
    return;
  }
  renderer.setPixelRatio(window.devicePixelRatio || 1);
  renderer.setClearColor(0xffffff);
  Object.assign(scene, {available: true, renderer, canvas, world: new THREE.Scene(), camera: new THREE.OrthographicCamera(-1, 1, 1, -1, -1e5, 1e5)});
  scene.world.add(new THREE.AmbientLight(0xffffff, 0.55));
  scene.lamp = new THREE.DirectionalLight(0xffffff, 0.5);
  scene.world.add(scene.lamp);
  measureExtent();
  scene.controls = new THREE.OrbitControls(scene.camera, canvas);
  scene.controls.screenSpacePanning = true;
  scene.controls.addEventListener('change', draw);
  clouds.forEach(addCloud);
  if (part) addPart();
  scene.marker = new THREE.Points(new THREE.BufferGeometry(), ringMaterial());
  scene.marker.frustumCulled = false;
  scene.marker.visible = false;
  scene.world.add(scene.marker);
  let pressed = null;
  canvas.addEventListener('pointerdown', event => { pressed = [event.clientX, event.clientY]; });
  canvas.addEventListener('pointerup', event => {
    if (pressed && Math.hypot(event.clientX - pressed[0], event.clientY - pressed[1]) < 4) pickAt(event.clientX, event.clientY);
    pressed = null;
  });
  window.addEventListener('resize', fit);
}

function measureExtent() {
  const box = new THREE.Box3();
  const extend = array => { for (let i = 0; i < array.length; i += 3) box.expandByPoint(new THREE.Vector3(array[i], array[i + 1], array[i + 2])); };
  if (part) extend(part.nodes);
  else clouds.forEach(cloud => extend(cloud.position));
  if (box.isEmpty()) box.expandByPoint(new THREE.Vector3());
  scene.centre = box.getCenter(new THREE.Vector3());
  scene.radius = Math.max(box.getSize(new THREE.Vector3()).length() / 2, 1e-3);
}

function pointMaterial() {
  return new THREE.ShaderMaterial({
    uniforms: {size: {value: state.size * (window.devicePixelRatio || 1)}},
    vertexShader: `attribute vec3 colour; attribute float shown; uniform float size; varying vec3 paint;
      void main() { paint = colour; gl_Position = projectionMatrix * modelViewMatrix * vec4(position, 1.0);
        gl_PointSize = size * shown; if (shown < 0.5) gl_Position = vec4(2.0, 2.0, 2.0, 1.0); }`,
    fragmentShader: `varying vec3 paint; void main() { float r = length(gl_PointCoord - 0.5); if (r > 0.5) discard;
      gl_FragColor = vec4(paint * (r > 0.38 ? 0.78 : 1.0), 1.0); }`
  });
}
function ringMaterial() {
  return new THREE.ShaderMaterial({
    depthTest: false, transparent: true, uniforms: {size: {value: 18 * (window.devicePixelRatio || 1)}},
    vertexShader: 'uniform float size; void main() { gl_Position = projectionMatrix * modelViewMatrix * vec4(position, 1.0); gl_PointSize = size; }',
    fragmentShader: 'void main() { float r = length(gl_PointCoord - 0.5); if (r > 0.5 || r < 0.36) discard; gl_FragColor = vec4(0.05, 0.05, 0.05, 1.0); }'
  });
}

function addCloud(cloud) {
  const count = cloud.deviation.length, geometry = new THREE.BufferGeometry();
  geometry.setAttribute('position', new THREE.BufferAttribute(cloud.position, 3));
  geometry.setAttribute('colour', new THREE.BufferAttribute(new Uint8Array(3 * count), 3, true));
  geometry.setAttribute('shown', new THREE.BufferAttribute(new Float32Array(count), 1));
  cloud.points = new THREE.Points(geometry, pointMaterial());
  cloud.points.frustumCulled = false;
  scene.world.add(cloud.points);
}

function choosePose(name) {
  for (const cloud of clouds) {
    Object.assign(cloud, cloud.poses[name]);
    if (cloud.points) cloud.points.geometry.setAttribute('position', new THREE.BufferAttribute(cloud.position, 3));
  }
  if (scene.marker) scene.marker.visible = false;
  byId('picked').replaceChildren(element('span', {class: 'quiet'}, 'Click a point to see its values.'));
}

// Corners of every facet by itself, with the normal averaged over the facets of the same CAD surface; where
// these disagree by more than 40 degrees there is an edge and the facet keeps its own.
function facetNormals(corner, surface) {
  const facets = surface.length, own = new Float32Array(3 * facets), sums = new Map();
  const a = new THREE.Vector3(), b = new THREE.Vector3(), c = new THREE.Vector3();
  const key = (f, k) => { const i = 9 * f + 3 * k; return corner[i] + ' ' + corner[i + 1] + ' ' + corner[i + 2] + ' ' + surface[f]; };
  for (let f = 0; f < facets; ++f) {
    a.fromArray(corner, 9 * f); b.fromArray(corner, 9 * f + 3).sub(a); c.fromArray(corner, 9 * f + 6).sub(a);
    const area = b.cross(c).clone();
    b.normalize().toArray(own, 3 * f);
    for (let k = 0; k < 3; ++k) { const at = key(f, k); if (sums.has(at)) sums.get(at).add(area); else sums.set(at, area.clone()); }
  }
  sums.forEach(sum => sum.normalize());
  const normals = new Float32Array(corner.length);
  for (let f = 0; f < facets; ++f) {
    a.fromArray(own, 3 * f);
    for (let k = 0; k < 3; ++k) { const smooth = sums.get(key(f, k)); (smooth.dot(a) > 0.766 ? smooth : a).toArray(normals, 9 * f + 3 * k); }
  }
  return normals;
}

function partGeometry(corner, surface) {
  const geometry = new THREE.BufferGeometry();
  geometry.setAttribute('position', new THREE.BufferAttribute(corner, 3));
  geometry.setAttribute('normal', new THREE.BufferAttribute(facetNormals(corner, surface), 3));
  return geometry;
}
const partMaterial = options => new THREE.MeshLambertMaterial(Object.assign({side: THREE.DoubleSide, polygonOffset: true, polygonOffsetFactor: 2, polygonOffsetUnits: 8}, options));

function addPart() {
  const corner = new Float32Array(3 * part.facets.length);
  for (let i = 0; i < part.facets.length; ++i) for (let k = 0; k < 3; ++k) corner[3 * i + k] = part.nodes[3 * part.facets[i] + k];
  part.corner = corner;
  scene.part = new THREE.Mesh(partGeometry(corner, part.surface), partMaterial({color: 0xd4d8de}));
  scene.world.add(scene.part);
}

// Facets cut at their longest edges until all edges are shorter than the limit, or there are too many.
function dividedPart(longest) {
  const corners = [], surface = [], stack = [];
  const edge = (t, i, j) => Math.hypot(t[3 * i] - t[3 * j], t[3 * i + 1] - t[3 * j + 1], t[3 * i + 2] - t[3 * j + 2]);
  for (let f = 0; f < part.surface.length; ++f) {
    stack.push(Array.from(part.corner.subarray(9 * f, 9 * f + 9)));
    while (stack.length) {
      const t = stack.pop(), lengths = [edge(t, 0, 1), edge(t, 1, 2), edge(t, 2, 0)];
      const k = lengths.indexOf(Math.max(...lengths));
      if (lengths[k] <= longest) { for (const x of t) corners.push(x); surface.push(part.surface[f]); continue; }
      const i = k, j = (k + 1) % 3, o = (k + 2) % 3, at = p => t.slice(3 * p, 3 * p + 3);
      const middle = at(i).map((x, c) => 0.5 * (x + t[3 * j + c]));
      stack.push([...at(i), ...middle, ...at(o)], [...middle, ...at(j), ...at(o)]);
    }
  }
  return {corner: new Float32Array(corners), surface: Uint32Array.from(surface)};
}

function spacingOf(cloud) {
  const steps = [];
  for (let i = 3; i < cloud.position.length && steps.length < 3000; i += 3)
    steps.push(Math.hypot(cloud.position[i] - cloud.position[i - 3], cloud.position[i + 1] - cloud.position[i - 2], cloud.position[i + 2] - cloud.position[i - 1]));
  steps.sort((a, b) => a - b);
  return steps.length ? steps[steps.length >> 1] : scene.radius / 50;
}

// Every corner takes the mean of the points around it, weighted by a Gaussian of the scan's spacing. Points off the
// corner's tangent plane belong to another side of the part.
function colourSurface() {
  const reach = 2.2 * Math.max(...clouds.filter(c => c.visible && c.position.length > 3).map(spacingOf), scene.radius / 400);
  if (!scene.fine) {
    let longest = reach / 1.5, area = 0;
    const side = new THREE.Vector3(), other = new THREE.Vector3(), from = new THREE.Vector3();
    for (let i = 0; i < part.corner.length; i += 9) {
      from.fromArray(part.corner, i);
      area += 0.5 * side.fromArray(part.corner, i + 3).sub(from).cross(other.fromArray(part.corner, i + 6).sub(from)).length();
    }
    longest = Math.max(longest, Math.sqrt(area / 60000));  // some 200,000 facets at most
    const fine = dividedPart(longest);
    scene.fine = new THREE.Mesh(partGeometry(fine.corner, fine.surface), partMaterial({vertexColors: THREE.VertexColors}));
    scene.fine.geometry.setAttribute('color', new THREE.BufferAttribute(new Uint8Array(fine.corner.length), 3, true));
    scene.world.add(scene.fine);
  }
  const cells = new Map(), cell = x => Math.floor(x / reach);
  const name = (x, y, z) => (x + 4096) * 67108864 + (y + 4096) * 8192 + (z + 4096);
  for (const cloud of clouds) for (let i = 0; i < cloud.deviation.length; ++i) {
    if (!isShown(cloud, i) || cloud.outlier[i]) continue;
    const at = name(cell(cloud.position[3 * i]), cell(cloud.position[3 * i + 1]), cell(cloud.position[3 * i + 2]));
    if (!cells.has(at)) cells.set(at, []);
    cells.get(at).push(cloud.position[3 * i], cloud.position[3 * i + 1], cloud.position[3 * i + 2], cloud.deviation[i]);
  }
  const position = scene.fine.geometry.attributes.position.array, normal = scene.fine.geometry.attributes.normal.array;
  const colour = scene.fine.geometry.attributes.color.array, known = new Map();
  for (let i = 0; i < position.length; i += 3) {
    const x = position[i], y = position[i + 1], z = position[i + 2];
    const place = x + ' ' + y + ' ' + z + ' ' + Math.round(4 * normal[i]) + Math.round(4 * normal[i + 1]) + Math.round(4 * normal[i + 2]);
    let paint = known.get(place);
    if (!paint) {
      let sum = 0, weight = 0;
      for (let cx = cell(x) - 1; cx <= cell(x) + 1; ++cx) for (let cy = cell(y) - 1; cy <= cell(y) + 1; ++cy) for (let cz = cell(z) - 1; cz <= cell(z) + 1; ++cz) {
        const near = cells.get(name(cx, cy, cz));
        if (!near) continue;
        for (let p = 0; p < near.length; p += 4) {
          const dx = near[p] - x, dy = near[p + 1] - y, dz = near[p + 2] - z, squared = dx * dx + dy * dy + dz * dz;
          if (squared > reach * reach || Math.abs(dx * normal[i] + dy * normal[i + 1] + dz * normal[i + 2]) > 0.35 * reach) continue;
          const w = Math.exp(-4 * squared / (reach * reach));
          sum += w * near[p + 3]; weight += w;
        }
      }
      paint = weight > 0.05 ? colourOf(sum / weight) : [212, 216, 222];
      known.set(place, paint);
    }
    colour[i] = paint[0]; colour[i + 1] = paint[1]; colour[i + 2] = paint[2];
  }
  scene.fine.geometry.attributes.color.needsUpdate = true;
}

function look(toCamera, up) {
  if (!scene.available) return;
  const direction = new THREE.Vector3(...toCamera).normalize();
  scene.camera.up.set(...up).normalize();
  if (Math.abs(direction.dot(scene.camera.up)) > 0.999) scene.camera.up.set(direction.y, direction.z, direction.x);
  scene.camera.position.copy(scene.centre).addScaledVector(direction, 3 * scene.radius);
  scene.camera.zoom = 1;
  scene.controls.dispose();
  scene.controls = new THREE.OrbitControls(scene.camera, scene.canvas);
  scene.controls.screenSpacePanning = true;
  scene.controls.target.copy(scene.centre);
  scene.controls.addEventListener('change', draw);
  scene.controls.update();
  fit();
}
function fit() {
  const width = scene.canvas.clientWidth, height = scene.canvas.clientHeight, half = 1.02 * scene.radius;
  scene.renderer.setSize(width, height, false);
  const wide = Math.max(1, width / height), tall = Math.max(1, height / width);
  Object.assign(scene.camera, {left: -half * wide, right: half * wide, top: half * tall, bottom: -half * tall});
  scene.camera.updateProjectionMatrix();
  draw();
}
function draw() {
  if (!scene.available) return;
  scene.lamp.position.copy(scene.camera.position).sub(scene.controls.target).add(scene.camera.up.clone().multiplyScalar(scene.radius));
  scene.renderer.render(scene.world, scene.camera);
}

// The nearest point within 10 pixels among those in front.
function pickAt(clientX, clientY) {
  const frame = scene.canvas.getBoundingClientRect(), x = clientX - frame.left, y = clientY - frame.top;
  const toClip = new THREE.Matrix4().multiplyMatrices(scene.camera.projectionMatrix, scene.camera.matrixWorldInverse);
  const candidates = [], at = new THREE.Vector3();
  for (const cloud of clouds) for (let i = 0; i < cloud.deviation.length; ++i) {
    if (!isShown(cloud, i)) continue;
    at.fromArray(cloud.position, 3 * i).applyMatrix4(toClip);
    const off = Math.hypot(0.5 * (at.x + 1) * frame.width - x, 0.5 * (1 - at.y) * frame.height - y);
    if (off < 10) candidates.push({cloud, i, off, depth: at.z * 1e5});
  }
  if (!candidates.length) return null;
  const front = Math.min(...candidates.map(c => c.depth)) + 0.02 * scene.radius;
  const best = candidates.filter(c => c.depth <= front).sort((a, b) => a.off - b.off)[0];
  showPicked(best.cloud, best.i);
  return best;
}
function showPicked(cloud, i) {
  const p = cloud.position.subarray(3 * i, 3 * i + 3), d = cloud.deviation[i], surface = cloud.surface[i];
  const where = tolerance ? (d > tolerance[1] ? 'above the upper limit' : d < tolerance[0] ? 'below the lower limit' : 'within tolerance') : '';
  byId('picked').innerHTML = `<b>${mm(d)} mm</b> <span class="quiet">${where}${cloud.outlier[i] ? ', outlier' : ''}</span>
    <div>view ${escaped(cloud.view)}, point ${i}</div><div>x ${mm(p[0], 3)} &nbsp; y ${mm(p[1], 3)} &nbsp; z ${mm(p[2], 3)} mm</div>
    <div>surface ${surface}: ${escaped(data.surfaces[surface] || '')}</div><div>SNR ${short(cloud.snr[i])}</div>`;
  scene.marker.geometry.setAttribute('position', new THREE.BufferAttribute(Float32Array.from(p), 3));
  scene.marker.visible = true;
  draw();
}

// ---- what follows the controls ---------------------------------------------------------------------------------------------

function update() {
  const shown = [];
  for (const cloud of clouds) {
    for (let i = 0; i < cloud.deviation.length; ++i) {
      const visible = isShown(cloud, i);
      if (visible && !cloud.outlier[i]) shown.push(cloud.deviation[i]);
      if (!scene.available) continue;
      cloud.points.geometry.attributes.shown.array[i] = visible ? 1 : 0;
      const c = cloud.outlier[i] ? [0, 0, 0] : colourOf(cloud.deviation[i]);
      cloud.points.geometry.attributes.colour.array.set(c, 3 * i);
    }
    if (!scene.available) continue;
    cloud.points.geometry.attributes.shown.needsUpdate = cloud.points.geometry.attributes.colour.needsUpdate = true;
    cloud.points.material.uniforms.size.value = state.size * (window.devicePixelRatio || 1);
    cloud.points.visible = !state.interpolate;
  }
  if (scene.available && part) {
    if (state.interpolate) colourSurface();
    if (scene.fine) scene.fine.visible = state.interpolate;
    scene.part.visible = byId('part').checked && !state.interpolate;
  }
  byId('bar').replaceChildren(colourBar());
  byId('histogram').replaceChildren(histogram(shown));
  byId('shown').textContent = `${shown.length} points` + (shown.length ? `, RMS ${mm(Math.sqrt(shown.reduce((s, d) => s + d * d, 0) / shown.length))} mm` : '') + ', outliers left out';
  draw();
}

function colourBar() {
  const svg = drawing('svg', {viewBox: '0 0 92 600', width: '100%', height: '100%', preserveAspectRatio: 'none'});
  const y = d => 300 - 290 * d / state.limit, steps = 120;
  for (let k = 0; k < steps; ++k) {
    const d = state.limit * (1 - 2 * (k + 0.5) / steps);
    svg.append(drawing('rect', {x: 0, y: 10 + 580 * k / steps, width: 20, height: 580 / steps + 0.6, fill: css(colourOf(d))}));
  }
  svg.append(drawing('rect', {x: 0, y: 10, width: 20, height: 580, fill: 'none', stroke: '#444'}));
  for (let k = -4; k <= 4; ++k) svg.append(drawing('text', {x: 26, y: y(k * state.limit / 4) + 4}, Number((k * state.limit / 4).toPrecision(3)) + (k === 4 ? ' mm' : '')));
  if (tolerance) for (const limit of tolerance) if (Math.abs(limit) <= state.limit) {
    svg.append(drawing('line', {x1: -2, x2: 90, y1: y(limit), y2: y(limit), stroke: '#000', 'stroke-dasharray': '4 2'}));
    svg.append(drawing('text', {x: 90, y: y(limit) + (limit === tolerance[1] ? -3 : 11), 'text-anchor': 'end', 'font-weight': 'bold'}, limit === tolerance[1] ? 'upper' : 'lower'));
  }
  return svg;
}

function histogram(values) {
  const bins = 50, counts = new Array(bins).fill(0), width = 290, height = 150, base = 128;
  let below = 0, above = 0;
  for (const d of values) {
    const k = Math.floor((d / state.limit + 1) / 2 * bins);
    if (d < -state.limit) ++below; else if (d > state.limit) ++above; else ++counts[Math.min(k, bins - 1)];
  }
  const svg = drawing('svg', {viewBox: `0 0 ${width} ${height}`, width: '100%'}), most = Math.max(...counts, 1);
  counts.forEach((n, k) => {
    const d = state.limit * (2 * (k + 0.5) / bins - 1), h = 112 * n / most;
    svg.append(drawing('rect', {x: 5 + 280 * k / bins, y: base - h, width: 280 / bins - 0.6, height: h, fill: css(colourOf(d)), stroke: '#555', 'stroke-width': 0.25}));
  });
  svg.append(drawing('line', {x1: 5, x2: 285, y1: base, y2: base, stroke: '#444'}));
  for (const k of [-1, -0.5, 0, 0.5, 1]) svg.append(drawing('text', {x: 145 + 140 * k, y: base + 14, 'text-anchor': k < 0 ? (k === -1 ? 'start' : 'middle') : k === 1 ? 'end' : 'middle'}, Number((k * state.limit).toPrecision(3))));
  if (tolerance) for (const limit of tolerance) if (Math.abs(limit) <= state.limit) {
    const x = 145 + 140 * limit / state.limit;
    svg.append(drawing('line', {x1: x, x2: x, y1: 6, y2: base, stroke: '#000', 'stroke-dasharray': '4 2'}));
  }
  svg.append(drawing('text', {x: 5, y: 12}, below ? `${below} below` : ''), drawing('text', {x: 285, y: 12, 'text-anchor': 'end'}, above ? `${above} above` : ''));
  return svg;
}

// ---- tables ----------------------------------------------------------------------------------------------------------------

const kConformity = {'conforming': 'good', 'not conforming': 'bad', 'cannot tell': 'doubt'};
const statisticsHeadings = ['Points', 'Outliers', 'Min', 'Max', 'Mean', 'RMS', 'Std dev', 'Mean +', 'Mean \u2212'];
const statisticsCells = s => [s.points, s.outliers, mm(s.min_mm), mm(s.max_mm), mm(s.mean_mm), mm(s.rms_mm), mm(s.standard_deviation_mm), mm(s.mean_positive_mm), mm(s.mean_negative_mm)];
const countHeadings = tolerance ? ['Within', 'Over', 'Under', 'Outliers outside'] : [];
const countCells = t => !tolerance ? [] : t ? [percent(t.percent_within), percent(t.percent_over), percent(t.percent_under), t.outliers_outside] : Array(4).fill('\u2013');

function viewTable() {
  const headings = ['View', '', 'Before RMS', ...statisticsHeadings, ...countHeadings];
  const rows = result.views.map(v => [v.view, v.failure ? {text: 'failed', kind: 'bad'} : v.converged ? (v.shows_misfit ? {text: 'converged, misfit', kind: 'doubt'} : {text: 'converged', kind: 'good'}) : {text: v.termination, kind: 'bad'},
    mm(v.initial_rms_mm), ...statisticsCells(v.deviations), ...countCells(v.tolerance)]);
  byId('view-table').append(table(headings, rows, 2));
  // Points that came from elsewhere were planned by nobody.
  if (!result.views.some(v => v.samples.planned)) return;
  byId('view-table').append(table(['Samples of view', 'Planned', 'Out of range', 'Missed', 'Points', 'of these, low signal', 'Rejected by registration', 'RMS from facets'],
    result.views.map(v => [v.view, v.samples.planned, v.samples.out_of_range, v.samples.missed, v.samples.points, v.samples.low_signal, v.samples.left_out_by_registration, mm(v.deviations_from_facets.rms_mm)]), 1));
}

function surfaceTable() {
  const rows = [], ids = [];
  for (const view of result.views) for (const s of view.per_surface) {
    rows.push([view.view, s.surface, s.name, ...statisticsCells(s), ...countCells(s.tolerance), mm((s.deviations_from_facets || {}).rms_mm)]);
    ids.push(s.surface);
  }
  const choose = r => ({class: 'pick', 'data-surface': ids[r], on: {click: () => { state.surface = state.surface === ids[r] ? -1 : ids[r]; byId('surface').value = state.surface; markSurface(); update(); }}});
  byId('surface-table').append(table(['View', 'Id', 'Surface', ...statisticsHeadings, ...countHeadings, 'RMS from facets'], rows, 3, choose));
  [...new Set(ids)].sort((a, b) => a - b).forEach(id => byId('surface').append(element('option', {value: id}, `${id} ${data.surfaces[id] || ''}`)));
}
function markSurface() {
  document.querySelectorAll('#surface-table tr.pick').forEach(row => row.classList.toggle('chosen', Number(row.dataset.surface) === state.surface));
}

function profileTable() {
  if (!result.profiles.length) { byId('profile-section').remove(); return; }
  byId('profiles').append(table(['Profile', 'Decision', {text: 'Why', kind: 'why'}, 'Lower', 'Upper', 'Points', 'Outliers', 'Min', 'Max', 'Profile', 'Guard band to accept', 'to reject', 'Within', 'Over', 'Under'],
    result.profiles.map(p => [p.name, {text: p.conformity, kind: kConformity[p.conformity]}, {text: p.reason, kind: 'why'}, mm(p.tolerance_mm[0], 3), mm(p.tolerance_mm[1], 3), p.points, p.outliers,
      mm(p.min_mm), mm(p.max_mm), mm(p.profile_mm), mm(p.guard_mm), mm(p.rejection_guard_mm), percent(p.counts.percent_within), percent(p.counts.percent_over), percent(p.counts.percent_under)]), 3));
}

const kComponents = ['rotation_x_rad', 'rotation_y_rad', 'rotation_z_rad', 'translation_x_mm', 'translation_y_mm', 'translation_z_mm'];
function differenceTable(differences) {
  const cell = (d, k) => {
    const c = d.components[k];
    if (!isNumber(c.value)) return 'not determined';
    const factor = k.endsWith('_rad') ? 1000 : 1;
    return {text: `${mm(factor * c.value)} \u00b1 ${mm(2 * factor * c.standard_uncertainty)}`, kind: Math.abs(c.value) > 3 * c.standard_uncertainty ? 'bad' : ''};
  };
  return table(['Of', 'From', 'Rotation x mrad', 'y', 'z', 'Translation x mm', 'y', 'z'], differences.map(d => [d.of, d.from, ...kComponents.map(k => cell(d, k))]), 2);
}

function jointTables() {
  const joint = result.joint;
  if (!joint) { byId('joint-section').remove(); return; }
  const alone = new Map(result.views.map(v => [v.view, v.deviations]));
  const several = joint.views.length > 1;
  byId('joint').append(
    element('p', {}, several ? 'All views as one scan: the rotary angles tie them together. Beside it each view registered by itself.'
      : 'The only view that was registered, on the datum surfaces; beside it the view by its best fit.'),
    table(['View', 'RMS together', 'Min', 'Max', 'RMS by itself', 'Min', 'Max'], joint.views.map(v => {
      const own = alone.get(v.view);
      return [v.view, mm(v.deviations.rms_mm), mm(v.deviations.min_mm), mm(v.deviations.max_mm), mm(own.rms_mm), mm(own.min_mm), mm(own.max_mm)];
    })),
    ...several ? [element('h3', {}, 'Difference between the views, each by itself'), differenceTable(joint.between_views)] : [],
    element('h3', {}, 'Each view by itself, from all together'), differenceTable(joint.views.map(v => v.alone)),
    element('p', {class: 'quiet'}, 'Value \u00b1 expanded uncertainty (k = 2). Red: more than three standard uncertainties; then the views disagree, because the rotary axis stands elsewhere than stated or because the part is no rigid copy of its model.'));
}

function offsetTable() {
  if (!result.groups.length) { byId('offset-section').remove(); return; }
  byId('offsets').append(table(['Group', 'Points', 'RMS mm'], result.groups.map(g => [g.name, g.points, mm(g.rms_mm)])));
  if (result.offsets.length) byId('offsets').append(element('h3', {}, 'Displacement'), differenceTable(result.offsets),
    element('p', {class: 'quiet'}, 'Rigid displacement of the group in the part frame, about the centroid of its points, seen from the first group\u2019s fit. Value \u00b1 expanded uncertainty (k = 2). Red: more than three standard uncertainties, a defect of the part and no misfit of the whole.'));
}

function factsUnder(title) {
  const facts = element('div', {class: 'facts'});
  byId('registration').append(element('h3', {}, title), facts);
  const unbroken = text => text.replace(/ (mrad|\u00b5m|mm)/g, '\u00a0$1');  // a unit stays with its number
  const add = (name, value) => facts.append(element('div', {}, element('span', {}, name), element('span', {}, unbroken(value))));
  add.after = node => byId('registration').append(node);
  return add;
}
// What the registration of a view and that of all views have in common.
function addRegistration(add, v) {
  add('termination', v.termination);
  add('iterations', String(v.iterations));
  if (v.shows_misfit) add('fit', 'neighbouring residuals agree: form errors of the size of the RMS, another part, or a wrong pose');
  add('inliers / rejected', `${v.inliers} / ${v.outliers}`);
  if (v.closest_points) {
    add('\u03c3 of a distance behind the covariance', `${short(1000 * v.sigma_mm)} \u00b5m, ${v.sigma_estimated ? 'from the residuals' : 'given'}`);
    add('closest points: searched / from cache / facets tested', `${v.closest_points.queries} / ${v.closest_points.cache_hits} / ${v.closest_points.facets_tested}`);
  }
  const u = v.pose_covariance.map((row, k) => Math.sqrt(Math.max(row[k], 0)));
  add('pose uncertainty (k = 1), rotation x y z', u.slice(0, 3).map(x => short(1000 * x)).join(', ') + ' mrad');
  add('pose uncertainty (k = 1), translation x y z at the scan\u2019s centroid', u.slice(3).map(x => short(1000 * x)).join(', ') + ' \u00b5m');
  if (v.undetermined) add('not determined by the scan', v.undetermined.length ? v.undetermined.join('; ') : 'nothing');
  add('pose, rotation w x y z', v.pose.rotation_wxyz.map(x => x.toFixed(8)).join(', '));
  add('pose, translation', v.pose.translation_mm.map(x => mm(x)).join(', ') + ' mm');
  add.after(covarianceDetails(v));
}
// The covariance as result.json holds it, and as correlations; folded away.
const kPoseComponents = ['rotation x', 'rotation y', 'rotation z', 'translation x', 'translation y', 'translation z'];
function covarianceDetails(v) {
  const c = v.pose_covariance, u = c.map((row, k) => Math.sqrt(Math.max(row[k], 0)));
  const unit = k => k < 3 ? '\u00b5rad' : '\u00b5m', scale = k => k < 3 ? 1e6 : 1e3;
  const rows = cell => kPoseComponents.map((name, r) => [`${name}, ${unit(r)}`, ...kPoseComponents.map((_, k) => cell(r, k))]);
  const headings = kPoseComponents.map((name, k) => `${name}, ${unit(k)}`);
  const known = (r, k) => u[r] > 0 && u[k] > 0;  // zero: locked, or not determined
  return element('details', {class: 'covariance'}, element('summary', {}, 'Covariance of the pose, 6 x 6'),
    element('p', {class: 'quiet'}, 'Of small rotations about the axes of the part through the scan\u2019s centroid at ' + v.pose_covariance_pivot_mm.map(x => mm(x, 3)).join(', ') +
      ' mm, and of the centroid\u2019s translations. An element has the unit of its row times that of its column: \u00b5rad\u00b2, \u00b5rad \u00b5m, \u00b5m\u00b2.'),
    element('div', {class: 'scroll'}, table(['Covariance', ...headings], rows((r, k) => short(scale(r) * scale(k) * c[r][k])))),
    element('div', {class: 'scroll'}, table(['Correlation', ...kPoseComponents], kPoseComponents.map((name, r) => [name, ...kPoseComponents.map((_, k) => known(r, k) ? mm(c[r][k] / (u[r] * u[k]), 3) : '\u2013')]))));
}
const surfaceNames = ids => ids.length ? ids.map(id => data.surfaces[id] || String(id)).join(', ') : 'none: best fit on all that was measured';

function registrationFacts() {
  for (const v of result.views) {
    const add = factsUnder(`View ${v.view}`);
    if (v.failure) { add('failed', v.failure); continue; }
    addRegistration(add, v);
    add('RMS before / after (weighted)', `${mm(v.initial_rms_mm)} / ${mm(v.weighted_rms_mm)} mm`);
    add('cross-check', v.cross_check ? (v.cross_check.agrees ? 'agrees: ' : 'DISAGREES: ') + v.cross_check.summary : 'not asked for');
    if (v.truth) add('error of the pose at the scan\u2019s centroid (simulation)', `${short(1000 * v.truth.translation_error_mm)} \u00b5m, ${short(1000 * v.truth.rotation_error_rad)} mrad`);
    add('time: scan / register / evaluate', [v.time_s.scan, v.time_s.register, v.time_s.evaluate].map(short).join(' / ') + ' s');
  }
  const datum = result.datum_surfaces;
  if (!result.joint) {
    if (datum && datum.length) factsUnder('Datum')('surfaces', surfaceNames(datum));
    return;
  }
  const add = factsUnder('All views together');
  addRegistration(add, result.joint);
  add('RMS of all points', mm(result.joint.deviations.rms_mm) + ' mm');
  if (datum) add('datum surfaces', surfaceNames(datum));
}

function provenance() {
  const run = result.run, facts = {
    'scenario': run.scenario, 'seed': run.seed, 'program': 'trueblade ' + run.program_version, 'date': run.date || '\u2013', 'machine': run.machine, 'lens': run.lens,
    'part': run.part, 'CAD surfaces / facets': `${run.surfaces} / ${run.facets}`, 'registration preset': run.registration_preset, 'rejected by registration': result.outlier_rules.registration, 'outliers of this report': result.outlier_rules.report, 'deviations from': run.deviations_from,
    'tolerance': tolerance ? `${tolerance[0]} to ${tolerance[1]} mm` : 'none', 'result schema': `${result.schema} ${result.schema_version}`
  };
  if (!run.scenario) delete facts.seed;
  for (const [name, value] of Object.entries(facts)) if (value !== '') byId('provenance').append(element('div', {}, element('span', {}, name), element('span', {}, String(value))));
  byId('scenario').textContent = data.scenario || 'not stored';
}

function summary() {
  document.title = `${result.run.scenario || result.run.part}: inspection`;
  byId('title').textContent = `Inspection of ${result.run.part}`;
  byId('subtitle').textContent = `${[result.run.scenario, result.run.date].filter(Boolean).map(t => t + ' \u00b7 ').join('')}${result.views.length} view${result.views.length === 1 ? '' : 's'}`;
  const chip = (text, kind) => byId('chips').append(element('span', {class: 'chip ' + kind}, text));
  const verdict = v => {
    if (v.failure) return [`${v.view}: failed`, 'bad'];
    if (!v.converged) return [`${v.view}: ${v.termination}`, 'bad'];
    const rms = `${v.view}: RMS ${mm(v.rms_mm)} mm`, t = v.tolerance;
    const misfit = v.shows_misfit ? ', does not fit everywhere' : '';
    if (t && t.over + t.under) return [`${rms}, ${t.over + t.under} out of tolerance${misfit}`, 'bad'];
    if (t && t.outliers_outside) return [`${rms}, outliers out of tolerance: ${t.outliers_outside}${misfit}`, 'doubt'];
    if (misfit) return [rms + misfit, 'doubt'];
    return [rms, 'good'];
  };
  for (const v of result.views) chip(...verdict(v));
  for (const p of result.profiles) chip(`${p.name}: ${p.conformity}`, kConformity[p.conformity]);
  const missing = [...result.views.filter(v => v.failure).map(v => `view ${v.view}: ${v.failure}`), ...result.missing, ...data.missing];
  if (missing.length) byId('missing').append(element('h3', {class: 'bad'}, 'Missing from this report'), element('ul', {}, ...missing.map(m => element('li', {}, m))));
  const features = result.missing_features || [];
  if (features.length) byId('missing').append(element('h3', {class: 'doubt'}, 'Features without a number'), element('ul', {}, ...features.map(m => element('li', {}, m))));
}

// ---- sections ----------------------------------------------------------------------------------------------------------------

const kFeatureUnits = f => f.unit === 'rad' ? {factor: 180 / Math.PI, unit: '\u00b0'} : {factor: 1, unit: 'mm'};

// The tolerance at every outline point: that of the profile that covers the surface, else that of all deviations.
function zonesAlong(section) {
  const zones = new Array(section.outline_x_y_normal_deviation.length).fill(tolerance);
  for (const stretch of section.profile_stretches || []) {
    const profile = result.profiles.find(p => p.name === stretch.profile);
    if (profile) zones.fill(profile.tolerance_mm, stretch.first, stretch.last + 1);
  }
  return zones;
}
const toleranceInWords = section => {
  const profiles = [...new Set((section.profile_stretches || []).map(s => s.profile))];
  if (profiles.length) return ` dashed: tolerance of the profile ${profiles.join(', ')}.`;
  return tolerance ? ' dashed: tolerance.' : '';
};

function sectionPlot(section, factor) {
  const outline = section.outline_x_y_normal_deviation, points = section.points_x_y_deviation;
  const xs = outline.map(o => o[0]), ys = outline.map(o => o[1]), margin = 0.08 * (Math.max(...xs) - Math.min(...xs));
  const left = Math.min(...xs) - margin, right = Math.max(...xs) + margin, low = Math.min(...ys) - margin, high = Math.max(...ys) + margin;
  const scale = 560 / (right - left), X = x => ((x - left) * scale).toFixed(2), Y = y => ((high - y) * scale).toFixed(2);
  const svg = drawing('svg', {viewBox: `0 0 560 ${((high - low) * scale).toFixed(0)}`, width: '100%', role: 'img'});
  const path = offset => outline.map((o, i) => (i ? 'L' : 'M') + X(o[0] + offset(o) * o[2]) + ' ' + Y(o[1] + offset(o) * o[3])).join('') + 'Z';
  // Broken where `offset` of an outline point is null.
  const open = offset => {
    let line = '', broken = true;
    outline.concat([outline[0]]).forEach((o, i) => {
      const d = offset(i % outline.length);
      if (d !== null) line += (broken ? 'M' : 'L') + X(o[0] + factor * d * o[2]) + ' ' + Y(o[1] + factor * d * o[3]);
      broken = d === null;
    });
    return line;
  };
  const zones = zonesAlong(section);
  for (const side of [0, 1]) svg.append(drawing('path', {d: open(i => zones[i] && zones[i][side]), fill: 'none', stroke: '#9aa4b1', 'stroke-dasharray': '4 3', 'stroke-width': 0.8}));
  svg.append(drawing('path', {d: path(() => 0), fill: '#eef1f5', stroke: '#333', 'stroke-width': 1}));
  const nearest = p => { let best = 0, least = Infinity; outline.forEach((o, i) => { const s = (o[0] - p[0]) ** 2 + (o[1] - p[1]) ** 2; if (s < least) { least = s; best = i; } }); return outline[best]; };
  const stride = Math.max(1, Math.ceil(points.length / 900));
  for (let i = 0; i < points.length; i += stride) {
    const p = points[i], o = nearest(p);
    svg.append(drawing('circle', {cx: X(p[0] + factor * p[2] * o[2]), cy: Y(p[1] + factor * p[2] * o[3]), r: 1.3, fill: css(scaleColour(p[2])), opacity: 0.75}));
  }
  svg.append(drawing('path', {d: open(i => outline[i][4]), fill: 'none', stroke: '#111', 'stroke-width': 1.6}));
  return svg;
}

function sections() {
  if (!result.sections.length) { byId('sections-section').remove(); return; }
  const largest = Math.max(1e-6, ...result.sections.flatMap(s => s.points_x_y_deviation.map(p => Math.abs(p[2]))));
  const size = Math.max(1, ...result.sections.flatMap(s => s.outline_x_y_normal_deviation.map(o => Math.abs(o[0]))));
  byId('factor').value = Math.log10(Math.min(1000, Math.max(1, 0.1 * size / largest)));
  const show = () => {
    const factor = Number(Math.pow(10, byId('factor').value).toPrecision(2));
    byId('factor-text').textContent = factor;
    byId('sections').replaceChildren(...result.sections.map(s => {
      const title = element('h3', {}, `Section at ${s.height_mm} mm`);
      if (s.missing) return element('div', {}, title, element('p', {class: 'bad'}, s.missing));
      const rows = s.features.map(f => {
        const {factor: k, unit} = kFeatureUnits(f);
        const found = isNumber(f.measured) ? [mm(k * f.measured), scaled(k, f.deviation), scaled(2 * k, f.standard_uncertainty)] : null;
        return element('tr', {}, element('td', {class: 'text'}, f.name.replace(/_/g, ' ')), element('td', {}, unit), element('td', {}, scaled(k, f.nominal)),
          ...(found ? found.map(x => element('td', {}, x)) : [element('td', {class: 'text doubt', colspan: 3}, f.reason)]), element('td', {class: 'text method'}, f.method));
      });
      const feature = element('table', {}, element('thead', {}, element('tr', {}, ...['Feature', 'Unit', 'Nominal', 'Measured', 'Deviation', 'U (k = 2)', 'Method'].map((h, c) => element('th', {class: ['text', '', '', '', '', '', 'text method'][c]}, h)))),
        element('tbody', {}, ...rows));
      return element('div', {class: 'blade'}, element('div', {}, title, sectionPlot(s, factor), element('p', {class: 'quiet'}, `${s.points} points, ${percent(s.covered_percent)} of the outline. Thin: nominal; bold: measured, exaggerated ${factor} times;${toleranceInWords(s)}`)), feature);
    }));
  };
  byId('factor').addEventListener('change', show);
  show();
}

// ---- start ----------------------------------------------------------------------------------------------------------------------

function connectControls() {
  byId('map').value = state.map;
  byId('limit').value = state.limit;
  const on = (id, change, event = 'change') => byId(id).addEventListener(event, () => { change(byId(id)); update(); });
  on('map', e => { state.map = e.value; });
  on('limit', e => { if (Number(e.value) > 0) state.limit = Number(e.value); });
  on('bands', e => { state.bands = e.checked; });
  on('band', e => { state.band = e.value; });
  on('pose', e => choosePose(e.value));
  if (!hasJointPose) byId('pose-choice').remove();
  on('outliers', e => { state.outliers = e.checked; });
  on('surface', e => { state.surface = Number(e.value); markSurface(); });
  on('size', e => { state.size = Number(e.value); }, 'input');
  on('interpolate', e => { state.interpolate = e.checked; });
  on('part', () => {});
  byId('interpolate').disabled = byId('part').disabled = !part;
  for (const cloud of clouds) {
    const box = element('input', {type: 'checkbox', checked: ''});
    box.addEventListener('change', () => { cloud.visible = box.checked; update(); });
    byId('views').append(element('label', {}, box, ` ${cloud.view} (${cloud.deviation.length})`));
    byId('directions').append(element('button', {type: 'button', on: {click: () => look(cloud.toCamera, cloud.up)}}, `as ${cloud.view}`));
  }
  const oblique = () => { const c = clouds[0]; const side = new THREE.Vector3(...c.up).cross(new THREE.Vector3(...c.toCamera)); look(new THREE.Vector3(...c.toCamera).addScaledVector(side, 0.6).add(new THREE.Vector3(...c.up).multiplyScalar(0.5)).toArray(), c.up); };
  if (clouds.length) byId('directions').append(element('button', {type: 'button', on: {click: oblique}}, 'oblique'));
}

summary();
viewTable();
profileTable();
jointTables();
offsetTable();
surfaceTable();
registrationFacts();
provenance();
makeScene();
connectControls();
sections();
update();
if (clouds.length) look(clouds[0].toCamera, clouds[0].up);
window.firstPictureMs = performance.now();

// `report.html#selftest` checks itself and writes what it found into the page, for the test in a real browser.
function selfTest() {
  const found = {errors: window.pageErrors, points: clouds.reduce((n, c) => n + c.deviation.length, 0), webgl: scene.available, first_picture_ms: Math.round(window.firstPictureMs)};
  if (scene.available) {
    const gl = scene.renderer.getContext(), width = gl.drawingBufferWidth, height = gl.drawingBufferHeight;
    const pixels = new Uint8Array(4 * width * height);
    draw();
    gl.readPixels(0, 0, width, height, gl.RGBA, gl.UNSIGNED_BYTE, pixels);
    const colours = new Set();
    let painted = 0;
    for (let i = 0; i < pixels.length; i += 4) { if (pixels[i] + pixels[i + 1] + pixels[i + 2] < 765) ++painted; colours.add(pixels[i] << 16 | pixels[i + 1] << 8 | pixels[i + 2]); }
    Object.assign(found, {pixels: width * height, painted, colours: colours.size});
    const cloud = clouds.find(c => c.deviation.length), frame = scene.canvas.getBoundingClientRect();
    if (cloud) {
      const i = cloud.deviation.length >> 1, at = new THREE.Vector3().fromArray(cloud.position, 3 * i).project(scene.camera);
      const place = {clientX: frame.left + 0.5 * (at.x + 1) * frame.width, clientY: frame.top + 0.5 * (1 - at.y) * frame.height, bubbles: true};
      scene.canvas.dispatchEvent(new PointerEvent('pointerdown', place));
      scene.canvas.dispatchEvent(new PointerEvent('pointerup', place));
      found.picked = byId('picked').textContent;
    }
    if (hasJointPose) {
      byId('pose').value = 'together';
      byId('pose').dispatchEvent(new Event('change'));
      found.pose_differs = clouds.reduce((n, c) => n + c.deviation.filter((d, i) => d !== c.poses.alone.deviation[i]).length, 0);
      // A point moves along the normal by the change of its deviation, and no farther than the views lie apart.
      found.pose_moves_mm = Math.max(...clouds.map(c => c.position.reduce((most, x, i) => Math.max(most, Math.abs(x - c.poses.alone.position[i])), 0)));
    }
    if (part) { state.interpolate = true; update(); draw(); const again = new Uint8Array(pixels.length); gl.readPixels(0, 0, width, height, gl.RGBA, gl.UNSIGNED_BYTE, again); let differ = 0; for (let i = 0; i < again.length; i += 4) if (again[i] !== pixels[i]) ++differ; found.surface_differs = differ; }
  }
  const covariances = document.querySelectorAll('details.covariance');
  found.covariances = covariances.length;
  found.correlations_of_one = [...covariances].flatMap(c => [...c.querySelectorAll('td')]).filter(cell => cell.textContent === '1.000').length;
  document.body.append(element('pre', {id: 'selftest'}, JSON.stringify(found)));
}
if (location.hash === '#selftest') selfTest();
if (location.hash === '#coloured' && part) { state.interpolate = true; byId('interpolate').checked = true; update(); }
