"""MJCF (https://mujoco.readthedocs.io/en/stable/XMLreference.html), with names of older versions."""

from __future__ import annotations

from substructures.interchange.known.check import Vocabulary

_TURNED = "axisangle euler quat xyaxes zaxis"
_JOINT = """actuatorfrclimited actuatorfrcrange actuatorgravcomp armature axis class damping frictionloss group limited
margin name pos range ref solimpfriction solimplimit solreffriction solreflimit springdamper springref springyield
stiffness type user"""
_GEOM = f"""{_TURNED} adhesion castshadow class conaffinity condim contype density fitscale fluidcoef fluidshape
friction fromto gap group hfield hfieldname margin mass material mesh name pos priority rgba shellinertia size
solimp solmix solref surfacevel type user"""
_SITE = f"{_TURNED} class fromto group material mesh name pos rgba size type user"
_TENDON = """actuatorfrclimited actuatorfrcrange armature class damping frictionloss group limited margin material name
range rgba solimpfriction solimplimit solreffriction solreflimit springlength springyield stiffness user width"""
#: of every actuator, and of those with gains, activations, or other models
_ACTUATOR = """actdim actearly actlimited actrange area armature bias biasprm biastype body class cogging controller
cranklength cranksite ctrllimited ctrlrange damping dampratio delay diameter dynprm dyntype ffrange force forcelimited
forcerange fpmax fvmax gain gainprm gaintype gear group imax inductance inheritrange input instance interp joint
jointinparent ki kp kv lengthrange lmax lmin lugre motorconst name nominal nsample plugin posrange range refsite
resistance saturation scale site slewmax slidersite tausmooth tendon thermal timeconst user velrange vmax"""
_ACTUATORS = (
    "general|motor|position|velocity|intvelocity|orientation|pid|damper|cylinder|muscle|adhesion|dcmotor|plugin"
)
_EQUALITY = "active class name solimp solref"
_HOLDERS = "worldbody|body|frame|replicate"


def _line(head: str, names: str = "") -> str:
    return f"{head}: {' '.join(names.split())}"


MJCF = Vocabulary.read(
    "\n".join(
        (
            _line("/mujoco", "model"),
            _line(
                "mujoco/compiler",
                """alignfree angle assetdir autolimits balanceinertia boundinertia boundmass conflict convexhull
                coordinate discardvisual eulerseq exactmeshinertia fitaabb fusestatic inertiafromgeom
                inertiagrouprange meshdir passthrough savecanonical savecompiled
                saveinertial settotalmass strippath texturedir usethread""",
            ),
            _line("compiler/lengthrange", "*"),
            _line(
                "mujoco/option",
                """actuatorgroupdisable apirate ccd_iterations ccd_tolerance collision cone density gravity impratio
                integrator iterations jacobian ls_iterations ls_tolerance magnetic mpr_iterations mpr_tolerance
                noslip_iterations noslip_tolerance o_friction o_margin o_solimp o_solref sdf_initpoints sdf_iterations
                sleep_tolerance solver timestep tolerance viscosity wind""",
            ),
            _line(
                "option/flag",
                """actuation autoreset clampctrl constraint contact damper diagexact energy equality eulerdamp
                filterparent frictionloss fwdinv gravity invdiscrete ipc island limit midphase multiccd
                nativeccd override passive refsafe sensor sensornoise sleep speculative spring warmstart""",
            ),
            _line("mujoco/size|statistic|visual|extension|asset|contact|sensor|custom|keyframe|deformable", "*"),
            _line("mujoco|default/default", "class"),
            _line("default/mesh|texture|material|camera|light|pair|skin|hfield", "*"),
            _line("default/joint", _JOINT),
            _line("default/geom", _GEOM),
            _line("default/site", _SITE),
            _line("default/tendon", _TENDON),
            _line("default/equality", _EQUALITY),
            _line(f"default/{_ACTUATORS}", _ACTUATOR),
            _line("mujoco/worldbody", f"{_TURNED} childclass name pos"),
            _line(f"{_HOLDERS}/body", f"{_TURNED} childclass fuse gravcomp mocap name pos simple sleep user"),
            _line(f"{_HOLDERS}/frame", f"{_TURNED} childclass name pos"),
            _line(f"{_HOLDERS}/replicate", "childclass count euler offset sep"),
            _line("body/inertial", f"{_TURNED} diaginertia fullinertia mass pos"),
            _line("body|frame/joint", _JOINT),
            _line("body|frame/freejoint", "align group name"),
            _line(f"{_HOLDERS}/geom", _GEOM),
            _line(f"{_HOLDERS}/site", _SITE),
            _line(f"{_HOLDERS}|geom/plugin", "*"),
            _line(f"{_HOLDERS}/camera|light|composite|flexcomp|attach|skin", "*"),
            _line("mujoco/tendon"),
            _line("tendon/spatial|fixed", _TENDON),
            _line("spatial|fixed/site|geom|pulley|joint", "*"),
            _line("mujoco/equality"),
            _line("equality/connect", f"{_EQUALITY} anchor body1 body2 site1 site2"),
            _line("equality/weld", f"{_EQUALITY} anchor body1 body2 relpose site1 site2 torquescale"),
            _line("equality/joint", f"{_EQUALITY} joint1 joint2 polycoef"),
            _line("equality/tendon|flex|flexvert|flexstrain|distance", "*"),
            _line("mujoco/actuator"),
            _line(f"actuator/{_ACTUATORS}", _ACTUATOR),
            _line("plugin/config", "key value"),
            _line("mujoco/include", "file"),
        )
    )
)
