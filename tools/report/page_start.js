// Fills the areas that the page holds; whichever fails says so in its place.
for (const [id, start] of Object.entries(starts)) {
  const area = document.getElementById(id);
  if (!area) continue;
  try {
    start(area);
  } catch (error) {
    area.append(element('p', {class: 'warning'}, `This part cannot be shown: ${error.message}`));
    throw error;
  }
}
// Last of what is done before printing: tables become as small as paper needs.
for (const [name, width] of [['beforeprint', 680], ['afterprint', Infinity]]) {
  addEventListener(name, () => {
    for (const table of document.querySelectorAll('.scroll table')) {
      table.style.zoom = 1;
      table.style.zoom = Math.min(1, width / table.offsetWidth);
    }
    if (name === 'afterprint') dispatchEvent(new Event('resize'));  // charts are as wide as the window again
  });
}
