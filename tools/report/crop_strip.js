// One strip for each recording: the windows where methods differ, of the baseline, the method that is shown first and the
// reference, beside the whole picture with their frames.
const MOST_STRIPS = 6;

function drawCrops(holder) {
  const scenes = report.pictures.scenes.filter((s) => setsOf(s.dump).length > 0).slice(0, MOST_STRIPS);
  const strips = scenes.map((scene) => element('figure', {class: 'crop'}));
  holder.replaceChildren(...strips);
  scenes.forEach((scene, i) => drawStrip(strips[i], scene));
}

async function drawStrip(strip, scene) {
  const sets = setsOf(scene.dump), budgets = budgetsOf(sets);
  const spp = budgets.includes(hero.spp) ? hero.spp : budgets[0];
  const of = (name) => sets.find((set) => {
    const c = report.combinations[set.combination];
    return c.spp === spp && methodOf(c) === name;
  });
  const ranked = ownFirst(rankedMethods(scene.dump, spp)).filter((name) => name !== hero.baseline && of(name));
  const input = of(hero.baseline) ?? sets.find((set) => report.combinations[set.combination].spp === spp);
  const first = ranked.length > 0 ? of(ranked[0]) : input;
  if (!input) return;
  const reference = await loadPicture(input.images.reference !== undefined ? input : first, 'reference');
  const estimates = await Promise.all([...new Set([input, first])].map(async (set) => [methodText(set), await loadPicture(set, 'estimate')]));
  const shown = [...estimates, ['reference', reference]].filter(([, picture]) => picture);
  const windows = scene.windows.slice(0, report.pictures.scenes.length > 1 ? 1 : 2), whole = reference ?? shown[0][1];
  const nodes = [tile(whole, scene, {x: 0, y: 0, width: whole.width, height: whole.height}, 'white', report.dumps[scene.dump], windows),
    ...windows.flatMap((window_, i) => shown.map(([name, picture]) => tile(picture, scene, window_, insetColour(i), name)))];
  strip.replaceChildren(element('div', {class: 'strip'}, ...nodes),
    element('figcaption', {}, `${report.dumps[scene.dump]}, ${spp} spp`));
}

const methodText = (set) => methodOf(report.combinations[set.combination]);

// A part of a picture, enlarged; `frames` are drawn on it.
function tile(picture, scene, part, colour, name, frames = []) {
  const scale = 180 / part.height, canvas = canvasOf(Math.round(part.width * scale), 180), context = canvas.getContext('2d');
  context.imageSmoothingEnabled = false;
  context.drawImage(paintImage(picture, scene.exposure), part.x, part.y, part.width, part.height, 0, 0, canvas.width, 180);
  context.lineWidth = 3;
  frames.forEach((frame, i) => {
    context.strokeStyle = insetColour(i);
    context.strokeRect(frame.x * scale, frame.y * scale, frame.width * scale, frame.height * scale);
  });
  named(canvas, frames.length ? `${name}, the whole picture` : `${name}, a part enlarged`);
  return element('div', {}, element('div', {style: frames.length ? '' : `border-top: 3px solid ${colour}`}, canvas),
    element('small', {title: name}, name));
}
