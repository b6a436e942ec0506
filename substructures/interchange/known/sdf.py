"""SDF 1.4 to 1.12 (http://sdformat.org/spec), with what Drake adds to it."""

from __future__ import annotations

from substructures.interchange.known.check import Vocabulary

SDF = Vocabulary.read(r"""
/sdf: version
sdf/world: name
sdf/model: name canonical_link placement_frame namespace
sdf|world/actor|light|audio|gui|scene|physics|atmosphere|plugin|spherical_coordinates|state|population|road: *
world/model: name canonical_link placement_frame namespace
world/gravity|magnetic_field|wind|joint|frame: *
model/model: name canonical_link placement_frame namespace
model/link: name
model/joint: name type
model/frame: name attached_to
sdf|world|model/include: merge
include/uri|name|static|placement_frame:
include/plugin: *
model/plugin|gripper|sensor: *
model/static|self_collide|allow_auto_disable|enable_wind:
model/linear_bushing_rpy|ball_constraint|collision_filter_group: *
model|include|link|joint|frame|inertial|collision|visual/pose: relative_to degrees rotation_format frame
link/inertial: auto
link/collision|visual: name
link/gravity|enable_wind|self_collide|kinematic|must_be_base_link|velocity_decay: *
link/sensor|projector|audio_sink|audio_source|battery|light|particle_emitter|plugin: *
inertial/mass|density:
inertial/inertia:
inertial/fluid_added_mass|auto_inertia_params: *
inertia/ixx|ixy|ixz|iyy|iyz|izz:
collision|visual/geometry|material|surface|plugin|meta|laser_retro|max_contacts|transparency|cast_shadows: *
collision|visual/lighting|visibility_flags|density|auto_inertia_params: *
collision|visual/proximity_properties|illustration_properties|perception_properties|accepting_renderer: *
joint/parent|child: link
joint/axis|axis2:
joint/physics|sensor|gearbox_ratio|gearbox_reference_body|thread_pitch|screw_thread_pitch: *
axis|axis2/xyz: expressed_in
axis|axis2/use_parent_model_frame|initial_position:
axis|axis2/dynamics|limit:
axis|axis2|joint/rotor_inertia|gear_ratio:
axis|axis2|joint/controller_gains: *
axis|axis2/mimic: joint axis multiplier offset
dynamics/damping|friction|spring_reference|spring_stiffness:
limit/lower|upper|effort|velocity|stiffness|dissipation|acceleration:
mimic/multiplier|offset|reference:
""")
