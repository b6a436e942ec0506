"""Tendons of MJCF files as loads, beside MuJoCo: accelerations and energies; what is told and what is refused."""

from __future__ import annotations

import sys
from pathlib import Path

import numpy as np
import pytest

from substructures import Definition, Model, TreeSpec, couple, derive, evaluate
from substructures.errors import InvalidDocument
from substructures.interchange.files.wanted import Options
from substructures.interchange.importing import import_file

mujoco = pytest.importorskip("mujoco", reason="MuJoCo is in the extra 'bench'")
pytest.importorskip("pinocchio", reason="Pinocchio is in the test extra (not on Windows)")
sys.path.insert(0, str(Path(__file__).parent))
from corpus import compared  # noqa: E402 -- the engine is optional
from with_mujoco import MujocoTwin  # noqa: E402 -- the engine is optional

ARM = """<mujoco><option><flag contact="disable" energy="enable"/></option><worldbody><site name="w" pos="0 .5 1"/>
<body name="a" pos="0 0 1" euler="0 0 30"><joint name="j" axis="0 1 0" pos=".2 .1 0" ref="10" springref="40"
 stiffness="3"/><geom name="g" size=".1" pos="1 0 0"/><site name="s" pos=".5 0 .1"/>
<body name="b" pos="1 0 0" euler="20 0 0"><joint name="k" axis="0 1 1" pos=".1 0 .2" springref="-20"/>
<joint name="l" type="slide" axis="1 1 0" ref=".2" springref=".7" stiffness="1"/><geom size=".1" pos=".5 0 0"/>
<frame pos="0 0 .2"><site name="u" pos=".3 0 .1"/></frame></body></body></worldbody>TAIL</mujoco>"""
FIXED = '<fixed name="t" {}><joint joint="j" coef="2"/><joint joint="k" coef="-1"/><joint joint="l" coef=".3"/></fixed>'
SPATIAL = '<spatial name="t" {}><site site="w"/><site site="s"/><site site="u"/></spatial>'
WITHIN = '<spatial name="t" {}><site site="s"/><site site="u"/></spatial>'
BEYOND = '<spatial name="t" {}><site site="w"/><site site="u"/></spatial>'
STATES = 24
#: attributes of tendons, and whether all three of shorter, slack and longer are met
LAWS = {
    "spring and damper": ('stiffness="20" damping="3"', False),
    "spring": ('stiffness="20" springlength=".3"', False),
    "damper": ('damping="3"', False),
    "dead band": ('stiffness="20" damping="3" springlength="BAND"', True),
    "dead band without damper": ('stiffness="20" springlength="BAND"', True),
    "slack": ('stiffness="20" springlength="0 1.4"', False),
    "slack, with damper": ('stiffness="20" damping="2" springlength="0 1.4"', False),
}
TENDONS = {
    "fixed": (FIXED, "-.4 .6"),
    "spatial": (SPATIAL, "1.4 1.7"),
    "within": (WITHIN, ".8 1"),
    "from the world": (BEYOND, "1.2 1.5"),
}


def arm(tendon: str, more: str = "") -> str:
    return ARM.replace("TAIL", f"{more}<tendon>{tendon}</tendon>")


def model_of(text: str, cut: tuple[str, ...]) -> Model:
    found = import_file(text.encode(), Options("none"), cut=cut)
    instances = [{"name": "x", "definition": found.definition}] if found.tree is None else found.tree["instances"]
    tree = {"name": "t", "gravity": [0, 0, -9.81], "instances": instances}
    parts = {each["name"]: derive(Definition.read(each["definition"])) for each in instances}
    return couple(TreeSpec.read(tree if found.tree is None else found.tree), parts)


@pytest.mark.parametrize("cut", [(), ("b",)], ids=["whole", "cut"])
@pytest.mark.parametrize("law", LAWS)
@pytest.mark.parametrize("kind", TENDONS)
def test_tendons_accelerate_as_in_mujoco_and_keep_its_energy(kind: str, law: str, cut: tuple[str, ...]) -> None:
    tendon, band = TENDONS[kind]
    text = arm(tendon.format(LAWS[law][0].replace("BAND", band)))
    ours, engine = model_of(text, cut), mujoco.MjModel.from_xml_string(text)
    q, qd = np.random.default_rng(7).uniform(-1.3, 1.3, (2, STATES, 3))
    answer = evaluate(ours, ["forward_dynamics", "potential_energy"], q=q, qd=qd)
    data, energies, sides = mujoco.MjData(engine), [], set()
    for i in range(STATES):
        data.qpos[:], data.qvel[:] = q[i], qd[i]
        mujoco.mj_forward(engine, data)
        assert answer["forward_dynamics"][i] == pytest.approx(data.qacc, rel=1e-9, abs=1e-9)
        energies.append(data.energy[0])
        sides.add(int(np.sum(data.ten_length[0] > engine.tendon_lengthspring[0])))
    assert np.ptp(answer["potential_energy"] - energies) < 1e-9
    assert not LAWS[law][1] or sides == {0, 1, 2}


@pytest.mark.filterwarnings("ignore")
@pytest.mark.parametrize("base", ["", "<freejoint/>"])
@pytest.mark.parametrize("tendon", [FIXED, SPATIAL])
def test_joints_that_follow_and_bodies_that_float_pull_tendons(tendon: str, base: str, tmp_path: Path) -> None:
    """With the attributes of a class, and of a file whose equations bind two joints of the tendon."""
    more = '<default><default class="c"><tendon stiffness="7" damping="2"/></default></default>'
    bound = '<equality><joint joint1="k" joint2="j" polycoef=".1 .5 0 0 0"/></equality>'
    text = arm(tendon.format('class="c" springlength=".9"'), more + bound)
    root = f'<body name="r" pos="1 2 3" euler="10 20 30">{base}<geom size=".3"/><body name="a"'
    path = tmp_path / "model.xml"
    path.write_text(text.replace('<body name="a"', root).replace("</worldbody>", "</body></worldbody>"))
    row = compared("tendon", path, MujocoTwin)
    assert not row.refused
    assert row.error < 1e-10


def told(tendon: str) -> list[str]:
    return [x["message"] for x in import_file(arm(tendon).encode()).definition.get("left_out", ())]


GEOM = '<spatial name="t" stiffness="2" damping="1"><site site="w"/><geom geom="g"/><site site="u"/></spatial>'
PULLEY = '<spatial name="t" stiffness="2"><site site="w"/><site site="s"/><pulley divisor="2"/><site site="s"/><site site="u"/></spatial>'  # noqa: E501


@pytest.mark.parametrize(
    ("tendon", "said"),
    [
        (GEOM, "stiffness, damping of a tendon is left out, which wraps around the geom 'g' (give sites in its place"),
        (GEOM.replace("geom=", "sidesite='s' geom="), "stiffness, damping of a tendon is left out, which wraps around"),
        (PULLEY, "stiffness of a tendon is left out, which is divided by a pulley: add a load for it"),
        (FIXED.format('range="-1 1"'), "range of a tendon is left out: add a load for it"),
        (SPATIAL.format('stiffness="1" limited="true" range="0 1"'), "range of a tendon is left out: add a load"),
        (FIXED.format('stiffness="1 2"'), "stiffness of a tendon is left out, which is a polynomial"),
        (FIXED.format('stiffness="1" frictionloss="2" armature="1"'), "armature, frictionloss of a tendon is left out"),
    ],
)
def test_what_no_load_says_is_told(tendon: str, said: str) -> None:
    (message,) = told(tendon)
    assert f": {said}" in message
    assert 'name="t"' in message


def test_a_tendon_that_does_nothing_is_no_loss() -> None:
    assert told(FIXED.format("")) == told(SPATIAL.format('width=".1"')) == []
    assert told(SPATIAL.format('limited="false" range="0 1"')) == []


def test_a_tendon_of_several_parts_over_a_joint_that_follows_is_told() -> None:
    bound = '<equality><joint joint1="l" joint2="k" polycoef=".1 .5 0 0 0"/></equality>'
    found = import_file(arm(FIXED.format('stiffness="1"'), bound).encode(), cut=("b",))
    assert found.tree is not None
    assert "loads" not in found.tree
    (lost,) = found.definition["left_out"]
    assert "a tendon over joints of several parts, one of which moves with another, is left out" in lost["message"]


@pytest.mark.parametrize(
    ("tendon", "said"),
    [
        (
            FIXED.format('stiffness="1"').replace('"k"', '"kk"'),
            "there is no joint 'kk' of one coordinate; did you mean",
        ),
        (SPATIAL.format('damping="1"').replace('"u"', '"v"'), "there is no site 'v'"),
        (FIXED.format('stiffness="1" springlength="2 1"'), "springlength is one length, or two of which the first"),
        (FIXED.format('stiffness="1" springlength="1 2 3"'), "springlength is one length, or two"),
        ('<spatial name="t" stiffness="1"><site site="w"/></spatial>', "two sites at least"),
        ('<fixed name="t" stiffness="1"/>', "a tendon needs a joint"),
    ],
)
def test_bad_tendons_are_refused_with_their_place(tendon: str, said: str) -> None:
    with pytest.raises(InvalidDocument, match=f"line [0-9]+: <(fixed|spatial|joint|site).*>: .*{said}"):
        import_file(arm(tendon).encode())
