const box = document.getElementById("filter"), count = document.getElementById("count");
const cards = [...document.querySelectorAll("[data-text]")];
function filter() {
  const words = box.value.toLowerCase().split(/\s+/);
  for (const card of cards) card.hidden = !words.every(word => card.dataset.text.includes(word));
  count.textContent = cards.filter(card => !card.hidden).length;
}
box.addEventListener("input", filter);
