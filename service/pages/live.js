const live = document.getElementById("live"), told = document.getElementById("told");
let waiting = 0;
async function again() {
  waiting = 0;
  const answer = await fetch(location.href, {headers: {Accept: "text/html"}});
  if (!answer.ok) throw new Error(answer.statusText);
  const fresh = new DOMParser().parseFromString(await answer.text(), "text/html").getElementById("live");
  if (fresh && !live.contains(document.activeElement)) live.replaceChildren(...fresh.childNodes);
}
function follow(source) {
  source.onmessage = source.onopen = null;
  for (const kind of ["state", "items"]) source.addEventListener(kind, () => { waiting ||= setTimeout(again, 400); });
  source.onopen = () => { told.textContent = ""; };
  source.onerror = () => {
    if (source.readyState === EventSource.CLOSED || live.querySelector("[data-final]")) return source.close();
    told.textContent = "the connection is lost; it is tried again";
  };
}
async function act(button) {
  const {method, address, to, sure} = button.dataset;
  if (sure && !confirm(sure)) return;
  button.disabled = true;
  const options = {method, headers: {"Content-Type": "application/json"}, body: method === "POST" ? "{}" : undefined};
  const answer = await fetch(address, options), json = answer.status === 204 ? {} : await answer.json();
  button.disabled = false;
  if (!answer.ok) { told.textContent = json.detail; return; }
  const where = {job: "/jobs/" + json.id, tree: `/trees/${json.name}@${json.revision}`, jobs: "/jobs", here: location.href};
  location.assign(json.kind && json.id && to === "tree" ? "/jobs/" + json.id : where[to]);
}
document.addEventListener("click", event => {
  const button = event.target.closest("button[data-address]");
  if (button) act(button).catch(error => { told.textContent = "no answer: " + error; });
});
if (live?.dataset.events && !live.querySelector("[data-final]")) follow(new EventSource(live.dataset.events));
else if (live?.dataset.running) setInterval(() => again().catch(() => {}), 2000);
