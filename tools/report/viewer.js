// The pictures of one recording: A, B and the reference - or all that there are, where the page says so - beside each
// other, under a slider, or in turn. All panes share zoom, place and exposure. What is shown follows from `state` alone; `render` makes the page agree with it.
function startImages(area) {
  const scenes = report.pictures.scenes.filter((s) => setsOf(s.dump).length > 0);
  if (scenes.length === 0) {
    area.append(element('p', {}, 'No image fits into this page; its EXR files: ',
      ...report.pictures.sets.slice(0, 200).flatMap((set) => linkList(set, 'results'))));
    return;
  }
  const state = {scene: 0, budget: 0, a: 0, b: 0, layer: 'image', mode: innerWidth < 700 && !report.all ? 'flip' : 'side', face: 1,
    split: 0.5, exposure: 0, zoom: 1, x: 0.5, y: 0.5, cursor: null, insets: [], pixel: null};
  const view = {state, scenes, area, panes: [], listeners: [], serial: 0};
  view.scene = () => scenes[state.scene];
  view.sets = () => setsOf(view.scene().dump);
  view.budgets = () => budgetsOf(view.sets());
  view.candidates = () => {
    const sets = view.sets(), spp = budgetsOf(sets)[state.budget];
    return sets.filter((set) => report.combinations[set.combination].spp === spp);
  };
  view.names = () => view.candidates().map((set) => methodOf(report.combinations[set.combination]));
  view.shownSets = () => (report.all ? view.candidates() : [view.candidates()[state.a], view.candidates()[state.b]]);
  view.pair = () => [0, 1].map((i) => view.shownSets()[i] ?? view.shownSets()[0]);
  view.choose = (change) => {
    const kept = ['a', 'b'].map((side) => view.names()[state[side]]);
    Object.assign(state, change);
    if ('scene' in change) Object.assign(state, {budget: Math.min(state.budget, view.budgets().length - 1), zoom: 1});
    // A method keeps its place on the screen when the budget or the recording changes.
    if ('scene' in change || 'budget' in change) {
      ['a', 'b'].forEach((side, i) => { state[side] = Math.max(0, view.names().indexOf(kept[i])); });
    }
    if (!report.all && ['scene', 'a', 'b'].some((key) => key in change)) state.insets = [];
    return loadShown(view).then(() => render(view), (error) => sayFailure(view, error));
  };
  Object.assign(state, firstChoice(view));
  buildViewer(view);
  openInViewer = (combination) => {
    const scene = scenes.findIndex((s) => s.dump === combination.dump);
    if (scene < 0) return;
    view.choose({scene});
    view.choose({budget: Math.max(0, view.budgets().indexOf(combination.spp))});
    const b = view.names().indexOf(methodOf(combination));
    if (b >= 0) view.choose({b});
    document.getElementById('images').scrollIntoView();
    view.controls.querySelector('select')?.focus({preventScroll: true});
  };
  addEventListener('resize', () => render(view));
  afterFirstPaint(() => view.choose({}));
}
starts['image-area'] = startImages;

let openInViewer = () => {};

// A picture that the program did not compute; one that was asked past is no failure.
function sayFailure(view, error) {
  if (!report.live) throw error;
  if (error.name !== 'AbortError' && error.message !== 'superseded') view.status.textContent = error.message;
}

// The baseline against the method that ranks first among those with pictures, at the largest budget; what the user added before others; without ranks, the
// project's own.
function firstChoice(view) {
  if (report.all) return {budget: 0, a: 0, b: 1, face: 0};
  // What has to be replayed first is small.
  const budget = view.sets()[0].live ? Math.max(0, view.budgets().indexOf(4)) : view.budgets().length - 1;
  view.state.budget = budget;
  const names = view.names();
  const ranked = rankedMethods(view.scene().dump, view.budgets()[budget]).filter((name) => names.includes(name));
  return {budget, a: Math.max(0, names.indexOf(report.baseline)),
    b: names.indexOf([report.first, ranked.find((name) => report.own.includes(name)), ranked[0], 'multiscale + directional', names.at(-1)].find((name) => names.includes(name)))};
}

// Pictures of the layer that is shown, and the values behind them: view.faces[i] = {letter, name, picture, set, map}.
async function loadShown(view) {
  const serial = ++view.serial, {state} = view, sets = view.shownSets(), layer = layers[state.layer];
  if (sets[0].live) nextLiveTurn();
  for (const recent of [unpackedPictures, paintedPictures]) recent.most = Math.max(recent.most, 3 * sets.length + 3);
  const of = async (set) => {
    const picture = await loadPicture(set, layer.picture);
    return layer.minus ? differenceOf(picture, await loadPicture(set, layer.minus)) : picture;
  };
  const judged = sets.find((set) => set.images.reference !== undefined) ?? sets[0];
  const [reference, images, pictures] = await Promise.all([loadPicture(judged, 'reference'),
    Promise.all(sets.map((set) => loadPicture(set, 'estimate'))), Promise.all(sets.map(of))]);
  for (const set of sets.filter((entry) => entry.live && serial === view.serial)) {
    const {spent, relmse} = await liveAnswer('replay', parametersOf(set));
    set.said = `: ${spent} samples${relmse === undefined ? '' : `, relMSE ${numberText(relmse)}`}`;
  }
  if (serial !== view.serial) return;
  view.images = {a: images[0], b: images[1] ?? images[0], reference};
  view.faces = sets.map((set, i) => ({letter: report.all ? String(i + 1) : 'AB'[i], name: methodOf(report.combinations[set.combination]),
    picture: pictures[i], set, map: state.layer !== 'image'}));
  if (reference) view.faces.push({letter: 'R', name: 'reference', picture: reference, map: false});
  for (const key of ['face', ...(report.all ? ['a', 'b'] : [])]) state[key] = Math.min(state[key], view.faces.length - 1);
  view.size = {width: images[0].width, height: images[0].height};
  if (state.insets.length === 0) state.insets = report.crops ?? view.scene().windows?.map((w) => ({...w})) ?? chooseInsets(view);
}

function facePainting(view, face) {
  if (!face.picture) return null;
  if (!face.map) return paintImage(face.picture, view.scene().exposure + view.state.exposure);
  const layer = layers[view.state.layer];
  return paintMap(face.picture, layer.scale(view.scene(), view.budgets()[view.state.budget]), layer.cyclic);
}

function linkList(set, letter) {
  const c = report.combinations[set.combination];
  if (Object.keys(set.links).length === 0) return [`${letter}, ${methodOf(c)}, ${c.spp} spp${set.said ?? ''}. `];
  return [`${letter}, ${methodOf(c)}, ${c.spp} spp: `, ...Object.entries(set.links).flatMap(
    ([name, href], i) => [i > 0 ? ', ' : '', element('a', {href}, `${name}.exr`)]), '. '];
}
