const live = document.getElementById("live"), told = document.getElementById("told");
const PAUSE = 2000, LOST = "the connection is lost; it is tried again";
let waiting = 0, source = null, isFinal = Boolean(live?.querySelector("[data-final]"));
const later = pause => { waiting ||= setTimeout(again, pause); };
const named = element => element && (element.getAttribute("href") ?? element.dataset.address);
async function again() {
  clearTimeout(waiting);
  waiting = 0;
  if (live.querySelector(":active")) return later(400);
  const asked = fetch(location.href, {headers: {Accept: "text/html"}});
  const [status, text] = await asked.then(async answer => [answer.status, await answer.text()]).catch(() => [503]);
  if (status >= 500) {
    told.textContent = LOST;
    return later(PAUSE);
  }
  if (status >= 400) {
    source?.close();
    told.textContent = status === 404 ? "it is there no more" : "it is not shown any more: load this page anew";
    return;
  }
  if (told.textContent === LOST) told.textContent = "";
  const page = new DOMParser().parseFromString(text, "text/html");
  const [fresh, rows, old] = [page.getElementById("live"), page.getElementById("rows"), document.getElementById("rows")];
  if (!fresh) return;
  const focus = live.contains(document.activeElement) ? named(document.activeElement) : null;
  isFinal = Boolean(fresh.querySelector("[data-final]"));
  live.replaceChildren(...fresh.childNodes);
  if (focus) [...live.querySelectorAll("a, button")].find(each => named(each) === focus)?.focus();
  if (rows && !old) live.after(rows);
  else if (rows && isFinal && !old.contains(document.activeElement)) old.replaceWith(rows);
  if (isFinal) source?.close();
  else if (source?.readyState === EventSource.CLOSED) follow();
}
function follow() {
  source = new EventSource(live.dataset.events);
  for (const kind of ["state", "items"]) source.addEventListener(kind, () => later(400));
  source.onerror = () => later(PAUSE);
}
async function act(button) {
  const {method, address, to, sure} = button.dataset;
  if (sure && !confirm(sure)) return;
  button.disabled = true;
  const options = {method, headers: {"Content-Type": "application/json"}, body: method === "POST" ? "{}" : undefined};
  const asked = fetch(address, options).then(async answer => [answer, answer.status === 204 ? {} : await answer.json()]);
  const [answer, json] = await asked.finally(() => { button.disabled = false; });
  if (!answer.ok) { told.textContent = json.detail; return; }
  const where = {job: "/jobs/" + json.id, tree: `/trees/${json.name}@${json.revision}`, jobs: "/jobs", here: location.href};
  location.assign(json.kind && json.id && to === "tree" ? "/jobs/" + json.id : where[to]);
}
document.addEventListener("click", event => {
  const button = event.target.closest("button[data-address]");
  if (button) act(button).catch(error => { told.textContent = "no answer: see whether the server runs, then try again"; });
});
if (live?.dataset.events && !isFinal) follow();
else if (live?.dataset.running) setInterval(again, PAUSE);
