const file = document.getElementById("file"), report = document.getElementById("report");
function line(text, address) {
  const item = document.createElement("li"), inner = address ? document.createElement("a") : item;
  inner.textContent = text;
  if (address) { inner.href = address; item.append(inner); }
  report.append(item);
}
async function upload() {
  if (!file.files.length) return;
  const chosen = file.files[0];
  report.replaceChildren();
  line("reading " + chosen.name + " ...");
  const told_of = {store: "true", file: chosen.name.slice(0, 200)}, cut = document.getElementById("cut").value.trim();
  const address = "/v1/imports?" + new URLSearchParams(cut ? {...told_of, cut} : told_of);
  const answer = await fetch(address, {method: "POST", headers: {"Content-Type": "application/octet-stream"}, body: chosen});
  const told = await answer.json();
  report.replaceChildren();
  if (answer.status === 202) return line("became a job: " + told.id, "/jobs/" + told.id);
  if (!answer.ok) return (told.errors?.length ? told.errors : [{message: told.detail}]).forEach(fault => line(fault.message));
  const kind = told.tree ? "/trees/" : "/substructures/";
  line("stored as " + told.stored.name + "@" + told.stored.version, kind + told.stored.name + "@" + told.stored.version);
  told.report.forEach(remark => line(remark.level + ": " + remark.place + ": " + remark.message));
}
file?.addEventListener("change", () => upload().catch(error => line("no answer: " + error)));
