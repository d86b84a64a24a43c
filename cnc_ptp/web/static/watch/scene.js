// The picture of the backplot: path, axes, tool, camera. It is drawn when something has changed, and not otherwise.
import {
  AmbientLight, BufferAttribute, BufferGeometry, Color, ConeGeometry, DirectionalLight, GridHelper, Group, Line, LineBasicMaterial,
  LineSegments, Mesh, MeshLambertMaterial, OrthographicCamera, OrbitControls, Scene, Vector3, WebGLRenderer,
} from "../vendor/three.js";

import { Pace } from "./pace.js";
import { coarser, pairsWithin } from "./toolpath.js";

const VIEWS = { iso: [1, -1.2, 0.9], top: [0, 0, 1], front: [0, -1, 0], side: [1, 0, 0], turning: [0, -1, 0] };
const UP = { top: [0, 1, 0], turning: [1, 0, 0] };
const MARGIN = 1.25;
const TRAIL = 0xc2255c;
const STEEPEST = Math.PI / 180; // between the view and straight from above or below
const SMALLEST = 1e-3; // mm, of the box that is looked at

export class PathScene {
  /** Throws where there is no WebGL. */
  constructor(host, canvas) {
    this._host = host;
    this._renderer = new WebGLRenderer({ canvas, antialias: false, powerPreference: "high-performance" });
    this._renderer.setPixelRatio(Math.min(window.devicePixelRatio, 2));
    this._scene = new Scene();
    this._camera = new OrthographicCamera(-1, 1, 1, -1, -1e5, 1e5);
    this._controls = new OrbitControls(this._camera, canvas);
    this._pace = new Pace((step, ratio) => this._setStep(step, ratio));
    this._controls.addEventListener("change", () => this.turned());
    this._scene.add(new AmbientLight(0xffffff, 1.6), sun());
    this._path = new Group();
    this._box = { min: [-50, -50, 0], max: [50, 50, 0] };
    this._view = "iso";
    this._asked = 0;
    this.frames = 0;
    this.tool = new Mesh(new ConeGeometry(1, 3, 16), new MeshLambertMaterial({ color: 0xd9822b }));
    this._scene.add(this._path, this.tool, axesOf());
    this._observer = new ResizeObserver(() => this._resize());
    this._observer.observe(host);
    this.setTheme();
    this.look("iso");
  }

  setTheme() {
    const style = getComputedStyle(document.documentElement);
    this._scene.background = new Color(style.getPropertyValue("--paper").trim());
    this._lines = new Color(style.getPropertyValue("--line").trim());
    this._place();
  }

  /** Shows a path: its positions, pairs, colours and box; `keepsView`: from where it is looked at now. */
  setPath(positions, pairs, colours, box, keepsView = false) {
    for (const child of [...this._path.children]) child.geometry.dispose();
    this._path.clear();
    const shape = new BufferGeometry();
    shape.setAttribute("position", new BufferAttribute(positions, 3));
    shape.setAttribute("color", new BufferAttribute(colours, 3, true));
    this._levels = new Map([[1, new BufferAttribute(pairs, 1)]]);
    shape.setIndex(this._levels.get(1));
    this._step = 1;
    this._shape = shape;
    this._shown = pairs.length / 2;
    const lines = new LineSegments(shape, new LineBasicMaterial({ vertexColors: true }));
    lines.frustumCulled = false;
    this._path.add(lines);
    if (box.min[0] <= box.max[0]) this._box = box;
    if (keepsView) this._place();
    else this.look(this._view);
  }

  /** Shows another path over it (x, y, z one after the other); null: none. */
  setTrail(positions) {
    if (this._trail) {
      this._trail.geometry.dispose();
      this._scene.remove(this._trail);
    }
    this._trail = null;
    if (positions) {
      const shape = new BufferGeometry();
      shape.setAttribute("position", new BufferAttribute(positions, 3));
      this._trail = new Line(shape, new LineBasicMaterial({ color: TRAIL }));
      this._trail.frustumCulled = false;
      this._scene.add(this._trail);
    }
    this.draw();
  }

  setColours(colours) {
    this._shape?.setAttribute("color", new BufferAttribute(colours, 3, true));
    this.draw();
  }

  /** Draws the path only up to so many pairs. */
  setShown(pairs) {
    if (pairs === this._shown) return;
    this._shown = pairs;
    this._setRange();
    this.draw();
  }

  /** While it is turned, only so many points are joined that it follows; then all of them again. */
  turned() {
    this._pace.turned();
    this.draw();
  }

  _setStep(step, ratio) {
    this._renderer.setPixelRatio(ratio * Math.min(window.devicePixelRatio, 2));
    if (!this._shape) return;
    if (!this._levels.has(step)) this._levels.set(step, new BufferAttribute(coarser(this._levels.get(1).array, step), 1));
    this._shape.setIndex(this._levels.get(step));
    this._step = step;
    this._setRange();
    this.draw();
  }

  /** Of the level that is drawn: the pairs up to the last point that is shown. */
  _setRange() {
    const last = this._shown ? this._levels.get(1).array[2 * this._shown - 1] : -1;
    this._shape.setDrawRange(0, 2 * pairsWithin(this._levels.get(this._step).array, (point) => point <= last));
  }

  setTool(x, y, z) {
    const { position } = this.tool;
    if (position.x === x && position.y === y && position.z === z + this._tip) return;
    position.set(x, y, z + this._tip);
    this.draw();
  }

  look(view) {
    this._view = view;
    const [middle, size] = this._extent();
    const direction = new Vector3(...VIEWS[view]).normalize();
    this._camera.up.set(...(UP[view] || [0, 0, 1]));
    this._camera.position.copy(middle).addScaledVector(direction, size * 2);
    this._controls.target.copy(middle);
    this._camera.zoom = 1;
    this._size = size;
    this._place();
    this._resize();
    this._controls.update();
    this.draw();
  }

  rotate(degrees) {
    const offset = this._camera.position.clone().sub(this._controls.target);
    offset.applyAxisAngle(this._camera.up, (degrees * Math.PI) / 180);
    this._camera.position.copy(this._controls.target).add(offset);
    this._controls.update();
  }

  /** The view comes more from above; negative: from below. */
  tilt(degrees) {
    const { up, position } = this._camera;
    const offset = position.clone().sub(this._controls.target);
    const angle = offset.angleTo(up);
    const wanted = Math.min(Math.max(angle - (degrees * Math.PI) / 180, STEEPEST), Math.PI - STEEPEST);
    offset.applyAxisAngle(new Vector3().crossVectors(up, offset).normalize(), wanted - angle);
    position.copy(this._controls.target).add(offset);
    this._controls.update();
  }

  zoom(factor) {
    this._camera.zoom *= factor;
    this._camera.updateProjectionMatrix();
    this.draw();
  }

  _extent() {
    const { min, max } = this._box;
    const middle = new Vector3(...min).add(new Vector3(...max)).multiplyScalar(0.5);
    return [middle, Math.max(SMALLEST, new Vector3(...max).sub(new Vector3(...min)).length())];
  }

  /** Grid and tool in the size of the path. */
  _place() {
    const [middle, size] = this._extent();
    if (this._grid) {
      this._grid.geometry.dispose();
      this._scene.remove(this._grid);
    }
    const step = 10 ** Math.floor(Math.log10(size / 2));
    const cells = Math.ceil((size * 1.2) / step);
    this._grid = new GridHelper(cells * step, cells, this._lines, this._lines);
    this._grid.rotation.x = Math.PI / 2;
    this._grid.position.set(Math.round(middle.x / step) * step, Math.round(middle.y / step) * step, this._box.min[2]);
    this._grid.visible = this._view !== "turning";
    this._scene.add(this._grid);
    const radius = size * 0.015;
    this.tool.scale.setScalar(radius);
    this.tool.rotation.x = -Math.PI / 2;
    this._tip = radius * 1.5;
    this.draw();
  }

  _resize() {
    const { clientWidth: width, clientHeight: height } = this._host;
    if (!width || !height) return;
    this._renderer.setSize(width, height, false);
    const half = ((this._size || 1) * MARGIN) / 2;
    const aspect = width / height;
    const [x, y] = aspect > 1 ? [half * aspect, half] : [half, half / aspect];
    Object.assign(this._camera, { left: -x, right: x, top: y, bottom: -y, near: -10 * half - 1e4, far: 10 * half + 1e4 });
    this._camera.updateProjectionMatrix();
    this.draw();
  }

  draw() {
    this._asked ||= requestAnimationFrame(() => this.drawNow());
  }

  drawNow() {
    this._asked = 0;
    this.frames += 1;
    this._renderer.render(this._scene, this._camera);
    this._pace.drawn();
  }

  end() {
    this._pace.end();
    this._observer.disconnect();
    cancelAnimationFrame(this._asked);
    this._asked = -1;
    this._controls.dispose();
    this._shape?.dispose();
    this._renderer.dispose();
  }
}

function sun() {
  const light = new DirectionalLight(0xffffff, 1.5);
  light.position.set(1, -2, 3);
  return light;
}

/** X red, Y green, Z blue, at the zero point. */
function axesOf() {
  const group = new Group();
  for (const [direction, colour] of [[[20, 0, 0], 0xd03030], [[0, 20, 0], 0x2f9e44], [[0, 0, 20], 0x2b6cd0]]) {
    const shape = new BufferGeometry().setFromPoints([new Vector3(), new Vector3(...direction)]);
    group.add(new Line(shape, new LineBasicMaterial({ color: colour })));
  }
  return group;
}
