// The page while `spool view` serves it: pictures of any budget and the samples of any pixel, asked of the program.
const live = {page: `${Math.random()}`.slice(2), turn: 0, open: new Map(), stop: new AbortController(), choices: null};
const livePictures = new Recent(24);

// A request for the budget before is not waited for any more.
function nextLiveTurn() {
  if (live.open.size > 0) {
    live.stop.abort();
    live.stop = new AbortController();
    for (const key of live.open.keys()) livePictures.map.delete(key);
    live.open.clear();
  }
  live.turn += 1;
}

async function askProgram(name, parameters, signal) {
  const answer = await fetch(`${name}?${new URLSearchParams(parameters)}`, {signal});
  if (!answer.ok) throw new Error((await answer.json()).error);
  return answer;
}

// {spent, relmse, pictures: {name: picture}} of a set of results that the program computes.
function liveAnswer(name, parameters) {
  const key = JSON.stringify([name, parameters]);
  return livePictures.get(key, () => {
    const signal = live.stop.signal;
    const promise = askProgram(name, name === 'replay' ? {...parameters, page: live.page, turn: live.turn} : parameters, signal)
      .then((answer) => answer.arrayBuffer()).then((bytes) => unpackPlanes(bytes, key));
    live.open.set(key, promise);
    promise.then(() => live.open.delete(key), () => { live.open.delete(key); livePictures.map.delete(key); });
    return promise;
  });
}

function unpackPlanes(bytes, key) {
  const length = new DataView(bytes).getUint32(0, true);
  const said = JSON.parse(new TextDecoder().decode(new Uint8Array(bytes, 4, length)));
  let at = 4 + length;
  const pictures = {};
  for (const {name, channels} of said.planes) {
    const size = said.width * said.height * channels;
    pictures[name] = {width: said.width, height: said.height, channels, values: new Float32Array(bytes, at, size), key: `${key} ${name}`};
    at += 4 * size;
  }
  return {...said, pictures};
}

async function livePicture(set, name) {
  const {recording, reference} = set.live;
  if (name === 'reference') return reference ? (await liveAnswer('reference', {recording})).pictures.reference : null;
  return (await liveAnswer('replay', parametersOf(set))).pictures[name] ?? null;
}

const parametersOf = ({live: {recording, sampler, filter, spp}}) => ({recording, sampler, filter, spp});

async function liveChoices() {
  live.choices ??= await (await askProgram('choices', {})).json();
  return live.choices;
}

// What was recorded at the pixel that was touched, with the weights of A and B.
async function livePixel(view) {
  const {pixel} = view.state, crop = view.scene().crop ?? [0, 0];
  if (!pixel) return null;
  const choices = await liveChoices(), at = {x: pixel.x + crop[0], y: pixel.y + crop[1]};
  const recording = choices.recordings.findIndex((r) => r.label === report.dumps[view.scene().dump]);
  if (recording < 0) return null;
  const answers = await Promise.all(view.pair().map(async (set) => {
    const c = report.combinations[set.combination];
    const sampler = choices.samplers.indexOf(report.samplers[c.sampler]), filter = choices.filters.indexOf(report.filters[c.filter]);
    const more = sampler < 0 || filter < 0 ? {} : {sampler, filter, spp: c.spp};
    return [set.combination, await (await askProgram('pixel', {recording, ...at, ...more})).json()];
  }));
  const footprints = Object.fromEntries(answers.filter(([, told]) => told.footprint).map(([combination, {footprint}]) =>
    [combination, {...footprint, taps: footprint.taps.map(([x, y, weight]) => [x - at.x, y - at.y, weight])}]));
  return {...answers[0][1], footprints};
}

// Whole numbers of samples, closer than a quarter of a doubling apart only where there are no others.
function liveBudgets(spp) {
  const budgets = [];
  for (let n = 1; n <= spp; n = Math.max(n + 1, Math.round(n * 2 ** 0.25))) budgets.push(n);
  return budgets;
}

// Every method at every budget, as results that the viewer knows; nothing is computed before it is shown.
function addLiveSets({recordings, samplers, filters}) {
  Object.assign(report, {dumps: recordings.map((r) => r.label), samplers, filters});
  const images = Object.fromEntries(['estimate', 'squared_error', 'density', 'filter_size', 'direction'].map((name) => [name, true]));
  recordings.forEach((r, recording) => {
    if (r.error) return;
    report.pictures.scenes.push({dump: recording, exposure: r.exposure, mean: r.mean, width: r.width, height: r.height, crop: null});
    for (const spp of liveBudgets(r.spp)) {
      samplers.forEach((_, sampler) => filters.forEach((_f, filter) => {
        report.pictures.sets.push({combination: report.combinations.length, links: {},
          images: r.reference ? {...images, reference: true} : images, live: {recording, sampler, filter, spp, reference: r.reference}});
        report.combinations.push({dump: recording, sampler, filter, spp, replicates: 1, failed: 0, values: [], ranks: {}, loses: 0});
      }));
    }
  });
}

async function startLive(area) {
  try {
    const choices = await liveChoices();
    addLiveSets(choices);
    if (choices.left_out) area.append(element('p', {class: 'note'}, choices.left_out));
    for (const {label, error} of choices.recordings.filter((r) => r.error)) {
      area.append(element('p', {class: 'warning'}, `${label}: ${error}`));
    }
    if (report.pictures.scenes.length === 0) {
      area.append(element('p', {}, 'No recording of these results can be replayed here.'));
      return;
    }
    startImages(area);
  } catch (error) {
    area.append(element('p', {class: 'warning'}, `The program does not answer: ${error.message}. Start spool view again.`));
  }
}
starts['live-area'] = startLive;
