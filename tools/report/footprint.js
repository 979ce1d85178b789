// With which weights a filter made a pixel: a map of them around the pixel, for A and B where their filters can say.
function footprintOf(set, found) {
  if (found.footprints) return found.footprints[set.combination] ?? null;
  const entry = report.pixels.find((e) => e.answers.includes(found));
  return entry?.footprints?.[set.combination]?.[entry.answers.indexOf(found)] ?? null;
}

function footprintFigures(view, found) {
  const area = element('div', {class: 'footprints'});
  view.pair().forEach((set, i) => {
    const footprint = footprintOf(set, found);
    if (!footprint) return;
    const largest = Math.max(...footprint.taps.map((tap) => tap[2])), {shapes} = footprint;
    const shape = shapes.length === 0 ? '' : shapes.map(({size, direction, widths}) => `size ${size}, ` +
      (Number.isFinite(direction) && direction !== null ? `direction ${numberText(direction, 3)}°` : 'no direction') +
      (widths.length > 0 ? `; widths ${widths.map(([beta, delta]) => `${numberText(delta, 3)} at ${numberText(beta, 3)}°`).join(', ')}`
        : '')).join('; ');
    area.append(element('figure', {class: 'footprint'},
      element('h3', {}, `${'AB'[i]}: weights of ${view.faces[i].name}`), footprintCanvas(footprint, largest),
      element('figcaption', {class: 'note'}, `${footprint.taps.length} ${footprint.taps.length === 1 ? 'pixel' : 'pixels'}, largest weight ${numberText(largest, 3)}` +
        (shape ? `; ${shape}` : ''))));
  });
  return area;
}

// A square for each pixel that took part, red where its weight is negative; the frame is the pixel itself.
function footprintCanvas({taps}, largest) {
  const reach = Math.max(2, ...taps.map(([dx, dy]) => Math.max(Math.abs(dx), Math.abs(dy)))), across = 2 * reach + 1;
  const side = Math.max(2, Math.floor(260 / across)), canvas = canvasOf(across * side, across * side);
  const context = canvas.getContext('2d'), table = rampTable('viridis');
  context.fillStyle = '#000';
  context.fillRect(0, 0, canvas.width, canvas.height);
  for (const [dx, dy, weight] of taps) {
    const share = Math.min(1, Math.abs(weight) / largest) ** 0.5, c = 3 * Math.round(255 * share);
    context.fillStyle = weight < 0 ? `rgb(${Math.round(255 * share)}, 0, 0)` : `rgb(${table[c]}, ${table[c + 1]}, ${table[c + 2]})`;
    context.fillRect((dx + reach) * side, (dy + reach) * side, side, side);
  }
  context.strokeStyle = '#fff';
  context.strokeRect(reach * side + 0.5, reach * side + 0.5, side - 1, side - 1);
  canvas.className = 'weights';
  return named(canvas, `weights of ${taps.length} pixels, brightness by their square root`);
}
