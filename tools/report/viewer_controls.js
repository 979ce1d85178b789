// Controls of the viewer, its keys, mouse and fingers.
const modes = {side: 'side by side', split: 'split', flip: 'flip'};
// Which face a key shows: a number its place, r the last one, which is the reference where there is one.
const faceKeys = (faces) => Object.fromEntries([...(report.all ? [] : [['a', 0], ['b', 1]]),
  ...faces.slice(0, 9).map((_, i) => [i + 1, i]), ...faces.flatMap((face, i) => (face.letter === 'R' ? [['r', i]] : []))]);

function buildViewer(view) {
  const keys = report.all ? '1 2 3 .. r' : 'a b r';
  view.controls = element('div', {class: 'controls viewer-controls'});
  view.tabs = element('div', {class: 'tabs', role: 'group', 'aria-label': 'Which picture'});
  view.stage = element('div', {class: report.all ? 'stage all' : 'stage', id: 'stage', tabindex: '0', role: 'application',
    'aria-label': `Pictures: arrow keys move, + and - zoom, Enter touches the middle pixel, ${keys} or space flip, e and E expose`});
  view.status = element('output', {class: 'note hint', id: 'pixel-values'});
  view.insets = element('div', {class: 'insets', id: 'insets'});
  view.links = element('p', {class: 'note'});
  const work = report.all ? [view.stage, view.status, view.insets] : [element('div', {class: 'work'}, view.stage, view.insets), view.status];
  view.area.append(view.controls, view.tabs, ...work,
    element('p', {class: 'note hint'}, `Drag moves, wheel or + - zooms (after a click into the pictures), ${keys} or space flip, `,
      `Enter touches the pixel in the middle, e E exposure, ${report.all ? '' : '[ ] budget, '}, . layer, 0 resets; drag a coloured frame to move its inset. `,
      view.sets()[0].live ? '' : `Values have eleven bits here${Object.keys(view.sets()[0].links).length ? '; the EXR files have all' : ''}.`), view.links);
  buildPixelPanel(view);
  view.stage.addEventListener('keydown', (event) => onKey(view, event));
  listenToPointers(view);
}

function render(view) {
  if (!view.faces) return;
  renderControls(view);
  layOutPanes(view);
  drawPanes(view);
  drawInsets(view);
  const [a, b] = view.pair();
  if (!report.all) view.links.replaceChildren(`${report.dumps[view.scene().dump]}: `, ...linkList(a, 'A'), ...(b === a ? [] : linkList(b, 'B')));
  showValues(view);
  view.stage.dataset.ready = 'true';
  for (const listener of view.listeners) listener();
}

// Built anew only when its choices change, so that a control keeps its focus while it is used.
function renderControls(view) {
  const {state} = view, budgets = view.budgets(), names = view.names();
  const key = JSON.stringify([state.scene, state.budget, names, view.faces.map((f) => f.name)]);
  if (view.controlsKey !== key) {
    view.controlsKey = key;
    const focused = view.controls.contains(document.activeElement) ? document.activeElement.id : '';
    const pick = (name) => (i) => view.choose({[name]: i});
    const labelled = (id, label) => { label.lastElementChild.id = id; return label; };
    const sides = report.all ? view.faces.map((face) => face.name) : names;
    view.controls.replaceChildren(...(report.all ? [] : [
      labelled('viewer-scene', select('Recording', view.scenes.map((s) => report.dumps[s.dump]), state.scene, pick('scene'))),
      slider('budget-slider', 'Samples per pixel', 0, budgets.length - 1, 1, pick('budget'))]),
    ...(report.all && sides.length < 3 ? [] : [
      ...['a', 'b'].flatMap((side) => sideLists(view, side, sides).map(([id, label]) => labelled(id, label)))]),
      buttons(view, 'layer', 'Layer', Object.keys(layers).filter((name) => has(view, name)).map((n) => [n, layers[n].name])),
      view.faces.length < 2 ? '' : buttons(view, 'mode', 'Show', Object.entries(modes)),
      slider('exposure-slider', 'Exposure', -10, 10, 0.5, (value) => { state.exposure = value; render(view); }),
      slider('split-slider', 'Split', 0, 1, 0.005, (value) => { state.split = value; render(view); }));
    if (focused) document.getElementById(focused)?.focus();
  }
  for (const side of ['a', 'b']) {
    const c = report.all ? {} : report.combinations[view.candidates()[state[side]].combination];
    for (const [id, value] of [['', state[side]], ['-sampler', c.sampler], ['-filter', c.filter]]) {
      const list = view.controls.querySelector(`#viewer-${side}${id}`);
      if (!list) continue;
      list.value = value;
      list.parentElement.hidden = report.all && state.mode !== 'split';  // all are shown otherwise
    }
  }
  if (!report.all) setSlider(view.controls.querySelector('#budget-slider'), state.budget, `${budgets[state.budget]} spp`);
  setSlider(view.controls.querySelector('#exposure-slider'), state.exposure, `${state.exposure >= 0 ? '+' : ''}${state.exposure} EV`);
  setSlider(view.controls.querySelector('#split-slider'), state.split, '');
  view.controls.querySelector('#split-slider').parentElement.hidden = state.mode !== 'split';
  for (const button of view.controls.querySelectorAll('button[data-value]')) {
    button.setAttribute('aria-pressed', String(state[button.dataset.group] === button.dataset.value));
  }
  view.tabs.hidden = state.mode !== 'flip';
  view.tabs.replaceChildren(...view.faces.map((face, i) => element('button', {type: 'button',
    'aria-pressed': String(i === state.face), onclick: () => view.choose({face: i})}, face.name)));
}

// [[id, list]] of what A or B shows: a list of samplers and one of filters where there are pairs of both, else one of all.
function sideLists(view, side, names) {
  const {state} = view, name = side.toUpperCase();
  const chosen = () => report.combinations[view.candidates()[state[side]].combination];
  const combinations = report.all ? [] : view.candidates().map((set) => report.combinations[set.combination]);
  const kinds = ['sampler', 'filter'].map((kind) => [kind, [...new Set(combinations.map((c) => c[kind]))]]);
  if (kinds.some(([, places]) => places.length < 2)) {
    return [[`viewer-${side}`, select(name, names, state[side], (i) => view.choose({[side]: i}))]];
  }
  // The same other half of the pair where it has a picture.
  const pick = (kind, other) => (value) => {
    const fits = combinations.map((c, i) => [c, i]).filter(([c]) => c[kind] === value);
    const [, place] = fits.find(([c]) => c[other] === chosen()[other]) ?? fits[0];
    view.choose({[side]: place});
  };
  return kinds.map(([kind, places], i) => {
    const label = select(i === 0 ? name : '+', places.map((place) => report[`${kind}s`][place]), -1, () => {});
    const list = label.lastElementChild;
    list.setAttribute('aria-label', `${kind} of ${name}`);
    [...list.options].forEach((option, at) => { option.value = places[at]; });
    list.addEventListener('change', () => pick(kind, kinds[1 - i][0])(Number(list.value)));
    return [`viewer-${side}-${kind}`, label];
  });
}

const has = (view, layer) => view.candidates().some((set) => set.images[layers[layer].picture] !== undefined &&
  (!layers[layer].minus || set.images[layers[layer].minus] !== undefined));

function buttons(view, group, title, entries) {
  return element('span', {class: 'buttons', role: 'group', 'aria-label': title}, ...entries.map(([value, name]) =>
    element('button', {type: 'button', 'data-group': group, 'data-value': value,
      onclick: () => view.choose({[group]: value})}, name)));
}

function slider(id, label, low, high, step, onchange) {
  const input = element('input', {type: 'range', id, min: low, max: high, step});
  input.addEventListener('input', () => onchange(Number(input.value)));
  return element('label', {class: 'slider'}, `${label} `, input, element('output', {}));
}

function setSlider(input, value, text) {
  input.value = value;
  input.setAttribute('aria-valuetext', text || String(value));
  input.nextElementSibling.textContent = text;
}

function zoomBy(view, factor) {
  view.state.zoom = Math.max(1, Math.min(view.state.zoom * factor, Math.max(64, view.size.width / 4)));
  view.stage.classList.toggle('zoomed', view.state.zoom > 1);
  drawPanes(view);
}

function onKey(view, event) {
  const {state} = view, step = 0.1 / state.zoom;
  if (event.ctrlKey || event.metaKey || event.altKey || !view.faces) return;
  const around = (key, list, by) => list[(list.indexOf(key) + by + list.length) % list.length];
  const shownLayers = Object.keys(layers).filter((name) => has(view, name));
  const budget = (by) => view.choose({budget: Math.max(0, Math.min(view.budgets().length - 1, state.budget + by))});
  const move = (x, y) => { state.x += x; state.y += y; drawPanes(view); };
  const actions = {
    ArrowLeft: () => move(-step, 0), ArrowRight: () => move(step, 0), ArrowUp: () => move(0, -step), ArrowDown: () => move(0, step),
    '+': () => zoomBy(view, 1.25), '=': () => zoomBy(view, 1.25), '-': () => zoomBy(view, 0.8),
    0: () => { Object.assign(state, {zoom: 1, x: 0.5, y: 0.5, exposure: 0, split: 0.5}); zoomBy(view, 1); render(view); },
    e: () => { state.exposure = Math.min(10, state.exposure + 0.5); render(view); },
    E: () => { state.exposure = Math.max(-10, state.exposure - 0.5); render(view); },
    Enter: () => { state.pixel = {x: Math.floor(state.x * view.size.width), y: Math.floor(state.y * view.size.height)}; render(view); },
    ' ': () => view.choose({mode: 'flip', face: report.all ? (state.face + 1) % view.faces.length : state.face === 0 ? 1 : 0}),
    '[': () => budget(-1), ']': () => budget(1),
    ',': () => view.choose({layer: around(state.layer, shownLayers, -1)}),
    '.': () => view.choose({layer: around(state.layer, shownLayers, 1)}),
  };
  for (const [key, face] of Object.entries(faceKeys(view.faces))) actions[key] = () => view.choose({mode: 'flip', face});
  if (!actions[event.key]) return;
  event.preventDefault();
  actions[event.key]();
}
