// One strip for each recording: the same small window of the baseline, the best method and the reference.
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
  const best = rankedMethods(scene.dump, spp).map(of).find((set) => set);
  const input = of(hero.baseline) ?? sets.find((set) => report.combinations[set.combination].spp === spp);
  if (!best || !input) return;
  const reference = await loadPicture(input.images.reference !== undefined ? input : best, 'reference');
  const shown = [['input', input, await loadPicture(input, 'estimate')], ['best', best, await loadPicture(best, 'estimate')],
    ['reference', null, reference]].filter(([, , picture]) => picture);
  const {width, height} = shown[0][2], side = Math.min(width, height, Math.max(24, Math.round(Math.min(width, height) / 3)));
  const score = reference ? relativeError(shown[0][2], reference) : new Float32Array(width * height);
  const window_ = bestWindow(score, width, height, side);
  const nodes = shown.map(([role, set, picture]) => {
    const size = 180, canvas = canvasOf(size, size), context = canvas.getContext('2d');
    context.imageSmoothingEnabled = false;
    context.drawImage(paintImage(picture, scene.exposure), window_.x, window_.y, side, side, 0, 0, size, size);
    const c = set && report.combinations[set.combination];
    return element('div', {}, canvas, element('small', {}, c ? `${role}: ${methodOf(c)}` : role));
  });
  strip.replaceChildren(element('div', {class: 'three'}, ...nodes),
    element('figcaption', {}, `${report.dumps[scene.dump]}, ${spp} spp`));
}
