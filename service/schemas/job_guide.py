"""What an item of a job is, kind by kind, for the OpenAPI document and the command line; the examples are tested."""

from __future__ import annotations

from typing import Any

KINDS = """What every item is, its optional fields in brackets. `tree` and `substructure` are references: `swing`, \
`swing@2`.

- `assemble`: a tree document, the body of `POST /v1/trees` (`TreeSpec`); the tree is stored.
- `derive`: a definition, the body of `POST /v1/substructures` (`Definition`); the version is stored.
- `verify`: `substructure` or `tree`, a reference, or `*` for the whole catalogue or all revisions of trees; the \
stored formulas are proven by deriving them anew.
- `upgrade`: `substructure` or `tree`, a reference to something of one's own, or `*` for the latest versions or \
revisions of all that is; it is derived anew with today's software, and the program takes the place of what is stored.
- `compare`: `a`, `b`, [`coordinates`], the body of `POST /v1/equivalences` (`EquivalenceRequest`), whose answer is \
the result. `b` may be a list, one against many, or `*` for all versions of the catalogue: an item each.
- `evaluate`: `tree`, `request`, [`grid` or `sample`], [`format`: `npz` (default), `arrow`]. `request` is the body of \
`POST /v1/trees/{ref}/evaluations` (`EvaluationRequest`); its states are `q` and `qd` there, or come from a grid or a \
sample, in which coordinates that are not named are 0. Names are coordinates (`rod.q1`), velocities (`rod.q1'`), \
parameters (`rod.m1`) and inputs (`tau.rod.q1`). `grid`: by name a number, a list, or `{"from", "to", "count"}`; all \
combinations, the last name varies fastest; numbers may have units. `sample`: `{"count", ["seed"], ["ranges"]}`, \
uniform in `ranges`, `[low, high]` by name, and for coordinates without one in their joint limits. Many states are \
split into items of at most `job_states`.
- `simulate`, `optimise`: `tree`, `request` or `requests` (a list, an item each), [`format`: `json` (default), `npz`, \
`csv`, `arrow`, `svg`, as far as the result can be one]. A request is the body of `POST /v1/trees/{ref}/simulations` \
or `.../optimal-controls`.
- `analyse`: the same with `analysis`, the last part of the path of any endpoint of the group analyses that computes \
numbers, such as `linearisations`, `root-loci`; a request is the body of that endpoint.
- `export`: `tree`, `quantity`, `format`, [`form`, `bind`, `options`, `group`], which mean what they mean for `GET \
/v1/trees/{ref}/{quantity}`; `options` are lists of texts by name. For the quantity `velocity-equations` also \
`request`, the body of its endpoint (`VelocityConstraints`). Or `tree`, `target`, [`quantities`, `name`, `bind`, \
`together`, `packed`, `fmi`, `precision`, `ranges`, `stages`, `standard`, `independent`], \
as of `GET /v1/trees/{ref}/export`; with `substructure` in place of `tree`, as of that of a part.
- `mirror`: `source`, the address of another instance (`https://parts.example.org`), one of those that the operator \
lists in `SUBSTRUCTURES_MIRROR_SOURCES`; the latest versions of all its public parts are stored, but for those that \
are there. Submitted again, or tried again after a failure, it goes on with what is missing.
- `sweep`: no items, but `template`, `columns`, [`choices`, `samples`, `where`, `pareto`, `keep`, `proof`]: numbers of \
all combinations, as a table (`GET /v1/jobs/{id}/table`)."""

CHOICES = """Lists of values by place in the template; every combination makes an item, the last choice varies \
fastest. A place is a JSON pointer (RFC 6901) into the template (`/request/parameters/rod.m1`, `/request/q/0`), all \
of which exists but the last step. In a tree document it can also be an instance (`arm`: its substructure) or an \
instance and a parameter (`arm.m`: what that is bound to); the trees get names of their own, `pair-ur5-camera`, \
unless `/name` is chosen."""

_SWING = {"q": [1.2, 0], "span": [0, 5], "step": 0.05}
EXAMPLES: tuple[dict[str, Any], ...] = (
    {
        "kind": "assemble",
        "template": {
            "name": "pair",
            "gravity": [0, 0, "-9.81"],
            "instances": [
                {"name": "arm", "substructure": "puma560"},
                {"name": "hand", "substructure": "camera", "at": "arm.flange"},
            ],
        },
        "choices": {"arm": ["puma560", "ur5"], "hand": ["parallel-gripper", "camera"]},
    },
    {
        "kind": "evaluate",
        "items": [
            {"tree": "swing", "request": {"quantities": ["metric"], "q": [[0, 0], [0.5, 1]]}},
            {
                "tree": "swing",
                "request": {"quantities": ["metric", "forces"]},
                "grid": {"rod.q1": {"from": -3, "to": 3, "count": 100}, "rod.q2'": [0, 1]},
            },
            {
                "tree": "swing",
                "request": {"quantities": ["forward_dynamics"]},
                "sample": {"count": 10000, "seed": 1, "ranges": {"rod.q1": [-1, 1], "tau.rod.q2": [-5, 5]}},
                "format": "npz",
            },
        ],
    },
    {
        "kind": "simulate",
        "template": {"tree": "swing", "request": {**_SWING, "parameters": {}}, "format": "csv"},
        "choices": {"/request/parameters/rod.m1": [0.5, 1, 2], "/request/q/0": [0.1, 1.2]},
    },
    {"kind": "simulate", "items": [{"tree": "swing", "requests": [_SWING, {**_SWING, "q": [0, 1.2]}]}]},
    {"kind": "analyse", "items": [{"tree": "swing", "analysis": "linearisations", "request": {"q": [0, 0]}}]},
    {"kind": "export", "items": [{"tree": "swing", "quantity": "metric", "format": "latex", "form": "expanded"}]},
    {"kind": "export", "items": [{"tree": "swing", "target": "c", "quantities": ["metric", "forces"]}]},
    {"kind": "verify", "items": [{"substructure": "*"}]},
    {"kind": "upgrade", "items": [{"substructure": "*"}]},
    {"kind": "compare", "items": [{"a": "swing", "b": ["acrobot", "puma560"], "coordinates": {"rod.q1": "q1"}}]},
)
