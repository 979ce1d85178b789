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
