// "/" goes to the search, wherever it is not typed into something.
addEventListener("keydown", (event) => {
    if (event.key !== "/" || event.target.closest("input, textarea, select")) return;
    const box = document.getElementById("filter") ?? document.getElementById("find");
    if (!box) return;
    event.preventDefault();
    box.focus();
    box.select();
});
